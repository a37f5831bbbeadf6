"""The foil pack without film, assembled and moved with friction between its petals: it depends on the path."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.equilibrium.pack_at_rest import at_rest, unloaded
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState

HALVINGS = 8
"""Times that a step of the way may be halved before there is no answer."""

LONGEST_MOVE = 5e-6
"""Longest step of a journal that moves in petals that slide along themselves [m]."""

LONGEST_INSERTION = 5e-5
"""Longest step of the radius of a journal that is inserted into them [m]."""


def assembled(friction: Friction, problem: CoupledProblem) -> FrictionResult | None:
    """The foil pack as it is assembled; None if none was found.

    Petals that slide along themselves lie without friction round a thinner journal, short of its radius by the radial
    clearance, which then grows to its size: friction builds up as petals are pressed outward. Others are assembled
    without friction.
    """
    clearance = problem.layout.case.bearing.clearance / problem.layout.scales.length if friction.exact else 0.0
    found = at_rest(problem, clearance, still=True)
    if found is None:
        return None
    pack = unloaded(problem, clearance, still=True)
    contacts, _ = solve_contacts(pack, (found.x, found.active), current_run().pack_solver)
    if contacts is None:
        return None
    fresh = FrictionState.fresh(friction, contacts.x, contacts.lam)
    start = FrictionResult(contacts.x, contacts.lam, contacts.active, contacts.state.residual, fresh, 0.0)
    if not friction.exact:
        return start
    steps = math.ceil(problem.layout.case.bearing.clearance / LONGEST_INSERTION)
    slid = led(friction, start, lambda share: unloaded(problem, (1.0 - share) * clearance, still=True), steps)
    return None if slid is None else replace(slid, lost=0.0)  # energy is counted from the assembled pack on


def moved(
    friction: Friction, before: tuple[CoupledProblem, FrictionResult], problem: CoupledProblem
) -> FrictionResult | None:
    """The pack after the journal has moved on to `problem`; None if it fails."""
    begin, state = before
    start, way = begin.displacement, problem.displacement - begin.displacement
    longest = LONGEST_MOVE / problem.layout.scales.length if friction.exact else np.inf
    steps = max(1, math.ceil(float(np.linalg.norm(way)) / longest - 1e-9))
    return led(friction, state, lambda share: unloaded(problem.at(displacement=start + share * way), still=True), steps)


def led(
    friction: Friction, state: FrictionResult, at: Callable[[float], FoilPackProblem], steps: int
) -> FrictionResult | None:
    """The pack led along a way in equal steps, in halves where one is too long; None if it fails."""
    parts, lost, done = [1.0 / steps] * steps, 0.0, 0.0
    halved = steps + HALVINGS
    while parts:
        there = 1.0 if len(parts) == 1 else done + parts[-1]
        slid = slid_to(at(there), friction, state)
        current_run().note("friction", share=there, outcome="found" if slid is not None else "halved")
        if slid is None:
            if len(parts) > halved:
                return None
            parts = [*parts[:-1], 0.5 * parts[-1], 0.5 * parts[-1]]
            continue
        parts.pop()
        done, lost = there, lost + slid.lost
        state = slid
    return replace(state, lost=lost)


def slid_to(pack: FoilPackProblem, friction: Friction, before: FrictionResult) -> FrictionResult | None:
    """The pack after a step: exact, or with friction that builds up over a width."""
    solver = current_run().pack_solver
    if not friction.exact:
        return slide(pack, friction, before, solver)
    return slide_exactly(pack, friction, before, pack.layout.wall.contacts.line_numbers, solver)
