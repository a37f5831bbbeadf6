"""Sparse direct solution behind one thin interface: equilibrated, counted, on one thread."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class SingularMatrixError(ArithmeticError):
    """A factorisation met a matrix without inverse."""


@dataclass
class Counter:
    """Work done: factorisations so far, and the unknowns they had."""

    factorizations: int = 0
    largest: int = 0


@dataclass(frozen=True)
class Factor:
    """`D_r M D_c`, its unknowns in the order of elimination, as `L U`: ready to solve with `M`."""

    lu: Any
    row: Array
    col: Array
    order: Index | None

    def solve(self, rhs: NDArray[Any]) -> NDArray[Any]:
        """Solve `M x = rhs`, rhs of shape (n,) or (n, k)."""
        row, col = (self.row, self.col) if rhs.ndim == 1 else (self.row[:, None], self.col[:, None])
        if self.order is None:
            out: NDArray[Any] = col * self.lu.solve(row * rhs)
            return out
        inner = self.lu.solve((row * rhs)[self.order])
        spread = np.empty_like(inner)
        spread[self.order] = inner
        scaled: NDArray[Any] = col * spread
        return scaled


PIVOT = 1e-4
"""A diagonal entry this large over the largest of its column is kept as pivot: patterns are symmetric and their order
is for the diagonal. Stricter pivoting fills in twice as much late in an interior point and is not more accurate."""

BACKWARD_ERROR = 1e-10
"""Backward error past which a factorisation is repeated with full pivoting."""


@dataclass
class LinearSolver:
    """Factorises the matrices of one problem and counts them."""

    counter: Counter = field(default_factory=Counter)

    def factor(self, matrix: sp.csc_array, rank: Array | None = None) -> Factor:
        """Equilibrate and factorise `matrix` (n, n).

        Parameters
        ----------
        matrix : (n, n) sparse
            The matrix; the order is chosen for symmetric patterns.
        rank : (n,) array, optional
            Place of each unknown in the elimination, if it is known.

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
        order = None if rank is None else np.argsort(rank, kind="stable")
        try:
            factor = Factor(symmetric_lu(scaled, order), row, col, order)
            if trusted(matrix, factor):
                return factor
        except RuntimeError:  # SuperLU met a zero pivot: without the diagonal it may still do
            pass
        try:
            return Factor(spla.splu(scaled, permc_spec="COLAMD", options={"Equil": False}), row, col, None)
        except RuntimeError as failure:  # SuperLU says "Factor is exactly singular" this way
            raise SingularMatrixError(str(failure)) from failure


def symmetric_lu(scaled: sp.csc_array, order: Index | None) -> Any:
    """Factorise with pivots on the diagonal where they are large enough, in the given order or minimum degree."""
    options = {"Equil": False, "SymmetricMode": True}
    if order is None:
        return spla.splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=PIVOT, options=options)
    ordered = sp.csc_array(scaled[order][:, order])
    return spla.splu(ordered, permc_spec="NATURAL", diag_pivot_thresh=PIVOT, options=options)


def trusted(matrix: sp.csc_array, factor: Factor) -> bool:
    """The factorisation solves with a small backward error (one solve, a fiftieth of the work)."""
    rhs = np.random.default_rng(0).standard_normal(matrix.shape[0]) / factor.row
    x = factor.solve(rhs)
    if not np.all(np.isfinite(x)):
        return False
    size = abs(matrix) @ np.abs(x) + np.abs(rhs)
    return bool(np.max(np.abs(matrix @ x - rhs) / np.maximum(size, np.finfo(float).tiny), initial=0.0) < BACKWARD_ERROR)


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
