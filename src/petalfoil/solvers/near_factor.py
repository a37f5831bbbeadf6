"""Solution with a matrix near one that is factorised: its factor, bordered, as the preconditioner of GMRES.

The first `common` unknowns of both matrices are the same, those behind them, the border, are not. With `K` the
factorised matrix, `J` the one to solve with, and `E` the border's columns of the unit matrix,

    [ K          [J_12; 0]   E ] [x; .]   [f; 0]
    [ [J_21 0]    J_22       0 ] [  z ] = [  g ]                                                        (1)
    [ E^T          0         0 ] [  h ]   [  0 ]

solves `J [x; z] = [f; g]` but for the difference of the common blocks, which GMRES makes up for (Saad, Iterative
Methods for Sparse Linear Systems, 2nd edition, 2003, sections 6.5 and 9.3, doi:10.1137/1.9780898718003).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.solvers.sparse_lu import Factor, LinearSolver

Array = NDArray[np.float64]

PRECISE = 1e-5
"""Preconditioned residual over the first estimate up to which GMRES goes. Newton's steps are then as good as with a
factor; where the matrix loses digits, much less is not reached."""

COARSE = 1e-2
"""The same up to which a solution is taken that has not got there."""

MOST_VECTORS = 10
"""Most vectors of GMRES. From a speed a tenth away it takes some ten; 24 solutions take a third of a factorisation."""


class NotNearError(ArithmeticError):
    """The factorised matrix is too far away to be of use."""


class Inverse(Protocol):
    """What solves with a matrix."""

    def solve(self, rhs: Array) -> NDArray[Any]:
        """Solve `M x = rhs`, rhs of shape (n,) or (n, k)."""

    def solve_transposed(self, rhs: Array) -> NDArray[Any]:
        """Solve `M^T x = rhs`, rhs of shape (n,)."""


@dataclass(frozen=True)
class NearInverse(ABC):
    """A matrix, and what solves with it but for a difference that GMRES makes up for.

    Attributes
    ----------
    matrix : (n, n) sparse
        `J`.
    """

    matrix: sp.csc_array

    @abstractmethod
    def nearly(self, rhs: Array) -> Array:
        """Solve `J x = rhs` but for the difference, (n,)."""

    @abstractmethod
    def nearly_transposed(self, rhs: Array) -> Array:
        """Solve `J^T x = rhs` likewise, (n,)."""

    def solve(self, rhs: Array) -> Array:
        """Solve `J x = rhs`, rhs of shape (n,) or (n, k).

        Raises
        ------
        NotNearError
            GMRES does not get there.
        """
        if rhs.ndim == 2:
            return np.column_stack([self.solve(column) for column in rhs.T])
        return improved(self.matrix, self.nearly, rhs)

    def solve_transposed(self, rhs: Array) -> Array:
        """Solve `J^T x = rhs`, rhs of shape (n,).

        Raises
        ------
        NotNearError
            GMRES does not get there.
        """
        return improved(self.matrix.T, self.nearly_transposed, rhs)


@dataclass(frozen=True)
class NearFactor(NearInverse):
    """The factor of a near matrix, bordered as (1): ready to solve with `matrix`.

    Attributes
    ----------
    factor : Factor
        Of the near matrix `K`.
    below : (k_J, common) sparse
        `J_21`.
    responses : (n_K, k) array
        What `K` makes of the columns of the border, those of `J` and `E`.
    border : tuple
        LU factors of the Schur complement of the border, (k, k).
    """

    factor: Factor
    below: sp.csr_array
    responses: Array
    border: tuple[Array, NDArray[np.intp]]

    @classmethod
    def of(cls, factor: Factor, matrix: sp.csc_array, common: int) -> NearFactor:
        """Solve for the border.

        Raises
        ------
        NotNearError
            Without the difference of the common blocks, the matrix is singular.
        """
        old, new = len(factor.row) - common, matrix.shape[0] - common
        columns = np.zeros((common + old, new + old))
        columns[:common, :new] = matrix[:common, common:].toarray()
        columns[common:, new:] = np.eye(old)
        responses = factor.solve(columns)
        complement = np.zeros((new + old, new + old))
        complement[:new, :new] = matrix[common:, common:].toarray()
        below = sp.csr_array(matrix[common:, :common])
        complement[:new] -= below @ responses[:common]
        complement[new:] = -responses[common:]
        return cls(matrix, factor, below, responses, factorized(complement))

    def nearly(self, rhs: Array) -> Array:
        """Solve (1), (n,)."""
        new, common = self.below.shape
        first = self.factor.solve(np.concatenate([rhs[:common], np.zeros(len(self.factor.row) - common)]))
        behind = rhs[common:] - self.below @ first[:common]
        border = scipy.linalg.lu_solve(self.border, np.concatenate([behind, -first[common:]]), check_finite=False)
        return np.concatenate([first[:common] - self.responses[:common] @ border, border[:new]])

    def nearly_transposed(self, rhs: Array) -> Array:
        """Solve with the transpose of (1), (n,)."""
        (new, common), behind = self.below.shape, np.zeros(len(self.border[1]))
        behind[:new] = rhs[common:]
        behind -= self.responses[:common].T @ rhs[:common]
        border = scipy.linalg.lu_solve(self.border, behind, trans=1, check_finite=False)
        first = rhs[:common] - self.below.T @ border[:new]
        return np.concatenate(
            [self.factor.solve_transposed(np.concatenate([first, -border[new:]]))[:common], border[:new]]
        )


@dataclass(frozen=True)
class NearbyFactor(NearInverse):
    """The factor of a near matrix of the same unknowns: GMRES makes up for all that differs.

    Attributes
    ----------
    factor : Factor
        Of the near matrix.
    """

    factor: Factor

    def nearly(self, rhs: Array) -> Array:
        """Solve with the near matrix, (n,)."""
        return np.asarray(self.factor.solve(rhs))

    def nearly_transposed(self, rhs: Array) -> Array:
        """Solve with its transpose, (n,)."""
        return np.asarray(self.factor.solve_transposed(rhs))


def factorized(complement: Array) -> tuple[Array, NDArray[np.intp]]:
    """LU factors and pivots of the Schur complement of a border, (k, k) and (k,).

    Raises
    ------
    NotNearError
        It is singular, or not finite.
    """
    if not np.all(np.isfinite(complement)):
        raise NotNearError("the border has no finite response")
    if not len(complement):
        return complement, np.zeros(0, dtype=np.intp)
    lu, pivots, zero = scipy.linalg.lapack.dgetrf(complement)
    if zero:
        raise NotNearError("the border is singular")
    return lu, pivots


def improved(matrix: Any, nearly: Callable[[Array], Array], rhs: Array) -> Array:
    """Solve `matrix x = rhs`, (n,), from what solves it `nearly`.

    Raises
    ------
    NotNearError
        GMRES does not get there.
    """
    start = nearly(rhs)
    size = float(np.linalg.norm(start))
    left = nearly(rhs - matrix @ start)
    product = spla.LinearOperator(matrix.shape, lambda x: nearly(matrix @ x), dtype=np.float64)
    more, failed = spla.gmres(product, left, rtol=0.0, atol=PRECISE * size, restart=MOST_VECTORS, maxiter=1)
    if failed and not float(np.linalg.norm(left - product @ more)) <= COARSE * size:
        raise NotNearError(f"not solved with {MOST_VECTORS} vectors")
    return np.asarray(start + more)


@dataclass
class FactorAtHand:
    """The last factor, for the matrices near it.

    Attributes
    ----------
    factor : Factor or None
        The factor.
    about : object
        What its matrix is of: it serves matrices of the same only.
    """

    factor: Factor | None = None
    about: object = None

    def near(self, matrix: sp.csc_array, common: int, about: object, solver: LinearSolver) -> NearFactor | None:
        """The factor, made ready to solve with `matrix`; None where there is none, or its border is singular.

        Solutions are counted by the `solver`.
        """
        if self.factor is None or self.about is not about:
            return None
        try:
            return NearFactor.of(replace(self.factor, counter=solver.counter), matrix, common)
        except NotNearError:
            return None

    def keep(self, factor: Factor, about: object) -> None:
        """From now on this one."""
        self.factor, self.about = factor, about

    def drop(self) -> None:
        """It was too far away."""
        self.factor = None
