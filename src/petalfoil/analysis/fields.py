"""Fields of a solution on the whole bearing: arrays and coordinates of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.evaluation import Evaluation
from petalfoil.equilibrium.nodal_state import NodalState
from petalfoil.walls import WallState, wall_kind

Array = NDArray[np.float64]
Named = dict[str, Array]


def film_fields(found: Evaluation) -> Named:
    """Pressure [Pa] and film thickness [m] over the whole length, (strip, node, axial)."""
    whole = found.answer.problem.layout.wall.film.axial.whole
    return {"pressure": whole(found.pressure), "film_thickness": whole(found.film_thickness)}


def state_of_wall(state: NodalState) -> WallState:
    """Deflections [m] and contact pressures [Pa] of a state."""
    layout = state.problem.layout
    pressure = state.lam * layout.scales.force / layout.wall.contacts.area
    return WallState(state.deflection * layout.scales.length, pressure, state.placed, state.membrane)


def wall_fields(found: Evaluation) -> Named:
    """Fields that the wall of the case declares, SI."""
    wall = found.state.problem.layout.wall
    return wall_kind(found.case).fields(found.case, wall, state_of_wall(found.state))


def coordinates(found: Evaluation) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the fields."""
    case, wall, placed = found.case, found.state.problem.layout.wall, found.state.placed
    film = wall.film
    strips = len(film.theta)
    return {
        "petal": np.arange(strips),
        "root_angle": film.theta[:, 0] - film.phi[0],
        "phi_exposed": film.phi,
        "z": film.axial.whole_z,
        **({} if placed is None else {"contact": np.arange(len(placed.force))}),
        **wall_kind(case).coordinates(case, wall),
    }


def all_fields(found: Evaluation) -> Named:
    """All fields of a solution."""
    return {**film_fields(found), **wall_fields(found)}
