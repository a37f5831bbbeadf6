"""A large linear system that is moved by few coordinates, as a small one with the same force over some frequencies.

Coordinates `e` move in `exp(s tau)`, unknowns `y` follow, and a force answers:

    (J + s S) y = -(f0 + s f1) e ,     F = (l0 + s l1)^T y + (d0 + s d1) e                              (E14)

With `K = J^-1 S`, `y` lies in the block Krylov space of `J^-1 f0` and `J^-1 f1`. In an orthonormal basis `V` of it,

    y = V c ,     (I + s H) c = -V^T J^-1 (f0 + s f1) e ,     H = V^T K V                               (E15)

which costs one factorisation of `J`, a solve for each basis vector, and dense algebra of that size for every `s`. Where
`J` is complex, so is `V`, and `V^T` stands for its conjugate transpose.
"""

from __future__ import annotations

import math
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

LEAST = 20
"""Basis vectors before the force is looked at."""

MOST = 160
"""Most basis vectors. Bearings take 28 to 48 of them for whirl ratios up to 3, and up to 96 for ratios up to 30."""

DEPENDENT = 1e-10
"""Part of a vector outside the space, over the vector, below which it is rounding and adds nothing."""

KEPT = 0.1
"""Part of a vector left outside the space, over the vector, from which a single Gram-Schmidt step is enough: no more is
left inside than ten times rounding."""

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
    farthest = max(points, key=abs)
    before: tuple[ReducedModel, Complex] | None = None
    while True:
        space.extend(system.solve(system.S @ space.next(block).T).T)
        if space.applied < LEAST and not space.complete:
            continue
        model = projected(system, space, start)
        there = model.at(farthest)
        if space.complete or (before is not None and settled(before[1], there) and agree(before[0], model, points)):
            return model
        before = model, there


def agree(before: ReducedModel, model: ReducedModel, points: Sequence[complex]) -> bool:
    """Whether two models have the same force at `points`."""
    return settled(before.at_each(points), model.at_each(points))


def settled(before: Complex, now: Complex) -> bool:
    """Whether forces are those `before` the last block of vectors (`SETTLED`)."""
    return bool(np.max(np.abs(now - before)) <= SETTLED * np.max(np.abs(now)))


def projected(system: MovedSystem, space: KrylovSpace, start: Values) -> ReducedModel:
    """The model in the vectors of `space` that `K` has been applied to; `start` is `J^-1` of the forcing (n, 2 d)."""
    V, d = space.vectors[: space.applied], len(system.direct[0])
    forcing, force = V.conj() @ start, (V @ np.hstack(system.force)).T
    return ReducedModel(
        space.H[: space.applied, : space.applied],
        (forcing[:, :d], forcing[:, d:]),
        (force[:d], force[d:]),
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

    def next(self, most: int) -> Values:
        """The first vectors that `K` has not been applied to, (k, n); their images are the next to extend the space.

        `most` of them: solves for several at once take a third of the time.
        """
        first, self.applied = self.applied, min(self.applied + most, self.count)
        vectors: Values = self._vectors[first : self.applied]
        return vectors

    def extend(self, images: Values) -> None:
        """Add what vectors (k, n) have outside the space; images of the last ones of `next`, where that was called."""
        first, known, basis = self.applied - len(images), self.count, self.vectors
        outside, size = images, lengths(images)
        least = DEPENDENT * size
        for _ in range(2):  # Gram-Schmidt, again where rounding is left
            inside, longer = outside @ basis.conj().T, size
            outside = outside - inside @ basis
            if self.applied:
                self._H[:known, first : self.applied] += inside.T
            size = lengths(outside)
            if np.all(size > KEPT * longer):
                break
        if known + len(images) > self.most or not np.all(size > least) or not self._append_all(outside, size, first):
            for k, rest in enumerate(outside):
                self._append(rest, float(least[k]), known, first + k if self.applied else None)

    def _append_all(self, outside: Values, size: Array, first: int) -> bool:
        """Add vectors (k, n) of a `size` (k,) that have nothing of the space, unless they nearly depend on each other.

        They are images of the vectors from the `first` on, where `K` has been applied. The squares of the parts that
        each has outside those before it are the pivots of their products, none of which exceeds 1: the least is no less
        than the determinant.
        """
        unit = outside / size[:, None]
        products = unit @ unit.conj().T
        if np.linalg.det(products).real <= KEPT**2:
            return False
        L, last = np.linalg.cholesky(products), self.count + len(unit)
        self._vectors[self.count : last] = np.linalg.inv(L) @ unit  # solving for n columns takes tens of times as long
        if self.applied:
            self._H[self.count : last, first : self.applied] = (L * size[:, None]).T
        self.count = last
        return True

    def _append(self, rest: Values, least: float, known: int, column: int | None) -> None:
        """Add what a vector (n,) has outside the space, unless that is `least` or shorter.

        It has nothing of the first vectors, those `known` before. `column` of `H` is that of the vector whose image it
        is, if it is one.
        """
        size, longer = length(rest), np.inf
        while least < size < KEPT * longer:
            inside, longer = self.vectors[known:].conj() @ rest, size
            rest = rest - inside @ self.vectors[known:]
            if column is not None:
                self._H[known : self.count, column] += inside
            size, known = length(rest), 0
        if size <= least or self.count == self.most:
            return
        self._vectors[self.count] = rest / size
        if column is not None:
            self._H[self.count, column] = size
        self.count += 1


def length(vector: Values) -> float:
    """Of a vector (n,)."""
    return math.sqrt(np.vdot(vector, vector).real)


def lengths(vectors: Values) -> Array:
    """Of vectors (k, n), (k,)."""
    return np.asarray(np.sqrt(np.einsum("kn,kn->k", vectors.conj(), vectors).real))
