"""Bending of a petal by cubic Hermite elements, 2-D: the energy of (33)-(39) with a continuous slope.

    E_b = D/2 int (W_phiphi / r_m^2 + W / R_p^2)^2 r_m L dphi                                         (S6)

The unknowns of a node are its deflection and its slope times a typical element's angle, so that both are lengths. A
point load inside an element bends it in a way that no cubic follows. What is missing is the deflection of a beam of
that element with both ends clamped (S7):

    b(s, t) = a^2 (1 - c)^2 (3 c - a - 2 a c) / 6 ,   a = min(s, t) ,  c = max(s, t)

at `s` by a unit load at `t`, times `(r_m h)^3 / (D L)`. With it petals are exact under point loads.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.hermite import basis

Array = NDArray[np.float64]

GAUSS_POINTS = 4
"""They integrate the square of a curvature, a polynomial of degree 6, exactly."""


@dataclass(frozen=True)
class PetalElements:
    """One petal, root to free edge.

    Attributes
    ----------
    phi : (n_node,) array
        Nodes [rad].
    length : float
        Length of the bearing [m].
    metric_radius, bend_radius : float
        `r_m` and `R_p` [m].
    rigidity : float
        `D` [N m].
    clamped : bool
        No slope at the root; otherwise no bending moment there.
    """

    phi: Array
    length: float
    metric_radius: float
    bend_radius: float
    rigidity: float
    clamped: bool

    @property
    def element_angle(self) -> Array:
        """Angle of each element [rad]."""
        return np.diff(self.phi)

    def angle_at(self, element: NDArray[np.intp], place: Array) -> Array:
        """Angle from the root at places (k,) from 0 to 1 within elements (k,) [rad]."""
        return np.asarray(self.phi[element] + place * self.element_angle[element])

    @property
    def slope_angle(self) -> float:
        """Angle that slopes are multiplied with to make unknowns [rad]."""
        return float(self.element_angle.mean())

    @property
    def nodal(self) -> sp.csr_array:
        """Nodal (value, slope) pairs from the unknowns: the root is held, its slope too where it is clamped."""
        scale = np.tile([1.0, 1.0 / self.slope_angle], len(self.phi))
        first = 2 if self.clamped else 1
        return sp.csr_array(sp.diags_array(scale, format="csc")[:, first:])

    @property
    def bending(self) -> sp.csr_array:
        """Matrix `B` with `E_b = |B w|^2 / 2`: changes of curvature at the Gauss points, (4 (n - 1), unknowns).

        `B^T (B w)` keeps the digits that `K w` loses in differences of neighbours, `n^2` of them for `n^4`.
        """
        at, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        t, weight = 0.5 * (at + 1.0), 0.5 * weight
        n, h = len(self.phi), self.element_angle
        scale = np.stack([np.ones_like(h), h, np.ones_like(h), h], axis=1)
        second = basis(t, 2) / (self.metric_radius * h[:, None, None]) ** 2
        chi = (second + basis(t) / self.bend_radius**2) * scale[:, None, :]
        chi *= np.sqrt(self.rigidity * self.metric_radius * self.length * weight * h[:, None])[:, :, None]
        rows = np.repeat(np.arange((n - 1) * GAUSS_POINTS), 4)
        cols = np.repeat(2 * np.arange(n - 1)[:, None] + np.arange(4), GAUSS_POINTS, axis=0).ravel()
        whole = sp.coo_array((chi.ravel(), (rows, cols)), shape=((n - 1) * GAUSS_POINTS, 2 * n))
        return sp.csr_array(whole.tocsr() @ self.nodal)

    @property
    def stiffness(self) -> sp.csr_array:
        """Matrix `K = B^T B` with `E_b = w K w / 2` in the unknowns [N/m]."""
        bending = self.bending
        return sp.csr_array(bending.T @ bending)

    @property
    def point_compliance(self) -> Array:
        """`(r_m h)^3 / (D L)` of each element: the unit of `b(s, t)` [m/N]."""
        return (self.metric_radius * self.element_angle) ** 3 / (self.rigidity * self.length)


def clamped_beam(s: Array, t: Array) -> Array:
    """`b(s, t)` (S7) [1]."""
    a, c = np.minimum(s, t), np.maximum(s, t)
    return np.asarray(a**2 * (1.0 - c) ** 2 * (3.0 * c - a - 2.0 * a * c) / 6.0)


def clamped_beam_own(t: Array) -> tuple[Array, Array]:
    """`b(t, t)`, and the derivative of `b(s, t)` by the place `s` at the load, `s = t`; [1]."""
    u = t * (1.0 - t)
    square = u * u
    return square * u / 3.0, square * (0.5 - t)


def clamped_beam_slope(s: Array, t: Array) -> Array:
    """Derivative of `b(s, t)` by the place `s` [1]."""
    a, c = np.minimum(s, t), np.maximum(s, t)
    before_load = a * (1.0 - c) ** 2 * (2.0 * c - a - 2.0 * a * c)
    behind_load = -(a**2) * (1.0 - c) * (3.0 * c - 1.0 - 2.0 * a * c)
    return np.asarray(np.where(s <= t, before_load, behind_load) / 2.0)


def clamped_beam_bend(s: Array, t: Array) -> Array:
    """Second derivative of `b(s, t)` by the place `s` [1]."""
    a, c = np.minimum(s, t), np.maximum(s, t)
    before_load, behind_load = (1.0 - c) ** 2 * (c - a - 2.0 * a * c), a**2 * (3.0 * c + a - 2.0 - 2.0 * a * c)
    return np.asarray(np.where(s <= t, before_load, behind_load))


def clamped_beam_twist(s: Array, t: Array) -> Array:
    """Derivative of `b(s, t)` by place and load [1]."""
    a, c = np.minimum(s, t), np.maximum(s, t)
    return np.asarray(a * (1.0 - c) * (1.0 - 3.0 * c + 3.0 * a * c))
