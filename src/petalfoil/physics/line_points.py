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

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.contact import GapLines

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


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
    """

    lines: tuple[GapLines, ...]
    gaps: int
    kind: Index
    line: Index
    phi: Array

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

        def of(lines: GapLines, cell: Index, t: Array) -> sp.csr_array:
            where = np.repeat(np.arange(len(cell)), 2), np.stack([cell, cell + 1], axis=1).ravel()
            return sp.csr_array((np.stack([1.0 - t, t], axis=1).ravel(), where), shape=(len(cell), len(lines.phi)))

        return self._over_gaps(of)

    @cached_property
    def cell_length(self) -> Array:
        """Length of the cell of each point, (k,) [rad]."""
        out = np.zeros(len(self.phi))
        for mine, lines in self._kinds():
            out[mine] = np.diff(lines.phi)[hermite.located(self.phi[mine], lines.phi)[0]]
        return out

    @cached_property
    def beside(self) -> Index:
        """Numbers of the gaps at the two nodes beside each point, (k, 2)."""
        out = np.zeros((len(self.phi), 2), dtype=np.intp)
        for mine, lines in self._kinds():
            cell, _ = hermite.located(self.phi[mine], lines.phi)
            out[mine] = lines.number[self.line[mine][:, None], cell[:, None] + np.arange(2)]
        return out

    def moved(self, change: Array) -> LinePoints:
        """The points after a `change` (k,) of their angles, on their lines."""
        phi = self.phi + change
        for mine, lines in self._kinds():
            phi[mine] = np.clip(phi[mine], lines.phi[0], lines.phi[-1])
        return replace(self, phi=phi)

    def kept(self, which: Mask) -> LinePoints:
        """Some of them."""
        return replace(self, kind=self.kind[which], line=self.line[which], phi=self.phi[which])

    def with_nodes(self, gaps: Index) -> LinePoints:
        """With points at the nodes of some gaps."""
        kind, line, phi = [self.kind], [self.line], [self.phi]
        for number, lines in enumerate(self.lines):
            on, node = np.nonzero(np.isin(lines.number, gaps))
            kind.append(np.full(len(on), number))
            line.append(on)
            phi.append(lines.phi[node])
        return replace(self, kind=np.concatenate(kind), line=np.concatenate(line), phi=np.concatenate(phi))

    def _kinds(self) -> Iterable[tuple[Mask, GapLines]]:
        for number, lines in enumerate(self.lines):
            yield self.kind == number, lines

    def _derivative(self, order: int) -> sp.csr_array:
        """Weights of the gaps in a derivative of (K15) by the angle."""

        def of(lines: GapLines, cell: Index, t: Array) -> sp.csr_array:
            length = np.diff(lines.phi)
            pairs = hermite.rows(cell, t, length, order) @ nodal_pairs(lines.phi)
            return sp.csr_array(sp.diags_array(length[cell] ** -float(order)) @ pairs)

        return self._over_gaps(of)

    def _over_gaps(self, of: Callable[[GapLines, Index, Array], sp.csr_array]) -> sp.csr_array:
        """Rows over all gaps from rows over the nodes of a line, (k, m)."""
        rows, columns, values = [np.zeros(0, dtype=np.intp)], [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
        for mine, lines in self._kinds():
            points = np.flatnonzero(mine)
            local = of(lines, *hermite.located(self.phi[points], lines.phi)).tocoo()
            rows.append(points[local.row])
            columns.append(lines.number[self.line[points[local.row]], local.col])
            values.append(local.data)
        where = np.concatenate(rows), np.concatenate(columns)
        return sp.csr_array((np.concatenate(values), where), shape=(len(self.phi), self.gaps))


def nodal_pairs(phi: Array) -> sp.csr_array:
    """(Value, slope) at all nodes from values at them, (2 n, n): slopes of parabolas, of chords at both ends."""
    n, step = len(phi), np.diff(phi)
    before, after, inner = step[:-1], step[1:], np.arange(1, n - 1)
    both = before + after
    rows = [2 * np.arange(n), *(2 * inner + 1 for _ in range(3)), np.repeat([1, 2 * n - 1], 2)]
    columns = [np.arange(n), inner - 1, inner, inner + 1, np.array([0, 1, n - 2, n - 1])]
    chords = np.array([-1.0, 1.0, -1.0, 1.0]) / np.repeat(step[[0, -1]], 2)
    parabolas = [-after / (before * both), (after - before) / (before * after), before / (after * both)]
    where = np.concatenate(rows), np.concatenate(columns)
    return sp.csr_array((np.concatenate([np.ones(n), *parabolas, chords]), where), shape=(2 * n, n))
