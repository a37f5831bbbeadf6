"""The package at rest with friction between its petals: loading, unloading, loading again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.session import Clock, one_thread
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer, State
from petalfoil.equilibria.package import at_rest, unloaded
from petalfoil.equilibria.sliding import Slid, slide
from petalfoil.equilibria.work import Work
from petalfoil.physics.friction import Friction
from petalfoil.problem.build import build_problem
from petalfoil.problem.coupled import CoupledProblem
from petalfoil.problem.package import PackageProblem
from petalfoil.problem.sliding import Rubbed, friction_of
from petalfoil.solvers.active_set import ActiveOptions, active_set

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Before = tuple[Array, Array, Mask, Rubbed]

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
    answer : Answer or None
        The package there; None if it was not found.
    lost : float
        Energy lost to friction from the start up to here [J].
    work, seconds
        What it cost.
    """

    case: Case
    leg: str
    answer: Answer | None
    lost: float
    work: Work
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
        clock, work = Clock(), Work()
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        with one_thread():
            slid = moved(friction, before, problem, work) if before else assembled(friction, problem, work)
        if slid is None:
            yield Point(case, leg, None, total * unit, work, clock.seconds)
            continue
        total += slid.lost
        before = problem, (slid.x, slid.lam, slid.closed, slid.rubbed)
        yield Point(case, leg, answer_of(problem, slid), total * unit, work, clock.seconds)


def assembled(friction: Friction, problem: CoupledProblem, work: Work) -> Slid | None:
    """The package as it is assembled: no friction yet; None if it did not settle."""
    found = at_rest(problem, work)
    if found is None:
        return None
    closed, _ = active_set(unloaded(problem), *found, work.package_solver, ActiveOptions())
    if closed is None:
        return None
    rubbed = Rubbed.fresh(friction, closed.x, closed.lam)
    return Slid(closed.x, closed.lam, closed.closed, closed.residual, rubbed, 0.0)


def moved(
    friction: Friction, before: tuple[CoupledProblem, Before], problem: CoupledProblem, work: Work
) -> Slid | None:
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
    return Slid(*state[:3], residual, state[3], lost)


def answer_of(problem: CoupledProblem, slid: Slid) -> Answer:
    """The state as the package's, under a film at rest."""
    still = problem.at(bearing_number=0.0)
    x = np.concatenate([slid.x, np.ones(problem.layout.n - problem.layout.n_wall)])
    return Answer(still, State(x, np.zeros(problem.layout.n_wall), slid.lam), slid.residual, WAY)
