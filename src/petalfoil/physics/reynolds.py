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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.problem import RESIDUAL_TOLERANCE

Array = NDArray[np.float64]


class FluxDerivatives(NamedTuple):
    """Derivatives of a flux through faces with respect to pressure and film thickness at both nodes."""

    by_P0: Array
    by_P1: Array
    by_H0: Array
    by_H1: Array


@dataclass(frozen=True)
class Flux:
    """Flux through faces, positive from node 0 to node 1.

    A residual asks for fluxes more often than a test of convergence for their scale, or a tangent for their
    derivatives, which cost twice as much: these are computed when they are asked for.

    Attributes
    ----------
    value : array
        Flux through every face.
    measure : callable
        Gives its scale.
    derive : callable
        Gives its derivatives.
    """

    value: Array
    measure: Callable[[], Array]
    derive: Callable[[], FluxDerivatives]

    @cached_property
    def scale(self) -> Array:
        """Sum of the magnitudes of its terms, rounding included: the scale of a residual."""
        return self.measure()

    @cached_property
    def derivatives(self) -> FluxDerivatives:
        """Derivatives by both nodes."""
        return self.derive()

    def times(self, width: Array | float) -> Flux:
        """The flow through faces of a width."""
        return Flux(
            self.value * width,
            lambda: self.scale * width,
            lambda: FluxDerivatives(*(part * width for part in self.derivatives)),
        )


ROUNDING = 4.0 * float(np.finfo(float).eps) / RESIDUAL_TOLERANCE
"""Rounding of a pressure over the tolerance of the residual.

A pressure difference below the rounding of the pressure has no meaning. The scale of a flux contains it, so that a
residual of rounding alone passes the tolerance. This matters where hardly any gas flows (a shaft at zero speed).
"""


def langevin(x: Array) -> Array:
    """`L(x) = coth x - 1/x` for `x >= 0`, without cancellation near zero."""
    small = x < 0.03
    some = small.any()
    y = np.where(small, 1.0, x) if some else x
    value = -2.0 / np.expm1(-2.0 * y) - 1.0 - 1.0 / y
    if not some:
        return np.asarray(value)
    square = np.minimum(x, 1.0) ** 2  # the series is used for x < 0.03 only; this keeps it finite elsewhere
    return np.where(small, x * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0))), value)


def langevin_slope(x: Array) -> Array:
    """Derivative of `langevin`."""
    small = x < 0.03
    y, square = np.where(small, 1.0, x), np.minimum(x, 1.0) ** 2
    decay = np.exp(-2.0 * y)
    slope = 1.0 / y**2 - 4.0 * decay / (1.0 - decay) ** 2
    return np.where(small, 1.0 / 3.0 - square * (1.0 / 15.0 - square * (2.0 / 189.0)), slope)


def mean_cube(H0: Array, H1: Array) -> Array:
    """Harmonic mean of `H^3` on a face, `1 / mean(H^-3)` of a linear film."""
    cube: Array = 2.0 * (H0 * H1) ** 2 / (H0 + H1)
    return cube


def slip_pressure(H0: Array, H1: Array, Kn: float) -> Array:
    """Pressure with the same effect on the flow as slip, `6 Kn mean(H^2) / mean(H^3)` (F7).

    For a linear film `1 / mean(H^-2) = H0 H1`. The pressure is then `6 Kn` over the harmonic mean of `H0` and `H1`.

    Parameters
    ----------
    H0, H1 : arrays
        Film thickness on both sides of faces [1].
    Kn : float
        Knudsen number on the reference film at ambient pressure [1].
    """
    return np.zeros_like(H0) if Kn == 0.0 else 3.0 * Kn * (1.0 / H0 + 1.0 / H1)


class FilmFaces(NamedTuple):
    """Pressures and film thicknesses on both sides of faces, mean of `H^3`, mean pressure, and that of slip."""

    P0: Array
    P1: Array
    H0: Array
    H1: Array
    cube: Array
    mean_P: Array
    slip: Array

    @classmethod
    def between(cls, P: tuple[Array, Array], H: tuple[Array, Array], Kn: float) -> FilmFaces:
        """The faces between nodes, in arrays of their own: views of the nodes' take twice as long in every term."""
        (P0, P1), (H0, H1) = ([np.ascontiguousarray(side) for side in sides] for sides in (P, H))
        return cls(P0, P1, H0, H1, mean_cube(H0, H1), 0.5 * (P0 + P1), slip_pressure(H0, H1, Kn))

    def by_films(self, Kn: float) -> tuple[Array, Array, Array, Array]:
        """Derivatives of `cube`, then of `slip`, by the films on both sides."""
        H0, H1, cube = self.H0, self.H1, self.cube
        both = H0 + H1
        return cube * (2.0 / H0 - 1.0 / both), cube * (2.0 / H1 - 1.0 / both), -3.0 * Kn / H0**2, -3.0 * Kn / H1**2


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
    faces = FilmFaces.between((P[:, :-1], P[:, 1:]), (H[:, :-1], H[:, 1:]), Kn)
    P0, P1, H0, H1, cube, mean_P, slip = faces
    conductance = cube * (mean_P + slip) / dphi
    x = (0.25 * Lam) * (H0 + H1) / conductance  # half the cell Peclet number
    behind, ahead, half = P0 * H0, P1 * H1, 0.5 * Lam

    poiseuille = conductance * (P0 - P1)
    couette = half * (behind + ahead)
    upwinding = half * langevin(x) * (behind - ahead)
    value = poiseuille + couette + upwinding
    flux = Flux(
        value,
        lambda: np.abs(poiseuille) + couette + np.abs(upwinding) + ROUNDING * conductance * mean_P,
        lambda: circumferential_derivatives(faces, x, Lam, dphi, Kn),
    )
    return limited(flux, supplied(faces, conductance, Lam, dphi, Kn))


