"""Reynolds' equation of the gas film: mass flux through the faces of control volumes, and its derivatives.

Dimensionless, with `Lam = 6 mu omega R_j^2 / (p_a h_ref^2)` (`docs/theory.md`, F1):

    d_phi( Lam P H - H^3 P P_phi ) - d_Z( H^3 P P_Z ) + 2 Lam d_tau(P H) = 0

Slip at the walls adds `6 Kn H^2` to `H^3 P` (F7). This equals an addition of `6 Kn / H` to the pressure in `H^3 P`.
The film thickness is linear between nodes. `H^3` on a face is the harmonic mean of that linear film, `1 / mean(H^-3)`,
because the flow resistances along the face add up (F2); `H^2` likewise. `P` and `P H` are averaged as in (56), (57).
The advected mass uses exponential fitting (Scharfetter and Gummel 1969, doi:10.1109/T-ED.1969.16566): central
differences where the film is resolved, upwind differences where `Lam H dphi / (H^3 P)` is large.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.problem import RESIDUAL_TOLERANCE

Array = NDArray[np.float64]


class Flux(NamedTuple):
    """Flux through faces, positive from node 0 to node 1, with its derivatives with respect to both nodes."""

    value: Array
    by_P0: Array
    by_P1: Array
    by_H0: Array
    by_H1: Array
    scale: Array
    """Sum of the magnitudes of the terms of the flux, rounding included: the scale of a residual."""


ROUNDING = 4.0 * float(np.finfo(float).eps) / RESIDUAL_TOLERANCE
"""Rounding of a pressure over the tolerance of the residual.

