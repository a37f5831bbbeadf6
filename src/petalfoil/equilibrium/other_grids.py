"""A 2-D film without ends from its equilibrium on another grid, where nothing else finds one on its own.

Petals that snap one by one fold every path from nothing a hundred times on one grid, and hardly on another: the places
at which contacts can lie differ. Deflections and pressures are interpolated from there, and the interior point, or a
march with a damped wall, goes on from what they give. The answer is that of the grid that was asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import BARRIERS, by_barriers, first_answer, marched_to_rest, marches
from petalfoil.equilibrium.pack_at_rest import assembled
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.mesh.splines import monotone
from petalfoil.solvers.problem import ContactProblem, PrimalDualPoint
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.damped import DampedWall
from petalfoil.system.unknowns import DEFLECTION, PRESSURE
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

FACTORS = (2.0 / 3.0, 2.0, 1.25, 0.5)
"""Cells per pitch over those asked for, in the order of trial. Of the four among 2000 random bearings that nothing else
answers, each of the first two answers three."""

LEAST_CELLS, MOST_CELLS = 8, 512
"""Grids beyond these are not tried: on coarser ones contacts are far from where they lie, finer ones take minutes."""

CARRIED_BARRIERS = (0.1, 0.01)
"""Barriers of an interior point, and of a march, from interpolated unknowns."""

CARRIED_DAMPINGS = (0.1, 1.0, 0.01)
"""Dampings of the wall in a march from interpolated unknowns."""


def or_from_other_grids(search: Callable[[CoupledProblem], Solution], problem: CoupledProblem) -> Solution:
    """What a search finds at a position; where it finds nothing, what the equilibrium on another grid leads to.

    Raises
    ------
    ConvergenceError
        That of the search, where other grids lead nowhere either.
    """
    try:
        return search(problem)
    except ConvergenceError:
        found = by_other_grids(problem)
        if found is None:
            raise
        return found


def by_other_grids(problem: CoupledProblem) -> Solution | None:
    """The equilibrium to which that on another grid leads; None if none does."""
    for other in grids(problem):
        known = on_grid(other)
        if known is None:
            continue
        points = points_from(problem, lambda damping: DampedWall.of(problem, damping), carried(known, problem))
        found = first_answer(problem, ((point, path_told(known)) for point in points))
        if found is not None:
            return replace(found, shortest_step=None, step_count=None)
    return None


def path_told(known: Solution) -> str:
    """How an answer was reached from one on another grid."""
    return f"from the equilibrium on {known.case.cells_per_pitch} cells per pitch"


def grids(problem: CoupledProblem) -> Iterator[CoupledProblem]:
    """The problem on other grids, at its speed and position; none but for petals that bend only, without ends."""
    layout = problem.layout
    case, axial = layout.case, layout.wall.film.axial
    if not (problem.endless and axial.is_2d) or layout.fields or not wall_kind(case).interpolates(case):
        return
    for factor in FACTORS:
        cells = round(factor * case.cells_per_pitch)
        if LEAST_CELLS <= cells <= MOST_CELLS and cells != case.cells_per_pitch:
            current_run().note("other grid", cells_per_pitch=cells)
            other = build_problem(case.replace(**{"model.cells_per_pitch": cells}))
            yield other.at(
                bearing_number=problem.bearing_number,
                displacement=problem.displacement,
                temperatures=problem.temperatures,
            )


def on_grid(other: CoupledProblem) -> Solution | None:
    """The equilibrium on a grid by the interior point, or by a march with a damped wall; None if they find none."""
    found = by_barriers(other, BARRIERS)
    if found is not None:
        return found
    return first_answer(other, marches(partial(DampedWall.of, other), partial(assembled, other)))


def points_from(
    problem: ContactProblem, damped: Callable[[float], ContactProblem], x: Array
) -> Iterator[PrimalDualPoint]:
    """Points whence the interior point may lead to a solution: unknowns `x` (n,), and where marches from there rest.

    Parameters
    ----------
    problem : ContactProblem
        What is solved.
    damped : callable
        The same with a damping of the wall.
    x : (n,) array
        Unknowns close to a solution [1].
    """
    for barrier in CARRIED_BARRIERS:
        yield opened(problem, x, barrier)
    for damping in CARRIED_DAMPINGS:
        for barrier in CARRIED_BARRIERS:
            point = marched_to_rest(damped(damping), opened(problem, x, barrier))
            if point is not None:
                yield point


def opened(problem: ContactProblem, x: Array, barrier: float) -> PrimalDualPoint:
    """A point of the interior-point method at unknowns `x` (n,), its pairs on the central path at a barrier."""
    s = np.maximum(problem.gaps(x), np.sqrt(barrier))
    return PrimalDualPoint(x, s, barrier * problem.weight / s)


def carried(known: Solution, problem: CoupledProblem) -> Array:
    """Unknowns (n,) on the grid of `problem` from an equilibrium on another one, by monotone cubics along petals."""
    before, here = known.problem.layout, problem.layout
    w = known.deflection * (before.scales.length / here.scales.length)
    deflection = wall_kind(here.case).interpolated(before.case, here.case, w)
    coarse, film = before.wall.film, here.wall.film
    ln_P = monotone(coarse.phi, np.log(known.problem.pressure(known.x)), axis=1)(film.phi)
    return here.unknowns.join({DEFLECTION: deflection, PRESSURE: film.at_unknowns(np.exp(ln_P))})
