"""Sparse rows whose products with vectors cost their arithmetic alone.

A product of SciPy's arrays first checks types, shapes and index types: on a pack of a thousand unknowns that takes ten
times as long as the sums. `SparseRows` goes to the compiled loop at once, and builds its transpose once.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse import _sparsetools  # the loops behind `@`; SciPy has no public way to them

Array = NDArray[np.float64]


class SparseRows(sp.csr_array):  # type: ignore[misc]
    """A real sparse matrix by rows whose entries do not change after it is built.

    Everything else is as in `scipy.sparse.csr_array`; products are the same to the last bit.
    """

    def __matmul__(self, other: Any) -> Any:
        """The product with an array or another sparse matrix."""
        if type(other) is not np.ndarray or other.ndim != 1 or other.dtype != np.float64:
            return super().__matmul__(other)
        rows, columns = self._size
        if len(other) != columns:
            raise ValueError(f"a matrix of {columns} columns cannot multiply a vector of {len(other)} entries")
        out = np.zeros(rows)
        _sparsetools.csr_matvec(rows, columns, self.indptr, self.indices, self.data, other, out)
        return out

    @cached_property
    def _size(self) -> tuple[int, int]:
        rows, columns = self.shape
        return int(rows), int(columns)

    @cached_property
    def T(self) -> SparseRows:
        """The transpose, by rows."""
        return SparseRows(self.transpose())

    @cached_property
    def magnitude(self) -> SparseRows:
        """Magnitudes of the entries."""
        return SparseRows(abs(self))


def rows_times(matrix: sp.csr_array, factor: Array) -> sp.csr_array:
    """The matrix with its rows times `factor` (n,)."""
    data = matrix.data * np.repeat(factor, np.diff(matrix.indptr))
    return sp.csr_array((data, matrix.indices, matrix.indptr), shape=matrix.shape)


def columns_times(matrix: sp.csr_array, factor: Array) -> sp.csr_array:
    """The matrix with its columns times `factor` (n,)."""
    return sp.csr_array((matrix.data * factor[matrix.indices], matrix.indices, matrix.indptr), shape=matrix.shape)


def added_blocks(blocks: Sequence[tuple[int, int, sp.sparray]], diagonal: Array) -> sp.csc_array:
    """A square matrix from blocks, each with its first row and column, and what is added to its diagonal (n,)."""
    size, on_diagonal = len(diagonal), np.flatnonzero(diagonal)
    parts = [(row, column, block.tocoo()) for row, column, block in blocks]
    rows = np.concatenate([*(row + part.row for row, _, part in parts), on_diagonal])
    columns = np.concatenate([*(column + part.col for _, column, part in parts), on_diagonal])
    data = np.concatenate([*(part.data for _, _, part in parts), diagonal[on_diagonal]])
    return sp.csc_array((data, (rows, columns)), shape=(size, size))
