"""The foil pack without film, assembled and moved with friction between its petals: it depends on the path."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_handover import PathState, at_nodes, at_points
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.line_handover import on_lines
from petalfoil.equilibrium.pack_at_rest import at_rest, unloaded
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.point_friction_path import RubbingPoints, slide_at_points
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState
from petalfoil.system.pack_at_points import PackAtPoints

HALVINGS = 12
"""Times that a step of the way may be halved before there is no answer."""

AT_NODES = 4
"""How many of these halvings are left to contacts at nodes, where contact points are lost: states that are handed over
move by what the two grids differ by."""

MOST_HALVED = 60
"""Steps of a way that may be halved before nodes hold the contacts to its end: stiff packs would be led there in
thousands of steps of the shortest length."""

ROUNDING = 1e-9
"""Part of a step by which its halves may differ from powers of two."""

LONGEST_MOVE = 5e-6
"""Longest step of a journal that moves in petals that slide along themselves [m]."""

LONGEST_INSERTION = 5e-5
"""Longest step of the radius of a journal that is inserted into them [m]."""


@dataclass(frozen=True)
class PathEnd:
    """The end of a way.

    Attributes
    ----------
    state : FrictionResult, RubbingPoints or PackOnLines
        The state.
    lost : float
        Energy lost on the way, over the units of force and length [1].
    steps, at_points : int
        Steps of the way, and how many of them ended with contact points.
    """

    state: PathState
    lost: float = 0.0
    steps: int = 0
    at_points: int = 0

    def then(self, state: PathState) -> PathEnd:
        """After one more step."""
        at_points = self.at_points + (not isinstance(state, FrictionResult))
        return PathEnd(state, self.lost + state.lost, self.steps + 1, at_points)


def assembled(friction: Friction, problem: CoupledProblem, *, points: bool = True) -> PathEnd | None:
    """The foil pack as it is assembled, with contact `points` where it has any; None if none was found.

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
        return PathEnd(start)
    begin = (with_points(friction, pack, start) if points else None) or start
    steps = math.ceil(problem.layout.case.bearing.clearance / LONGEST_INSERTION)
    way = partial(inserted, problem, clearance)
    slid = led(friction, begin, way, steps, points=points)
    return None if slid is None else replace(slid, lost=0.0)  # energy is counted from the assembled pack on


def moved(friction: Friction, before: tuple[CoupledProblem, PathState], problem: CoupledProblem) -> PathEnd | None:
    """The pack after the journal has moved on to `problem`; None if it fails."""
    begin, state = before
    start, way = begin.displacement, problem.displacement - begin.displacement
    longest = LONGEST_MOVE / problem.layout.scales.length if friction.exact else np.inf
    steps = max(1, math.ceil(float(np.linalg.norm(way)) / longest - 1e-9))
    return led(friction, state, lambda share: unloaded(problem.at(displacement=start + share * way), still=True), steps)


def inserted(problem: CoupledProblem, clearance: float, share: float) -> FoilPackProblem:
    """The pack round a journal that a `share` of the clearance has been added to."""
    return unloaded(problem, (1.0 - share) * clearance, still=True)


def led(
    friction: Friction, state: PathState, at: Callable[[float], FoilPackProblem], steps: int, *, points: bool = True
) -> PathEnd | None:
    """The pack led along a way in equal steps, in halves where one is too long; None if it fails.

    Where contact `points` are lost, nodes hold the contacts until points are found again.
    """
    parts, done, way, halved = [1.0 / steps] * steps, 0.0, PathEnd(state), 0
    shortest = (1.0 + ROUNDING) * 0.5**HALVINGS / steps
    while parts:
        there = 1.0 if len(parts) == 1 else done + parts[-1]
        slid = slid_to(at(there), friction, way.state)
        current_run().note("friction", share=there, outcome="halved" if slid is None else "found")
        if slid is not None:
            parts.pop()
            done = there
            nodal = slid if points and isinstance(slid, FrictionResult) else None
            way = way.then((None if nodal is None else with_points(friction, at(there), nodal)) or slid)
        elif not isinstance(way.state, FrictionResult) and (
            halved == MOST_HALVED or parts[-1] <= shortest * 2.0**AT_NODES
        ):
            points = points and halved < MOST_HALVED
            current_run().note("friction", share=done, outcome="contact points lost")
            nodal = at_nodes(friction, way.state, at(done))
            if nodal is None:
                return None
            way = replace(way, state=nodal)
        elif parts[-1] <= shortest:
            return None
        else:
            parts, halved = [*parts[:-1], 0.5 * parts[-1], 0.5 * parts[-1]], min(halved + 1, MOST_HALVED)
    return way


def slid_to(pack: FoilPackProblem, friction: Friction, before: PathState) -> PathState | None:
    """The pack after a step: exact, or with friction that builds up over a width."""
    solver = current_run().pack_solver
    if isinstance(before, PackOnLines):
        return slide_on_lines(replace(before, pack=pack), before, solver)
    if isinstance(before, RubbingPoints):
        ahead = PackAtPoints.of(before.whole, pack.coupled, before.state, before.force, pack.withdrawn)
        return slide_at_points(ahead, before.law(friction.coefficient), solver)
    if not friction.exact:
        return slide(pack, friction, before, solver)
    return slide_exactly(pack, friction, before, pack.layout.wall.contacts.line_numbers, solver)


def with_points(friction: Friction, pack: FoilPackProblem, nodal: FrictionResult) -> RubbingPoints | PackOnLines | None:
    """A state with contacts at nodes with contact points or, in 3-D, lines that keep its friction forces.

    None where there are none near it, or none are asked for.
    """
    whole = pack.layout.elements
    if friction.exact and pack.layout.case.has_contact_lines:
        return on_lines(friction, pack, nodal)
    if whole is None or not friction.exact:
        return None
    state, force = at_points(whole, friction, nodal)
    ahead = PackAtPoints.of(whole, pack.coupled, state, force, pack.withdrawn)
    found = slide_at_points(ahead, None, current_run().pack_solver)
    return None if found is None else replace(found, lost=nodal.lost)
