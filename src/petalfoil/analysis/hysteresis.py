"""The package at rest with friction between its petals: loading, unloading, loading again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.session import Clock
from petalfoil.case import Case
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.equilibrium.package_at_rest import at_rest, unloaded
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import RefinedState, Solution
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_newton import ActiveOptions, active_set
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import FrictionState, friction_of
from petalfoil.system.package import PackageProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Before = tuple[Array, Array, Mask, FrictionState]

HALVINGS = 8
"""Times that a way between two points may be halved before there is no answer."""

WAY = "package at rest, moved here with friction between its petals"
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
        The package there; None if it was not found.
    lost : float
        Energy lost to friction from the start up to here [J].
    work, seconds
        What it cost.
    """

    case: Case
    leg: str
    answer: Solution | None
    lost: float
    work: RunLog
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
    before: tuple[CoupledProblem, Before] | None = None
    total, unit = 0.0, base.layout.scales.force * base.layout.scales.length
    for leg, case in way:
        clock, work = Clock(), RunLog()
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        slid = moved(friction, before, problem, work) if before else assembled(friction, problem, work)
        if slid is None:
            yield Point(case, leg, None, total * unit, work, clock.seconds)
            continue
        total += slid.lost
        before = problem, (slid.x, slid.lam, slid.closed, slid.rubbed)
        yield Point(case, leg, answer_of(problem, slid), total * unit, work, clock.seconds)


def assembled(friction: Friction, problem: CoupledProblem, work: RunLog) -> FrictionResult | None:
    """The package as it is assembled: no friction yet; None if it did not settle."""
    found = at_rest(problem, work)
    if found is None:
        return None
    closed, _ = active_set(unloaded(problem), *found, work.package_solver, ActiveOptions())
    if closed is None:
        return None
    rubbed = FrictionState.fresh(friction, closed.x, closed.lam)
    return FrictionResult(closed.x, closed.lam, closed.closed, closed.residual, rubbed, 0.0)


def moved(
    friction: Friction, before: tuple[CoupledProblem, Before], problem: CoupledProblem, work: RunLog
) -> FrictionResult | None:
    """The package after the journal has moved on to `problem`, in halves where a step is too long; None if it fails."""
    begin, state = before
    parts, lost, done, residual = [1.0], 0.0, 0.0, 0.0
    start, end = begin.displacement, problem.displacement
    while parts:
        there = done + parts[-1]
        here = problem.at(displacement=start + there * (end - start))
        package = PackageProblem(here, np.zeros(problem.layout.n_wall))
        slid = slide(package, friction, state, work.package_solver)
        work.note("friction", share=there, outcome="found" if slid is not None else "halved")
        if slid is None:
            if len(parts) > HALVINGS:
                return None
            parts = [*parts[:-1], 0.5 * parts[-1], 0.5 * parts[-1]]
            continue
        parts.pop()
        done, lost, residual = there, lost + slid.lost, slid.residual
        state = slid.x, slid.lam, slid.closed, slid.rubbed
    return FrictionResult(*state[:3], residual, state[3], lost)


def answer_of(problem: CoupledProblem, slid: FrictionResult) -> Solution:
    """The state as the package's, under a film at rest."""
    still = problem.at(bearing_number=0.0)
    x = np.concatenate([slid.x, np.ones(problem.layout.n - problem.layout.n_wall)])
    return Solution(still, RefinedState(x, np.zeros(problem.layout.n_wall), slid.lam), slid.residual, WAY)
