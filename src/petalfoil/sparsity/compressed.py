"""Sparse matrices from arrays that are known to fit.

SciPy checks types, shapes and index types of every new matrix: for a pack of a thousand unknowns that takes eight times
as long as all else of building it, and a pack is discretised in some hundred matrices.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import lru_cache
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]
Matrix = TypeVar("Matrix")

SHAPES = 256
"""Shapes that are remembered, each as a matrix without arrays."""


def compressed(
    kind: Callable[..., Matrix], data: Values, indices: Values, indptr: Values, shape: tuple[int, int]
) -> Matrix:
    """The matrix `kind((data, indices, indptr), shape=shape)`, unchecked; indices have 32 bits where these suffice."""
    if max(len(data), *shape) > np.iinfo(np.int32).max:
        return kind((data, indices, indptr), shape=shape)
    matrix: Any = copy(_without_arrays(kind, *shape))
    matrix.data = data
    matrix.indices, matrix.indptr = indices.astype(np.int32, copy=False), indptr.astype(np.int32, copy=False)
    return cast(Matrix, matrix)


@lru_cache(maxsize=SHAPES)
def _without_arrays(kind: Callable[..., Any], rows: int, columns: int) -> Any:
    matrix = kind((rows, columns))
    matrix.indptr = matrix.indptr[:0]
    return matrix