A pressure difference below the rounding of the pressure has no meaning. The scale of a flux contains it, so that a
residual of rounding alone passes the tolerance. This matters where hardly any gas flows (a shaft at zero speed).
"""


def langevin(x: Array) -> tuple[Array, Array]:
    """`L(x) = coth x - 1/x` for `x >= 0` and its derivative, without cancellation near zero."""
    small = x < 0.03
    y = np.where(small, 1.0, x)
    square = np.minimum(x, 1.0) ** 2  # the series is used for x < 0.03 only; this keeps it finite elsewhere
    decay = np.exp(-2.0 * y)
    value = (1.0 + decay) / (1.0 - decay) - 1.0 / y
    slope = 1.0 / y**2 - 4.0 * decay / (1.0 - decay) ** 2
    series = x * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0)))
    series_slope = 1.0 / 3.0 - square * (1.0 / 15.0 - square * (2.0 / 189.0))
    return np.where(small, series, value), np.where(small, series_slope, slope)


def mean_cube(H0: Array, H1: Array) -> tuple[Array, Array, Array]:
    """Harmonic mean of `H^3` on a face, `1 / mean(H^-3)` of a linear film, and its derivatives by `H0` and `H1`."""
    both = H0 + H1
    cube = 2.0 * (H0 * H1) ** 2 / both
    return cube, cube * (2.0 / H0 - 1.0 / both), cube * (2.0 / H1 - 1.0 / both)


def slip_pressure(H0: Array, H1: Array, Kn: float) -> tuple[Array, Array, Array]:
    """Pressure with the same effect on the flow as slip, `6 Kn mean(H^2) / mean(H^3)`, and its derivatives (F7).

    For a linear film `1 / mean(H^-2) = H0 H1`. The pressure is then `6 Kn` over the harmonic mean of `H0` and `H1`.

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
    """Circumferential mass flux through the faces between neighbours on axis 1 (F2).

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
    x = 0.5 * Lam * mean_H * dphi / conductance  # half the cell Peclet number
    fit, slope = langevin(x)
    jump = P1 * H1 - P0 * H0

    poiseuille = -conductance * (P1 - P0) / dphi
    couette = 0.5 * Lam * (P0 * H0 + P1 * H1)
    upwinding = -0.5 * Lam * fit * jump

    # value = -conductance dP / dphi + Lam/2 (P0 H0 + P1 H1) - Lam/2 L(x) (P1 H1 - P0 H0): every factor is
    # differentiated; `wind` is the derivative of the last term by x, and x_P, x_H0, x_H1 are the derivatives of x
    half, wind = 0.5 * Lam, 0.5 * Lam * slope * jump
    x_P = -0.5 * x / (mean_P + slip)  # derivative of x by P0 and by P1
    by_P0 = (conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H0 * (1.0 + fit) - wind * x_P
    by_P1 = (-conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H1 * (1.0 - fit) - wind * x_P
    x_H0 = x * (0.5 / mean_H - cube_H0 / cube - slip_H0 / (mean_P + slip))
    x_H1 = x * (0.5 / mean_H - cube_H1 / cube - slip_H1 / (mean_P + slip))
    drop, slipped = (mean_P + slip) * (P1 - P0) / dphi, cube * (P1 - P0) / dphi
    by_H0 = -cube_H0 * drop - slip_H0 * slipped + half * P0 * (1.0 + fit) - wind * x_H0
    by_H1 = -cube_H1 * drop - slip_H1 * slipped + half * P1 * (1.0 - fit) - wind * x_H1
    value = poiseuille + couette + upwinding
    scale = np.abs(poiseuille) + couette + np.abs(upwinding) + ROUNDING * conductance * mean_P / dphi
    flux = Flux(value, by_P0, by_P1, by_H0, by_H1, scale)
    return limited(flux, supplied(P0, H0, (Lam, dphi), (cube, cube_H0, cube_H1), (mean_P, slip, slip_H0, slip_H1)))


def supplied(
    P0: Array, H0: Array, film: tuple[float, Array], cube: tuple[Array, Array, Array], pressure: tuple[Array, ...]
) -> Flux:
    """What the upstream pressure alone drives through a face, `(Lam H0 + mean(H^3 (P + slip)) / dphi) P0`.

    Parameters
    ----------
    film : (Lam, dphi)
        As in `circumferential_flux`.
    cube : three arrays
        Mean of `H^3` and its derivatives by both films.
    pressure : four arrays
        Mean pressure, that of slip, and the derivatives of the latter by both films.
    """
    (Lam, dphi), (mean, mean_H0, mean_H1), (mean_P, slip, slip_H0, slip_H1) = film, cube, pressure
    rate = Lam * H0 + mean * (mean_P + slip) / dphi
    by_P = 0.5 * mean * P0 / dphi  # through the mean pressure, by either
    by_mean, by_slip = P0 * (mean_P + slip) / dphi, P0 * mean / dphi
    by_H0 = Lam * P0 + by_mean * mean_H0 + by_slip * slip_H0
    by_H1 = by_mean * mean_H1 + by_slip * slip_H1
    return Flux(rate * P0, rate + by_P, by_P, by_H0, by_H1, rate * P0)


def limited(flux: Flux, supply: Flux) -> Flux:
    """Keep a face from draining its upstream node: past `DRAIN supply` the flux bends smoothly toward twice that (F2b).

    The mean film of a face says nothing where the film opens by orders of magnitude within one cell, as behind a
    contact on a coarse grid: the fitted flux then asks for a negative pressure upstream, and no film solves it. The
    supply vanishes with the upstream pressure, so that a flux bounded by a multiple of it leaves every node a positive
    pressure.
    """
    bound = DRAIN * supply.value
    over = flux.value > bound
    if not over.any():
        return flux
    ratio = np.where(over, bound / np.where(over, flux.value, 1.0), 1.0)  # flux = bound (2 - bound / flux)
    value = np.where(over, bound * (2.0 - ratio), flux.value)
    by_flux, by_bound = ratio**2, DRAIN * 2.0 * (1.0 - ratio)
    by_P0, by_P1, by_H0, by_H1 = (by_flux * d + by_bound * b for d, b in zip(flux[1:5], supply[1:5], strict=True))
    return Flux(value, by_P0, by_P1, by_H0, by_H1, flux.scale)


DRAIN = 10.0
"""Flux over what the upstream pressure supplies, from where it is limited. In a resolved film the two are alike: no
number of the regression table, at 8 to 64 cells per pitch, moves with the limit."""


def axial_flux(P: Array, H: Array, dZ: Array, Kn: float = 0.0) -> Flux:
    """Axial mass flux through the faces between neighbours on axis 2 (F3).

    `mean(P) dP = d(P^2 / 2)` holds exactly on a face. `sum (H^3 P^2 / 2 + 6 Kn H^2 P)` over a closed circle therefore
    has the same value at every station, as the integral has in the differential equation.
    """
    P0, P1, H0, H1 = P[..., :-1], P[..., 1:], H[..., :-1], H[..., 1:]
    (cube, cube_H0, cube_H1), mean_P = mean_cube(H0, H1), 0.5 * (P0 + P1)
    slip, slip_H0, slip_H1 = slip_pressure(H0, H1, Kn)

    poiseuille = -cube * (mean_P + slip) * (P1 - P0) / dZ

    by_P0 = cube * (P0 + slip) / dZ
    by_P1 = -cube * (P1 + slip) / dZ
    drop, slipped = (mean_P + slip) * (P1 - P0) / dZ, cube * (P1 - P0) / dZ
    by_H0, by_H1 = -cube_H0 * drop - slip_H0 * slipped, -cube_H1 * drop - slip_H1 * slipped
    scale = np.abs(poiseuille) + ROUNDING * cube * (mean_P**2 + slip * mean_P) / dZ
    return Flux(poiseuille, by_P0, by_P1, by_H0, by_H1, scale)
