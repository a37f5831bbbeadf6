"""Active contacts between nodes, as constraints that eliminate unknowns.

Contacts at nodes make unknowns move in groups (`ContactConstraints`). A contact point between nodes joins groups and
eliminates one of them, which the others then determine. So these contacts, too, make the system smaller, and no
multiplier stands in it.
"""

from __future__ import annotations

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
        """Equations of the free unknowns from all of them, (n,) or (n, j); shape (n_free,) or (n_free, j)."""
        return np.asarray(self.basis.T @ full)

    def spread(self, free: NDArray[Any]) -> NDArray[Any]:
        """All unknowns from the free ones, (n_free,) or (n_free, j); shape (n,) or (n, j)."""
        return np.asarray(self.basis @ free)

    def reduce(self, matrix: sp.csc_array) -> sp.csc_array:
        """The matrix over the free unknowns, without reactions (T4)."""
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
    n, rows = rows.shape[1], without_empty(rows)
    alone, connected = components(rows)
    solved = [solved_alone(rows, alone), *(solved_together(rows, some) for some in connected)]
    pivot = np.zeros(n, dtype=bool)
    pivot[np.concatenate([part.depends for part in solved])] = True
    number, free = np.cumsum(~pivot) - 1, np.flatnonzero(~pivot)
    strongest = np.where(pivot, -1, number)
    parts = [(free, number[free], np.ones(len(free)))]
    for part in solved:
        parts.append((part.row, number[part.determines], part.weights))
        strongest[part.depends] = np.where(part.strongest >= 0, number[part.strongest], -1)
    at, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    return sp.csr_array((values, (at, columns)), shape=(n, len(free))), strongest


@dataclass(frozen=True)
class DependentUnknowns:
    """Unknowns that others determine.

    Attributes
    ----------
    depends, strongest : (j,) int array
        Their numbers, and the unknown that determines each most; -1 where none does.
    row, determines, weights : (e,) array
        Entries: an unknown that depends, one that determines it, and by how much.
    """

    depends: Index
    strongest: Index
    row: Index
    determines: Index
    weights: Array


def without_empty(rows: sp.csr_array) -> sp.csr_array:
    """The rows that hold unknowns, without stored zeros: a row without unknowns constrains nothing."""
    rows = rows.copy()
    rows.eliminate_zeros()
    held = np.diff(rows.indptr)
    return rows if np.all(held) else sp.csr_array(rows[held > 0])


def solved_alone(rows: sp.csr_array, alone: Index) -> DependentUnknowns:
    """Rows `alone` that share no unknowns with others, each solved for its unknown with the largest entry."""
    if not len(alone):
        none = np.zeros(0, dtype=np.intp)
        return DependentUnknowns(none, none, none, none, np.zeros(0))
    held = np.diff(rows.indptr)[alone]
    starts = np.cumsum(held) - held
    entry = np.repeat(rows.indptr[alone] - starts, held) + np.arange(held.sum())
    unknown, value, row = rows.indices[entry].astype(np.intp), rows.data[entry], np.repeat(np.arange(len(alone)), held)
    by_size = np.lexsort((-np.abs(value), row))  # of each row the largest entry first
    pivot = by_size[starts]
    second = np.where(held > 1, unknown[by_size[np.minimum(starts + 1, len(entry) - 1)]], -1)
    others = np.ones(len(entry), dtype=bool)
    others[pivot] = False
    weights = -value / value[pivot][row]
    return DependentUnknowns(unknown[pivot], second, unknown[pivot][row][others], unknown[others], weights[others])


def solved_together(rows: sp.csr_array, some: Index) -> DependentUnknowns:
    """Rows `some` that share unknowns, solved for those with the largest pivots."""
    block = rows[some]
    unknowns = np.unique(block.indices).astype(np.intp)
    dense = np.zeros((len(some), len(unknowns)))
    np.add.at(
        dense,
        (np.repeat(np.arange(len(some)), np.diff(block.indptr)), np.searchsorted(unknowns, block.indices)),
        block.data,
    )
    _, R, order = la.qr(dense, mode="economic", pivoting=True)
    sizes = np.abs(np.diag(R))
    rank = int(np.count_nonzero(sizes > DEPENDENT * sizes[0]))
    depends, determines = unknowns[order[:rank]], unknowns[order[rank:]]
    weights = -la.solve_triangular(R[:rank, :rank], R[:rank, rank:])
    strongest = np.full(rank, -1, dtype=np.intp)
    if len(determines):
        strongest = determines[np.argmax(np.abs(weights), axis=1)]
    return DependentUnknowns(
        depends, strongest, np.repeat(depends, len(determines)), np.tile(determines, rank), weights.ravel()
    )


def components(rows: sp.csr_array) -> tuple[Index, list[Index]]:
    """Rows that share no unknowns with others, and groups of rows that share some."""
    k, n = rows.shape
    pattern = sp.csr_array((np.ones(len(rows.data)), rows.indices + k, rows.indptr), shape=(k, k + n))
    pattern.resize((k + n, k + n))
    label = sp.csgraph.connected_components(pattern, directed=False)[1][:k]
    order = np.argsort(label, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(label[order])) + 1) if k else []
    alone = np.array([group[0] for group in groups if len(group) == 1], dtype=np.intp)
    return alone, [group for group in groups if len(group) > 1]
