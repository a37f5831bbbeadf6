"""Forces on the journal (62)-(64), and the friction torque of the film."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh

Array = NDArray[np.float64]


def node_area(mesh: FilmMesh, radius: float) -> Array:
    """Area that each film node represents on a cylinder of `radius`, shape (node, axial) [m^2]."""
    return radius * mesh.arc_weight[:, None] * mesh.axial.load_weight[None, :]


def film_force(mesh: FilmMesh, radius: float, Q: Array) -> Array:
    """Force of the film on the journal, `-sum Q n R_j dphi dz` (J1), from the excess pressure `Q` [Pa]; (2,) [N]."""
    normal = np.sum(Q * node_area(mesh, radius), axis=2)
    return -np.array([np.sum(normal * np.cos(mesh.theta)), np.sum(normal * np.sin(mesh.theta))])


def contact_force(theta: Array, reaction: Array) -> Array:
    """Force of solid contact on the journal, `-sum lam_J n` (J1); (2,) [N]."""
    return -np.array([np.sum(reaction * np.cos(theta)), np.sum(reaction * np.sin(theta))])


def viscous_torque(
    mesh: FilmMesh, radius: float, state: tuple[Array, Array], shear: tuple[float, float], slip: float = 0.0
) -> float:
    """Torque of the viscous shear stress on the journal (J4) [N m].

    `R_j sum (mu U / (h + 2 lambda) + (h/2) dp/dx) dA`, the first term at nodes, the second on faces. With slip at both
    walls the Couette shear stress is that of a film thicker by twice the mean free path `lambda`. The pressure term
    does not change.

    Parameters
    ----------
    state : pair of (strip, node, axial) arrays
        Pressure [Pa] and film thickness [m].
    shear : (mu, U)
        Viscosity [Pa s] and surface speed [m/s].
    slip : float
        Mean free path times pressure, a constant; zero without slip [m Pa].
    """
    (p, h), (mu, U) = state, shear
    couette = np.sum(mu * U / (h + 2.0 * slip / p) * node_area(mesh, radius))
    mean_h = 0.5 * (h[:, :-1] + h[:, 1:])
    poiseuille = np.sum(0.5 * mean_h * np.diff(p, axis=1) * mesh.axial.load_weight)
    return float(radius * (couette + poiseuille))


def attitude_angle(force: Array, displacement: Array) -> float:
    """Angle from `-F` to the displacement `e` (J2), positive in the sense of rotation [rad].

    It is nan if the force or the displacement is zero.
    """
    if not np.any(force) or not np.any(displacement):
        return float("nan")
    difference = np.arctan2(displacement[1], displacement[0]) - np.arctan2(-force[1], -force[0])
    return float(np.arctan2(np.sin(difference), np.cos(difference)))
