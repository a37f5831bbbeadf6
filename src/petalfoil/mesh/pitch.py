"""The division of one pitch into cells, and the nodes of a petal.

A petal is `phi1 / phi0 = k + f` pitches long, with a whole number `k` and `0 <= f < 1`. Its free edge lies at the
fraction `f` of a pitch. The pitch is divided at `f`, and each part has cells of equal length. A petal has `k` whole
pitches and the first part of one more. The nodes of all layers then have the same angles for any overlap: contact is
node to node, film nodes are petal nodes, and no value is interpolated.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FLUSH = 1e-9
"""An overlap that differs from a whole number of pitches by less than this is taken as whole: rounding of the input."""

COARSEST_FAMILY = 16
"""Smallest number of cells whose division is repeated on finer grids.

A grid of `c * 2**s` cells, `c >= 16`, halves the cells of the grid of `c` cells `s` times. Such grids are nested, which
the extrapolation to vanishing cell size needs.
"""


def split_overlap(overlap: float) -> tuple[int, float]:
    """Whole pitches `k` and remaining fraction `f` of a petal, `0 <= f < 1` [1]."""
    whole = math.floor(overlap + FLUSH)
    return whole, max(overlap - whole, 0.0) if overlap - whole > FLUSH else 0.0


def divide_pitch(fraction: float, cells: int) -> tuple[int, int]:
    """Cells in `[0, f]` and `[f, 1]`, in proportion to their lengths and at least one in each.

    Equal numbers would put half of the cells into a very short part (`docs/numerics.md`: 64 cells in 6 % of a pitch).
    """
    if fraction == 0.0:
        return 0, cells
    base, repeats = cells, 1
    while base % 2 == 0 and base // 2 >= COARSEST_FAMILY:
        base, repeats = base // 2, repeats * 2
    first = min(max(round(fraction * base), 1), base - 1)
    return first * repeats, (base - first) * repeats


def petal_angles(pitch: float, overlap: float, cells: int) -> NDArray[np.float64]:
    """Local angles of a petal's nodes, root to free edge, shape (n_node,) [rad]."""
    whole, fraction = split_overlap(overlap)
    first, second = divide_pitch(fraction, cells)
    head = fraction * np.arange(first) / max(first, 1)
    tail = fraction + (1.0 - fraction) * np.arange(second) / second
    one_pitch = np.concatenate([head, tail])
    pitches = [one_pitch + repeat for repeat in range(whole)]
    rest = whole + fraction * np.arange(first + 1) / max(first, 1)
    return pitch * np.concatenate([*pitches, rest])
