"""Gaps between petals of Hermite elements as curves, and contact points that lie anywhere on them (K10)-(K12).

A curve is the gap of a petal toward the journal, the bushing or the petal below, along the angle where they face each
other. On every element it is a cubic, linear in the unknowns `w` of the petals and in the journal's displacement `e`:

    p(t) = sum_k H_k(t) (rest + by_e e + by_w w)_k                                                     (K10)

A point load bends its own element further (S7), so that with reactions `lam_d` at `t_d` on one element the gap is

    p(t) + sum_d C b(t, t_d) lam_d ,   C the point compliance, that of both petals between petals        (K11)

Toward the journal `C = 0`: the film, whose pressures bend elements too, has the thickness of the cubic alone, and no
petal that touches the journal is nearer to it anywhere than its gap.

At a contact point this gap vanishes, and so does its slope, except at the end of a curve.                (K12)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.petal_elements import (
    clamped_beam,
    clamped_beam_bend,
    clamped_beam_own,
    clamped_beam_slope,
    clamped_beam_twist,
)
from petalfoil.sparsity import SparseRows, Triplets, add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


class Facing(Enum):
    """What a petal faces along a curve."""

    JOURNAL = "journal"
    BUSHING = "bushing"
    PETAL = "petal"


@dataclass(frozen=True)
class GapCurves:
    """All curves. Positions on a curve are counted in elements from its first node.

    Attributes
    ----------
    facing : tuple of Facing
        What each curve is about.
    first : (n_curve,) int array
        First node of each curve; its elements follow, and the next curve has nodes of its own.
    elements : (n_curve,) int array
        Elements of each curve.
    angle : (n_node - 1,) array
        Angle of the element behind each node, 1 between curves [rad].
    compliance : (n_node - 1,) array
        `C` of each element in (K11), in units of gap over reaction; zero toward the journal.
    softness : (n_node - 1,) array
        Point compliance of the petals on each element, toward the journal too, in the same units.
    rest : (2 n_node,) array
        Nodal (value, slope) of the gaps of undeflected petals round a centred journal.
    by_e : (2 n_node, d) array
        Their derivative by the journal's displacement.
    by_w : (2 n_node, n) sparse
        Their derivative by the unknowns of the petals.
    """

    facing: tuple[Facing, ...]
    first: Index
    elements: Index
    angle: Array
    compliance: Array
    softness: Array
    rest: Array
    by_e: Array
    by_w: sp.csr_array

    def locate(self, curve: Index, position: Array) -> tuple[Index, Array]:
        """Element and place in it of positions on curves."""
        inside = np.maximum(np.minimum(np.floor(position).astype(np.intp), self.elements[curve] - 1), 0)
        return self.first[curve] + inside, position - inside

    def rows(self, curve: Index, position: Array, derivative: int = 0) -> sp.csr_array:
        """Weights of the nodal gaps in the gap at positions on curves, or in a derivative by the place in the element.

        Shape (k, 2 n_node).
        """
        return hermite.rows(*self.locate(curve, position), self.angle, derivative)

    @cached_property
    def _sampled(self) -> dict[int, tuple[Index, Array, Index, Array, SparseRows]]:
        return {}

    def samples(self, per_element: int) -> tuple[Index, Array, Index, Array, SparseRows]:
        """Places along all curves: curve, position, element, place in it, and weights of the nodal gaps there."""
        if per_element not in self._sampled:
            count = self.elements * per_element
            curve = np.repeat(np.arange(len(count)), count)
            number = np.arange(len(curve)) - np.repeat(np.cumsum(count) - count, count)
            position = (number + 0.5) / per_element
            element, t = self.locate(curve, position)
            rows = SparseRows(hermite.rows(element, t, self.angle))
            self._sampled[per_element] = (curve, position, element, t, rows)
        return self._sampled[per_element]

    @cached_property
    def padded(self) -> tuple[Index, Array]:
        """`by_w` by rows of equal length: unknowns, in their order, and weights, zero where a row has fewer."""
        held = np.diff(self.by_w.indptr)
        number = np.arange(self.by_w.nnz) - np.repeat(self.by_w.indptr[:-1], held)
        at = np.repeat(np.arange(len(held)), held), number
        unknown, weight = (np.zeros((len(held), held.max(initial=1)), kind) for kind in (np.int32, np.float64))
        unknown[at], weight[at] = self.by_w.indices, self.by_w.data
        return unknown, weight

    def nodal(self, w: Array, e: Array) -> Array:
        """Nodal (value, slope) of all gaps, (2 n_node,)."""
        gaps: Array = self.rest + self.by_e @ e + self.by_w @ w
        return gaps


@dataclass(frozen=True)
class ContactPoints:
    """Contacts on gap curves: points that travel, and stretches along which two petals lie on each other.

    A stretch has a travelling point at each end, and in between points that divide it evenly. These move with the ends,
    so that an end never passes one of them.

    Attributes
    ----------
    curve, position : (k,) array
        Curve and position of each travelling point, in their order along the curves.
    inner : (k,) int array
        Points between each travelling point and the next one: a stretch; zero elsewhere.
    reaction : (j,) array
        Reactions of all points, those of a stretch between its ends.
    """

    curve: Index
    position: Array
    inner: Index
    reaction: Array

    @classmethod
    def none(cls) -> ContactPoints:
        """No contact."""
        place, value = np.zeros(0, dtype=np.intp), np.zeros(0)
        return cls(place, value, place, value)

    @cached_property
    def ends(self) -> Index:
        """Numbers of the travelling points among all points, (k,)."""
        return np.arange(len(self.curve)) + np.cumsum(self.inner) - self.inner

    @cached_property
    def _between(self) -> tuple[Index, Array]:
        """The travelling point before each point or at it, and the part of the way to the next one, (j,) each."""
        before = np.repeat(np.arange(len(self.curve)), self.inner + 1)
        return before, (np.arange(len(self.reaction)) - self.ends[before]) / (self.inner[before] + 1.0)

    @cached_property
    def spread(self) -> sp.csr_array:
        """Derivative of all positions by those of the travelling points, (j, k)."""
        number = np.arange(len(self.reaction))
        rows, cols, weights = self.by_travel(Triplets(number, number, np.ones(len(number))))
        return sp.csr_array((weights, (rows, cols)), shape=(len(number), len(self.curve)))

    def by_travel(self, by_place: Triplets) -> Triplets:
        """Derivatives by the positions of the travelling points, from those by all positions (columns)."""
        (rows, cols, values), (before, part) = by_place, self._between
        first, behind = before[cols], part[cols]
        if not self.inner.any():
            return Triplets(rows, first, values)
        shared = np.flatnonzero(behind)
        return Triplets(
            np.concatenate([rows, rows[shared]]),
            np.concatenate([first, first[shared] + 1]),
            np.concatenate([values * (1.0 - behind), (values * behind)[shared]]),
        )

    @cached_property
    def every_curve(self) -> Index:
        """Curve of every point, (j,)."""
        return self.curve if len(self.curve) == len(self.reaction) else np.repeat(self.curve, self.inner + 1)

    @cached_property
    def every_position(self) -> Array:
        """Position of every point, (j,)."""
        if len(self.curve) == len(self.reaction):
            return self.position
        before, part = self._between
        ahead = np.minimum(before + 1, len(self.curve) - 1)
        return np.asarray((1.0 - part) * self.position[before] + part * self.position[ahead])


@dataclass(frozen=True)
class PointGaps:
    """Gap and its derivatives at all contact points, reactions' own bending included (K11).

    Points act on each other on one element only: the matrices are sparse.

    Attributes
    ----------
    curves : GapCurves
        All curves.
    points : ContactPoints
        The contact points, (j,) in all.
    nodal : (2 n_node,) array
        Nodal (value, slope) of all gaps.
    """

    curves: GapCurves
    points: ContactPoints
    nodal: Array

    @cached_property
    def value(self) -> Array:
        """`p`, (j,)."""
        return np.asarray(self._cubic[0] + self._bending[0])

    @property
    def bending(self) -> Array:
        """What reactions bend their own elements by at the points, `sum_d C b lam_d`, (j,)."""
        return self._bending[0]

    @cached_property
    def slope(self) -> Array:
        """The derivative of `p` by the place in the element, (j,)."""
        return np.asarray(self._cubic[1] + self._bending[1])

    @cached_property
    def _bending(self) -> tuple[Array, Array]:
        """`sum_d C b lam_d` at the points, and its derivative by the place, (j,) each."""
        if len(self._pairs[0]) > len(self.points.reaction):
            parts = (self._bent(part) * self._load for part in (clamped_beam, clamped_beam_slope))
            value, slope = map(self._at_points, parts)
            return value, slope
        element, t = self._place  # each alone on its element
        turned = self.curves.compliance[element] * self.points.reaction
        value, slope = clamped_beam_own(t)
        return turned * value, turned * slope

    @cached_property
    def bend(self) -> Triplets:
        """Derivatives of values by the reactions, (j, j)."""
        return self._matrix(self._bent(clamped_beam))

    @cached_property
    def bend_slope(self) -> Triplets:
        """Derivatives of slopes by the reactions, (j, j)."""
        return self._matrix(self._bent(clamped_beam_slope))

    @cached_property
    def value_by_place(self) -> Triplets:
        """Derivatives of values by the places, (j, j).

        By the place of another point `b(t, t_d)` changes with `t_d`, and `b` is symmetric; by the own place it changes
        by `2 b_s(t, t)`.
        """
        (at, load), (element, t) = self._pairs, self._place
        own, others, slope = at == load, self._others, self._bent(clamped_beam_slope)
        by_place = self.curves.compliance[element][at] * clamped_beam_slope(t[load], t[at]) * others
        twice = others + np.where(own, 2.0 * self._load, 0.0)
        by_place[own] = (self._cubic[1] + self._at_points(slope * twice))[at[own]]
        return self._matrix(by_place)

    @cached_property
    def slope_by_place(self) -> Triplets:
        """Derivatives of slopes by the places, (j, j).

        By the own place `b_s(t, t)` changes by `u (1 - 2 t)^2 - u^2`, `u = t (1 - t)`.
        """
        (at, load), (element, t) = self._pairs, self._place
        own, others, u = at == load, self._others, t * (1.0 - t)
        turn = self.curves.compliance[element] * self.points.reaction * (u * (1.0 - 2.0 * t) ** 2 - u**2)
        by_place = self._bent(clamped_beam_twist) * others
        bend = self._at_points(self._bent(clamped_beam_bend) * others)
        by_place[own] = (self._curvature + bend + turn)[at[own]]
        return self._matrix(by_place)

    @cached_property
    def _place(self) -> tuple[Index, Array]:
        """Element of each point and place in it."""
        return self.curves.locate(self.points.every_curve, self.points.every_position)

    @cached_property
    def _pairs(self) -> tuple[Index, Index]:
        """Points on one element: at the first, by the load of the second."""
        return together(self._place[0])

    @cached_property
    def _load(self) -> Array:
        """Reaction of the second point of each pair."""
        return self.points.reaction[self._pairs[1]]

    @cached_property
    def _others(self) -> Array:
        """The same, zero where it is the first point itself."""
        at, load = self._pairs
        return np.where(at == load, 0.0, self._load)

    @cached_property
    def _beams(self) -> tuple[Array, Array, Array]:
        """Compliance of the element of each pair, place of the first point in it, and of the second."""
        (at, load), (element, t) = self._pairs, self._place
        return self.curves.compliance[element[at]], t[at], t[load]

    def _bent(self, part: Callable[[Array, Array], Array]) -> Array:
        """Compliance of each pair, or a derivative."""
        compliance, at, load = self._beams
        return compliance * part(at, load)

    @cached_property
    def weights(self) -> tuple[Index, Array]:
        """Columns (j, 4) of the nodal gaps at each point, and their weights in the gap and its slope, (j, 2, 4)."""
        return hermite.entries_with_slopes(*self._place, self.curves.angle)

    def of_nodal(self, columns: Array) -> tuple[Array, Array]:
        """Gaps and slopes at the points that several nodal gaps (2 n_node, d) have there, (j, d) each."""
        at, weights = self.weights
        value, slope = np.einsum("kdi,kie->dke", weights, columns[at])
        return value, slope

    @cached_property
    def by_w(self) -> tuple[Triplets, Triplets]:
        """Derivatives of the cubic of (K10) at the points, and of its slope, by the unknowns of the petals, (j, n)."""
        (columns, weights), (unknowns, by_unknowns) = self.weights, self.curves.padded
        unknown, weight = unknowns[columns], by_unknowns[columns]
        both = [weights[:, kind, :, None] * weight for kind in range(2)]
        held = [np.nonzero(values) for values in both]
        value, slope = (Triplets(at[0], unknown[at], values[at]) for at, values in zip(held, both, strict=True))
        return value, slope

    @cached_property
    def nodal_loads(self) -> Array:
        """Reactions as loads on the nodal (value, slope) of the gaps, (2 n_node,)."""
        columns, weights = self.weights
        loads = weights[:, 0] * self.points.reaction[:, None]
        return add_up(columns.ravel(), loads.ravel(), len(self.curves.rest))

    @cached_property
    def _cubic(self) -> Array:
        """The cubic of (K10) at the points, and its derivative by the place, (2, j)."""
        columns, weights = self.weights
        return np.asarray(np.einsum("kdi,ki->dk", weights, self.nodal[columns]))

    @property
    def _curvature(self) -> Array:
        """The second derivative of the cubic of (K10) by the place at the points, (j,)."""
        columns, weights = hermite.entries(*self._place, self.curves.angle, 2)
        return np.asarray(np.einsum("ki,ki->k", weights, self.nodal[columns]))

    def _at_points(self, part: Array) -> Array:
        """Sum of a part of the pairs at each point, (j,)."""
        return add_up(self._pairs[0], part, len(self.points.reaction))

    def _matrix(self, part: Array) -> Triplets:
        """A part of the pairs as a matrix, (j, j)."""
        return Triplets(*self._pairs, part)


def together(element: Index) -> tuple[Index, Index]:
    """All pairs of points on one element, a point with itself included: numbers of the first and of the second."""
    first, second = np.nonzero(element[:, None] == element)
    return first, second


def sampled(curves: GapCurves, points: ContactPoints, nodal: Array, per_element: int) -> tuple[Index, Array, Array]:
    """Gaps along all curves, reactions' own bending included: curve, position, gap of every sample, curve by curve."""
    curve, position, element, t, rows = curves.samples(per_element)
    gap = rows @ nodal
    at_element, at = curves.locate(points.every_curve, points.every_position)
    own = np.searchsorted(element, at_element)[:, None] + np.arange(per_element)
    bends = (curves.compliance[at_element] * points.reaction)[:, None] * clamped_beam(t[own], at[:, None])
    return curve, position, gap + add_up(own.ravel(), bends.ravel(), len(gap))
