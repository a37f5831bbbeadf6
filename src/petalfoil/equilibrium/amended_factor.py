"""One factor of the tangent for states with other contact points: these are a border of loads on nodal gaps.

Petals are linear, and pressures change little while contacts are looked for: of the tangent `J` hardly more than the
border of reactions and places changes. With the factor of a tangent `J_0`, and `E` the unit columns of its own
reactions and places, which are to vanish,

    [ J_0        [J_12; 0]   E ] [x; .]   [f; 0]
    [ [J_21 0]    J_22       0 ] [  y ] = [  g ]                                                       (C17)
    [ E^T         0          0 ] [  h ]   [  0 ]

solves `J [x; y] = [f; g]` but for the difference of the films, which GMRES makes up for (`solvers/near_factor.py`).
`J_12` are loads on nodal (value, slope) of the gaps. What `J_0` answers to each of these is found once, and serves all
points on the elements beside it, wherever they travel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.near_factor import Inverse, NearbyFactor, NearInverse, NotNearError, factorized
from petalfoil.solvers.sparse_lu import Factor, LinearSolver, SingularMatrixError
from petalfoil.system.point_equations import PointEquations

Array = NDArray[np.float64]
Index = NDArray[np.intp]

MOST_LOADS = 400
"""Most nodal loads that are answered by one factor, four for each element with a point; past that another one is made.
The rig has some 150, with those that points have travelled over."""

OWN = 2
"""Tangents of a search with factors of their own, before the last of these serves on: short searches have no more, and
to amend one costs some hundred solves, as much as three or four factors."""


NEARBY = 0.5
"""Farthest that a point has travelled, in elements, where the factor of a state with the same contacts serves as it is:
GMRES takes some six solves for each of Newton's, no more than another factor takes."""


@dataclass(eq=False)
class NodalAnswers:
    """What a factorised tangent answers to loads on nodal gaps, found as they are asked for.

    Attributes
    ----------
    equations : PointEquations
        The equations at the state of `J_0`.
    factor : Factor
        `J_0`, ready to solve with.
    place : (2 n_node,) int array
        Which answer is that of a nodal load, -1 where it has not been asked for.
    used : (m,) int array
        The nodal loads that have been answered.
    answers : (n, m) array
        Changes of the unknowns of `J_0` by a unit of each.
    openings : (2 n_node, m) array
        Changes of the nodal gaps by the same.
    released, opened : (n, o), (2 n_node, o) array
        Changes of both by units of the residuals of its own points, `E`.
    """

    equations: PointEquations
    factor: Factor
    place: Index
    used: Index
    answers: Array
    openings: Array
    released: Array
    opened: Array

    @classmethod
    def of(cls, equations: PointEquations, factor: Factor) -> NodalAnswers:
        """None asked for so far; a solve for each reaction and place."""
        by_w, n = equations.whole.curves.by_w, equations.n
        common, nodes = equations.whole.n_wall + equations.whole.n_film, by_w.shape[0]
        released = factor.solve(np.eye(n, n - common, -common))
        opened = by_w @ released[: by_w.shape[1]]
        none, place = np.zeros(0, dtype=np.intp), np.full(nodes, -1, dtype=np.intp)
        return cls(equations, factor, place, none, np.zeros((n, 0)), np.zeros((nodes, 0)), released, opened)

    @property
    def common(self) -> int:
        """Unknowns that do not depend on the contact points: deflections and pressures."""
        return self.equations.whole.n_wall + self.equations.whole.n_film

    def ask(self, loads: Index) -> None:
        """Find the answers to nodal loads that have not been asked for.

        Raises
        ------
        NotNearError
            There are too many.
        """
        fresh = np.unique(loads[self.place[loads] < 0])
        if not len(fresh):
            return
        if len(self.used) + len(fresh) > MOST_LOADS:
            raise NotNearError(f"more than {MOST_LOADS} nodal loads")
        by_w = self.equations.whole.curves.by_w
        columns = np.zeros((self.equations.n, len(fresh)))
        columns[: by_w.shape[1]] = by_w[fresh].toarray().T
        found = self.factor.solve(columns)
        self.place[fresh] = len(self.used) + np.arange(len(fresh))
        self.used = np.concatenate([self.used, fresh])
        self.answers = np.concatenate([self.answers, found], axis=1)
        self.openings = np.concatenate([self.openings, by_w @ found[: by_w.shape[1]]], axis=1)

    def spread(self, columns: Index, weights: Array) -> Array:
        """Weights (j, 4) of nodal gaps (j, 4) at points as columns over those in use, (m, j)."""
        out = np.zeros((len(self.used), len(columns)))
        out[self.place[columns], np.arange(len(columns))[:, None]] = weights
        return out


