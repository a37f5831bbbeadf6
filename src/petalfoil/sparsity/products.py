"""Sparse rows whose products with vectors cost their arithmetic alone.

A product of SciPy's arrays first checks types, shapes and index types: on a pack of a thousand unknowns that takes ten
times as long as the sums. `SparseRows` goes to the compiled loop at once, and builds its transpose once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse import _sparsetools  # the loops behind `@`; SciPy has no public way to them

from petalfoil.sparsity.compressed import compressed

Array = NDArray[np.float64]
Index = NDArray[np.integer[Any]]


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
        (rows, columns), data, indices = self._size, np.empty_like(self.data), np.empty_like(self.indices)
        indptr = np.empty(columns + 1, self.indptr.dtype)
        _sparsetools.csr_tocsc(rows, columns, self.indptr, self.indices, self.data, indptr, indices, data)
        return compressed(SparseRows, data, indices, indptr, (columns, rows))

    @cached_property
    def magnitude(self) -> SparseRows:
        """Magnitudes of the entries."""
        return compressed(SparseRows, np.abs(self.data), self.indices, self.indptr, self._size)


class Triplets(NamedTuple):
    """Entries of a matrix: rows (k,), columns (k,), values (k,)."""

    rows: Index
    cols: Index
    data: Array

    @classmethod
    def of(cls, matrix: sp.sparray) -> Triplets:
        """Those of a sparse matrix, in the order in which it holds them."""
        if matrix.format not in ("csr", "csc"):
            coo = matrix.tocoo()
            return cls(coo.row, coo.col, coo.data)
        major = np.repeat(np.arange(len(matrix.indptr) - 1, dtype=matrix.indices.dtype), np.diff(matrix.indptr))
        rows, cols = (major, matrix.indices) if matrix.format == "csr" else (matrix.indices, major)
        return cls(rows, cols, matrix.data)

    @classmethod
    def of_dense(cls, values: Array) -> Triplets:
        """Those of an array (n, m), zeros left out."""
        rows, cols = np.nonzero(values)
        return cls(rows, cols, values[rows, cols])

    @classmethod
    def diagonal(cls, values: Array) -> Triplets:
        """Those of a diagonal (n,), zeros left out."""
        at = np.flatnonzero(values)
        return cls(at, at, values[at])

    @property
    def T(self) -> Triplets:
        """Those of the transpose."""
        return Triplets(self.cols, self.rows, self.data)

    def times(self, *, rows: Array | float = 1.0, cols: Array | None = None) -> Triplets:
        """Those of the matrix with its rows times factors (n,) or one for all, and its columns times others (m,)."""
        data = self.data * (rows if isinstance(rows, float) else rows[self.rows])
        return Triplets(self.rows, self.cols, data if cols is None else data * cols[self.cols])

    def from_rows(self, chosen: Index, size: int) -> Triplets:
        """Those of some rows, of `size` in all, as a matrix of their own."""
        if len(chosen) == size:
            return self
        number = np.full(size, -1)
        number[chosen] = np.arange(len(chosen))
        inside = number[self.rows] >= 0
        return Triplets(number[self.rows[inside]], self.cols[inside], self.data[inside])


@dataclass(frozen=True)
class SummedEntries:
    """Entries of a matrix, no place named twice, each a weighted sum of values that change.

    Attributes
    ----------
    rows, cols : (k,) array
        Places, column by column.
    weights : (k, values) sparse
        Weights of the values.
    """

    rows: Index
    cols: Index
    weights: SparseRows

    @classmethod
    def of_product(cls, rows: Index, cols: Index, right: sp.csr_array) -> SummedEntries:
        """Entries of `L @ right`, `L` with values at the places `rows`, `cols`, some of them perhaps named twice."""
        held = np.diff(right.indptr)[cols]
        value = np.repeat(np.arange(len(cols)), held)
        taken = np.repeat(right.indptr[cols] - np.cumsum(held) + held, held) + np.arange(len(value))
        size = int(rows.max(initial=-1)) + 1
        place, entry = np.unique(right.indices[taken].astype(np.int64) * size + rows[value], return_inverse=True)
        weights = sp.csr_array((right.data[taken], (entry, value)), shape=(len(place), len(cols)))
        col, row = np.divmod(place, max(size, 1))
        return cls(row.astype(np.int32), col.astype(np.int32), SparseRows(weights))

    def at(self, values: Array) -> Triplets:
        """The entries at some values."""
        return Triplets(self.rows, self.cols, self.weights @ values)


def added_blocks(blocks: Sequence[tuple[int, int, sp.sparray | Triplets]], diagonal: Array) -> sp.csc_array:
    """A square matrix from blocks, each with its first row and column, and what is added to its diagonal (n,).

    It goes to the compiled loop at once, like products.
    """
    size, on_diagonal = len(diagonal), np.flatnonzero(diagonal)
    parts = [(row, col, part if isinstance(part, Triplets) else Triplets.of(part)) for row, col, part in blocks]
    whole = placed([*parts, (0, 0, Triplets(on_diagonal, on_diagonal, diagonal[on_diagonal]))])
    matrix = compressed(sp.csc_array, *_sorted(whole.cols, whole.rows, whole.data, size), (size, size))
    matrix.sum_duplicates()
    return matrix


def rows_of_blocks(blocks: Sequence[tuple[int, int, sp.sparray | Triplets]], shape: tuple[int, int]) -> sp.csr_array:
    """A matrix by rows from blocks that do not overlap, each with its first row and column."""
    whole = placed([(row, col, part if isinstance(part, Triplets) else Triplets.of(part)) for row, col, part in blocks])
    return compressed(sp.csr_array, *_sorted(whole.rows, whole.cols, whole.data, shape[0]), shape)


def placed(parts: Sequence[tuple[int, int, Triplets]]) -> Triplets:
    """All entries of blocks, each with its first row and column."""
    rows = np.concatenate([row + part.rows for row, _, part in parts], dtype=np.int32)
    cols = np.concatenate([col + part.cols for _, col, part in parts], dtype=np.int32)
    return Triplets(rows, cols, np.concatenate([part.data for _, _, part in parts]))


def _sorted(major: Index, minor: Index, data: Array, size: int) -> tuple[Array, Index, Index]:
    """Entries sorted by `major`: data, places along the other, and first entry of each of `size`."""
    indptr, indices, sorted_data = np.empty(size + 1, np.int32), np.empty_like(minor), np.empty_like(data)
    _sparsetools.coo_tocsr(size, size, len(data), major, minor, data, indptr, indices, sorted_data)
    return sorted_data, indices, indptr
