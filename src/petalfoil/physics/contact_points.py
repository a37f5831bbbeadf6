"""Contact at isolated points that lie between nodes and move with the load (K5)-(K9).

Petals mostly touch at isolated points (in 3-D: one at each axial station). In the discrete equilibrium such a point is
one active node, or two while it passes from one to the next. One active node is a pin and two are a clamp: a tangent
with contacts at nodes alternates between two stiffnesses on every grid. Here each becomes a point again, with the gap
`p`, its slope and its curvature interpolated from the nodes:

    p = 0 ,  p' = 0 ,  p'' > 0                                             at the contact point        (K5)
    d phi_c = -dp' / p'' ,   which adds  (lam / p'') p'^T p'  to the tangent                           (K6)
    phi_c = a (minimum of the gap) + (1 - a) (centroid of the reactions)                               (K7)
    a = 1 / (1 + C lam / p'') ,   C the turn of the gap there by a unit moment                         (K8)

Longer runs of active nodes are line contacts. They stay at their nodes, and so do contacts at the ends of a petal,
which do not move.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.contact import Contacts, GapLines

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

POINT_NODES = 2
"""Most neighbouring active nodes of one contact point: it lies between them."""

MARGIN = 2
"""Nodes between a contact point and the end of its line: the kink of the curvature is read that far on both sides."""

EVEN = 0.5
"""Weight of the minimum in (K7) while the turn of the gap by a moment is not known."""


@dataclass(frozen=True)
class IsolatedContacts:
    """Contacts of an equilibrium, as points where they are isolated.

    Attributes
    ----------
    groups : tuple of PointsOnLines
        The points, kind by kind.
    at_nodes : (m,) bool array
        Active contacts that belong to no point.
    """

    groups: tuple[PointsOnLines, ...]
    at_nodes: Mask

    @classmethod
    def of(cls, contacts: Contacts, gaps: Array, lam: Array, active: Mask) -> IsolatedContacts:
        """Those of an equilibrium with the contacts `active`, from gaps and reactions at the nodes, all (m,)."""
        groups = tuple(PointsOnLines.of(lines, gaps, lam, active) for lines in contacts.lines)
        at_nodes = active.copy()
        for group in groups:
            at_nodes[group.replaced] = False
        return cls(groups, at_nodes)

    def placed(self, compliance: Array) -> IsolatedContacts:
        """The points where their `compliance` `C` (k,), in units of gap over reaction [1/rad^2], puts them (K8)."""
        weight = 1.0 / (1.0 + compliance * self.travel_stiffness)
        ends = np.cumsum([len(group.line) for group in self.groups], dtype=np.intp)
        parts = zip(self.groups, np.split(weight, ends)[: len(self.groups)], strict=True)
        return replace(self, groups=tuple(replace(group, weight=part) for group, part in parts))

    @property
    def value(self) -> sp.csr_array:
        """Gap at the points, from the gaps at the nodes, (k, m) [1]."""
        return self._stacked([group.value for group in self.groups])

    @property
    def slope(self) -> sp.csr_array:
        """Slope of the gap at the points, likewise, (k, m) [1/rad]."""
        return self._stacked([group.slope for group in self.groups])

    @property
    def travel_stiffness(self) -> Array:
        """`lam / p''` of (K6), in units of reaction over gap, (k,) [rad^2]."""
        return np.concatenate([np.zeros(0), *(group.reaction / group.curvature for group in self.groups)])

    @property
    def contact_line(self) -> Index:
        """Number of the contact line along the shaft that each point is part of, (k,)."""
        numbers, first = [np.zeros(0, dtype=np.intp)], 0
        for group in self.groups:
            numbers.append(group.contact_line + first)
            first = int(numbers[-1].max(initial=first - 1)) + 1
        return np.concatenate(numbers)

    def _stacked(self, parts: list[sp.csr_array]) -> sp.csr_array:
        empty = sp.csr_array((0, len(self.at_nodes)))
        return sp.csr_array(sp.vstack([empty, *parts], format="csr"))


@dataclass(frozen=True)
class PointsOnLines:
    """Contact points on lines of gaps.

    Attributes
    ----------
    lines : GapLines
        The lines.
    gaps, lam : (m,) array
        All gaps and reactions.
    line, first, last : (k,) int array
        Line, first and last active node of each point.
    weight : (k,) array
        Weight `a` of the minimum of the gap in the position.
    """

    lines: GapLines
    gaps: Array
    lam: Array
    line: Index
    first: Index
    last: Index
    weight: Array

    @classmethod
    def of(cls, lines: GapLines, gaps: Array, lam: Array, active: Mask) -> PointsOnLines:
        """Those of an equilibrium: short runs of active nodes away from the ends, where the gap curves upward."""
        closed = np.pad(active[lines.number], ((0, 0), (1, 1)))
        line, first = np.nonzero(closed[:, 1:-1] & ~closed[:, :-2])
        last = np.nonzero(closed[:, 1:-1] & ~closed[:, 2:])[1]
        short = (last - first < POINT_NODES) & (first >= MARGIN) & (last < len(lines.phi) - MARGIN)
        runs = cls(lines, gaps, lam, line[short], first[short], last[short], np.full(int(short.sum()), EVEN))
        curved = runs.least_curvature > 0.0
        return cls(lines, gaps, lam, runs.line[curved], runs.first[curved], runs.last[curved], runs.weight[curved])

    @property
    def replaced(self) -> Index:
        """Indices of the active contacts at nodes that the points replace."""
        return np.concatenate([self.lines.number[self.line, node] for node in (self.first, self.last)])

    @property
    def contact_line(self) -> Index:
        """Number of each point's contact line, (k,): points of a petal that come first, second, ... on a station."""
        start = np.searchsorted(self.line, self.line)
        order = np.arange(len(self.line)) - start
        both = np.stack([self.line // self.lines.stations, order])
        return np.unique(both, axis=1, return_inverse=True)[1].reshape(-1)

    @cached_property
    def reaction(self) -> Array:
        """Reaction at each point, (k,)."""
        one, other = (self.lam[self.lines.number[self.line, node]] for node in (self.first, self.last))
        return np.asarray(one + np.where(self.last > self.first, other, 0.0))

    @cached_property
    def position(self) -> Array:
        """Angle of each point (K7), (k,) [rad].

        While one node is active the reaction stays on it, and the minimum passes from the middle of one cell to that of
        the next. While two are active the minimum stays between them, and the centroid of the reactions passes from one
        to the other. The two phases last as `a` to `1 - a` (K8), so that the mean with these weights moves evenly.
        """
        phi, first, last = self.lines.phi, self.first, self.last
        span = phi[last] - phi[first]
        before, after = phi[first] - phi[first - 1], phi[first + 1] - phi[first]
        slope, curvature = self._differences(first)
        downhill = np.divide(-slope, curvature, out=np.zeros(len(first)), where=curvature > 0.0)
        minimum = np.where(last > first, 0.5 * span, np.clip(downhill, -0.5 * before, 0.5 * after))
        centroid = span * self.lam[self.lines.number[self.line, last]] / self.reaction
        return np.asarray(phi[first] + self.weight * minimum + (1.0 - self.weight) * centroid)

    @cached_property
    def cell(self) -> Index:
        """Node before each point, (k,)."""
        return np.where(self.position < self.lines.phi[self.first], self.first - 1, self.first)

    @cached_property
    def fraction(self) -> Array:
        """Place of each point in its cell, (k,) [1]."""
        start, end = self.lines.phi[self.cell], self.lines.phi[self.cell + 1]
        return np.asarray((self.position - start) / (end - start))

    @cached_property
    def curvature(self) -> Array:
        """`p''` at each point, (k,)."""
        return self._curvature_at(self.fraction)

    @property
    def least_curvature(self) -> Array:
        """The smallest `p''` between the centroid of the reactions and the minimum of the gap, (k,)."""
        centroid, minimum = (replace(self, weight=np.full(len(self.line), float(a))) for a in (0, 1))
        start, end = self.lines.phi[minimum.cell], self.lines.phi[minimum.cell + 1]
        one, other = minimum.fraction, (centroid.position - start) / (end - start)
        bend, rise = self.kink * (end - start), minimum._curvature_at(np.ones(1)) - minimum._curvature_at(np.zeros(1))
        vertex = np.divide(bend - rise, 2.0 * bend, out=np.zeros(len(bend)), where=bend > 0.0)
        lowest = np.clip(vertex, np.minimum(one, other), np.maximum(one, other))
        return np.asarray(np.min([minimum._curvature_at(t) for t in (one, other, lowest)], axis=0))

    def _curvature_at(self, t: Array) -> Array:
        """`p''` at the place `t` (k,) of the cell (K9).

        Bending moments, and `p''` with them, are linear between nodes that carry the reactions. The same reaction
        between two nodes leaves `p''` at these as it is and lowers it in between: by the kink of the nodal `p''`.
        """
        step = self.lines.phi[self.cell + 1] - self.lines.phi[self.cell]
        straight = (1.0 - t) * self._differences(self.cell)[1] + t * self._differences(self.cell + 1)[1]
        return np.asarray(straight - self.kink * step * t * (1.0 - t))

    @cached_property
    def kink(self) -> Array:
        """Change of the derivative of `p''` across the active nodes, which their reactions make, (k,)."""
        phi, first, last = self.lines.phi, self.first, self.last
        before, at_first, at_last, after = (self._differences(node)[1] for node in (first - 1, first, last, last + 1))
        rise, fall = (
            (after - at_last) / (phi[last + 1] - phi[last]),
            (at_first - before) / (phi[first] - phi[first - 1]),
        )
        return np.maximum(rise - fall, 0.0)

    @property
    def value(self) -> sp.csr_array:
        """Gap at the points, linear between nodes as the moment of a reaction is, (k, m)."""
        weights = np.stack([1.0 - self.fraction, self.fraction], axis=1)
        return self._over_gaps(self.cell[:, None] + np.arange(2), weights)

    @property
    def slope(self) -> sp.csr_array:
        """Slope of the gap at the points, that of the cubic through four nodes, (k, m) [1/rad]."""
        nodes = self.cell[:, None] + np.arange(-1, 3)
        return self._over_gaps(nodes, cubic_slopes(self.lines.phi[nodes] - self.position[:, None]))

    def _differences(self, node: Index) -> tuple[Array, Array]:
        """Slope and curvature of the parabola through the gaps at a node and beside it, (k,)."""
        phi, number = self.lines.phi, self.lines.number
        before, after = phi[node] - phi[node - 1], phi[node + 1] - phi[node]
        left, middle, right = (self.gaps[number[self.line, node + k]] for k in (-1, 0, 1))
        fall, rise = (middle - left) / before, (right - middle) / after
        return (fall * after + rise * before) / (before + after), 2.0 * (rise - fall) / (before + after)

    def _over_gaps(self, nodes: Index, weights: Array) -> sp.csr_array:
        """Rows with `weights` (k, j) on the gaps at `nodes` (k, j) of each point's line, (k, m)."""
        rows = np.repeat(np.arange(len(nodes)), nodes.shape[1])
        numbers = self.lines.number[self.line[:, None], nodes]
        return sp.csr_array((weights.ravel(), (rows, numbers.ravel())), shape=(len(nodes), len(self.gaps)))


def cubic_slopes(offset: Array) -> Array:
    """Weights of the values at `offset` (k, 4) in the slope at zero of the cubic through them, (k, 4)."""
    powers = offset[:, None, :] ** np.arange(4)[:, None]
    unit = np.zeros((len(offset), 4, 1))
    unit[:, 1] = 1.0  # only the linear term has a slope at zero
    return np.asarray(np.linalg.solve(powers, unit)[:, :, 0])
