"""Sparse matrices with a fixed pattern: the places are sorted once, the values are added up at every assembly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

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
        key, slot = np.unique(cols.astype(np.int64) * n + rows, return_inverse=True)
        indptr = np.searchsorted(key, np.arange(n + 1, dtype=np.int64) * n)
        return cls(n, slot, (key % n).astype(np.int32), indptr.astype(np.int32))

    @cached_property
    def rank(self) -> NDArray[np.float64]:
        """Place of each unknown in an elimination that fills in little (minimum degree), shape (n,).

        SuperLU orders a matrix of this pattern with a dominant diagonal; found once, it serves every matrix of the
        pattern and, group by group, those with unknowns tied together.
        """
        noise = np.random.default_rng(0).uniform(0.1, 1.0, len(self.indices))
        shape = (self.n, self.n)
        dominant = sp.csc_array((noise, self.indices, self.indptr), shape=shape) + self.n * sp.eye_array(self.n)
        options = {"Equil": False, "SymmetricMode": True}
        lu = spla.splu(sp.csc_array(dominant), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
        return np.asarray(lu.perm_c, dtype=np.float64)

    def assemble(self, values: NDArray[np.float64]) -> sp.csc_array:
        """The matrix with `values` (n_entry,) at the places, in their order."""
        data = add_up(self.slot, values, len(self.indices))
        return sp.csc_array((data, self.indices, self.indptr), shape=(self.n, self.n))
