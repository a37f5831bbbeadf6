"""Case -> coupled problem."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.memory import check_memory
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.scales import scales_of
from petalfoil.walls import Wall, build_wall
from petalfoil.walls.tilting import tilting
from petalfoil.walls.two_bearings import paired


def build_problem(case: Case) -> CoupledProblem:
    """Discretise `case` at its speed and eccentricity; a grid beyond the memory there is is refused first.

    A journal under a moment is free to tilt, and starts parallel to the bushing.
    """
    check_memory(case)
    if case.operation.moment is not None:
        return build_tilting(case)
    return discretised(case, build_wall(case), np.array(case.operation.eccentricity))


def on_the_same_wall(problem: CoupledProblem, case: Case) -> CoupledProblem:
    """Discretise a case on the wall of another problem.

    Parameters
    ----------
    problem : CoupledProblem
        A bearing at a position of its journal.
    case : Case
        The same bearing but for its gas, speed, load, position and the friction of its journal: what no wall reads.
    """
    return discretised(case, problem.layout.wall, np.array(case.operation.eccentricity))


def build_tilting(case: Case) -> CoupledProblem:
    """Discretise the whole length of `case` under a journal that is free to tilt, at the slopes of the case."""
    whole = case.replace(**{"model.symmetry": False, "operation.tilt": None})
    slopes = lever_of(case) * np.array(case.operation.tilt or (0.0, 0.0))
    wall = tilting(build_wall(whole), lever_of(case))
    return discretised(whole, wall, np.append(case.operation.eccentricity, slopes))


def lever_of(case: Case) -> float:
    """Lever of the slopes of a journal that tilts about the bearing's centre, half the length [m]."""
    return 0.5 * case.bearing.length


def build_pair(case: Case) -> CoupledProblem:
    """Both bearings of `case` on a shaft that tilts, as its rotor has them; the whole length of each.

    Raises
    ------
    UsageError
        Their 2-D films have no ends, or they differ by more than how they stand askew.
    """
    if case.rotor is None or case.rotor.span is None:
        raise ValueError("this rotor runs in one bearing")
    if case.rotor.second is not None and case.rotor.second.replaced:
        raise UsageError(
            "a motion in two bearings is followed where they are equal: leave the tables of rotor.second out, or ask "
            "`balance` and `stability`, which take unequal ones"
        )
    whole = case.replace(**{"model.symmetry": False})
    check_memory(whole, bearings=2)
    first, second = (build_wall(one.replace(**{"model.symmetry": False})) for one in case.supports)
    before, behind = case.rotor.places
    wall = paired((first, second), (before, behind))
    slopes = np.zeros(wall.n_position - len(case.operation.eccentricity))
    problem = discretised(whole, wall, np.append(case.operation.eccentricity, slopes))
    if problem.layout.film_rows.inventory is not None:
        raise UsageError("two 2-D films without ends hold no gas of their own: take the 3-D model or ambient edges")
    return problem


def discretised(case: Case, wall: Wall, displacement: NDArray[np.float64]) -> CoupledProblem:
    """The equations on a wall at a displacement [m]."""
    scales = scales_of(case, wall)
    radius, speed = case.bearing.journal_radius, case.operation.speed
    balance = FilmBalance(wall.film, radius, case.slip_length / scales.length)
    return CoupledProblem(
        layout=BearingLayout(case, wall, balance, scales),
        bearing_number=scales.bearing_number(case.gas.viscosity, speed, radius),
        displacement=displacement / scales.length,
    )
