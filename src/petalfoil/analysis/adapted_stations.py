"""Stations along the shaft where the solution bends most, from a solution of the same bearing on a coarse grid.

Near both ends the petals lift off the film within a few millimetres: the film opens fivefold between two of 24 equal
stations, and pressure and film of the whole bearing are wrong by some per cent. The density of the stations is

    rho(z) = sqrt( |P_zz| / mean + |(P - 1) (ln H)_zz| / mean )       root mean squares round the bearing

smoothed, with a floor. A case gets it as `model.axial_density`: it is that of the case's own operating point, whatever
is asked, so that all results of a case share their stations.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.side_stations import side_density
from petalfoil.case import Case, PetalTheory
from petalfoil.case.sections import UNIFORM
from petalfoil.equilibrium.cold_start import by_barriers
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.errors import ConvergenceError
from petalfoil.memory import check_memory
from petalfoil.system.build import build_problem
from petalfoil.system.loaded import load_of
from petalfoil.walls.petals import stretches

Array = NDArray[np.float64]

FIRST_CELLS, FIRST_AXIAL = 12, 16
"""Grid of the coarse solution, a twelfth of the time of the default grid. From 24 × 16 cells stations are the same
within 2 %."""

FIRST_GRADING = 0.8
"""How far cells of a second coarse solution shrink toward the ends, from 9 to 1 mm on 76 mm. The contact of the rig at
12 000 rpm, 1 mm wide and 2 mm from the ends, lies between the first two of equal cells: the contact fraction on 24
stations is half of that on 72 without a second solution, 5 % lower with it."""

FLOOR = 0.3
"""Least density over the mean of what asks for stations. On 24 cells, 8 petals at 200 and 280 um: minimum film within
0.5 % of that on 48, peak pressure within 0.3 % (1.0: 0.8 and 1.7 %; equal stations: 2.2 and 4.4 %)."""

SMOOTHINGS = 2
"""Times that each density is averaged with its neighbours (1/4, 1/2, 1/4): cells then grow evenly."""

DIGITS = 4
"""Digits of a density: what rounding does to the coarse solution does not reach the stations."""


def with_stations(case: Case) -> Case:
    """The case with its adapted `model.axial_density`; as it is where stations are not to be adapted.

    Petals that stretch need stations at their sides, which no solution has to tell (`side_stations.py`), unless the
    case asks for adapted ones. Where what asks for stations is largest at the ends, equal cells do not resolve it: the
    coarse solution is repeated on cells that shrink toward them, of petals that bend only. Where the coarse grid has no
    solution, stations lie at equal distances, and the case of the result says so.

    Raises
    ------
    DefinitionError
        The grid of the case needs more memory than there is.
    """
    if not case.adapts_stations or case.operation.speed == 0.0:
        return case
    check_memory(case)
    if stretches(case) and case.model.axial_density is None:
        return case.replace(**{"model.axial_density": side_density(case)})
    density = coarse_density(case, {"model.axial_density": UNIFORM})
    bends_only = case.petal_theory is PetalTheory.INEXTENSIBLE
    if bends_only and density is not None and density[0] == max(density):
        density = coarse_density(case, {"model.axial_density": None, "model.axial_grading": FIRST_GRADING}) or density
    return case.replace(**{"model.axial_density": UNIFORM if density is None else density})


def coarse_density(case: Case, cells: dict[str, object]) -> tuple[float, ...] | None:
    """Density of the stations from the coarse grid with these `cells` over the length; None without a solution."""
    grid = {"model.cells_per_pitch": min(case.cells_per_pitch, FIRST_CELLS), "model.axial_cells": FIRST_AXIAL}
    with one_thread(), running():
        solution = coarse_solution(case.replace(**grid, **cells))
    return None if solution is None else station_density(solution)


def coarse_solution(case: Case) -> Solution | None:
    """An equilibrium at the case's operating point; None where none is found at once."""
    load = case.operation.load
    if not case.shares_evenly:  # the first bearing under its part of the load
        case, load = case.supports[0], None if load is None else RotorInBearings.of(case, load).shares()[0]
    problem = build_problem(case)
    if load is None:
        return by_barriers(problem)
    try:
        return balance_cold(problem, load_of(case, load, problem.layout))
    except ConvergenceError:  # the analysis itself will say why, on the grid that is asked for
        return None


def station_density(solution: Solution) -> tuple[float, ...]:
    """Density of the stations at equal distances from an end to the middle, with mean 1, from a coarse solution."""
    problem, axial = solution.problem, solution.problem.layout.wall.film.axial
    z, P, H = axial.whole_z, axial.whole(problem.pressure(solution.x)), axial.whole(problem.film(solution.x))
    by_pressure = round_the_bearing(second_derivative(P, z))
    by_film = round_the_bearing((P[..., 1:-1] - 1.0) * second_derivative(np.log(H), z))
    wanted = np.sqrt(over_mean(by_pressure) + over_mean(by_film))
    equal = np.linspace(0.0, axial.length, FIRST_AXIAL + 1)
    density = np.interp(equal, z[1:-1], wanted)
    for _ in range(SMOOTHINGS):
        padded = np.pad(density, 1, mode="edge")
        density = 0.25 * padded[:-2] + 0.5 * padded[1:-1] + 0.25 * padded[2:]
    density = density + FLOOR * float(np.mean(density))
    density = 0.5 * (density + density[::-1])
    half = density[: len(density) // 2 + 1] / float(np.mean(density))
    return tuple(float(f"{value:.{DIGITS}g}") for value in half)


def second_derivative(values: Array, z: Array) -> Array:
    """Second derivative along the last axis at the inner stations `z`."""
    slope = np.diff(values, axis=-1) / np.diff(z)
    return np.asarray(np.diff(slope, axis=-1) / (0.5 * (z[2:] - z[:-2])))


def round_the_bearing(values: Array) -> Array:
    """Root mean square over strips and nodes, (axial,)."""
    return np.asarray(np.sqrt(np.mean(values**2, axis=(0, 1))))


def over_mean(values: Array) -> Array:
    """Values over their mean; zeros where all vanish."""
    mean = float(np.mean(values))
    return values / mean if mean > 0.0 else np.zeros_like(values)
