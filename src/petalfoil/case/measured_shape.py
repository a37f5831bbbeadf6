"""A measured free shape: rows of angle from the root and radius of the unloaded mid-surface.

Between the rows a cubic spline gives the radius. Measurements scatter: with a stated tolerance `σ` (standard deviation
of a radius) the spline is the smoothest that stays, on average over the rows, within it (Reinsch 1967; FITPACK)::

    Σ ((r_i − s(φ_i)) / σ)² <= number of rows

Shell theory needs one curvature of the free petal: that of the circle that fits the rows best.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Table = tuple[tuple[float, float], ...]

EDGE_TOLERANCE = 1e-5
"""Angle by which the last row may fall short of the free edge [rad]: angles written with three decimals of a degree.
The spline goes on that far, over some tens of nanometres of radius."""

NEIGHBOURS = 4
"""Rows from which a left-out row is predicted, by the cubic through them."""


def measured_radius(phi: ArrayLike, table: Table, tolerance: float = 0.0) -> NDArray[np.float64]:
    """Return the mid-surface radius of a measured free shape [m].

    Parameters
    ----------
    phi : array_like
        Angles from the root [rad]; beyond the table's ends its end radii hold.
    table : tuple of (float, float)
        Rows of angle [rad] and radius [m], the angles growing from 0.
    tolerance : float
        Standard deviation of a measured radius [m]; 0 for a curve through every row.
    """
    angle = np.clip(np.asarray(phi, dtype=np.float64), 0.0, table[-1][0] + EDGE_TOLERANCE)
    return np.asarray(_spline(table, tolerance)(angle), dtype=np.float64)


@lru_cache(maxsize=16)  # a pack is derived anew whenever it is asked for
def _spline(table: Table, tolerance: float) -> BSpline:
    from scipy.interpolate import BSpline, make_interp_spline, splrep  # 0.3 s: only for those who measured

    angles, radii = np.asarray(table).T
    degree = min(3, len(table) - 1)
    if tolerance == 0.0:
        return make_interp_spline(angles, radii, k=degree)
    weight = np.full(len(table), 1.0 / tolerance)
    return BSpline(*splrep(angles, radii, w=weight, k=degree, s=len(table)))


def fitted_bend_radius(table: Table) -> float:
    """Return the radius of the circle that fits a measured shape best (Taubin 1991) [m]; infinite for a straight one.

    The circle is `a (x² + y²) + b x + c y + d = 0`, whose radius is ``sqrt(b² + c² − 4 a d) / (2 |a|)``.
    """
    angles, radii = np.asarray(table).T
    x, y = radii * np.cos(angles), radii * np.sin(angles)
    x, y = x - x.mean(), y - y.mean()
    square = x**2 + y**2
    mean = square.mean()
    # Taubin's constraint is a unit vector in these scaled columns: the best circle is the last singular vector.
    scaled = np.column_stack([(square - mean) / (2.0 * math.sqrt(mean)), x, y])
    last, b, c = np.linalg.svd(scaled, full_matrices=False)[2][-1]
    a = last / (2.0 * math.sqrt(mean))
    d = -mean * a
    return math.inf if a == 0.0 else float(math.sqrt(b**2 + c**2 - 4.0 * a * d) / (2.0 * abs(a)))


def row_errors(table: Table) -> NDArray[np.float64]:
    """Return by how much each inner row misses the cubic through its neighbours, shape (rows - 2,) [m].

    It is what scatter adds up to and, of a smooth shape, some ten times the error of the spline between the rows: the
    cubic bridges twice their spacing.
    """
    from scipy.interpolate import barycentric_interpolate

    angles, radii = np.asarray(table).T
    errors = np.empty(len(table) - 2)
    for row in range(1, len(table) - 1):
        first = min(max(row - NEIGHBOURS // 2, 0), max(len(table) - NEIGHBOURS - 1, 0))
        others = np.arange(first, min(first + NEIGHBOURS + 1, len(table)))
        others = others[others != row]
        errors[row - 1] = barycentric_interpolate(angles[others], radii[others], angles[row]) - radii[row]
    return errors
