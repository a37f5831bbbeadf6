"""Active contacts between nodes, as constraints that eliminate unknowns.

Contacts at nodes make unknowns move in groups (`ContactConstraints`). A contact point between nodes joins groups and
eliminates one of them, which the others then determine. So these contacts, too, make the system smaller, and no
multiplier stands in it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints
from petalfoil.sparsity import SparseRows

Array = NDArray[np.float64]
Index = NDArray[np.intp]

DEPENDENT = 1e-9
"""Pivot of a constraint over the largest of those it meets, below which it repeats them."""


@dataclass(frozen=True)
class PointConstraints(ContactConstraints):
    """Node contacts and contact points; `G`, `held` and reactions are of the rows of both, in this order.

    Attributes
    ----------
    basis : (n, n_free) sparse
        Changes of all unknowns by the free ones, `G basis = 0`.
    """

    basis: SparseRows

    @property
    def motions(self) -> SparseRows:
        """`Z`: that of both."""
        return self.basis

    def gather(self, full: NDArray[Any]) -> NDArray[Any]:
        """Equations of the free unknowns; shape (n_free,)."""
        return np.asarray(self.basis.T @ full)

    def spread(self, free: NDArray[Any]) -> NDArray[Any]:
        """All unknowns from the free ones; shape (n,)."""
        return np.asarray(self.basis @ free)

    def reduce(self, matrix: sp.csc_array) -> sp.csc_array:
        """The matrix over the free unknowns, without reactions (T5)."""
        own: sp.csr_array = self.basis.T
        return sp.csc_array((own if self._dragged is None else own - self._dragged) @ matrix @ self.basis)


def constrain_points(nodes: ContactConstraints, points: sp.csr_array) -> PointConstraints:
    """Node contacts and the rows `points` (k, n) together; reactions of points act along their rows alone."""
    n, inside = len(nodes.group), nodes.group >= 0
    one = np.ones(int(inside.sum()))
    moved = SparseRows((one, (np.flatnonzero(inside), nodes.group[inside])), shape=(n, nodes.n_free))
    rest, strongest = eliminated(points @ moved)
    rows = SparseRows(sp.vstack([nodes.G, points], format="csr"))
    group = np.where(inside, strongest[nodes.group], -1)
    every, none = np.ones(rows.shape[0], dtype=bool), np.zeros(0, dtype=np.intp)
    acting = None if nodes.acting is None else SparseRows(sp.vstack([nodes.acting, points], format="csr"))
    return PointConstraints(every, rows, group, rest.shape[1], none, SparseRows(moved @ rest), acting=acting)


def eliminated(rows: sp.csr_array) -> tuple[sp.csr_array, Index]:
    """Changes of unknowns that keep `rows` (k, n) zero, (n, n - rank), and the free unknown each depends on most, (n,).

    Rows that share unknowns are solved together, for the unknowns with the largest pivots.
    """
    n = rows.shape[1]
    solved: list[tuple[Index, Index, Array]] = []
    pivot = np.zeros(n, dtype=bool)
    for some, unknowns in components(rows):
        dense = rows[some][:, unknowns].toarray()
        _, R, order = la.qr(dense, mode="economic", pivoting=True)
        sizes = np.abs(np.diag(R))
        rank = int(np.count_nonzero(sizes > DEPENDENT * sizes[0]))
        depends, determines = unknowns[order[:rank]], unknowns[order[rank:]]
        solved.append((depends, determines, -la.solve_triangular(R[:rank, :rank], R[:rank, rank:])))
        pivot[depends] = True
    number = np.cumsum(~pivot) - 1
    free = np.flatnonzero(~pivot)
    parts = [(free, number[free], np.ones(len(free)))]
    strongest = np.where(pivot, -1, number)
    for depends, determines, weights in solved:
        parts.append((np.repeat(depends, len(determines)), np.tile(number[determines], len(depends)), weights.ravel()))
        if len(determines):
            strongest[depends] = number[determines[np.argmax(np.abs(weights), axis=1)]]
    at, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    return sp.csr_array((values, (at, columns)), shape=(n, len(free))), strongest


def components(rows: sp.csr_array) -> Iterator[tuple[Index, Index]]:
    """Rows that share unknowns, and these unknowns."""
    k, n = rows.shape
    coo = rows.tocoo()
    graph = sp.coo_array((np.ones(coo.nnz), (coo.row, k + coo.col)), shape=(k + n, k + n))
    label = sp.csgraph.connected_components(graph, directed=False)[1]
    for one in np.unique(label[k + coo.col]):  # a row without unknowns constrains nothing
        yield np.flatnonzero(label[:k] == one), np.flatnonzero(label[k:] == one)
