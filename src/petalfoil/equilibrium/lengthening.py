"""A 2-D film without ends as the limit of ever longer bearings: where nothing else finds its equilibrium.

A short bearing with ambient ends has one equilibrium that a cold start finds. From there it is made longer step by step
(F6c). Where its branch ends, the interior point or a march looks for another; so the pack may snap on the way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from petalfoil.equilibrium.cold_start import BARRIERS, GOALS, MARCH, finish, nothing_found, reached
from petalfoil.equilibrium.continuation import follow, restart, widened
from petalfoil.equilibrium.pack_at_rest import assembled
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.interior_point import interior_point
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.leaking_film import LeakingFilm

FIRST = (3.0, 30.0, 300.0, 3e3, 3e4)
"""Leakages over the bearing number at which a start is tried: the smaller, the less is left to go."""

LAST = 1e-6
"""Leakage over the bearing number below which it is left out."""

FACTOR = 3.0
"""Largest factor on the leakage in one step."""

LEAST_FACTOR = 1.03
"""Factor below which the branch is taken to have ended."""

AFTER_JUMP = 1.2
"""Factor of the first step on another branch."""

LEAPS = (1.06, 1.015, 1.12, 1.01, 1.3)
"""Factors that are tried in turn where a branch has ended: which states a search ends in varies with small changes."""

DAMPINGS = (0.1, 1.0, 0.01)
"""Dampings of the wall in a march from the end of a branch."""

MARCHING = replace(MARCH, max_steps=60)
LED_ON = ContactOptions(tangents=8)


def lengthened(problem: CoupledProblem) -> Solution:
    """The equilibrium to which that of a short bearing leads as its length grows.

    Parameters
    ----------
    problem : CoupledProblem
        Bearing whose film has no ends.

    Raises
    ------
    ConvergenceError
        No length has an equilibrium, or none was found beyond some length, which the message tells.
    """
    known, leakage = shortest(problem)
    factor, leaps = FACTOR, iter(LEAPS)
    while leakage > 0.0:
        ahead = leakage / factor if leakage / factor > LAST * problem.bearing_number else 0.0
        step = found(partial(follow, known, of_length(problem, ahead), LED_ON, np.zeros_like(known.x)))
        if step is not None:
            known, leakage, factor = step, ahead, min(factor**1.5, FACTOR)
            continue
        if factor > LEAST_FACTOR and factor not in LEAPS:
            factor = factor**0.5
            continue
        step = next(filter(None, map(found, other_branches(known, problem, ahead))), None)
        if step is not None:
            known, leakage, factor, leaps = step, ahead, AFTER_JUMP, iter(LEAPS)
            continue
        factor = next(leaps, 0.0)
        if not factor:
            raise no_rest(problem, leakage)
    return replace(known, solution_path="followed from a bearing of finite length to the limit of a long one")


def of_length(problem: CoupledProblem, leakage: float) -> CoupledProblem:
    """The problem with a leakage through its ends, itself without any."""
    return LeakingFilm.through_ends(problem, leakage) if leakage else problem


def shortest(problem: CoupledProblem) -> tuple[Solution, float]:
    """The longest bearing among a few short ones that a cold start answers, and its leakage.

    Raises
    ------
    ConvergenceError
        None of them.
    """
    for over_speed in FIRST:
        leakage = over_speed * problem.bearing_number
        start = next(filter(None, map(found, cold_starts(of_length(problem, leakage)))), None)
        if start is not None:
            return start, leakage
    raise nothing_found()


def other_branches(known: Solution, problem: CoupledProblem, leakage: float) -> Iterator[Callable[[], Solution | None]]:
    """Searches for an equilibrium at a leakage that the branch of `known` does not reach."""
    target = of_length(problem, leakage)
    yield partial(restart, known, target, np.zeros_like(known.x))
    yield from cold_starts(target)
    for damping in DAMPINGS:
        yield partial(marched, known, LeakingFilm.through_ends(problem, leakage, damping), target)


def cold_starts(target: CoupledProblem) -> Iterator[Callable[[], Solution | None]]:
    """Interior points from the assembled pack."""
    for barrier in BARRIERS[:3]:
        yield partial(from_pack, target, barrier)


def from_pack(target: CoupledProblem, barrier: float) -> Solution | None:
    """The equilibrium that the assembled pack leads to at one barrier."""
    return finish(target, assembled(target, barrier), "interior point from the assembled pack")


def marched(known: Solution, damped: LeakingFilm, target: CoupledProblem) -> Solution | None:
    """Where a march with a damped wall comes to rest from the end of a branch; None if it does not."""
    run = current_run()
    start, watch = widened(damped, known.x, known.lam), run.watch("damped wall", reached(GOALS[0]))
    point, rests = interior_point(damped, start, run.film_solver, MARCHING, watch)
    return finish(target, point, "marched to rest with a damped wall") if rests else None


def found(search: Callable[[], Solution | None]) -> Solution | None:
    """What a search finds; None also where its matrix turns singular."""
    try:
        return search()
    except SingularMatrixError as failure:
        current_run().note("length", outcome=str(failure))
        return None


def no_rest(problem: CoupledProblem, leakage: float) -> ConvergenceError:
    """The error of a pack whose branches end before the limit of a long bearing."""
    length = LeakingFilm.through_ends(problem, leakage).length * problem.layout.balance.radius
    own = problem.layout.case.bearing.length
    return ConvergenceError(
        "no equilibrium found in the limit of a long bearing (2-D, continuous edges): lengthened from a short one with "
        f"ambient ends, equilibria were found up to a length of {length:.3g} m and none beyond it",
        history=current_run().history,
        advice=f'take the length of the bearing into account, {own:.3g} m: model.kind = "3d"; or model.edges = '
        '"ambient", if the films are vented at the petals\' edges',
    )
