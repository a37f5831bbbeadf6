"""One pitch, divided where a petal's free edge falls, and repeated along a petal.

With `phi1 / phi0 = k + f` the pitch is cut at `f`; each part is divided uniformly. A petal is `k` whole
pitches and the first part once more. Then the nodes of all layers share their angles: contact is node to
node, film nodes are petal nodes, and nothing is interpolated, whatever the overlap.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

FLUSH = 1e-9
"""A fraction of a pitch closer to 0 or 1 than this is rounding of a whole number of pitches."""

COARSEST_FAMILY = 16
"""Cell counts `c * 2**s`, `c >= 16`, share the division of `c` cells, so that such grids are nested."""


def split_overlap(overlap: float) -> tuple[int, float]:
    """Whole pitches `k` and remaining fraction `f` of a petal, `0 <= f < 1` [1]."""
    whole = math.floor(overlap + FLUSH)
    return whole, max(overlap - whole, 0.0) if overlap - whole > FLUSH else 0.0


def divide_pitch(fraction: float, cells: int) -> tuple[int, int]:
    """Cells in `[0, f]` and `[f, 1]`, in proportion to their lengths and at least one in each.

    Equal numbers would put half of the cells into a sliver (numerics: 64 cells in 6 % of a pitch).
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
