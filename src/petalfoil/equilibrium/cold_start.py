"""Film and package from nothing: the assembled package, then both through the interior point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from petalfoil.equilibrium.package_at_rest import assembled
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution, from_closed, from_point
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.contact_newton import ActiveOptions, active_set
from petalfoil.solvers.interior_point import InteriorOptions, Step, contact_set, interior_point
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import RESIDUAL_TOLERANCE, CoupledProblem

BARRIERS = (3.0, 30.0, 0.3, 300.0)
"""Barriers at which the film joins, in ambient pressure times 10 um; the first serves 97 % of random packages."""

FILM_ALONE = ActiveOptions(max_steps=60, near=0.3, gain=0.2, chords=8)
"""Over a rigid wall Newton converges from afar, and a step with the factor at hand costs a fifth of another."""

GOALS = (1e-5, 1e-8, 1e-11)
"""Barriers at which the contact set is read and tried: it is right, or close, at the first on grids up to 512 cells a
pitch."""


def solve_cold(problem: CoupledProblem, work: RunLog, barriers: tuple[float, ...] = BARRIERS) -> Solution:
    """Solve from nothing; each barrier in turn until one leads to an answer.

    Raises
    ------
    ConvergenceError
        None did.
    """
    for barrier in barriers:
        answer = attempt(problem, barrier, work)
        if answer is not None:
            return answer
    raise nothing_found(work)


def nothing_found(work: RunLog) -> ConvergenceError:
    """The error of a search that came to nothing, with its history."""
    return ConvergenceError(
        "no equilibrium found: film, petals and contacts did not settle from any start",
        history=work.history,
        advice="refine the grid, lower the eccentricity or approach it along a curve; extreme preload (thick or short "
        "petals, a rigid mount with a steep root) makes equilibria that switch from node to node",
    )


def attempt(problem: CoupledProblem, barrier: float, work: RunLog) -> Solution | None:
    """Solve from the assembled package at one barrier; None if that leads nowhere."""
    way = f"interior point from the assembled package, barrier {barrier:g}"
    if not problem.layout.n_wall:
        return over_rigid_wall(problem, work)
    try:
        return finish(problem, assembled(problem, barrier, work), way, work)
    except SingularMatrixError as failure:
        work.note("film", outcome=str(failure))
        return None


def over_rigid_wall(problem: CoupledProblem, work: RunLog) -> Solution | None:
    """The film alone, from ambient pressure: nothing moves and nothing touches."""
    untouched = np.zeros(len(problem.weight), dtype=bool)
    closed, outcome = active_set(problem, np.ones(problem.layout.n), untouched, work.film_solver, FILM_ALONE)
    work.note("film", outcome=outcome.value)
    return from_closed(problem, closed, "Newton from ambient pressure")


def finish(
    problem: CoupledProblem, start: ConePoint, way: str, work: RunLog, options: InteriorOptions | None = None
) -> Solution | None:
    """Drive the barrier down from `start`; read the contact set as soon as it shows, and solve on it exactly."""
    point, numbers = start, options or InteriorOptions()
    for goal in GOALS:
        numbers = replace(numbers, least_barrier=0.1 * goal)
        point, found = interior_point(problem, point, work.film_solver, numbers, work.watch("film", content(goal)))
        numbers = replace(numbers, march=False)
        if not found:
            return None
        x, touching = contact_set(problem, point, work.film_solver)
        closed, outcome = active_set(problem, x, touching, work.film_solver, ActiveOptions())
        work.note("contacts", outcome=outcome.value, touching=int(touching.sum()))
        answer = from_closed(problem, closed, way)
        if answer is not None:
            return answer
    return from_point(problem, point, way)


def content(goal: float) -> Callable[[Step], bool]:
    """Stop at the barrier `goal`, with residuals to match."""

    def look(step: Step) -> bool:
        residual = max(1e2 * goal, 0.5 * RESIDUAL_TOLERANCE)
        return step.barrier < goal and step.residual < residual and step.infeasibility < residual

    return look
