"""Sparse direct solution behind one thin interface: equilibrated, counted, on one thread."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

Array = NDArray[np.float64]


class SingularMatrixError(ArithmeticError):
    """A factorisation met a matrix without inverse."""


@dataclass
class Counter:
    """Work done: factorisations so far, and the unknowns they had."""

    factorizations: int = 0
    largest: int = 0


@dataclass(frozen=True)
class Factor:
    """`D_r M D_c = L U`, ready to solve with `M`."""

    lu: Any
    row: Array
    col: Array

    def solve(self, rhs: Array) -> Array:
        """Solve `M x = rhs`, rhs of shape (n,) or (n, k)."""
        row, col = (self.row, self.col) if rhs.ndim == 1 else (self.row[:, None], self.col[:, None])
        out: Array = col * self.lu.solve(row * rhs)
        return out


@dataclass
class LinearSolver:
    """Factorises the matrices of one problem and counts them."""

    counter: Counter = field(default_factory=Counter)

    def factor(self, matrix: sp.csc_array) -> Factor:
        """Equilibrate and factorise `matrix` (n, n).

        Raises
        ------
        SingularMatrixError
            The matrix has no inverse, or not a finite one.
        """
        self.counter.factorizations += 1
        self.counter.largest = max(self.counter.largest, matrix.shape[0])
        if not np.all(np.isfinite(matrix.data)):
            raise SingularMatrixError("matrix with entries that are not finite")
        scaled, row, col = equilibrate(matrix)
        try:
            lu = spla.splu(scaled, permc_spec="COLAMD", options={"Equil": False})
        except RuntimeError as failure:  # SuperLU says "Factor is exactly singular" this way
            raise SingularMatrixError(str(failure)) from failure
        return Factor(lu, row, col)


def equilibrate(matrix: sp.csc_array) -> tuple[sp.csc_array, Array, Array]:
    """Scale rows, then columns, to largest entries of 1; returns the scaled matrix and both factors."""
    size = np.abs(matrix.data)
    n = matrix.shape[0]
    largest = np.zeros(n)
    np.maximum.at(largest, matrix.indices, size)
    row = 1.0 / np.where(largest > 0.0, largest, 1.0)
    data = matrix.data * row[matrix.indices]
    starts = matrix.indptr[:-1]
    filled = np.diff(matrix.indptr) > 0
    tallest = np.ones(n)
    tallest[filled] = np.maximum.reduceat(np.abs(data), starts[filled])
    col = 1.0 / np.where(tallest > 0.0, tallest, 1.0)
    data = data * np.repeat(col, np.diff(matrix.indptr))
    return sp.csc_array((data, matrix.indices, matrix.indptr), shape=matrix.shape), row, col
