"""Reynolds' equation of the gas film: fluxes through the faces of control volumes.

Dimensionless, with `Lam = 6 mu omega R_j^2 / (p_a h_ref^2)` (`docs/theory.md`, F1):

    d_phi( Lam P H - H^3 P P_phi ) - d_Z( H^3 P P_Z ) + 2 Lam d_tau(P H) = 0

Where the gas slips at its walls, `H^3 P` grows by `6 Kn H^2` (F7), as if `6 Kn / H` were added to the pressure.
Between nodes the film is taken linear, and the means of `H^3` and `H^2` on a face are those that let as much pass as
the whole of it does (F2): the thin end decides, not the thick one. `P` and `P H` are averaged as in (56), (57). The
advected mass is fitted exponentially (Scharfetter and Gummel 1969, doi:10.1109/T-ED.1969.16566): central where the
film is resolved, upwind where `Lam H dphi / (H^3 P)` is large, monotone in between.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Flux(NamedTuple):
    """Flux through faces, positive toward the node `1`, and its derivatives by the two nodes of a face."""

    value: Array
    by_P0: Array
    by_P1: Array
    by_H0: Array
    by_H1: Array
    size: Array
    """Sum of the magnitudes of the flux's terms, rounding included: what a residual is small against."""


ROUNDING = 4.0 * float(np.finfo(float).eps) / 1e-8
"""Pressures carry rounding: differences of neighbours below this share of the pressure, over the residual's
tolerance of 1e-8, say nothing. It matters where the film hardly flows (a shaft at rest)."""


def langevin(x: Array) -> tuple[Array, Array]:
    """`L(x) = coth x - 1/x` for `x >= 0` and its derivative, without cancellation near zero."""
    small = x < 0.03
    y = np.where(small, 1.0, x)
    square = np.minimum(x, 1.0) ** 2  # the series serve x < 0.03 only: keep them finite elsewhere
    decay = np.exp(-2.0 * y)
    value = (1.0 + decay) / (1.0 - decay) - 1.0 / y
    slope = 1.0 / y**2 - 4.0 * decay / (1.0 - decay) ** 2
    series = x * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0)))
    series_slope = 1.0 / 3.0 - square * (1.0 / 15.0 - square * (2.0 / 189.0))
    return np.where(small, series, value), np.where(small, series_slope, slope)


def mean_cube(H0: Array, H1: Array) -> tuple[Array, Array, Array]:
    """Mean of `H^3` on a face, `1 / mean(H^-3)` of a film linear between its nodes, and its derivatives by them."""
    both = H0 + H1
    cube = 2.0 * (H0 * H1) ** 2 / both
    return cube, cube * (2.0 / H0 - 1.0 / both), cube * (2.0 / H1 - 1.0 / both)


def slip_pressure(H0: Array, H1: Array, Kn: float) -> tuple[Array, Array, Array]:
    """Pressure that would let as much pass as slip does, `6 Kn mean(H^2) / mean(H^3)`, and its derivatives (F7).

    With the mean `H0 H1 = 1 / mean(H^-2)` of a linear film that is `6 Kn` over the harmonic mean of `H`.

    Parameters
    ----------
    H0, H1 : arrays
        Film thickness on both sides of faces [1].
    Kn : float
        Knudsen number on the reference film at ambient pressure [1].
    """
    if Kn == 0.0:
        return np.zeros_like(H0), np.zeros_like(H0), np.zeros_like(H0)
    return 3.0 * Kn * (1.0 / H0 + 1.0 / H1), -3.0 * Kn / H0**2, -3.0 * Kn / H1**2


def circumferential_flux(P: Array, H: Array, Lam: float, dphi: Array, Kn: float = 0.0) -> Flux:
    """Mass flux along the rotation through the faces between neighbours on axis 1 (F2).

    Parameters
    ----------
    P, H : (strip, node, axial) arrays
        Pressure and film thickness [1].
    Lam : float
        Bearing number on the reference film [1].
    dphi : (node - 1, 1) array
        Angles between nodes [rad].
    Kn : float
        Knudsen number on the reference film at ambient pressure; zero without slip [1].
    """
    P0, P1, H0, H1 = P[:, :-1], P[:, 1:], H[:, :-1], H[:, 1:]
    cube, cube_H0, cube_H1 = mean_cube(H0, H1)
    mean_P, mean_H = 0.5 * (P0 + P1), 0.5 * (H0 + H1)
    slip, slip_H0, slip_H1 = slip_pressure(H0, H1, Kn)
    conductance = cube * (mean_P + slip)
    x = 0.5 * Lam * mean_H * dphi / conductance  # half the cell's Peclet number
    fit, slope = langevin(x)
    jump = P1 * H1 - P0 * H0

    poiseuille = -conductance * (P1 - P0) / dphi
    couette = 0.5 * Lam * (P0 * H0 + P1 * H1)
    upwinding = -0.5 * Lam * fit * jump

    half, wind = 0.5 * Lam, 0.5 * Lam * slope * jump
    x_P = -0.5 * x / (mean_P + slip)  # by either pressure
    by_P0 = (conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H0 * (1.0 + fit) - wind * x_P
    by_P1 = (-conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H1 * (1.0 - fit) - wind * x_P
    x_H0 = x * (0.5 / mean_H - cube_H0 / cube - slip_H0 / (mean_P + slip))
    x_H1 = x * (0.5 / mean_H - cube_H1 / cube - slip_H1 / (mean_P + slip))
    drop, slipped = (mean_P + slip) * (P1 - P0) / dphi, cube * (P1 - P0) / dphi
    by_H0 = -cube_H0 * drop - slip_H0 * slipped + half * P0 * (1.0 + fit) - wind * x_H0
    by_H1 = -cube_H1 * drop - slip_H1 * slipped + half * P1 * (1.0 - fit) - wind * x_H1
    value = poiseuille + couette + upwinding
    size = np.abs(poiseuille) + couette + np.abs(upwinding) + ROUNDING * conductance * mean_P / dphi
    return Flux(value, by_P0, by_P1, by_H0, by_H1, size)


def axial_flux(P: Array, H: Array, dZ: Array, Kn: float = 0.0) -> Flux:
    """Mass flux along the shaft through the faces between neighbours on axis 2 (F3).

    `mean(P) dP = d(P^2 / 2)` holds exactly on a face, so that `sum (H^3 P^2 / 2 + 6 Kn H^2 P)` over a closed circle is
    the same at every station, as the integral is in the continuum.
    """
    P0, P1, H0, H1 = P[..., :-1], P[..., 1:], H[..., :-1], H[..., 1:]
    (cube, cube_H0, cube_H1), mean_P = mean_cube(H0, H1), 0.5 * (P0 + P1)
    slip, slip_H0, slip_H1 = slip_pressure(H0, H1, Kn)

    poiseuille = -cube * (mean_P + slip) * (P1 - P0) / dZ

    by_P0 = cube * (P0 + slip) / dZ
    by_P1 = -cube * (P1 + slip) / dZ
    drop, slipped = (mean_P + slip) * (P1 - P0) / dZ, cube * (P1 - P0) / dZ
    by_H0, by_H1 = -cube_H0 * drop - slip_H0 * slipped, -cube_H1 * drop - slip_H1 * slipped
    size = np.abs(poiseuille) + ROUNDING * cube * (mean_P**2 + slip * mean_P) / dZ
    return Flux(poiseuille, by_P0, by_P1, by_H0, by_H1, size)