def circumferential_derivatives(faces: FilmFaces, x: Array, Lam: float, dphi: Array, Kn: float) -> FluxDerivatives:
    """Derivatives of the circumferential flux (F2), at half the cell Peclet number `x`, before it is limited."""
    P0, P1, H0, H1, cube, mean_P, slip = faces
    cube_H0, cube_H1, slip_H0, slip_H1 = faces.by_films(Kn)
    conductance, fit, jump = cube * (mean_P + slip), langevin(x), P1 * H1 - P0 * H0
    # value = -conductance dP / dphi + Lam/2 (P0 H0 + P1 H1) - Lam/2 L(x) (P1 H1 - P0 H0): every factor is
    # differentiated; `wind` is the derivative of the last term by x, and x_P, x_H0, x_H1 are the derivatives of x
    half, wind = 0.5 * Lam, 0.5 * Lam * langevin_slope(x) * jump
    x_P = -0.5 * x / (mean_P + slip)  # derivative of x by P0 and by P1
    by_P0 = (conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H0 * (1.0 + fit) - wind * x_P
    by_P1 = (-conductance - 0.5 * cube * (P1 - P0)) / dphi + half * H1 * (1.0 - fit) - wind * x_P
    x_H0 = x * (1.0 / (H0 + H1) - cube_H0 / cube - slip_H0 / (mean_P + slip))
    x_H1 = x * (1.0 / (H0 + H1) - cube_H1 / cube - slip_H1 / (mean_P + slip))
    drop, slipped = (mean_P + slip) * (P1 - P0) / dphi, cube * (P1 - P0) / dphi
    by_H0 = -cube_H0 * drop - slip_H0 * slipped + half * P0 * (1.0 + fit) - wind * x_H0
    by_H1 = -cube_H1 * drop - slip_H1 * slipped + half * P1 * (1.0 - fit) - wind * x_H1
    return FluxDerivatives(by_P0, by_P1, by_H0, by_H1)


def supplied(faces: FilmFaces, conductance: Array, Lam: float, dphi: Array, Kn: float) -> Flux:
    """What the upstream pressure alone drives through a face, `(Lam H0 + mean(H^3 (P + slip)) / dphi) P0`.

    `conductance` is the second term in brackets.
    """
    P0, _, H0, _, cube, mean_P, slip = faces
    rate = Lam * H0 + conductance

    def derivatives() -> FluxDerivatives:
        cube_H0, cube_H1, slip_H0, slip_H1 = faces.by_films(Kn)
        by_P = 0.5 * cube * P0 / dphi  # through the mean pressure, by either
        by_cube, by_slip = P0 * (mean_P + slip) / dphi, P0 * cube / dphi
        by_H0 = Lam * P0 + by_cube * cube_H0 + by_slip * slip_H0
        return FluxDerivatives(rate + by_P, by_P, by_H0, by_cube * cube_H1 + by_slip * slip_H1)

    supply = rate * P0
    return Flux(supply, lambda: supply, derivatives)


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

    def derivatives() -> FluxDerivatives:
        by_flux, by_bound = ratio**2, DRAIN * 2.0 * (1.0 - ratio)
        pairs = zip(flux.derivatives, supply.derivatives, strict=True)
        return FluxDerivatives(*(by_flux * d + by_bound * b for d, b in pairs))

    return Flux(value, flux.measure, derivatives)


DRAIN = 10.0
"""Flux over what the upstream pressure supplies, from where it is limited. In a resolved film the two are alike: no
number of the regression table, at 8 to 64 cells per pitch, moves with the limit."""


def axial_flux(P: Array, H: Array, dZ: Array, Kn: float = 0.0) -> Flux:
    """Axial mass flux through the faces between neighbours on axis 2 (F3).

    `mean(P) dP = d(P^2 / 2)` holds exactly on a face. `sum (H^3 P^2 / 2 + 6 Kn H^2 P)` over a closed circle therefore
    has the same value at every station, as the integral has in the differential equation.
    """
    if P.shape[-1] == 1:  # a film without ends
        none = P[..., :-1]
        return Flux(none, lambda: none, lambda: FluxDerivatives(none, none, none, none))
    faces = FilmFaces.between((P[..., :-1], P[..., 1:]), (H[..., :-1], H[..., 1:]), Kn)
    P0, P1, _, _, cube, mean_P, slip = faces
    poiseuille = -cube * (mean_P + slip) * (P1 - P0) / dZ

    def derivatives() -> FluxDerivatives:
        cube_H0, cube_H1, slip_H0, slip_H1 = faces.by_films(Kn)
        drop, slipped = (mean_P + slip) * (P1 - P0) / dZ, cube * (P1 - P0) / dZ
        return FluxDerivatives(
            cube * (P0 + slip) / dZ,
            -cube * (P1 + slip) / dZ,
            -cube_H0 * drop - slip_H0 * slipped,
            -cube_H1 * drop - slip_H1 * slipped,
        )

    return Flux(
        poiseuille, lambda: np.abs(poiseuille) + ROUNDING * cube * (mean_P**2 + slip * mean_P) / dZ, derivatives
    )
