"""A matrix function of `s`, known at some points, as a rational one; and the modes of a mass on it.

Adaptive barycentric interpolation (AAA; Nakatsukasa, Sète and Trefethen 2018), one set of weights for all entries:

    R(s) = sum_j w_j F_j / (s - z_j)  /  sum_j w_j / (s - z_j)                       (E8)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

Complex = NDArray[np.complex128]

MOST = 24
"""Most support points."""
PRECISION = 1e-8
"""Error over the largest entry at which enough points support the function."""


@dataclass(frozen=True)
class Rational:
    """`R(s)` of (E8).

    Attributes
    ----------
    z, w : (k,) complex array
        Support points and their weights.
    F : (k, d, d) complex array
        Values there.
    """

    z: Complex
    w: Complex
    F: Complex

    @classmethod
    def fit(cls, points: Complex, values: Complex) -> Rational:
        """Interpolate `values` (n, d, d) at `points` (n,)."""
        n = len(points)
        flat = values.reshape(n, -1)
        size, near = np.max(np.abs(flat)), np.broadcast_to(flat.mean(axis=0), flat.shape)
        support: list[int] = []
        weights = np.zeros(0, dtype=np.complex128)
        while len(support) < min(MOST, n // 2):
            error = np.max(np.abs(flat - near), axis=1)
            if np.max(error) <= PRECISION * size:
                break
            support.append(int(np.argmax(error)))
            weights, near = interpolated(points, flat, support)
        return cls(points[support], weights, values[support])

    def at(self, s: complex) -> Complex:
        """`R(s)`, away from the support points, (d, d)."""
        parts = self.w / (s - self.z)
        out: Complex = np.tensordot(parts, self.F, axes=1) / parts.sum()
        return out

    def modes(self, mass: float) -> Complex:
        """Every `s` with `det(mass s^2 + R(s)) = 0`, unordered.

        With `x_j = v / (s - z_j)` and `u = s v` the equation is linear in `s`:
        `s x_j = z_j x_j + v`, `s v = u`, `sum_j w_j (mass (u + z_j v + z_j^2 x_j) + F_j x_j) = 0`.
        """
        k, d = len(self.z), self.F.shape[1]
        one, at_v, at_u = np.eye(d), k * d, (k + 1) * d
        A, B = (np.zeros(((k + 2) * d, (k + 2) * d), dtype=np.complex128) for _ in "AB")
        B[:at_u, :at_u] = np.eye(at_u)
        A[:at_v, :at_v] = np.kron(np.diag(self.z), one)
        A[:at_v, at_v:at_u] = np.kron(np.ones((k, 1)), one)
        A[at_v:at_u, at_u:] = one
        held = [w * (F + mass * z**2 * one) for z, w, F in zip(self.z, self.w, self.F, strict=True)]
        A[at_u:, :at_v] = np.hstack(held)
        A[at_u:, at_v:at_u] = mass * (self.w @ self.z) * one
        A[at_u:, at_u:] = mass * self.w.sum() * one
        alpha, beta = la.eigvals(A, B, homogeneous_eigvals=True)
        finite = np.abs(beta) > np.finfo(float).eps * np.abs(alpha)
        out: Complex = alpha[finite] / beta[finite]
        return out


def interpolated(points: Complex, flat: Complex, support: list[int]) -> tuple[Complex, Complex]:
    """Weights that suit all columns of `flat` (n, m) best, and what they give at all points."""
    others = np.setdiff1d(np.arange(len(points)), support)
    cauchy = 1.0 / (points[others, None] - points[None, support])
    loewner = [(column[others, None] - column[None, support]) * cauchy for column in flat.T]
    weights = la.svd(np.vstack(loewner), full_matrices=False)[2][-1].conj()
    near = flat.copy()
    near[others] = (cauchy * weights) @ flat[support] / (cauchy @ weights)[:, None]
    return weights, near
