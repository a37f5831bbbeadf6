"""Forces on the journal (62)-(64), and the friction torque of the film."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh

Array = NDArray[np.float64]


def node_area(mesh: FilmMesh, radius: float) -> Array:
    """Area that each film node represents on a cylinder of `radius`, shape (node, axial) [m^2]."""
    return radius * mesh.arc_weight[:, None] * mesh.axial.load_weight[None, :]


def film_force_rows(mesh: FilmMesh, area: Array, normals: Array) -> Array:
    """Force of the film on the journal by the excess pressure at each film node, `-n R_j dphi dz` (J1); (d, nodes).

    Parameters
    ----------
    area : (node, axial) array
        `R_j dphi dz`, see `node_area`.
    normals : (d, nodes) array
        Components of `-n` at all nodes: what a displacement of the journal does to the film [1].
    """
    rows: Array = np.broadcast_to(area, mesh.shape).ravel() * normals
    return rows


def film_force(mesh: FilmMesh, radius: float, Q: Array) -> Array:
    """Force of the film on the journal (J1), from the excess pressure `Q` [Pa]; (2,) [N]."""
    inward = -np.stack([np.cos(mesh.theta), np.sin(mesh.theta)])
    normals = np.broadcast_to(inward[..., None], (2, *mesh.shape)).reshape(2, -1)
    force: Array = film_force_rows(mesh, node_area(mesh, radius), normals) @ Q.ravel()
    return force


def contact_fraction(contact: float, Q: Array, area: Array) -> float:
    """Share of the solid contacts in what presses on the journal (J3), in [0, 1].

    Suction presses on nothing: counted as a negative pressure it would lift the share above 1.

    Parameters
    ----------
    contact : float
        Sum of the normal contact forces [N].
    Q : array
        Excess pressure of the film [Pa], of any shape that `area` [m^2] has too.
    """
    return contact / (contact + float(np.sum(np.maximum(Q, 0.0) * area))) if contact > 0.0 else 0.0


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
    mu, U = shear
    return float(viscous_torques(mesh, radius, state, (mu, np.asarray(U)), slip))


def viscous_torques(
    mesh: FilmMesh, radius: float, state: tuple[Array, Array], shear: tuple[float, Array], slip: float = 0.0
) -> Array:
    """The same of many films, (...,) [N m]; `state` are (..., strip, node, axial) arrays, surface speeds (...,)."""
    (p, h), (mu, U) = state, shear
    film = (-3, -2, -1)
    couette = mu * U * np.sum(node_area(mesh, radius) / (h + 2.0 * slip / p), axis=film)
    mean_h = 0.5 * (h[..., :-1, :] + h[..., 1:, :])
    poiseuille = np.sum(0.5 * mean_h * np.diff(p, axis=-2) * mesh.axial.load_weight, axis=film)
    return np.asarray(radius * (couette + poiseuille))


def attitude_angle(force: Array, displacement: Array) -> float:
    """Angle from `-F` to the displacement `e` (J2), positive in the sense of rotation [rad].

    It is nan if the force or the displacement is zero.
    """
    if not np.any(force) or not np.any(displacement):
        return float("nan")
    difference = np.arctan2(displacement[1], displacement[0]) - np.arctan2(-force[1], -force[0])
    return float(np.arctan2(np.sin(difference), np.cos(difference)))
