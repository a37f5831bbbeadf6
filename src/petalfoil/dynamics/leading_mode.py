"""The leading mode of film and petals at a fixed journal: its eigenvalue follows a changed equilibrium to first order.

With right and left vectors of `J u + s M u = 0` (E1), the quotient

    s = -(y^T J u) / (y^T M u)                                                                         (V6)

is stationary in both: with the vectors of one equilibrium and the matrices of a neighbour, its derivative along a
change of the equilibrium is that of the eigenvalue.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.dynamics.film_stability import held_contacts, leading_eigenvalue, pencil_of
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.constraints import ContactConstraints
from petalfoil.solvers.sparse_lu import LinearSolver

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

OFF = 1e-3
"""Shift from the eigenvalue at which vectors are iterated, over its size: near it, and not quite singular."""

ITERATIONS = 12
"""Each takes three digits off what is left of other modes, unless one is nearly as close."""

SETTLED = 1e-9
"""Relative change of the quotient at which the vectors are taken."""


@dataclass(frozen=True)
class LeadingMode:
    """The leading mode of an equilibrium.

    Attributes
    ----------
    constraints : ContactConstraints
        Its active contacts, held.
    right, left : (n_free,) complex array
        Vectors `u` and `y`.
    """

    constraints: ContactConstraints
    right: Complex
    left: Complex

    @classmethod
    def of(cls, solution: Solution) -> LeadingMode:
        """Find the mode by inverse iteration.

        Raises
        ------
        ConvergenceError
            The shaft does not turn, or another mode is as near.
        """
        start = leading_eigenvalue(solution)
        if not np.isfinite(start):
            raise ConvergenceError(
                "no growth rate to differentiate: the shaft does not turn", advice="give a speed above zero"
            )
        constraints = held_contacts(solution)
        J, M = matrices(solution, constraints)
        shift = start + OFF * abs(start) * (1.0 + 1.0j if start.imag else 1.0)
        solver = current_run().probe_solver
        mode = cls(constraints, *vectors(J, M, shift, solver))
        value = mode.eigenvalue(solution)
        if not abs(value - start) <= OFF * abs(value):
            raise ConvergenceError(
                "no derivative of the growth rate: another mode is as near as the leading one",
                advice="ask for other results, or change the case a little",
            )
        return mode

    def eigenvalue(self, solution: Solution) -> complex:
        """The quotient (V6) of an equilibrium, in radians of rotation."""
        J, M = matrices(solution, self.constraints)
        return complex(-(self.left @ (J @ self.right)) / (self.left @ (M @ self.right)))


def matrices(solution: Solution, constraints: ContactConstraints) -> tuple[sp.csc_array, sp.csc_array]:
    """`J` and `M` of an equilibrium over the unknowns that are free under `constraints`, or with contact points all."""
    if solution.elements is not None:
        pencil = pencil_of(solution.elements.equations)
        return pencil.J, pencil.M
    linearized = solution.problem.linearize(solution.x)
    steady = linearized.matrix(np.zeros(len(solution.problem.weight)))
    return constraints.reduce(steady), constraints.reduce(linearized.stored)


def vectors(J: sp.csc_array, M: sp.csc_array, shift: complex, solver: LinearSolver) -> tuple[Complex, Complex]:
    """Right and left vector of the eigenvalue nearest to `shift`, by inverse iteration from both sides."""
    shifted = sp.csc_array(J + shift * M)
    right, left = solver.factor(shifted), solver.factor(sp.csc_array(shifted.T))
    u = np.random.default_rng(0).standard_normal(J.shape[0]) + 0.0j
    y, value = u.copy(), 0.0 + 0.0j
    for _ in range(ITERATIONS):
        u, y = right.solve(M @ u), left.solve(M.T @ y)
        u, y = u / np.linalg.norm(u), y / np.linalg.norm(y)
        last, value = value, complex(-(y @ (J @ u)) / (y @ (M @ u)))
        if abs(value - last) <= SETTLED * abs(value):
            break
    return u, y