@dataclass(frozen=True)
class AmendedFactor(NearInverse):
    """A factor bordered as (C17): ready to solve with the tangent of a state with other contact points.

    Attributes
    ----------
    known : NodalAnswers
        The factor, and what it answers to nodal loads.
    loads, reads : (m, k) array
        `J_12` and `J_21` over the first `m` nodal gaps in use: others have been asked for since.
    complement : tuple
        LU factors of the Schur complement of the border.
    """

    known: NodalAnswers
    loads: Array
    reads: Array
    complement: tuple[Array, NDArray[np.intp]]

    @classmethod
    def of(cls, known: NodalAnswers, equations: PointEquations) -> AmendedFactor:
        """Solve for the border.

        Raises
        ------
        NotNearError
            The points are too many, or do not determine the petals.
        """
        matrix, common = equations.steady, known.common
        loads, reads = border(known, equations)
        k = loads.shape[1]
        complement = np.zeros((k + known.released.shape[1],) * 2)
        complement[:k, :k] = corner(matrix, common) - reads.T @ (known.openings[known.used] @ loads)
        complement[:k, k:] = -(reads.T @ known.opened[known.used])
        complement[k:, :k], complement[k:, k:] = -(known.answers[common:] @ loads), -known.released[common:]
        return cls(matrix, known, loads, reads, factorized(complement))

    def nearly(self, rhs: Array) -> Array:
        """Solve (C17), (n,)."""
        known, (m, k), common = self.known, self.loads.shape, self.known.common
        by_w, ahead = known.equations.whole.curves.by_w, np.zeros(known.equations.n)
        ahead[:common] = rhs[:common]
        first = known.factor.solve(ahead)
        read = (by_w @ first[: by_w.shape[1]])[known.used[:m]] @ self.reads
        behind = np.concatenate([rhs[common:] - read, -first[common:]])
        found = scipy.linalg.lu_solve(self.complement, behind, check_finite=False)
        first -= known.answers[:, :m] @ (self.loads @ found[:k]) + known.released @ found[k:]
        return np.concatenate([first[:common], found[:k]])

    def nearly_transposed(self, rhs: Array) -> Array:
        """Solve with the transpose of (C17), (n,)."""
        known, (m, k), common = self.known, self.loads.shape, self.known.common
        by_w, ahead = known.equations.whole.curves.by_w, np.zeros(known.equations.n)
        ahead[:common] = rhs[:common]
        pushed = self.loads.T @ (known.answers[:, :m].T @ ahead)
        behind = np.concatenate([rhs[common:] - pushed, -(known.released.T @ ahead)])
        found = scipy.linalg.lu_solve(self.complement, behind, trans=1, check_finite=False)
        read = np.zeros(by_w.shape[0])
        read[known.used[:m]] = self.reads @ found[:k]
        ahead[: by_w.shape[1]] -= by_w.T @ read
        ahead[common:] = -found[k:]
        return np.concatenate([known.factor.solve_transposed(ahead)[:common], found[:k]])


def close_by(one: ContactPoints, other: ContactPoints) -> bool:
    """Whether two states have the same contacts, none of which is farther than `NEARBY` from where it was."""
    same = np.array_equal(one.curve, other.curve) and np.array_equal(one.inner, other.inner)
    return same and bool(np.all(np.abs(one.position - other.position) <= NEARBY))


def border(known: NodalAnswers, equations: PointEquations) -> tuple[Array, Array]:
    """`J_12` and `J_21` of a state as loads on the nodal gaps in use, and as sums of these gaps, (m, j + k) each."""
    points, (columns, weights) = equations.state.points, equations.gaps.weights
    known.ask(columns)
    value, slope = (known.spread(columns, weights[:, kind]) for kind in range(2))
    travel = -points.reaction * slope
    if points.inner.any():
        travel = np.asarray(travel @ points.spread)
    loads = np.concatenate([-value, travel * equations.travels], axis=1)
    reads = np.concatenate([value * (1.0 - equations.idle), slope[:, points.ends] * equations.travels], axis=1)
    return loads, reads


