"""Heat of the gas film as a whole: friction power, conduction to its walls, with their derivatives.

A film of mean temperature `T_f` between walls passes to one of them, at `T_1`, the other being at `T_2`,

    q_1 = (k / h) (6 T_f - 4 T_1 - 2 T_2)                                                              (H2)

per area: its temperature across the film is a parabola (`docs/theory.md`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.forces import node_area

Array = NDArray[np.float64]

OWN, OTHER, FILM = 4.0, 2.0, 6.0
"""Weights of a wall's own temperature, of the other wall's and of the film's in (H2)."""


class FilmPower(NamedTuple):
    """Friction power of the film on the journal [W] and its derivatives at the nodes.

    Attributes
    ----------
    couette, poiseuille : float
        The part of the shear by the speed, which is proportional to the viscosity, and that by the pressure [W].
    by_p, by_h : (strip, node, axial) arrays
        Derivatives of their sum by pressure [W/Pa] and film thickness [W/m].
    """

    couette: float
    poiseuille: float
    by_p: Array
    by_h: Array


def film_power(mesh: FilmMesh, radius: float, state: tuple[Array, Array], shear: tuple[float, float]) -> FilmPower:
    """Friction power of the film: the torque (J4) without slip times the angular velocity.

    Parameters
    ----------
    state : pair of (strip, node, axial) arrays
        Pressure [Pa] and film thickness [m].
    shear : (mu, U)
        Viscosity [Pa s] and surface speed [m/s].
    """
    (p, h), (mu, U) = state, shear
    area, weight = node_area(mesh, radius), mesh.axial.load_weight
    couette = mu * U**2 * area / h
    drop, mean_h = np.diff(p, axis=1), 0.5 * (h[:, :-1] + h[:, 1:])
    by_p, by_h = np.zeros_like(p), -couette / h
    by_p[:, 1:] += 0.5 * U * mean_h * weight
    by_p[:, :-1] -= 0.5 * U * mean_h * weight
    by_h[:, 1:] += 0.25 * U * drop * weight
    by_h[:, :-1] += 0.25 * U * drop * weight
    return FilmPower(float(couette.sum()), float(np.sum(0.5 * U * mean_h * drop * weight)), by_p, by_h)


def film_conductance(mesh: FilmMesh, radius: float, h: Array, conductivity: float) -> tuple[float, Array]:
    """Conductance `k sum dA / h` of the gas between journal and wall [W/K], and its derivative by `h` [W/(K m)]."""
    each = conductivity * node_area(mesh, radius) / h
    return float(each.sum()), -each / h
