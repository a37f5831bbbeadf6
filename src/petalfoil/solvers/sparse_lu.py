"""Sparse direct solution behind one thin interface: equilibrated, counted, on one thread."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray
from scipy.sparse import _sparsetools  # the loops behind `@`; SciPy has no public way to them
from scipy.sparse.csgraph import connected_components, structural_rank

from petalfoil.sparsity import Elimination, Order, compressed, postorder

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class SingularMatrixError(ArithmeticError):
    """A factorisation met a matrix without inverse."""


@dataclass
class Counter:
    """Work done: factorisations so far, the unknowns they had, and right-hand sides solved for."""

    factorizations: int = 0
    largest: int = 0
    solves: int = 0


@dataclass(frozen=True)
class Factor:
    """`D_r M D_c`, its unknowns in the order of elimination, as `L U`: ready to solve with `M`."""

    lu: Any
    row: Array
    col: Array
    order: Index | None
    counter: Counter = field(default_factory=Counter)

    def solve(self, rhs: NDArray[Any]) -> NDArray[Any]:
        """Solve `M x = rhs`, rhs of shape (n,) or (n, k)."""
        self.counter.solves += 1 if rhs.ndim == 1 else rhs.shape[1]
        if rhs.ndim == 1:
            one: NDArray[Any] = self.col * self.scaled(self.row * rhs)
            return one
        scaled = np.multiply(rhs.T, self.row, order="C").T  # by columns, as SuperLU takes and returns them
        few = [self.scaled(scaled[:, first : first + AT_ONCE]).T for first in range(0, rhs.shape[1], AT_ONCE)]
        columns: NDArray[Any] = np.concatenate([scaled[:, :0].T, *few]) * self.col
        return columns.T

    def solve_transposed(self, rhs: Array) -> Array:
        """Solve `M^T x = rhs`, rhs of shape (n,)."""
        self.counter.solves += 1
        return np.asarray(self.row * self.scaled(self.col * rhs, "T"))

    @property
    def determinant_sign(self) -> float:
        """Sign of the determinant of `M`: scales are positive, an order of unknowns moves rows and columns alike."""
        diagonal = np.sign(self.lu.U.diagonal())
        return float(np.prod(diagonal)) * parity(self.lu.perm_r) * parity(self.lu.perm_c)

    def scaled(self, rhs: NDArray[Any], transposed: str = "N") -> NDArray[Any]:
        """Solve with the scaled matrix, or with its transpose ("T")."""
        if self.order is None:
            out: NDArray[Any] = self.lu.solve(rhs, transposed)
            return out
        inner: NDArray[Any] = self.lu.solve(rhs[self.order], transposed)
        spread = np.empty_like(inner)
        spread[self.order] = inner
        return spread


AT_ONCE = 8
"""Right-hand sides solved for together: SuperLU strides over all of them, and dozens no longer fit into a cache (a
hundred take two to thirty times longer together than one by one)."""

PIVOT = 1e-5
"""A diagonal entry this large over the largest of its column is kept as pivot: patterns are symmetric and their order
is for the diagonal. Stricter pivoting fills in twice as much late in an interior point and is not more accurate."""

BACKWARD_ERROR = 1e-10
"""Backward error past which a factorisation is repeated with full pivoting."""

PANELS = ((20_000, 1), (np.inf, 8))
"""Columns that SuperLU updates together, up to so many unknowns: small matrices are too sparse for several to pay."""


@dataclass
class LinearSolver:
    """Factorises matrices, counts them, and remembers in which order like ones are best eliminated.

    Attributes
    ----------
    counter : Counter
        Factorisations done.
    elimination_orders : dict
        Orders learnt so far, by the key of a problem.
    """

    counter: Counter = field(default_factory=Counter)
    elimination_orders: dict[Hashable, Elimination] = field(default_factory=dict)

    def elimination(self, key: Hashable | None) -> Elimination | None:
        """Orders of the problems with this `key`; None where a problem has none."""
        return None if key is None else self.elimination_orders.setdefault(key, Elimination())

    def factor(self, matrix: sp.csc_array, order: Order | None = None) -> Factor:
        """Equilibrate and factorise `matrix` (n, n).

        Parameters
        ----------
        matrix : (n, n) sparse
            The matrix; the order is chosen for symmetric patterns.
        order : Order, optional
            Remembers the elimination order of like matrices.

        Raises
        ------
        SingularMatrixError
            The matrix has no inverse, or not a finite one.
        """
        self.counter.factorizations += 1
        self.counter.largest = max(self.counter.largest, matrix.shape[0])
        if not np.all(np.isfinite(matrix.data)):
            raise SingularMatrixError("matrix with entries that are not finite")
        scaled, row, col = equilibrate(without_zeros(matrix))
        if not scaled.has_pivots:
            raise SingularMatrixError("matrix whose entries leave an unknown or an equation without a pivot")
        places = None if order is None else order.known(len(scaled.data))
        try:
            factor = Factor(symmetric_lu(scaled, places), row, col, places, self.counter)
            if trusted(scaled, factor):
                if order is not None and scaled.n:  # active contacts may hold all unknowns
                    fill, found = factor.lu.nnz / scaled.n, factor.lu.perm_c
                    own = None if places is not None else partial(elimination_order, scaled, found, fill)
                    order.learn(own, fill, len(scaled.data))
                return factor
        except RuntimeError:  # SuperLU met a zero pivot: without the diagonal it may still do
            pass
        try:
            return Factor(
                spla.splu(scaled.matrix, permc_spec="COLAMD", options={"Equil": False}), row, col, None, self.counter
            )
        except RuntimeError as failure:  # SuperLU says "Factor is exactly singular" this way
            raise SingularMatrixError(str(failure)) from failure


@dataclass(frozen=True)
class Columns:
    """Entries of a square matrix by columns.

    SciPy's arrays check types, shapes and index types at every step: for a thousand unknowns that took six times as
    long as SuperLU.

    Attributes
    ----------
    data : (k,) array
        Entries [1].
    indices : (k,) array
        Their rows.
    indptr : (n + 1,) array
        First entry of each column.
    """

    data: NDArray[Any]
    indices: NDArray[Any]
    indptr: NDArray[Any]

    @property
    def n(self) -> int:
        """Rows."""
        return len(self.indptr) - 1

    @property
    def matrix(self) -> sp.csc_array:
        """As an array of SciPy's, in canonical format as long as no entry stands twice."""
        return compressed(sp.csc_array, self.data, self.indices, self.indptr, (self.n, self.n))

    @property
    def has_pivots(self) -> bool:
        """Whether rows and columns can be matched so that a pivot may stand in each, whatever the values are.

        In symmetric mode SuperLU writes past its arrays where they cannot.
        """
        columns = np.repeat(np.arange(self.n), np.diff(self.indptr))
        if np.count_nonzero(self.indices == columns) == self.n:  # no entry stands twice: a full diagonal
            return True
        pattern = compressed(sp.csr_array, np.ones(len(self.data)), self.indices, self.indptr, (self.n, self.n))
        return bool(structural_rank(pattern) == self.n)

    @property
    def magnitude(self) -> Columns:
        """Magnitudes of the entries."""
        return Columns(np.abs(self.data), self.indices, self.indptr)

    def times(self, x: NDArray[Any]) -> NDArray[Any]:
        """The product with a vector (n,) of the same type."""
        out = np.zeros(self.n, dtype=x.dtype)
        _sparsetools.csc_matvec(self.n, self.n, self.indptr, self.indices, self.data, x, out)
        return out

    def in_order(self, order: Index) -> Columns:
        """Rows and columns in another order."""
        place = np.empty(self.n, dtype=self.indices.dtype)
        place[order] = np.arange(self.n, dtype=self.indices.dtype)
        held = np.diff(self.indptr)[order]
        indptr = np.zeros(self.n + 1, dtype=self.indptr.dtype)
        np.cumsum(held, out=indptr[1:])
        taken = np.repeat(self.indptr[:-1][order] - indptr[:-1], held) + np.arange(len(self.data))
        return Columns(self.data[taken], place[self.indices[taken]], indptr)


