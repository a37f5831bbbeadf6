"""The foil pack at zero speed with friction between its petals: loading, unloading, loading again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.friction_handover import PathState
from petalfoil.equilibrium.friction_history import assembled, moved
from petalfoil.equilibrium.nodal_state import sampled_lines, sampled_solution
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.point_friction_path import RubbingPoints
from petalfoil.equilibrium.run_context import RunContext, running
from petalfoil.equilibrium.solution import RefinedState, Solution
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of

Array = NDArray[np.float64]

WAY = "foil pack at zero speed, moved here with friction between its petals"
"""How such a state was reached."""


@dataclass(frozen=True)
class LoopPoint:
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
    point_share : float or None
        Share of the steps up to here that ended with contact points [1]; None if it was not found.
    run, seconds
        The run that found it, and its wall time [s].
    """

    case: Case
    leg: str
    answer: Solution | None
    lost: float
    point_share: float | None
    run: RunContext
    seconds: float


def legs(cases: Sequence[Case], loop: bool) -> list[tuple[str, Case]]:
    """The way through `cases`: there, and if a `loop` is asked for, back and there again."""
    way = [("loading", case) for case in cases]
    if loop:
        way += [("unloading", case) for case in reversed(cases[:-1])] + [("reloading", case) for case in cases[1:]]
    return way


def follow(way: list[tuple[str, Case]]) -> Iterator[LoopPoint]:
    """Yield the states along `way`, each from the one before; the first is assembled without friction."""
    base = build_problem(way[0][1])
    friction = friction_of(way[0][1], base.layout)
    if friction is None:
        raise ValueError("without friction the way does not matter")
    before: tuple[CoupledProblem, PathState] | None = None
    total, unit, steps, at_points = 0.0, base.layout.scales.force * base.layout.scales.length, 0, 0
    for leg, case in way:
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        with running() as run:
            gone = moved(friction, before, problem) if before else assembled(friction, problem)
        if gone is None:
            yield LoopPoint(case, leg, None, total * unit, None, run, run.seconds)
            continue
        total, steps, at_points = total + gone.lost, steps + gone.steps, at_points + gone.at_points
        before, share = (problem, gone.state), at_points / steps if steps else 0.0
        yield LoopPoint(case, leg, answer_of(problem, gone.state), total * unit, share, run, run.seconds)


def answer_of(problem: CoupledProblem, slid: PathState) -> Solution:
    """The state as the pack's, under a film at rest."""
    still = problem.at(bearing_number=0.0)
    if isinstance(slid, RubbingPoints):
        equations = replace(slid.equations, film_held=None)
        return replace(sampled_solution(PointContacts(equations, slid.residual), None), solution_path=WAY)
    if isinstance(slid, PackOnLines):
        return replace(sampled_lines(slid.in_film(still), None), solution_path=WAY)
    state = RefinedState(problem.layout.ambient(slid.x), np.zeros(problem.layout.n_wall), slid.lam)
    return Solution(still, state, slid.residual, WAY)
