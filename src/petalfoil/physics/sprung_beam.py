"""Loads of a clamped beam on springs at evenly spaced places: what is left of them on the springs (S8).

    x + k C b x = r ,   b = b(t_i, t_j) (S7) ,   t_i = (i + 1/2) / S                                    (S8)

With `y = C b x`, the deflections of the beam under `x`, these are `(K / C + k) y = r` and `x = r - k y`. `K` is the
stiffness of a beam of cubic elements between the places, exact under loads there: block tridiagonal, with deflection
and slope of each place. So a beam takes `S` steps in place of the `S^3` of a dense matrix.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

INNER, FIRST, LAST = (24.0, 0.0, 8.0), (108.0, -18.0, 12.0), (108.0, 18.0, 12.0)
"""Entries (1, 1), (1, 2), (2, 2) of a diagonal block of `K / S^3`, for slopes over `S`: of two elements of length
`1/S`, and at the ends of one beside one half as long, toward the clamped end."""


def on_springs(stiffness: Array, compliance: Array, loads: Array) -> Array:
    """`x` of (S8) of some beams, (L, S, m), for springs `k` (L, S), compliances `C` (L,) and loads `r` (L, S, m)."""
    k, r = np.ascontiguousarray(stiffness.T), np.ascontiguousarray(loads.transpose(1, 2, 0))
    unit = compliance / len(k) ** 3
    pivots, y = eliminated(k * unit, r * unit)
    left = r - k[:, None, :] * substituted(pivots, y)
    return np.asarray(left.transpose(2, 0, 1))


def eliminated(k: Array, r: Array) -> tuple[list[tuple[Array, Array, Array]], list[tuple[Array, Array]]]:
    """Inverse pivots and reduced loads of each place, from springs (S, L) and loads (S, m, L) over the unit of `K`.

    The block of neighbours is [[-12, 6], [-6, 2]].
    """
    pivots: list[tuple[Array, Array, Array]] = []
    reduced: list[tuple[Array, Array]] = []
    for i, own in enumerate(k):
        diagonal = FIRST if i == 0 else LAST if i == len(k) - 1 else INNER
        d11, d12, d22 = (np.full_like(own, entry) for entry in diagonal)
        d11 = d11 + own
        force, moment = r[i], np.zeros_like(r[i])
        if i:
            (i11, i12, i22), (f, m) = pivots[-1], reduced[-1]
            up11, up12 = -12.0 * i11 - 6.0 * i12, -12.0 * i12 - 6.0 * i22
            up21, up22 = 6.0 * i11 + 2.0 * i12, 6.0 * i12 + 2.0 * i22
            d11 = d11 + 12.0 * up11 + 6.0 * up12
            d12 = d12 - 6.0 * up11 - 2.0 * up12
            d22 = d22 - 6.0 * up21 - 2.0 * up22
            force, moment = force - up11 * f - up12 * m, -(up21 * f + up22 * m)
        determinant = d11 * d22 - d12 * d12
        pivots.append((d22 / determinant, -d12 / determinant, d11 / determinant))
        reduced.append((force, moment))
    return pivots, reduced


def substituted(pivots: list[tuple[Array, Array, Array]], reduced: list[tuple[Array, Array]]) -> Array:
    """Deflections `y`, (S, m, L)."""
    found: list[Array] = []
    y, turn = np.zeros_like(reduced[0][0]), np.zeros_like(reduced[0][0])
    for (i11, i12, i22), (force, moment) in zip(reversed(pivots), reversed(reduced), strict=True):
        f, m = force + 12.0 * y - 6.0 * turn, moment + 6.0 * y - 2.0 * turn
        y, turn = i11 * f + i12 * m, i12 * f + i22 * m
        found.append(y)
    return np.stack(found[::-1])
