"""A short SciPy program for a plain gas journal bearing, as a reference of time.

Finite volumes for `div(H^3 P grad P / 2 - Lam P H / 2) = 0` in `phi, Z`, central in the advection, `P = 1` at both
ends, half the length by symmetry; Newton with the exact sparse Jacobian and `spsolve`. It does not import petalfoil.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

TOLERANCE = 1e-8
"""Largest residual over the flows of its cell."""


class Film(NamedTuple):
    """Load along and across the line of centres over `p_a L D`, peak `p / p_a`, scaled residual."""

    along: float
    across: float
    peak: float
    residual: float


def solve(around: int, along: int, length: float, Lam: float, eps: float) -> Film:
    """Solve for the pressures from ambient pressure.

    `around` by `along` cells over the circle and the whole length `L / R_j = length`; film `1 + eps cos(theta)`.
    """
    half = along // 2
    dphi, dZ = 2.0 * np.pi / around, length / along
    theta = np.arange(around) * dphi
    node = np.arange(around * (half + 1)).reshape(around, half + 1)  # column 0 at the end, the last in the middle
    H = np.repeat(1.0 + eps * np.cos(theta), half + 1)
    width = np.full(half + 1, dZ)
    width[-1] = 0.5 * dZ  # half a cell at the plane of symmetry
    a = np.concatenate([node[:, 1:].ravel(), node[:, :-1].ravel()])
    b = np.concatenate([np.roll(node, -1, axis=0)[:, 1:].ravel(), node[:, 1:].ravel()])
    n_around = around * half
    mean_cube = 0.5 * (H[a] ** 3 + H[b] ** 3)
    mean_cube[:n_around] *= np.tile(width[1:], around) / dphi
    mean_cube[n_around:] *= dphi / dZ
    carried = np.zeros(len(a))
    carried[:n_around] = 0.5 * Lam * np.tile(width[1:], around)
    face, faces = np.arange(len(a)), len(a)
    ones = np.ones(faces)
    at_a = sp.csr_array((ones, (face, a)), shape=(faces, H.size))
    at_b = sp.csr_array((ones, (face, b)), shape=(faces, H.size))
    free = node[:, 1:].ravel()
    outflow = (at_a - at_b).T.tocsr()[free]
    at_a, at_b = at_a[:, free], at_b[:, free]
    P = np.ones(H.size)
    for _ in range(50):
        flow = 0.5 * mean_cube * (P[a] ** 2 - P[b] ** 2) + carried * (P[a] * H[a] + P[b] * H[b])
        residual = outflow @ flow
        size = abs(outflow) @ (0.5 * mean_cube * (P[a] ** 2 + P[b] ** 2) + carried * (P[a] * H[a] + P[b] * H[b]))
        worst = float(np.max(np.abs(residual) / size))
        if worst <= TOLERANCE:
            break
        by_a, by_b = mean_cube * P[a] + carried * H[a], -mean_cube * P[b] + carried * H[b]
        change = spsolve((outflow @ (by_a[:, None] * at_a + by_b[:, None] * at_b)).tocsc(), -residual)
        falling = change < 0.0
        fraction = min(1.0, 0.8 * np.min(-P[free][falling] / change[falling], initial=np.inf))
        P[free] += fraction * change
    weight = 2.0 * width * dphi / (2.0 * length)  # both halves, over L D / R_j^2
    weight[0] *= 0.5
    line_load = (P.reshape(node.shape) - 1.0) @ weight
    return Film(float(-line_load @ np.cos(theta)), float(line_load @ np.sin(theta)), float(P.max()), worst)
