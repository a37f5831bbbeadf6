"""Sparse matrices from equal or unequal blocks, at the cost of copying their entries.

SciPy's own go through lists of entries, sorted anew and checked at every step: a pack of eight petals spent a fifth of
its discretisation there.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity.compressed import compressed

Array = NDArray[np.float64]


def block_diagonal(parts: Sequence[sp.sparray | Array]) -> sp.csr_array:
    """The matrix with the `parts` along its diagonal, by rows; zeros of dense parts are not stored."""
    known = {id(part): part if isinstance(part, sp.csr_array) else sp.csr_array(part) for part in parts}
    rows = [known[id(part)] for part in parts]
    first_col = list(accumulate((part.shape[1] for part in rows), initial=0))
    first_entry = list(accumulate((part.nnz for part in rows), initial=0))
    data = np.concatenate([np.zeros(0), *(part.data for part in rows)])
    cols = [part.indices + at for part, at in zip(rows, first_col[:-1], strict=True)]
    starts = [part.indptr[1:] + at for part, at in zip(rows, first_entry[:-1], strict=True)]
    none = np.zeros(1, np.int32)
    indices, indptr = np.concatenate([none[:0], *cols]), np.concatenate([none, *starts])
    return compressed(sp.csr_array, data, indices, indptr, (len(indptr) - 1, first_col[-1]))


def repeated(matrix: sp.csr_array, count: int) -> sp.csr_array:
    """The matrix with the same block `count` times along its diagonal: the product of the identity with it."""
    rows, cols = matrix.shape
    number = np.arange(count, dtype=np.int32)[:, None]
    indices = (matrix.indices + cols * number).ravel()
    indptr = np.append((matrix.indptr[:-1] + matrix.nnz * number).ravel(), count * matrix.nnz)
    return compressed(sp.csr_array, np.tile(matrix.data, count), indices, indptr, (count * rows, count * cols))


def at_stations(matrix: sp.sparray, count: int) -> sp.csr_array:
    """The matrix at each of `count` stations, unknowns station by station: its product with the identity."""
    return sp.csr_array(matrix) if count == 1 else sp.csr_array(sp.kron(matrix, sp.eye_array(count), format="csr"))
