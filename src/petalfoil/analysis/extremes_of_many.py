"""The least values of many fields on one grid at once: those of `extremes.lowest`, by the same steps in arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.extremes import BEYOND, SHORTEST, STENCIL, STEPS, NodalProfile, taylor

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


def lowest_of_each(fields: Array, phi: Array, z: Array) -> Array:
    """Smallest value of each of `fields` (k, strip, node, axial) over nodes at `phi` (node,) and `z` (axial,); (k,)."""
    values = fields.reshape(-1, len(phi), len(z))
    node, axial = np.divmod(values.reshape(len(values), -1).argmin(axis=1), len(z))
    line = np.arange(len(values))
    along = ManyProfiles.of(Stencils.of(phi), node, values[line, :, axial])
    across = ManyProfiles.of(Stencils.of(z), axial, values[line, node])
    own, window = (
        values[line, node, axial],
        values[line[:, None, None], along.window[:, :, None], across.window[:, None]],
    )
    coefficients = along.matrix @ (window - own[:, None, None]) @ across.matrix.transpose(0, 2, 1)
    below, found = falls(coefficients, along, across)
    kept = found & (below <= BEYOND * (along.spread + across.spread))
    lowest = own - np.where(kept, below, along.parabola + across.parabola)
    return np.asarray(lowest.reshape(fields.shape[:2]).min(axis=1))


def highest_of_each(fields: Array, phi: Array, z: Array) -> Array:
    """Largest value of each of `fields`, (k,)."""
    return -lowest_of_each(-fields, phi, z)


@dataclass(frozen=True)
class Stencils:
    """Polynomials about every node of a direction, as of `extremes.NodalProfile`.

    Attributes
    ----------
    nodes : (n,) array
        Coordinates.
    window : (n, s) int array
        Nodes that the polynomial about each node meets; at an end any, with weights of zero.
    matrix : (n, s, s) array
        Coefficients of the polynomial through values at them.
    reach : (n, 2) array
        Coordinates of both neighbours in cells; 0 at an end.
    """

    nodes: Array
    window: Index
    matrix: Array
    reach: Array

    @classmethod
    def of(cls, nodes: Array) -> Stencils:
        """Those of `nodes`; a motion asks for the same ones again and again."""
        return _stencils(np.ascontiguousarray(nodes).tobytes())

    @property
    def inside(self) -> Mask:
        """Nodes with neighbours on both sides, (n,)."""
        return np.asarray(self.reach[:, 0] < 0.0)


@lru_cache(maxsize=16)
def _stencils(nodes: bytes) -> Stencils:
    places = np.frombuffer(nodes)
    n, width = len(places), min(STENCIL, len(places))
    window, matrix, reach = np.zeros((n, width), np.intp), np.zeros((n, width, width)), np.zeros((n, 2))
    for at in range(n):
        line = NodalProfile.of(places, places, at)
        own = np.arange(line.window.start, line.window.stop)
        window[at, : len(own)], reach[at] = own, line.reach
        matrix[at, : len(own), : len(own)] = line.coefficients
    return Stencils(places, window, matrix, reach)


@dataclass(frozen=True)
class ManyProfiles:
    """One direction through the lowest nodes of many fields, an entry of each.

    Attributes
    ----------
    window : (m, s) int array
        Nodes that the polynomial meets.
    matrix : (m, s, s) array
        Its coefficients from the values there.
    reach : (m, 2) array
        Coordinates of both neighbours in cells; 0 at an end.
    inside : (m,) bool array
        Whether there are two.
    spread, parabola : (m,) array
        Largest difference of the neighbours to the node, and what the parabola through them falls below it; 0 at an
        end.
    """

    window: Index
    matrix: Array
    reach: Array
    inside: Mask
    spread: Array
    parabola: Array

    @classmethod
    def of(cls, stencils: Stencils, at: Index, values: Array) -> ManyProfiles:
        """Those of nodes `at` (m,), with the `values` (m, n) of all nodes."""
        inside, nodes, line = stencils.inside[at], stencils.nodes, np.arange(len(at))
        middle = np.where(inside, at, 1) if len(nodes) > 2 else at
        before, after = (np.clip(middle + side, 0, len(nodes) - 1) for side in (-1, 1))
        own, left, right = (values[line, place] for place in (middle, before, after))
        spread = np.where(inside, np.maximum(left, right) - own, 0.0)
        fall = np.zeros(len(at))
        if len(nodes) > 2:
            fall = np.where(inside, vertex_falls((nodes[before], nodes[middle], nodes[after]), (left, own, right)), 0.0)
        return cls(stencils.window[at], stencils.matrix[at], stencils.reach[at], inside, spread, fall)


def vertex_falls(x: tuple[Array, Array, Array], y: tuple[Array, Array, Array]) -> Array:
    """What parabolas through three points each fall below the middle one, the lowest; 0 of none that opens upward."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    curvature = (right - left) / (x[2] - x[0])
    slope = left + curvature * (x[1] - x[0])
    open_up = curvature > 0.0
    return np.where(open_up, 0.25 * slope**2 / np.where(open_up, curvature, 1.0), 0.0)


def falls(c: Array, along: ManyProfiles, across: ManyProfiles) -> tuple[Array, Mask]:
    """What polynomials `sum c[m, a, b] x^a y^b` fall below their node, and whether they have a lowest place near it.

    Newton's method from the node, in the directions that have neighbours on both sides.
    """
    count = len(c)
    at, reach, free = np.zeros((2, count)), np.stack([along.reach, across.reach]), (along.inside, across.inside)
    below, found, left = np.zeros(count), np.zeros(count, dtype=bool), np.arange(count)
    for _ in range(STEPS):
        value, slope, bend = taylor(c[left].transpose(1, 2, 0), *at[:, left])
        step, convex = newton_step(slope, bend, (free[0][left], free[1][left]))
        here = left[convex]
        near, far = reach[:, here, 0], reach[:, here, 1]
        ahead = np.clip(at[:, here] + step[:, convex], near, far)
        moved = np.abs(ahead - at[:, here]).max(axis=0)
        at[:, here] = ahead
        done = moved <= SHORTEST
        bound = np.stack([one[here] for one in free]) & ((ahead == near) | (ahead == far))
        good = done & ~bound.any(axis=0)
        found[here[good]] = True
        below[here[good]] = np.maximum(0.0, -value[convex][good])
        left = here[~done]
        if not len(left):
            break
    return below, found


def newton_step(
    slope: tuple[Array, Array], bend: tuple[Array, Array, Array], free: tuple[Mask, Mask]
) -> tuple[Array, Mask]:
    """Steps (2, m) to where gradients, (m,) by x and by y, vanish in free directions; whether they lead down.

    `bend` are the second derivatives by x, by both, and by y.
    """
    (g, h), (xx, xy, yy) = slope, bend
    both = free[0] & free[1]
    area = xx * yy - xy * xy
    convex = np.where(both, (xx > 0.0) & (area > 0.0), ~(free[0] & ~(xx > 0.0)) & ~(free[1] & ~(yy > 0.0)))
    by_both, by_xx, by_yy = (
        np.where(mine, value, 1.0)
        for mine, value in ((both & convex, area), (free[0] & convex, xx), (free[1] & convex, yy))
    )
    step = np.stack(
        [
            np.where(both, (xy * h - yy * g) / by_both, np.where(free[0], -g / by_xx, 0.0)),
            np.where(both, (xy * g - xx * h) / by_both, np.where(free[1], -h / by_yy, 0.0)),
        ]
    )
    return step, convex
