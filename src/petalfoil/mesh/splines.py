"""Cubic curves through values at nodes, with as few imports as they need: `scipy.interpolate` takes 0.3 s to load.

Between two nodes a curve is a cubic with given slopes at both; how the slopes follow from the values is the difference:

- `smooth`: the second derivative is continuous, and the third at the nodes next to the ends ("not a knot");
- `monotone`: where the values are monotone the curve is (Fritsch and Butland 1984, as in SciPy).

Results are those of `CubicSpline` and `PchipInterpolator` to rounding.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CubicCurve:
    """A cubic between each two nodes.

    Attributes
    ----------
    nodes : (n,) array
        Places of the nodes, in order.
    coefficients : (n - 1, 4, ...) array
        Powers 0 to 3 of the distance from the node before.
    axis : int
        Axis of the values along which they lie at the nodes.
    """

    nodes: Array
    coefficients: Array
    axis: int

    def __call__(self, places: Array, derivative: int = 0) -> Array:
        """Values at places (k,), or a derivative; outside the nodes the cubics at the ends go on."""
        cubic = np.clip(np.searchsorted(self.nodes, places, side="right") - 1, 0, len(self.nodes) - 2)
        c = self.coefficients
        s = column(places - self.nodes[cubic], c.ndim - 1)
        power, values = np.ones_like(s), np.zeros((len(places), *c.shape[2:]))
        for k in range(derivative, c.shape[1]):
            values += c[cubic, k] * power * math.perm(k, derivative)
            power = power * s
        return np.moveaxis(values, 0, self.axis)


def smooth(nodes: Array, values: Array, axis: int) -> CubicCurve:
    """The curve with a continuous second derivative through values (..., n, ...) at nodes (n,) along an axis."""
    y = np.moveaxis(values, axis, 0)
    return through(nodes, y, smooth_slopes(nodes, y), axis)


def monotone(nodes: Array, values: Array, axis: int) -> CubicCurve:
    """The monotone curve through values (..., n, ...) at nodes (n,) along an axis."""
    y = np.moveaxis(values, axis, 0)
    return through(nodes, y, monotone_slopes(nodes, y), axis)


def through(nodes: Array, y: Array, slopes: Array, axis: int) -> CubicCurve:
    """The curve with values and slopes (n, ...) at nodes (n,)."""
    h = column(np.diff(nodes), y.ndim)
    chord = np.diff(y, axis=0) / h
    bend = (slopes[:-1] + slopes[1:] - 2.0 * chord) / h
    powers = [y[:-1], slopes[:-1], (chord - slopes[:-1]) / h - bend, bend / h]
    return CubicCurve(nodes, np.stack(powers, axis=1), axis)


def smooth_slopes(nodes: Array, y: Array) -> Array:
    """Slopes (n, ...) at nodes that make the second derivative continuous.

    At an inner node `h_i s_(i-1) + 2 (h_(i-1) + h_i) s_i + h_(i-1) s_(i+1) = 3 (h_i m_(i-1) + h_(i-1) m_i)`, with
    distances `h` and chords `m`; next to the ends the third derivative is continuous too.
    """
    h, d = np.diff(nodes), nodes[2:] - nodes[:-2]
    H, m = column(h, y.ndim), np.diff(y, axis=0) / column(h, y.ndim)
    if len(nodes) == 2:
        return np.concatenate([m, m])
    if len(nodes) == 3:  # both conditions at the ends are about the one inner node: a parabola
        middle = (H[1] * m[0] + H[0] * m[1]) / d[0]
        return np.stack([2.0 * m[0] - middle, middle, 2.0 * m[1] - middle])
    bands = np.zeros((3, len(nodes)))
    bands[1, 1:-1], bands[0, 2:], bands[2, :-2] = 2.0 * (h[:-1] + h[1:]), h[:-1], h[1:]
    bands[1, 0], bands[0, 1] = h[1], d[0]
    bands[1, -1], bands[2, -2] = h[-2], d[-1]
    right = np.empty_like(y, dtype=np.float64)
    right[1:-1] = 3.0 * (H[1:] * m[:-1] + H[:-1] * m[1:])
    right[0] = ((H[0] + 2.0 * d[0]) * H[1] * m[0] + H[0] ** 2 * m[1]) / d[0]
    right[-1] = (H[-1] ** 2 * m[-2] + (2.0 * d[-1] + H[-1]) * H[-2] * m[-1]) / d[-1]
    slopes = solve_banded((1, 1), bands, right.reshape(len(nodes), -1), check_finite=False)
    return np.asarray(slopes.reshape(y.shape))


def monotone_slopes(nodes: Array, y: Array) -> Array:
    """Slopes (n, ...) at nodes: weighted harmonic means of the chords beside them, 0 where the values turn."""
    h = column(np.diff(nodes), y.ndim)
    m = np.diff(y, axis=0) / h
    if len(nodes) == 2:
        return np.concatenate([m, m])
    before, after = 2.0 * h[1:] + h[:-1], h[1:] + 2.0 * h[:-1]
    rises = np.sign(m[:-1]) * np.sign(m[1:]) > 0.0
    safe = np.where(rises, m[:-1], 1.0), np.where(rises, m[1:], 1.0)
    slopes = np.empty_like(y, dtype=np.float64)
    slopes[1:-1] = np.where(rises, 1.0 / ((before / safe[0] + after / safe[1]) / (before + after)), 0.0)
    slopes[0] = end_slope(h[0], h[1], m[0], m[1])
    slopes[-1] = end_slope(h[-1], h[-2], m[-1], m[-2])
    return slopes


def end_slope(h: Array, next_h: Array, m: Array, next_m: Array) -> Array:
    """Slope at an end: that of the parabola through three values, as far as the curve then stays monotone."""
    slope = ((2.0 * h + next_h) * m - h * next_m) / (h + next_h)
    steep = (np.sign(m) != np.sign(next_m)) & (np.abs(slope) > 3.0 * np.abs(m))
    return np.where(np.sign(slope) != np.sign(m), 0.0, np.where(steep, 3.0 * m, slope))


def column(values: Array, ndim: int) -> Array:
    """Numbers (k,) along the first of `ndim` axes."""
    return values.reshape(-1, *([1] * (ndim - 1)))
