"""Active contacts as constraints that eliminate unknowns.

An active contact holds one unknown at a value, or keeps the difference of two constant. Unknowns that are connected in
this way move as one group, and a group that is connected to a held unknown does not move. Active contacts thus make the
linear system smaller, without multipliers. Their reactions follow afterwards from the equations of the group.

Reactions of contacts that rub act along rows `H` other than those of the gaps, `G` (D6). They leave the equations by an
oblique projection: what the free unknowns read of `F - H^T lam = 0` is

    Z^T (F - (H - G)^T lam) = 0 ,    lam = (G H^T)^-1 G F                                                      (T4)

with the motions `Z` that keep the gaps closed.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.solvers.sparse_lu import Factor, LinearSolver, SingularMatrixError
from petalfoil.sparsity import SparseRows, TiedOrder, add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class ContactConstraints:
    """Active rows of `G`, each +-1 on one unknown or the difference of two.

    Attributes
    ----------
    held : (m,) bool array
        The gaps held closed.
    G : (k, n) sparse
        Their rows.
    group : (n,) int array
        Number of the free unknown that each unknown moves with, -1 where it is held.
    n_free : int
        Free unknowns.
    stops : (j,) int array
        Active gaps that close a chain of held ones. They are not held: what moves the chain as a whole opens them.
    acting : (k, n) sparse or None
        Rows `H` along which their reactions act; None where these are those of the gaps.
    """

    held: Mask
    G: SparseRows
    group: Index
    n_free: int
    stops: Index
    acting: SparseRows | None = field(default=None, kw_only=True)

    @cached_property
    def determinate(self) -> bool:
        """No held gap repeats what others already say (a chain held at both ends)."""
        return int(self.G.shape[0]) == len(self.group) - self.n_free

    @cached_property
    def _normal(self) -> spla.SuperLU:
        return spla.splu(sp.csc_array(self.G @ self.G.T))

    def close(self, gaps: Array) -> Array:
        """Smallest change of the unknowns that closes gaps of `gaps` (k,) or (k, j) (T1); shape (n,) or (n, j)."""
        if not len(gaps):
            return np.zeros((len(self.group), *gaps.shape[1:]))
        return np.asarray(-(self.G.T @ self._normal.solve(gaps)))

    @cached_property
    def _across(self) -> spla.SuperLU:
        """Factors of `G H^T`.

        Raises
        ------
        SingularMatrixError
            Gaps repeat each other: each of their reactions drags by itself, and none is determined.
        """
        if self.acting is None:
            return self._normal
        if not self.determinate:
            raise SingularMatrixError("gaps that repeat each other rub")
        return spla.splu(sp.csc_array(self.G @ self.acting.T))

    @cached_property
    def motions(self) -> sp.csr_array:
        """`Z`: changes of all unknowns by the free ones, (n, n_free)."""
        inside = np.flatnonzero(self.group >= 0)
        ones, shape = np.ones(len(inside)), (len(self.group), self.n_free)
        return sp.coo_array((ones, (inside, self.group[inside])), shape=shape).tocsr()

    @cached_property
    def _dragged(self) -> sp.csr_array | None:
        """What reactions leave in the equations of the free unknowns by all equations (T4), (n_free, n); None if none.

        Only rows whose reactions act on more than their gaps need a solve.
        """
        if self.acting is None:
            return None
        more = sp.csr_array(self.acting - self.G)
        rubbing = np.flatnonzero(np.diff(more.indptr))
        if not len(rubbing):
            return None
        units = np.zeros((self.G.shape[0], len(rubbing)))
        units[rubbing, np.arange(len(rubbing))] = 1.0
        reactions = sp.csr_array(self._across.solve(units, "T").T) @ sp.csr_array(self.G)
        return sp.csr_array((sp.csr_array(self.motions.T) @ sp.csr_array(more[rubbing].T)) @ reactions)

    def reactions(self, residual: NDArray[Any]) -> NDArray[Any]:
        """Reactions `lam` (k,) or (k, j) with `H^T lam = residual` on the eliminated equations (T2)."""
        if not self.G.shape[0]:
            return np.zeros((0, *residual.shape[1:]))
        return apply_to_parts(self._across.solve, self.G @ residual)

    def reactions_adjoint(self, by_reactions: Array) -> Array:
        """Derivative by the residual (n,) of what has the derivative `by_reactions` (k,) by `reactions`."""
        if not len(by_reactions):
            return np.zeros(len(self.group))
        return np.asarray(self.G.T @ self._across.solve(by_reactions, "N" if self.acting is None else "T"))

    def close_adjoint(self, by_change: Array) -> Array:
        """Derivative by the gaps (k,) of what has the derivative `by_change` (n,) by the change `close`."""
        return np.asarray(-self._normal.solve(self.G @ by_change)) if self.G.shape[0] else np.zeros(0)

    def gather(self, full: NDArray[Any]) -> NDArray[Any]:
        """Add up the equations (n,) or (n, j) of unknowns that move together; shape (n_free,) or (n_free, j)."""
        if full.ndim > 1:
            return np.asarray(self.motions.T @ full)
        inside = self.group >= 0
        return apply_to_parts(lambda part: add_up(self.group[inside], part, self.n_free), full[inside])

    def spread(self, free: NDArray[Any]) -> NDArray[Any]:
        """Move every unknown with its group, from (n_free,) or (n_free, j); shape (n,) or (n, j)."""
        return np.concatenate([free, np.zeros((1, *free.shape[1:]))])[self.group]

    def balanced(self, full: NDArray[Any]) -> NDArray[Any]:
        """What equations leave of those of the free unknowns without their reactions (T4); shapes as in `gather`."""
        gathered = self.gather(full)
        return gathered if self._dragged is None else gathered - self._dragged @ full

    def balanced_adjoint(self, free: NDArray[Any]) -> NDArray[Any]:
        """Derivative by all equations (n,) of what has the derivative `free` (n_free,) by `balanced`."""
        spread = self.spread(free)
        return spread if self._dragged is None else spread - self._dragged.T @ free

    def largest(self, scale: Array) -> Array:
        """Largest of `scale` (n,) among the unknowns that each moves with, (n,): their equations share what is left."""
        inside = self.group >= 0
        of_group = np.zeros(self.n_free)
        np.maximum.at(of_group, self.group[inside], scale[inside])
        return np.where(inside, np.append(of_group, 0.0)[self.group], scale)

    def reduce(self, matrix: sp.csc_array) -> sp.csc_array:
        """The matrix over the free unknowns: rows and columns of a group added up, without reactions (T4)."""
        if not self.G.shape[0]:
            return matrix
        if self._dragged is not None:
            return sp.csc_array((sp.csr_array(self.motions.T) - self._dragged) @ (matrix @ self.motions))
        coo = matrix.tocoo()
        rows, cols = self.group[coo.row], self.group[coo.col]
        inside = (rows >= 0) & (cols >= 0)
        shape = (self.n_free, self.n_free)
        return sp.coo_array((coo.data[inside], (rows[inside], cols[inside])), shape=shape).tocsc()

    def elimination_order(self, solver: LinearSolver, key: Hashable | None) -> TiedOrder | None:
        """Elimination order of the free unknowns, as far as `solver` knows it from other contact sets of `key`."""
        learnt = solver.elimination(key)
        return None if learnt is None else TiedOrder(learnt.tied, self.group, self.n_free)

    def factor(self, matrix: sp.csc_array, solver: LinearSolver, key: Hashable | None) -> Factor:
        """Factorise `matrix` (n, n) over the free unknowns.

        Raises
        ------
        SingularMatrixError
            It has no inverse there.
        """
        return solver.factor(self.reduce(matrix), self.elimination_order(solver, key))


def apply_to_parts(linear: Callable[[Array], Array], value: NDArray[Any]) -> NDArray[Any]:
    """Apply a real linear map to a real or a complex vector."""
    if np.iscomplexobj(value):
        return linear(np.ascontiguousarray(value.real)) + 1j * linear(np.ascontiguousarray(value.imag))
    return linear(value)


def constrain(
    G: SparseRows, active: Mask, stops: slice | None = None, acting: SparseRows | None = None
) -> ContactConstraints:
    """Hold the gaps `active` (m,) closed, whose reactions act along the rows `acting` (m, n), by default those of `G`.

    Where active gaps repeat each other, one of them becomes a stop if `stops` says where stops are looked for first;
    without it all are held, and the constraints are not determinate.
    """
    held = active if stops is None else determining(G, active, stops)
    rows = SparseRows(G[held])
    n, entries = G.shape[1], np.diff(rows.indptr)
    single, double = rows.indptr[:-1][entries == 1], rows.indptr[:-1][entries == 2]
    ground = n
    one = np.concatenate([rows.indices[single], rows.indices[double]])
    other = np.concatenate([np.full(len(single), ground), rows.indices[double + 1]])
    graph = sp.coo_array((np.ones(len(one)), (one, other)), shape=(n + 1, n + 1))
    count, label = sp.csgraph.connected_components(graph, directed=False)
    number = np.arange(count)
    number = np.where(number == label[ground], -1, number - (number > label[ground]))
    along = None if acting is None or acting is G else SparseRows(acting[held])
    return ContactConstraints(held, rows, number[label[:n]], count - 1, np.flatnonzero(active & ~held), acting=along)


def determining(G: sp.csr_array, active: Mask, last: slice) -> Mask:
    """The rows of `G` among `active` that connect unknowns without a closed chain, (m,); those in `last` come last.

    They are a spanning forest of the graph whose edges are the rows: a row that would close a chain is left out.
    """
    rows = np.flatnonzero(active)
    entries = np.diff(G.indptr)[rows]
    rows = rows[entries > 0]
    ground = G.shape[1]
    one = G.indices[G.indptr[rows]]
    both = np.diff(G.indptr)[rows] == 2
    other = np.where(both, G.indices[np.minimum(G.indptr[rows] + 1, len(G.indices) - 1)], ground)
    late = np.zeros(G.shape[0], dtype=bool)
    late[last] = True
    order = np.lexsort((rows, late[rows]))
    low, high = np.minimum(one, other)[order], np.maximum(one, other)[order]
    _, first = np.unique(low.astype(np.int64) * (ground + 1) + high, return_index=True)  # of parallel rows the earliest
    low, high, kept = low[first], high[first], order[first]
    graph = sp.coo_array((1.0 + first, (low, high)), shape=(ground + 1, ground + 1)).tocsr()
    forest = sp.csgraph.minimum_spanning_tree(graph).tocoo()
    place = {(int(a), int(b)): int(k) for a, b, k in zip(low, high, kept, strict=True)}
    mask = np.zeros(len(active), dtype=bool)
    for a, b in zip(forest.row, forest.col, strict=True):
        mask[rows[place[min(int(a), int(b)), max(int(a), int(b))]]] = True
    return mask


def places_among(members: Mask) -> Index:
    """Place of each among those that are `members` (m,), -1 of the others; (m,)."""
    return np.where(members, np.cumsum(members) - 1, -1)