def without_zeros(matrix: sp.csc_array) -> sp.csc_array:
    """The matrix without stored zeros: places kept for contacts that are open would fill in as if they were not."""
    if np.all(matrix.data):
        return matrix
    bare = matrix.copy()
    bare.eliminate_zeros()
    return bare


def symmetric_lu(scaled: Columns, order: Index | None) -> Any:
    """Factorise with pivots on the diagonal where they are large enough, in the given order or minimum degree."""
    options = {"Equil": False, "SymmetricMode": True}
    panel = next(columns for most, columns in PANELS if scaled.n <= most)
    numbers = {"diag_pivot_thresh": PIVOT, "panel_size": panel, "options": options}
    if order is None:
        return spla.splu(scaled.matrix, permc_spec="MMD_AT_PLUS_A", **numbers)
    ordered = scaled.in_order(order).matrix
    ordered.has_canonical_format = True  # no entry stands twice, and SuperLU does not ask for sorted rows
    return spla.splu(ordered, permc_spec="NATURAL", **numbers)


FULL = 40.0
"""Entries of the factors an unknown from which the postorder of an elimination is worth finding: with 110 (3-D, 24 x 16
cells) it takes four factorisations' gain of 6 %, with 60 nine, with 20 (2-D) more than all of a cold start."""


