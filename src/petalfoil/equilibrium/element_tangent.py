"""A step of Newton's method for petals of Hermite elements, under a load with the journal's position bordered.

With the tangent `J`, the derivatives `F_e` of the rows by the position, and those of the force, `R` and `R_e`,

    J dX + F_e de = -F ,     R dX + R_e de = -(force + load)                                            (C10)

One factorisation of `J` serves both; without a load `de` vanishes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.parameter_response import StateWeights
from petalfoil.equilibrium.small_motion import TangentEquations
from petalfoil.equilibrium.under_load import FORCE_TOLERANCE
from petalfoil.solvers.near_factor import Inverse
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.system.loaded import load_scale

Array = NDArray[np.float64]


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
class ElementTangent:
    """The tangent at one state, factorised.

    Attributes
    ----------
    factor : Inverse
        `J`, ready to solve with.
    units : (n, n_position) array
        Change of the unknowns by a unit of each coordinate of the journal; no columns without a load.
    rows : (n_position, n) array
        `R`.
    gradient : (n_position, n_position) array
        Force by the journal's position, unknowns following.
    """

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
            return cls(factor, np.zeros((equations.n, 0)), np.zeros((0, equations.n)), np.zeros((0, 0)))
        units, rows = factor.solve(-equations.forcing()), equations.force_rows
        return cls(factor, units, rows, rows @ units + equations.force_direct)

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
        try:
            move = np.linalg.solve(self.gradient, -force - self.rows @ own)
        except np.linalg.LinAlgError:
            raise NoPointsError("the load does not determine the journal's position") from None
        return own + self.units @ move, move

    def adjoint(self, by_state: StateWeights) -> StateWeights:
        """Derivatives of a result along the equilibrium by the rates of the equations (V11); one transposed solve.

        Raises
        ------
        NoPointsError
            The journal's position is not determined.
        """
        by_unknowns, s = by_state.residual, np.zeros(self.units.shape[1], dtype=np.float64)
        if len(s):
            try:
                s[:] = np.linalg.solve(self.gradient.T, by_unknowns @ self.units + by_state.force)
            except np.linalg.LinAlgError:
                raise NoPointsError("the load does not determine the journal's position") from None
            by_unknowns = by_unknowns - s @ self.rows
        force = -s if len(s) else np.zeros(len(by_state.force))
        return StateWeights(-self.factor.solve_transposed(by_unknowns), np.zeros(0), force)
