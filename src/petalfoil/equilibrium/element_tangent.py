"""A step of Newton's method for petals of Hermite elements, under a load with the journal's position bordered.

With the tangent `J`, the derivatives `F_e` of the rows by the position, and those of the force, `R` and `R_e`,

    J dX + F_e de = -F ,     R dX + R_e de = -(force + load)                                            (C10)

One factorisation of `J` serves both; without a load `de` vanishes. Its pivots are chosen for little fill-in
(`sparse_lu.PIVOT`), so that solves of stiff packs lose digits. Newton's method corrects them; derivatives solve once
more for what is left (`refined`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.parameter_response import StateWeights
from petalfoil.equilibrium.small_motion import TangentEquations
from petalfoil.equilibrium.under_load import FORCE_TOLERANCE
from petalfoil.solvers.near_factor import Inverse
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.solvers.tangent import SeenTangent
from petalfoil.system.loaded import load_scale

Array = NDArray[np.float64]


ROUNDED = 1e-13
"""What a solve may leave of a row, over the magnitudes of its terms; more is solved for once more. Most packs leave
1e-15 to 3e-14; one of the stiff ones leaves 4e-12, and 1e-5 of its derivatives."""


class NoPointsError(ArithmeticError):
    """Newton's method found no equilibrium of petals with continuous slopes; it says why."""


def unbalanced(equations: TangentEquations, load: Array | None) -> Array:
    """Force that a Newton step balances, over the unit of force, (n_position,); nothing without a load."""
    return np.zeros(len(equations.problem.displacement)) if load is None else equations.newton_force + load


def scaled_force(equations: TangentEquations, load: Array | None) -> Array:
    """What is left of the force over what a solution leaves, times the residual of a solution: it joins the others."""
    if load is None:
        return np.zeros(0)
    return (equations.force + load) / load_scale(load) * (RESIDUAL_TOLERANCE / FORCE_TOLERANCE)


@dataclass(frozen=True)
class ElementTangent(SeenTangent):
    """The tangent at one state, factorised; residuals that it is seen to answer are those of the film's rows.

    Attributes
    ----------
    equations : TangentEquations
        The equations at the state.
    factor : Inverse
        `J`, ready to solve with.
    units : (n, n_position) array
        Change of the unknowns by a unit of each coordinate of the journal; no columns without a load.
    rows : (n_position, n) array
        `R`.
    gradient : (n_position, n_position) array
        Force by the journal's position, unknowns following.
    """

    equations: TangentEquations
    factor: Inverse
    units: Array
    rows: Array
    gradient: Array

    @classmethod
    def at(cls, equations: TangentEquations, load: Array | None, solver: LinearSolver) -> ElementTangent:
        """Factorise at a state.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals.
        """
        try:
            factor = solver.factor(equations.steady)
        except SingularMatrixError:
            raise NoPointsError("the contacts do not determine the petals") from None
        return cls.of(equations, load, factor)

    @classmethod
    def of(cls, equations: TangentEquations, load: Array | None, factor: Inverse) -> ElementTangent:
        """The tangent at a state, whose `J` is ready to solve with."""
        if load is None:
            return cls(equations, factor, np.zeros((equations.n, 0)), np.zeros((0, equations.n)), np.zeros((0, 0)))
        units, rows = np.asfortranarray(factor.solve(-equations.forcing())), equations.force_rows
        return cls(equations, factor, units, rows, rows @ units + equations.force_direct)

    @property
    def n(self) -> int:
        """Unknowns."""
        return len(self.units)

    def correction(self, residual: Array, force: Array) -> tuple[Array, Array]:
        """Changes of the unknowns (n,) and of the journal's position (n_position,) from what is left of both.

        Raises
        ------
        NoPointsError
            The journal's position is not determined.
        """
        own = self.factor.solve(-residual)
        if not self.units.shape[1]:
            return own, np.zeros(len(force))
        move = self._compliance @ (-force - self.rows @ own)
        return own + self.units @ move, move

    @cached_property
    def _compliance(self) -> Array:
        """The inverse of `gradient`: steps in time ask for it thousands of times.

        Raises
        ------
        NoPointsError
            The journal's position is not determined.
        """
        try:
            return np.asarray(np.linalg.inv(self.gradient), dtype=np.float64)
        except np.linalg.LinAlgError:
            raise NoPointsError("the load does not determine the journal's position") from None

    def refined(self, residual: Array, force: Array) -> tuple[Array, Array]:
        """The same to rounding of the equations: one solve, and another where the factor has lost digits (`ROUNDED`).

        Raises
        ------
        NoPointsError
            The journal's position is not determined.
        """
        change, move = self.correction(residual, force)
        J, by_e = self.equations.steady, self.equations.forcing()
        left = residual + J @ change + by_e @ move
        if not has_lost_digits(left, np.abs(residual) + abs(J) @ np.abs(change) + np.abs(by_e) @ np.abs(move)):
            return change, move
        unbalanced = force + self.equations.force_rows @ change + self.equations.force_direct @ move
        more, further = self.correction(left, unbalanced)
        return change + more, move + further

    def adjoint(self, by_state: StateWeights) -> StateWeights:
        """Derivatives of a result along the equilibrium by the rates of the equations (V11).

        One transposed solve, and another where the factor has lost digits (`ROUNDED`).

        Raises
        ------
        NoPointsError
            The journal's position is not determined.
        """
        found, J = self._adjoint(by_state), self.equations.steady
        left = by_state.residual + J.T @ found.residual
        size = np.abs(by_state.residual) + abs(J).T @ np.abs(found.residual)
        rows, direct = self.equations.force_rows, self.equations.force_direct
        left, size = left + rows.T @ found.force, size + np.abs(rows).T @ np.abs(found.force)
        if not has_lost_digits(left, size):
            return found
        unbalanced = by_state.force + self.equations.forcing().T @ found.residual + direct.T @ found.force
        more = self._adjoint(replace(by_state, residual=left, force=unbalanced))
        return StateWeights(found.residual + more.residual, found.gaps, found.force + more.force)

    def _adjoint(self, by_state: StateWeights) -> StateWeights:
        """The same by one solve."""
        by_unknowns, s = by_state.residual, np.zeros(self.units.shape[1], dtype=np.float64)
        if len(s):
            try:
                s[:] = np.linalg.solve(self.gradient.T, by_unknowns @ self.units + by_state.force)
            except np.linalg.LinAlgError:
                raise NoPointsError("the load does not determine the journal's position") from None
            by_unknowns = by_unknowns - s @ self.rows
        force = -s if len(s) else np.zeros(len(by_state.force))
        return StateWeights(-self.factor.solve_transposed(by_unknowns), np.zeros(0), force)


def has_lost_digits(left: Array, size: Array) -> bool:
    """Whether what a solve leaves of some row is more than `ROUNDED` of the magnitudes of its terms."""
    return bool(np.any(np.abs(left) > ROUNDED * size))
