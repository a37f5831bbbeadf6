"""Closed gaps as eliminated unknowns.

A closed gap holds one unknown at a value, or ties two to a constant difference. Unknowns tied together move as
one; those tied to a held one do not move. So closed gaps make the system smaller instead of larger, and no
multiplier stands in it. Their reactions follow afterwards from the equations that were merged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.sparsity import Elimination, TiedOrder, add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class Ties:
    """Closed rows of `G`, each +-1 on one unknown or the difference of two.

    Attributes
    ----------
    G : (k, n) sparse
        The closed rows.
    group : (n,) int array
        Number of the free unknown that each unknown moves with, -1 where it is held.
    n_free : int
        Free unknowns.
    """

    G: sp.csr_array
    group: Index
    n_free: int

    @cached_property
    def determinate(self) -> bool:
        """No closed gap repeats what others already say (a chain held at both ends)."""
        n = len(self.group)
        return int(self.G.shape[0]) == n - self.n_free

    @cached_property
    def _normal(self) -> spla.SuperLU:
        return spla.splu(sp.csc_array(self.G @ self.G.T))

    def close(self, gaps: Array) -> Array:
        """Smallest change of the unknowns that closes gaps of `gaps` (k,) (T1); shape (n,)."""
        out: Array = -(self.G.T @ self._normal.solve(gaps)) if len(gaps) else np.zeros(len(self.group))
        return out

    def reactions(self, residual: NDArray[Any]) -> NDArray[Any]:
        """Reactions `lam` (k,) with `G^T lam = residual` on the tied equations (T2)."""
        if not self.G.shape[0]:
            return np.zeros(0)
        return apart(self._normal.solve, self.G @ residual)

    def gather(self, full: NDArray[Any]) -> NDArray[Any]:
        """Add up the equations of unknowns that move together; shape (n_free,)."""
        inside = self.group >= 0
        return apart(lambda part: add_up(self.group[inside], part, self.n_free), full[inside])

    def spread(self, free: NDArray[Any]) -> NDArray[Any]:
        """Move every unknown with its group; shape (n,)."""
        return np.append(free, 0.0)[self.group]

    def rank(self, order: Elimination | None) -> TiedOrder | None:
        """Order of the free unknowns in the elimination, as far as it is known from other contact sets."""
        return None if order is None else TiedOrder(order.tied, self.group, self.n_free)

    def reduce(self, matrix: sp.csc_array) -> sp.csc_array:
        """The matrix over the free unknowns: rows and columns of a group added up."""
        if not self.G.shape[0]:
            return matrix
        coo = matrix.tocoo()
        rows, cols = self.group[coo.row], self.group[coo.col]
        inside = (rows >= 0) & (cols >= 0)
        shape = (self.n_free, self.n_free)
        return sp.coo_array((coo.data[inside], (rows[inside], cols[inside])), shape=shape).tocsc()


def apart(linear: Callable[[Array], Array], value: NDArray[Any]) -> NDArray[Any]:
    """Apply a real linear map to a real or a complex vector."""
    if np.iscomplexobj(value):
        return linear(np.ascontiguousarray(value.real)) + 1j * linear(np.ascontiguousarray(value.imag))
    return linear(value)


def tie(G: sp.csr_array, closed: NDArray[np.bool_]) -> Ties:
    """Close the rows `closed` (m,) of `G`."""
    rows = sp.csr_array(G[closed])
    n, held = G.shape[1], np.diff(rows.indptr)
    single, double = rows.indptr[:-1][held == 1], rows.indptr[:-1][held == 2]
    ground = n
    one = np.concatenate([rows.indices[single], rows.indices[double]])
    other = np.concatenate([np.full(len(single), ground), rows.indices[double + 1]])
    graph = sp.coo_array((np.ones(len(one)), (one, other)), shape=(n + 1, n + 1))
    count, label = sp.csgraph.connected_components(graph, directed=False)
    number = np.arange(count)
    number = np.where(number == label[ground], -1, number - (number > label[ground]))
    return Ties(rows, number[label[:n]], count - 1)
