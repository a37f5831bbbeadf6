"""Fields of a solution on the whole bearing: arrays and coordinates of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.evaluation import Evaluation
from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.walls import WallState, wall_kind

Array = NDArray[np.float64]
Named = dict[str, Array]


def film_fields(found: Evaluation) -> Named:
    """Pressure [Pa] and film thickness [m] over the whole length, (strip, node, axial)."""
    whole = found.answer.problem.layout.wall.film.axial.whole
    return {"pressure": whole(found.pressure), "film_thickness": whole(found.film_thickness)}


def wall_state(answer: Solution) -> WallState:
    """Deflections [m] and contact pressures [Pa] of a solution."""
    layout = answer.problem.layout
    deflection = (answer.deflection + answer.state.low_order) * layout.scales.length  # to the last digit of each
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


def all_fields(found: Evaluation) -> Named:
    """All fields of a solution."""
    return {**film_fields(found), **wall_fields(found.case, found.answer)}
