"""The extreme of a field between nodes: a quartic through five nodes in each direction.

Extremes taken at nodes jump from node to node as a grid is refined, and the strip of the lowest node need not be that
of the lowest value. On every strip that may hold the extreme, the field about its lowest node is the polynomial of
fourth degree along the arc and of fourth degree along the shaft that meets the nearest 5 x 5 nodes. Its lowest place
within a cell of the node is found by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import polynomial
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
        lines = (Line.of(phi, field[strip, :, axial], node), Line.of(z, field[strip, node], axial))
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


@dataclass(frozen=True)
class Line:
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
    def of(cls, nodes: Array, values: Array, at: int) -> Line:
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

    def place(self, local: float) -> float:
        """Coordinate of a place given in cells."""
        return float(self.nodes[self.at] + self.cell * local)


def _between_nodes(values: Array, lines: tuple[Line, Line]) -> tuple[float, float, float]:
    """Lowest value of a strip (node, axial) and its place (angle, z), about the node that `lines` pass through."""
    along, across = lines
    own, window = float(values[along.at, across.at]), values[along.window, across.window]
    below = _quartic(window - own, lines)
    if below is None or below[0] > BEYOND * (along.spread + across.spread):
        (fall, x), (fall_z, y) = along.parabola, across.parabola
        below = fall + fall_z, x, y
    return own - below[0], along.place(below[1]), across.place(below[2])


def _quartic(rise: Array, lines: tuple[Line, Line]) -> tuple[float, float, float] | None:
    """What the polynomial through `rise` above the node falls below it, and where, in cells; None if nowhere near.

    Newton's method from the node, in the directions that have neighbours on both sides.
    """
    vandermonde = [polynomial.polyvander(line.local, len(line.local) - 1) for line in lines]
    c = np.linalg.solve(vandermonde[1], np.linalg.solve(vandermonde[0], rise).T).T  # sum c[a, b] x^a y^b
    free = [k for k, line in enumerate(lines) if line.inside]
    bounds, place = np.array([line.reach for line in lines]), np.zeros(2)
    for _ in range(STEPS if free else 0):
        value, slope, bend = _taylor(c, place)
        bend = bend[np.ix_(free, free)]
        if bend[0, 0] <= 0.0 or np.linalg.det(bend) <= 0.0:
            return None
        ahead = place.copy()
        ahead[free] -= np.linalg.solve(bend, slope[free])
        ahead = np.clip(ahead, bounds[:, 0], bounds[:, 1])
        step, place = float(np.max(np.abs(ahead - place))), ahead
        if step <= SHORTEST:
            at_bound = bool(np.any((place == bounds.T)[:, free]))
            return None if at_bound else (max(0.0, -value), float(place[0]), float(place[1]))
    return None if free else (0.0, 0.0, 0.0)


def _taylor(c: Array, place: Array) -> tuple[float, Array, Array]:
    """Value, gradient (2,) and second derivatives (2, 2) of the polynomial `sum c[a, b] x^a y^b` at a place."""
    (x, dx, ddx), (y, dy, ddy) = (_powers(t, n) for t, n in zip(place.tolist(), c.shape, strict=True))
    across, turning = c @ y, c @ dy
    mixed = float(dx @ turning)
    bend = np.array([[float(ddx @ across), mixed], [mixed, float(x @ (c @ ddy))]])
    return float(x @ across), np.array([float(dx @ across), float(x @ turning)]), bend


def _powers(t: float, n: int) -> tuple[Array, Array, Array]:
    """Powers of `t` from 0 to `n - 1`, and their first and second derivatives by `t`."""
    k = np.arange(n)
    powers = t ** np.arange(n, dtype=np.float64)
    first, second = np.zeros(n), np.zeros(n)
    first[1:] = k[1:] * powers[:-1]
    second[2:] = k[2:] * k[1:-1] * powers[:-2]
    return powers, first, second


def vertex(x: Array, y: Array) -> tuple[float, float]:
    """Lowest value and its place of the parabola through three points whose middle one is the lowest."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    curvature = (right - left) / (x[2] - x[0])
    if not curvature > 0.0:
        return float(y[1]), float(x[1])
    slope = left + curvature * (x[1] - x[0])  # at the middle point
    shift = -slope / (2.0 * curvature)
    return float(y[1] + 0.5 * slope * shift), float(x[1] + shift)
