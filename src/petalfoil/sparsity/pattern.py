"""Sparse matrices with a fixed pattern: the places are sorted once, the values are added up at every assembly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity.compressed import compressed

Index = NDArray[np.intp]


def add_up(places: Index, values: NDArray[np.float64], n: int) -> NDArray[np.float64]:
    """Add `values` (k,) up at their `places` (k,) in a vector of length `n`."""
    total: NDArray[np.float64] = np.bincount(places, values, n).astype(np.float64, copy=False)
    return total


@dataclass(frozen=True)
class Pattern:
    """Places of the entries of an `n` by `n` matrix; an entry named several times adds up."""

    n: int
    slot: Index
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]

    @classmethod
    def of(cls, rows: Index, cols: Index, n: int) -> Pattern:
        """Sort the places (rows, cols), each of shape (n_entry,), by column."""
        wanted = cols.astype(np.int64) * n + rows
        order = np.argsort(wanted, kind="stable")  # the places come in sorted runs, which this sort merges
        first = np.diff(wanted[order], prepend=-1) > 0
        slot = np.empty(len(order), dtype=np.intp)
        slot[order] = np.cumsum(first) - 1
        key = wanted[order][first]
        indptr = np.searchsorted(key, np.arange(n + 1, dtype=np.int64) * n)
        return cls(n, slot, (key % n).astype(np.int32), indptr.astype(np.int32))

    def assemble(self, values: NDArray[np.float64]) -> sp.csc_array:
        """The matrix with `values` (n_entry,) at the places, in their order."""
        data = add_up(self.slot, values, len(self.indices))
        return compressed(sp.csc_array, data, self.indices, self.indptr, (self.n, self.n))
