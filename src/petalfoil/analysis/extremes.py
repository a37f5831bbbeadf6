"""The extreme of a field between nodes: a quartic through five nodes in each direction.

Extremes taken at nodes jump from node to node as a grid is refined, and the strip of the lowest node need not be that
of the lowest value. On every strip that may hold the extreme, the field about its lowest node is the polynomial of
fourth degree along the arc and of fourth degree along the shaft that meets the nearest 5 x 5 nodes. Its lowest place
within a cell of the node is found by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STENCIL = 5
"""Nodes in each direction: a polynomial of fourth degree, whose extreme has an error of fifth order."""

BEYOND = 0.25
"""Most that the extreme may lie beyond the extreme node, over the largest difference to its neighbours in a direction.
A parabola goes to 1/8 of it. A quartic that goes farther has been led astray by a kink; parabolas replace it."""

STEPS, SHORTEST = 30, 1e-10
"""Newton steps at most, and the length of the last one in cells."""


@dataclass(frozen=True)
class Extreme:
    """Value and place of an extreme: strip, angle within the strip [rad], distance along the shaft [m]."""

    value: float
    strip: int
    phi: float
    z: float


def lowest(field: Array, phi: Array, z: Array) -> Extreme:
    """Smallest value of `field` (strip, node, axial) over nodes at `phi` (node,) and `z` (axial,)."""
    flat = field.reshape(len(field), -1)
    places, nodal = flat.argmin(axis=1), flat.min(axis=1)
    best: Extreme | None = None
    for strip in np.argsort(nodal, kind="stable"):
        node, axial = divmod(int(places[strip]), len(z))
        lines = (NodalProfile.of(phi, field[strip, :, axial], node), NodalProfile.of(z, field[strip, node], axial))
        if best is not None and nodal[strip] - BEYOND * sum(line.spread for line in lines) >= best.value:
            continue
        value, angle, distance = _between_nodes(field[strip], lines)
        if best is None or value < best.value:
            best = Extreme(value, int(strip), angle, distance)
    if best is None:
        raise ValueError("a field without strips has no extreme")
    return best


def highest(field: Array, phi: Array, z: Array) -> Extreme:
    """Largest value of `field`."""
    low = lowest(-field, phi, z)
    return Extreme(-low.value, low.strip, low.phi, low.z)


def weights_at(here: Extreme, field: Array, phi: Array, z: Array) -> Array:
    """Derivatives of an extreme of `field` by its values, the shape of the field: its place is stationary."""
    out, values = np.zeros_like(field), field[here.strip]
    node, axial = np.unravel_index(int(np.abs(values - here.value).argmin()), values.shape)
    lines = NodalProfile.of(phi, values[:, axial], int(node)), NodalProfile.of(z, values[node], int(axial))
    along, across = (line.weights(place) for line, place in zip(lines, (here.phi, here.z), strict=True))
    out[here.strip, lines[0].window, lines[1].window] = np.outer(along, across)
    if not abs(float(np.sum(out * field)) - here.value) <= FOLLOWED * abs(here.value):  # parabolas replace the quartic
        out[:] = 0.0
        three = [line.parabola_weights(place) for line, place in zip(lines, (here.phi, here.z), strict=True)]
        out[here.strip, :, axial] += three[0]
        out[here.strip, node, :] += three[1]
        out[here.strip, node, axial] -= 1.0
    return out


FOLLOWED = 1e-12
"""Relative difference of an extreme from the polynomial at its place by which it is known to be that of the quartic."""


@dataclass(frozen=True)
class NodalProfile:
    """Values along one direction through the lowest node of a strip.

    Attributes
    ----------
    nodes, values : (k,) array
        Coordinates and values.
    at : int
        Place of the lowest node. At an end of the line it stands for the extreme of the direction.
    window : slice
        The nodes that the polynomial meets.
    cell : float
        Mean of the two cells beside the node, the unit of its coordinate.
    """

    nodes: Array
    values: Array
    at: int
    window: slice
    cell: float

    @classmethod
    def of(cls, nodes: Array, values: Array, at: int) -> NodalProfile:
        """The line with the node at place `at`."""
        if not 0 < at < len(nodes) - 1:
            return cls(nodes, values, at, slice(at, at + 1), 1.0)
        width = min(STENCIL, len(nodes))
        first = min(max(at - width // 2, 0), len(nodes) - width)
        return cls(nodes, values, at, slice(first, first + width), 0.5 * float(nodes[at + 1] - nodes[at - 1]))

    @property
    def inside(self) -> bool:
        """The node has neighbours on both sides."""
        return 0 < self.at < len(self.nodes) - 1

    @property
    def spread(self) -> float:
        """Largest difference of the neighbours to the node; 0 at an end."""
        at, values = self.at, self.values
        return float(max(values[at - 1], values[at + 1]) - values[at]) if self.inside else 0.0

    @property
    def local(self) -> Array:
        """Coordinates of the window, 0 at the node, in cells."""
        return np.asarray((self.nodes[self.window] - self.nodes[self.at]) / self.cell)

    @property
    def coefficients(self) -> Array:
        """Coefficients of the polynomial through values at the window, in cells, (k, k)."""
        return _interpolating(*self.local.tolist())

    @property
    def reach(self) -> tuple[float, float]:
        """Coordinates of both neighbours, in cells; 0 at an end."""
        if not self.inside:
            return 0.0, 0.0
        before, after = self.nodes[[self.at - 1, self.at + 1]] - self.nodes[self.at]
        return float(before) / self.cell, float(after) / self.cell

    @property
    def parabola(self) -> tuple[float, float]:
        """What the parabola through node and neighbours falls below the node, and where that is, in cells."""
        if not self.inside:
            return 0.0, 0.0
        three = slice(self.at - 1, self.at + 2)
        value, place = vertex(self.nodes[three], self.values[three])
        return float(self.values[self.at]) - value, (place - float(self.nodes[self.at])) / self.cell

    def weights(self, place: float) -> Array:
        """Weights of the nodes of the window in the polynomial at a `place`."""
        local = (place - float(self.nodes[self.at])) / self.cell
        powers = local ** np.arange(len(self.local))
        return np.asarray(powers @ self.coefficients)

    def parabola_weights(self, place: float) -> Array:
        """Weights of all nodes in the parabola through the node and its neighbours at a `place`."""
        out = np.zeros(len(self.nodes))
        out[self.at] = 1.0
        if self.inside:
            three = slice(self.at - 1, self.at + 2)
            local = (self.nodes[three] - self.nodes[self.at]) / self.cell
            at = (place - float(self.nodes[self.at])) / self.cell
            out[three] = at ** np.arange(3) @ _interpolating(*local.tolist())
        return out

    def place(self, local: float) -> float:
        """Coordinate of a place given in cells."""
        return float(self.nodes[self.at] + self.cell * local)


def _between_nodes(values: Array, lines: tuple[NodalProfile, NodalProfile]) -> tuple[float, float, float]:
    """Lowest value of a strip (node, axial) and its place (angle, z), about the node that `lines` pass through."""
    along, across = lines
    own, window = float(values[along.at, across.at]), values[along.window, across.window]
    below = _quartic(window - own, lines)
    if below is None or below[0] > BEYOND * (along.spread + across.spread):
        (fall, x), (fall_z, y) = along.parabola, across.parabola
        below = fall + fall_z, x, y
    return own - below[0], along.place(below[1]), across.place(below[2])


def _quartic(rise: Array, lines: tuple[NodalProfile, NodalProfile]) -> tuple[float, float, float] | None:
    """What the polynomial through `rise` above the node falls below it, and where, in cells; None if nowhere near.

    Newton's method from the node, in the directions that have neighbours on both sides.
    """
    ((first, last), along), ((near, far), across) = (_stencil(line.nodes.tobytes(), line.at) for line in lines)
    c = (along @ rise @ across.T).tolist()  # sum c[a][b] x^a y^b
    x = y = 0.0
    for _ in range(STEPS):
        value, slope, bend = taylor(c, x, y)
        step = _newton_step(slope, bend, (lines[0].inside, lines[1].inside))
        if step is None:
            return None
        ahead = min(max(x + step[0], first), last), min(max(y + step[1], near), far)
        moved, (x, y) = max(abs(ahead[0] - x), abs(ahead[1] - y)), ahead
        if moved <= SHORTEST:
            at_bound = (lines[0].inside and x in (first, last)) or (lines[1].inside and y in (near, far))
            return None if at_bound else (max(0.0, -value), x, y)
    return None


@lru_cache(maxsize=4096)
def _stencil(nodes: bytes, at: int) -> tuple[tuple[float, float], Array]:
    """Reach and polynomial about a node of `nodes`; a motion asks at the same nodes every step."""
    line = NodalProfile.of(np.frombuffer(nodes), np.frombuffer(nodes), at)
    return line.reach, line.coefficients


def _interpolating(*places: float) -> Array:
    """Coefficients of the polynomial through values at `places`, (k, k)."""
    return np.asarray(np.linalg.inv(np.vander(places, increasing=True)))


def _newton_step(
    slope: tuple[float, float], bend: tuple[float, float, float], free: tuple[bool, bool]
) -> tuple[float, float] | None:
    """Step to where the gradient vanishes, in the directions that are free; None where the field is not convex.

    `bend` are the second derivatives by x, by both, and by y.
    """
    (g, h), (xx, xy, yy) = slope, bend
    if free == (True, True):
        area = xx * yy - xy * xy
        return ((xy * h - yy * g) / area, (xy * g - xx * h) / area) if xx > 0.0 and area > 0.0 else None
    if (free[0] and not xx > 0.0) or (free[1] and not yy > 0.0):
        return None
    return (-g / xx if free[0] else 0.0), (-h / yy if free[1] else 0.0)


def taylor(c: Any, x: Any, y: Any) -> tuple[Any, tuple[Any, Any], tuple[Any, Any, Any]]:
    """Value, gradient and second derivatives (by x, by both, by y) of the polynomial `sum c[a][b] x^a y^b`.

    Horner's scheme in what it is given: plain numbers, for arrays of five cost ten times as much, or entries `c[a][b]`,
    `x` and `y` (m,) of many polynomials.
    """
    value = by_x = by_xx = by_y = by_xy = by_yy = 0.0
    for row in reversed(c):
        f = f_y = f_yy = 0.0
        for entry in reversed(row):
            f_yy = f_yy * y + 2.0 * f_y
            f_y = f_y * y + f
            f = f * y + entry
        by_xx = by_xx * x + 2.0 * by_x
        by_x = by_x * x + value
        value = value * x + f
        by_xy = by_xy * x + by_y
        by_y = by_y * x + f_y
        by_yy = by_yy * x + f_yy
    return value, (by_x, by_y), (by_xx, by_xy, by_yy)


def vertex(x: Array, y: Array) -> tuple[float, float]:
    """Lowest value and its place of the parabola through three points whose middle one is the lowest."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    curvature = (right - left) / (x[2] - x[0])
    if not curvature > 0.0:
        return float(y[1]), float(x[1])
    slope = left + curvature * (x[1] - x[0])  # at the middle point
    shift = -slope / (2.0 * curvature)
    return float(y[1] + 0.5 * slope * shift), float(x[1] + shift)
