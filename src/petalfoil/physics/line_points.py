"""Contact points between the nodes of gap lines, at places of their own (K15)-(K17).

Petals touch along lines that cross the axial stations between nodes. Along the arc of a station a gap is the cubic
Hermite curve whose slope at a node is that of the parabola through it and the nodes beside it:

    p(t) = H_0 g_i + H_1 h s_i + H_2 g_(i+1) + H_3 h s_(i+1) ,   t in [0, 1] on a cell of length h       (K15)

It is linear in the gaps at the nodes, and its slope is continuous. At a contact point it vanishes, and so does its
slope:

    p(phi_c) = 0                                                                                       (K16)
    p'(phi_c) = 0 ,   p'' > 0                                                                          (K17)

The reaction of a point is shared by the nodes with the weights that (K15) gives them: what does no work on `p`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.contact import GapLines
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


POWERS = np.arange(1.0, 4.0)
"""What powers of a place turn to as they are differentiated."""

DESCENTS, FARTHEST_DESCENT = 3, 0.5
"""Steps toward the minimum of a gap, and the farthest of each in cells."""


@dataclass(frozen=True)
class LinePoints:
    """Contact points on gap lines.

    Attributes
    ----------
    lines : tuple of GapLines
        All lines, kind by kind.
    gaps : int
        Number of all gaps.
    kind, line : (k,) int array
        Kind of each point and its line among those of the kind.
    phi : (k,) array
        Local angle of each point [rad].
    before : (k,) int array or None
        Number of each among the points of an earlier state, -1 of those added since; None where there is no such state.
    """

    lines: tuple[GapLines, ...]
    gaps: int
    kind: Index
    line: Index
    phi: Array
    before: Index | None = None

    @cached_property
    def stencil(self) -> tuple[Index, Array]:
        """Gaps that each point reads, (k, 8), and their weights in (K15) and two derivatives by the angle, (3, k, 8).

        They are those at the two nodes beside the point, then those that the slopes there read; some of them twice.
        """
        gaps, weights = np.zeros((len(self.phi), 8), dtype=np.intp), np.zeros((3, len(self.phi), 8))
        for (points, cell, t), lines in zip(self._cells, self.lines, strict=True):
            if not len(points):
                continue
            read, cubics = lines.cubics
            gaps[points] = lines.number[self.line[points][:, None], read[cell]]
            weights[:, points] = np.matmul(derivatives_at(t, lines.cell_length[cell]), cubics[cell]).transpose(1, 0, 2)
        return gaps, weights

    def along(self, gaps: Array) -> Array:
        """Gap [1], slope [1/rad] and second derivative [1/rad^2] at the points, from the gaps at all nodes; (3, k)."""
        read, weights = self.stencil
        return np.asarray(np.einsum("dki,ki->dk", weights, gaps[read]))

    def pushes(self, reaction: Array) -> Array:
        """Reactions at the nodes that do the same work as those of the points (k,), (m,)."""
        read, weights = self.stencil
        return add_up(read.ravel(), (weights[0] * reaction[:, None]).ravel(), self.gaps)

    @cached_property
    def value(self) -> sp.csr_array:
        """Weights of the gaps at the nodes in the gap at the points, (k, m) [1]."""
        return self._derivative(0)

    @cached_property
    def slope(self) -> sp.csr_array:
        """Those in its slope, (k, m) [1/rad]."""
        return self._derivative(1)

    @cached_property
    def curvature(self) -> sp.csr_array:
        """Those in its second derivative, (k, m) [1/rad^2]."""
        return self._derivative(2)

    @cached_property
    def shares(self) -> sp.csr_array:
        """Shares of the two nodes beside each point that keep a reaction's place, (k, m): none is negative."""
        t = np.zeros(len(self.phi))
        for points, _, place in self._cells:
            t[points] = place
        return self._over_gaps(self.beside, np.stack([1.0 - t, t], axis=1))

    @cached_property
    def cell_length(self) -> Array:
        """Length of the cell of each point, (k,) [rad]."""
        out = np.zeros(len(self.phi))
        for (points, cell, _), lines in zip(self._cells, self.lines, strict=True):
            out[points] = lines.cell_length[cell]
        return out

    @property
    def mean_cell(self) -> float:
        """Mean length of the cells of all lines [rad]: the same wherever the points are."""
        return sum(lines.mean_cell for lines in self.lines) / len(self.lines)

    @cached_property
    def beside(self) -> Index:
        """Numbers of the gaps at the two nodes beside each point, (k, 2)."""
        out = np.zeros((len(self.phi), 2), dtype=np.intp)
        for (points, cell, _), lines in zip(self._cells, self.lines, strict=True):
            out[points] = lines.number[self.line[points][:, None], cell[:, None] + np.arange(2)]
        return out

    @property
    def nearest(self) -> Index:
        """Number of the gap at the node nearest to each point, (k,)."""
        before, after = self.to_nodes
        return np.where(before <= after, self.beside[:, 0], self.beside[:, 1])

    @cached_property
    def to_nodes(self) -> tuple[Array, Array]:
        """Angle from each point to the node before and after it, (k,) each [rad]."""
        before, after = np.zeros(len(self.phi)), np.zeros(len(self.phi))
        for (points, cell, _), lines in zip(self._cells, self.lines, strict=True):
            before[points] = self.phi[points] - lines.phi[cell]
            after[points] = lines.phi[cell + 1] - self.phi[points]
        return before, after

    def moved(self, change: Array) -> LinePoints:
        """The points after a `change` (k,) of their angles, on their lines."""
        phi = self.phi + change
        for mine, lines in self._kinds():
            phi[mine] = np.clip(phi[mine], lines.phi[0], lines.phi[-1])
        return replace(self, phi=phi)

    def lowest(self, gaps: Array) -> LinePoints:
        """The points where the gap near them is least, by a few steps of Newton's method from the gaps at all nodes."""
        points = self
        for _ in range(DESCENTS):
            _, slope, curvature = points.along(gaps)
            upward = curvature > 0.0
            farthest = FARTHEST_DESCENT * points.cell_length
            step = np.where(upward, -slope / np.where(upward, curvature, 1.0), -np.sign(slope) * farthest)
            points = points.moved(np.clip(step, -farthest, farthest))
        return points

    def kept(self, which: Mask) -> LinePoints:
        """Some of them."""
        before = None if self.before is None else self.before[which]
        return replace(self, kind=self.kind[which], line=self.line[which], phi=self.phi[which], before=before)

    def with_nodes(self, gaps: Index) -> LinePoints:
        """With points at the nodes of some gaps."""
        return self.joined(self.at_nodes(gaps))

    def at_nodes(self, gaps: Index) -> LinePoints:
        """Points at the nodes of some gaps alone."""
        none, asked = np.zeros(0, dtype=np.intp), np.zeros(self.gaps, dtype=np.bool_)
        asked[gaps] = True
        kind, line, phi = [none], [none], [np.zeros(0)]
        for number, lines in enumerate(self.lines):
            on, node = np.nonzero(asked[lines.number])
            kind.append(np.full(len(on), number))
            line.append(on)
            phi.append(lines.phi[node])
        return LinePoints(self.lines, self.gaps, np.concatenate(kind), np.concatenate(line), np.concatenate(phi))

    def joined(self, others: LinePoints) -> LinePoints:
        """These points, then others, which no earlier state has."""
        fresh = np.full(len(others.phi), -1)
        return replace(
            self,
            kind=np.concatenate([self.kind, others.kind]),
            line=np.concatenate([self.line, others.line]),
            phi=np.concatenate([self.phi, others.phi]),
            before=None if self.before is None else np.concatenate([self.before, fresh]),
        )

    def _kinds(self) -> Iterable[tuple[Mask, GapLines]]:
        for number, lines in enumerate(self.lines):
            yield self.kind == number, lines

    @cached_property
    def _cells(self) -> tuple[tuple[Index, Index, Array], ...]:
        """Kind by kind: numbers of its points, their cells and places in them."""
        out = []
        for mine, lines in self._kinds():
            points = np.flatnonzero(mine)
            phi = self.phi[points]
            cell = np.minimum(np.searchsorted(lines.phi[1:], phi, side="right"), len(lines.phi) - 2)
            out.append((points, cell, (phi - lines.phi[cell]) / lines.cell_length[cell]))
        return tuple(out)

    def _derivative(self, order: int) -> sp.csr_array:
        """Weights of the gaps in a derivative of (K15) by the angle, (k, m)."""
        read, weights = self.stencil
        return self._over_gaps(read, weights[order])

    def _over_gaps(self, read: Index, weights: Array) -> sp.csr_array:
        """Rows over all gaps from those that each point reads and their weights, (k, m)."""
        rows = np.repeat(np.arange(len(self.phi)), read.shape[1])
        return sp.csr_array((weights.ravel(), (rows, read.ravel())), shape=(len(self.phi), self.gaps))


def derivatives_at(t: Array, length: Array) -> Array:
    """Powers of places `t` (k,) in cells of some `length` (k,), and two derivatives by the angle, (k, 3, 4)."""
    out = np.zeros((len(t), 3, 4))
    out[:, 0], by_length = hermite.powers(t), 1.0 / length[:, None]
    out[:, 1, 1:] = POWERS * out[:, 0, :3] * by_length
    out[:, 2, 2:] = POWERS[1:] * out[:, 1, 1:3] * by_length
    return out