def corner(matrix: sp.csc_array, common: int) -> Array:
    """`J_22`, (k, k)."""
    size, first = matrix.shape[0] - common, int(matrix.indptr[common])
    rows = matrix.indices[first:] - common
    cols = np.repeat(np.arange(size), np.diff(matrix.indptr[common:]))
    out, inside = np.zeros((size, size)), rows >= 0
    out[rows[inside], cols[inside]] = matrix.data[first:][inside]
    return out


def serving_factor(tangent: ElementTangent | None, solver: LinearSolver) -> ServingFactor:
    """The factor that served the search with a last `tangent`; none at hand where there was no search."""
    factor = None if tangent is None else tangent.factor
    return factor.serving if isinstance(factor, ServedTangent) else ServingFactor(solver)


@dataclass(eq=False)
class ServingFactor:
    """The last factor of a search: it serves the tangents of the states that follow.

    Attributes
    ----------
    solver : LinearSolver
        Makes another one where that is too far away.
    made : (PointEquations, Factor) or None
        The factor, and the equations at the state that it is of; None where there is none so far.
    known : NodalAnswers or None
        What it has answered; None before another state asks for it.
    own : int
        States that still get a factor of their own, before one is amended.
    sparing : bool
        Whether states close by with the same contacts do with the factor at hand already before that.
    """

    solver: LinearSolver
    own: int = OWN
    sparing: bool = False
    made: tuple[PointEquations, Factor] | None = None
    known: NodalAnswers | None = None

    def tangent(self, equations: PointEquations, load: Array | None) -> ElementTangent:
        """The tangent at a state, by the factor at hand or one of its own.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        return ElementTangent.of(equations, load, ServedTangent(self, equations, self.amended(equations)))

    def amended(self, equations: PointEquations) -> Inverse:
        """The factor at hand, amended for a state; one of its own where there is none or that is too far away.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        if self.made is None or self.made[0].whole is not equations.whole:
            return self.renewed(equations)
        if equations.journal_friction:  # other forces than those of the gaps act on the petals (D6)
            return self.renewed(equations)
        before, factor = self.made
        if self.sparing and self.known is None and close_by(before.state.points, equations.state.points):
            return NearbyFactor(equations.steady, factor)
        if self.own > 0:
            return self.renewed(equations)
        try:
            self.known = self.known or NodalAnswers.of(*self.made)
            return AmendedFactor.of(self.known, equations)
        except NotNearError:
            return self.renewed(equations)

    def renewed(self, equations: PointEquations) -> Factor:
        """The factor of a state, from now on the one at hand.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        try:
            factor = self.solver.factor(equations.steady)
        except SingularMatrixError:
            raise NoPointsError("the contacts do not determine the petals") from None
        self.made, self.known, self.own = (equations, factor), None, self.own - 1
        return factor


@dataclass(eq=False)
class ServedTangent:
    """The tangent of a state, by a factor that serves it as long as it leads to solutions.

    Attributes
    ----------
    serving : ServingFactor
        Where another one comes from.
    equations : PointEquations
        The equations at the state.
    inverse : Inverse
        What solves with it at present.
    """

    serving: ServingFactor
    equations: PointEquations
    inverse: Inverse

    def solve(self, rhs: Array) -> Array:
        """Solve `J x = rhs`, rhs of shape (n,) or (n, k); with a factor of its own where the other one is too far away.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        return self.served(lambda inverse: inverse.solve(rhs))

    def nearly(self, rhs: Array) -> Array:
        """Solve `J x = rhs`, (n,), as the factor at hand does without GMRES."""
        inverse = self.inverse
        if isinstance(inverse, NearInverse):
            return inverse.nearly(rhs)
        return np.asarray(inverse.solve(rhs))

    def solve_transposed(self, rhs: Array) -> Array:
        """Solve `J^T x = rhs`, rhs of shape (n,), likewise.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        return self.served(lambda inverse: inverse.solve_transposed(rhs))

    def served(self, solution: Callable[[Inverse], NDArray[Any]]) -> Array:
        """A solution by the factor at hand, or by one of the state's own.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        try:
            return solution(self.inverse)
        except NotNearError:
            self.inverse = self.serving.renewed(self.equations)
        return solution(self.inverse)
