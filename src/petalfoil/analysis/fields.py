"""Fields of an answer on the whole bearing: arrays and coordinates of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.walls import WallState, wall_kind

Array = NDArray[np.float64]
Named = dict[str, Array]


def film_fields(answer: Solution) -> Named:
    """Pressure [Pa] and film thickness [m] over the whole length, (strip, node, axial)."""
    problem = answer.problem
    scales, axial = problem.layout.scales, problem.layout.wall.film.axial
    return {
        "pressure": axial.whole(problem.pressure(answer.x) * scales.pressure),
        "film_thickness": axial.whole(problem.film(answer.x) * scales.length),
    }


def wall_state(answer: Solution) -> WallState:
    """Deflections [m] and contact pressures [Pa] of an answer."""
    layout = answer.problem.layout
    deflection = answer.x[: layout.n_wall] * layout.scales.length
    return WallState(deflection, answer.lam * layout.scales.force / layout.wall.contacts.area)


def wall_fields(case: Case, answer: Solution) -> Named:
    """Fields that the wall of `case` declares, SI."""
    return wall_kind(case).fields(case, answer.problem.layout.wall, wall_state(answer))


def coordinates(case: Case, answer: Solution) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the fields."""
    wall = answer.problem.layout.wall
    film = wall.film
    strips = len(film.theta)
    return {
        "petal": np.arange(strips),
        "root_angle": film.theta[:, 0] - film.phi[0],
        "phi_exposed": film.phi,
        "z": film.axial.whole_z,
        **wall_kind(case).coordinates(case, wall),
    }


def all_fields(case: Case, answer: Solution) -> Named:
    """All fields of an answer."""
    return {**film_fields(answer), **wall_fields(case, answer)}
