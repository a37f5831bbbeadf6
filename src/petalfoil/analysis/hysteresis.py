"""The foil pack at zero speed with friction between its petals: loading, unloading, loading again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.equilibrium.pack_at_rest import at_rest, unloaded
from petalfoil.equilibrium.run_context import RunContext, current_run, running
from petalfoil.equilibrium.solution import RefinedState, Solution
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState, friction_of

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

HALVINGS = 8
"""Times that a way between two points may be halved before there is no answer."""

WAY = "foil pack at zero speed, moved here with friction between its petals"
"""How such a state was reached."""


@dataclass(frozen=True)
class Point:
    """A state on the way.

    Attributes
    ----------
    case : Case
        The journal's place.
    leg : str
        "loading", "unloading" or "reloading".
    answer : Solution or None
        The foil pack there; None if it was not found.
    lost : float
        Energy lost to friction from the start up to here [J].
    run, seconds
        The run that found it, and its wall time [s].
    """

    case: Case
    leg: str
    answer: Solution | None
    lost: float
    run: RunContext
    seconds: float


def legs(cases: Sequence[Case], loop: bool) -> list[tuple[str, Case]]:
    """The way through `cases`: there, and if a `loop` is asked for, back and there again."""
    way = [("loading", case) for case in cases]
    if loop:
        way += [("unloading", case) for case in reversed(cases[:-1])] + [("reloading", case) for case in cases[1:]]
    return way


def follow(way: list[tuple[str, Case]]) -> Iterator[Point]:
    """Yield the states along `way`, each from the one before; the first is assembled without friction."""
    base = build_problem(way[0][1])
    friction = friction_of(way[0][1], base.layout)
    if friction is None:
        raise ValueError("without friction the way does not matter")
    before: tuple[CoupledProblem, FrictionResult] | None = None
    total, unit = 0.0, base.layout.scales.force * base.layout.scales.length
    for leg, case in way:
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        with running() as run:
            slid = moved(friction, before, problem) if before else assembled(friction, problem)
        if slid is None:
            yield Point(case, leg, None, total * unit, run, run.seconds)
            continue
        total += slid.lost
        before = problem, slid
        yield Point(case, leg, answer_of(problem, slid), total * unit, run, run.seconds)


def assembled(friction: Friction, problem: CoupledProblem) -> FrictionResult | None:
    """The foil pack as it is assembled: no friction yet; None if it did not settle."""
    found = at_rest(problem)
    if found is None:
        return None
    contacts, _ = solve_contacts(unloaded(problem), (found.x, found.active), current_run().pack_solver)
    if contacts is None:
        return None
    fresh = FrictionState.fresh(friction, contacts.x, contacts.lam)
    return FrictionResult(contacts.x, contacts.lam, contacts.active, contacts.state.residual, fresh, 0.0)


def moved(
    friction: Friction, before: tuple[CoupledProblem, FrictionResult], problem: CoupledProblem
) -> FrictionResult | None:
    """The pack after the journal has moved on to `problem`, in halves where a step is too long; None if it fails."""
    begin, state = before
    parts, lost, done = [1.0], 0.0, 0.0
    start, end = begin.displacement, problem.displacement
    while parts:
        there = done + parts[-1]
        here = problem.at(displacement=start + there * (end - start))
        package = FoilPackProblem(here, np.zeros(problem.layout.n_wall))
        slid = slide(package, friction, state, current_run().pack_solver)
        current_run().note("friction", share=there, outcome="found" if slid is not None else "halved")
        if slid is None:
            if len(parts) > HALVINGS:
                return None
            parts = [*parts[:-1], 0.5 * parts[-1], 0.5 * parts[-1]]
            continue
        parts.pop()
        done, lost = there, lost + slid.lost
        state = slid
    return replace(state, lost=lost)


def answer_of(problem: CoupledProblem, slid: FrictionResult) -> Solution:
    """The state as the pack's, under a film at rest."""
    still = problem.at(bearing_number=0.0)
    state = RefinedState(problem.layout.ambient(slid.x), np.zeros(problem.layout.n_wall), slid.lam)
    return Solution(still, state, slid.residual, WAY)