def elimination_order(scaled: Columns, found: Index, fill: float) -> Index:
    """Unknowns in the order in which a factorisation of `fill` eliminated them, in postorder of its tree if full.

    `found` (n,) are the places that SuperLU gave them.
    """
    order: Index = np.argsort(found)
    return postorder(scaled.matrix, order) if fill > FULL else order


def trusted(scaled: Columns, factor: Factor) -> bool:
    """The factorisation solves with a small backward error (one solve, a twentieth of the work)."""
    rhs = trial(scaled.n)
    x = factor.scaled(rhs)
    if not np.all(np.isfinite(x)):
        return False
    size = scaled.magnitude.times(np.abs(x)) + np.abs(rhs)
    return bool(np.max(np.abs(scaled.times(x) - rhs) / size, initial=0.0) < BACKWARD_ERROR)


def parity(order: NDArray[np.integer]) -> int:
    """1 for an even permutation (n,), -1 for an odd one."""
    n = len(order)
    moves = sp.csr_array((np.ones(n), (np.arange(n), order)), shape=(n, n))
    cycles, _ = connected_components(moves, directed=False)
    return 1 if (n - cycles) % 2 == 0 else -1


@lru_cache(maxsize=8)
def trial(n: int) -> Array:
    """The right-hand side that a factorisation is tried on, (n,)."""
    rhs = np.random.default_rng(0).standard_normal(n)
    rhs.setflags(write=False)
    return rhs


def equilibrate(matrix: sp.csc_array) -> tuple[Columns, Array, Array]:
    """Scale rows to sums of 1, then columns to largest entries of 1; returns the scaled matrix and both factors."""
    rows = np.bincount(matrix.indices, np.abs(matrix.data), matrix.shape[0])
    row = 1.0 / np.where(rows > 0.0, rows, 1.0)
    data = matrix.data * row[matrix.indices]
    starts, held = matrix.indptr[:-1], np.diff(matrix.indptr)
    filled = held > 0
    tallest = np.ones(len(starts))
    tallest[filled] = np.maximum.reduceat(np.abs(data), starts[filled])
    col = 1.0 / np.where(tallest > 0.0, tallest, 1.0)
    return Columns(data * np.repeat(col, held), matrix.indices, matrix.indptr), row, col
