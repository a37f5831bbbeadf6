"""A large linear system that is moved by few coordinates, as a small one with the same force over some frequencies.

Coordinates `e` move in `exp(s tau)`, unknowns `y` follow, and a force answers:

    (J + s S) y = -(f0 + s f1) e ,     F = (l0 + s l1)^T y + (d0 + s d1) e                              (E14)

With `K = J^-1 S`, `y` lies in the block Krylov space of `J^-1 f0` and `J^-1 f1`. In an orthonormal basis `V` of it,

    y = V c ,     (I + s H) c = -V^T J^-1 (f0 + s f1) e ,     H = V^T K V                               (E15)

which costs one factorisation of `J`, a solve for each basis vector, and dense algebra of that size for every `s`. Where
`J` is complex, so is `V`, and `V^T` stands for its conjugate transpose.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Values = NDArray[np.inexact[Any]]
"""Real, or complex where `J` is."""
Complex = NDArray[np.complex128]

MOST = 160
"""Most basis vectors. Bearings take 28 to 48 of them for whirl ratios up to 3, and up to 96 for ratios up to 30."""

DEPENDENT = 1e-10
"""Part of a vector outside the space, over the vector, below which it is rounding and adds nothing."""

SETTLED = 1e-10
"""Change of the force by the last block of vectors, over the largest force, below which the space is large enough."""


@dataclass(frozen=True)
class MovedSystem:
    """(E14), `n` unknowns moved by `d` coordinates.

    Attributes
    ----------
    solve : callable
        `J^-1` times vectors (n,) or (n, k).
    S : (n, n) sparse
        What the unknowns store.
    forcing : pair of (n, d) array
        `f0`, `f1`.
    force : pair of (n, d) array
        `l0`, `l1`.
    direct : pair of (d, d) array
        `d0`, `d1`.
    """

    solve: Callable[[Values], Values]
    S: sp.csc_array
    forcing: tuple[Values, Values]
    force: tuple[Values, Values]
    direct: tuple[Values, Values]


@dataclass(frozen=True)
class ReducedModel:
    """(E15): the system in `q` basis vectors.

    Attributes
    ----------
    H : (q, q) array
        `V^T K V`.
    forcing : pair of (q, d) array
        `V^T J^-1 f0`, `V^T J^-1 f1`.
    force : pair of (d, q) array
        `l0^T V`, `l1^T V`.
    direct : pair of (d, d) array
        `d0`, `d1`.
    """

    H: Values
    forcing: tuple[Values, Values]
    force: tuple[Values, Values]
    direct: tuple[Values, Values]

    @property
    def size(self) -> int:
        """Basis vectors."""
        return len(self.H)

    def at(self, s: complex) -> Complex:
        """`F` by unit displacements, (d, d)."""
        return np.asarray(self.at_each([s])[0], dtype=np.complex128)

    def at_each(self, points: Sequence[complex]) -> Complex:
        """The same at several `s`, (k, d, d): small systems solved in one call."""
        s = np.asarray(points, dtype=np.complex128)[:, None, None]
        moved = -np.linalg.solve(np.eye(self.size) + s * self.H, _at(self.forcing, s))
        return np.asarray(_at(self.force, s) @ moved + _at(self.direct, s), dtype=np.complex128)

    def derivative(self, s: complex) -> Complex:
        """Derivative of `at` by `s`, (d, d)."""
        moved = -self._solve(s, _at(self.forcing, s))
        rate = -self._solve(s, self.H @ moved + self.forcing[1])
        return np.asarray(self.force[1] @ moved + _at(self.force, s) @ rate + self.direct[1], dtype=np.complex128)

    def modes(self, mass: Array, gyroscopic: Array) -> Complex:
        """Every finite `s` at which the system and a body on the coordinates move freely; unordered.

        The body obeys `(mass s^2 + gyroscopic s) e = F`, both (d, d).

        With `v = s e` the equations are linear in `s`, in the unknowns `c`, `e` and `v`.
        """
        q, d = self.size, len(self.direct[0])
        one, none = np.eye(d), np.zeros((d, d))
        steady: list[list[Values]] = [
            [np.eye(q), self.forcing[0], np.zeros((q, d))],
            [-self.force[0], -self.direct[0], gyroscopic],
            [np.zeros((d, q)), none, -one],
        ]
        rates: list[list[Values]] = [
            [self.H, self.forcing[1], np.zeros((q, d))],
            [-self.force[1], -self.direct[1], mass],
            [np.zeros((d, q)), one, none],
        ]
        alpha, beta = la.eigvals(-np.block(steady), np.block(rates), homogeneous_eigvals=True)
        finite = np.abs(beta) > np.finfo(float).eps * np.abs(alpha)
        return np.asarray(alpha[finite] / beta[finite], dtype=np.complex128)

    def _solve(self, s: complex, right: NDArray[np.complexfloating]) -> Complex:
        return np.asarray(np.linalg.solve(np.eye(self.size) + s * self.H, right), dtype=np.complex128)


def _at(pair: tuple[Values, Values], s: complex | Complex) -> Complex:
    return np.asarray(pair[0] + s * pair[1], dtype=np.complex128)


def reduce_system(system: MovedSystem, points: Sequence[complex]) -> ReducedModel:
    """The smallest block Krylov model whose force has settled at `points` (`MOST` vectors at most)."""
    start = system.solve(np.hstack(system.forcing))
    block, space = start.shape[1], KrylovSpace(len(start), start.dtype)
    space.extend(start.T)
    last: Complex | None = None
    while True:
        for _ in range(block):
            if space.complete:
                break
            space.extend([system.solve(system.S @ space.next())])
        model = projected(system, space, start)
        now = model.at_each(points)
        settled = last is not None and np.max(np.abs(now - last)) <= SETTLED * np.max(np.abs(now))
        if settled or space.complete:
            return model
        last = now


def projected(system: MovedSystem, space: KrylovSpace, start: Values) -> ReducedModel:
    """The model in the vectors of `space` that `K` has been applied to; `start` is `J^-1` of the forcing (n, 2 d)."""
    V, d = space.vectors[: space.applied].T, len(system.direct[0])
    steady, rate = V.conj().T @ start[:, :d], V.conj().T @ start[:, d:]
    return ReducedModel(
        space.H[: space.applied, : space.applied],
        (steady, rate),
        (system.force[0].T @ V, system.force[1].T @ V),
        system.direct,
    )


class KrylovSpace:
    """An orthonormal basis that grows by images of its own vectors under `K`, in the order in which they came.

    Attributes
    ----------
    vectors : (k, n) array
        The basis.
    H : (k, k) array
        Their products with `K` times them, as far as it has been applied.
    applied : int
        Vectors that `K` has been applied to.
    """

    def __init__(self, n: int, dtype: np.dtype[Any]) -> None:
        self.most = min(MOST, n)
        self._vectors, self._H = np.zeros((self.most, n), dtype), np.zeros((self.most, self.most), dtype)
        self.count = self.applied = 0

    @property
    def vectors(self) -> Values:
        """The basis, (count, n)."""
        basis: Values = self._vectors[: self.count]
        return basis

    @property
    def H(self) -> Values:
        """Products of the basis with `K` times it, (count, count)."""
        products: Values = self._H[: self.count, : self.count]
        return products

    @property
    def complete(self) -> bool:
        """`K` has been applied to all vectors: they span all that can be reached, or all that may be kept."""
        return self.applied == self.count

    def next(self) -> Values:
        """The first vector that `K` has not been applied to; its image is the next to extend the space."""
        self.applied += 1
        vector: Values = self.vectors[self.applied - 1]
        return vector

    def extend(self, images: Sequence[Values] | Values) -> None:
        """Add what vectors (n,) have outside the space."""
        for image in images:
            rest, whole = image, float(np.linalg.norm(image))
            for _ in range(2):  # Gram-Schmidt, again for what rounding left
                inside = self.vectors.conj() @ rest
                rest = rest - self.vectors.T @ inside
                if self.applied:
                    self._H[: self.count, self.applied - 1] += inside
            size = float(np.linalg.norm(rest))
            if size <= DEPENDENT * whole or self.count == self.most:
                continue
            self._vectors[self.count] = rest / size
            if self.applied:
                self._H[self.count, self.applied - 1] = size
            self.count += 1
