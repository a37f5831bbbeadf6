"""Active contacts of an equilibrium in its linear response: isolated ones are points that travel (model, question 6).

With `n` the derivative of the gap at the points by the unknowns, `n'` that of its slope, and `n_e`, `n'_e` the same by
the journal's position, a small motion keeps `n dx + n_e de = 0`, and reactions that travel with their points add

    (lam / p'') n'^T (n' dx + n'_e de)       to the rows of the wall                                    (E12)
    -(lam / p'') n'_e^T (n' dx + n'_e de)    to the force on the journal                                (E13)

This tangent converges with the grid. It is not the derivative of the discrete equations, whose contacts jump from node
to node: Newton's method for equilibria keeps that one.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.point_constraints import PointConstraints, constrain_points
from petalfoil.solvers.tangent import GapRows
from petalfoil.sparsity import SparseRows
from petalfoil.system.coupled import CoupledProblem, Linearization

Array = NDArray[np.float64]


class PlacedPoints(Protocol):
    """Contacts at nodes and at points, as the linear response reads them."""

    @property
    def at_nodes(self) -> NDArray[np.bool_]:
        """Contacts at nodes, (m,)."""

    @property
    def value(self) -> sp.csr_array:
        """Gap at the points, from the gaps at the nodes, (k, m) [1]."""

    @property
    def slope(self) -> sp.csr_array:
        """Slope of the gap at the points, likewise, (k, m) [1/rad]."""

    @property
    def travel_stiffness(self) -> Array:
        """`lam / p''` of (E12), in units of reaction over gap, (k,) [rad^2]."""


class NodalContacts(Protocol):
    """A state with contacts at nodes."""

    @property
    def problem(self) -> CoupledProblem:
        """Speed and position."""

    @property
    def x(self) -> Array:
        """Unknowns, (n,) [1]."""

    @property
    def lam(self) -> Array:
        """Reactions, (m,) [1]."""

    @property
    def active(self) -> NDArray[np.bool_]:
        """Contacts that carry load, (m,)."""

    @property
    def load(self) -> Array | None:
        """Load that it balances over the unit of force, (n_position,) [1]; None at a fixed position."""


@dataclass(frozen=True)
class TravellingContacts:
    """Active contacts and what they add to the linear response.

    Attributes
    ----------
    constraints : PointConstraints
        Contacts at nodes, then the points.
    gap_by_e : (k, d) array
        `n_e` of all of them [1].
    slope_by_x : (j, n) sparse
        `n'` of the points [1/rad].
    slope_by_e : (j, d) array
        `n'_e` of the points [1/rad].
    travel_stiffness : (j,) array
        `lam / p''` [rad^2].
    held : (m,) bool array
        Contacts at nodes among all gaps.
    """

    constraints: PointConstraints
    gap_by_e: Array
    slope_by_x: sp.csr_array
    slope_by_e: Array
    travel_stiffness: Array
    held: NDArray[np.bool_]

    @classmethod
    def of(cls, solution: Solution, linearized: Linearization) -> TravellingContacts:
        """Those of an equilibrium; where there are points, one factorisation tells where they are (K8)."""
        problem, active = solution.problem, solution.active
        if problem.acting is not problem.G:  # (E12) is that of reactions along the gaps alone
            return cls.at_nodes(solution)
        if not constrain(problem.G, active).determinate:  # bottomed out
            return cls.at_nodes(solution)
        points = placed_points(solution, linearized)
        at_points = float(solution.lam[active & ~points.at_nodes].sum() / max(solution.lam.sum(), 1e-300))
        count = len(points.travel_stiffness)
        current_run().note("contact points", points=count, nodes=int(points.at_nodes.sum()), carried=at_points)
        return travelling_contacts((problem.G, problem.G), problem.layout.wall.contacts.by_e, points)

    @classmethod
    def at_nodes(cls, solution: Solution) -> TravellingContacts:
        """Those of an equilibrium, all at their nodes."""
        problem, contacts = solution.problem, solution.problem.layout.wall.contacts
        rows = problem.G, problem.acting
        return travelling_contacts(rows, contacts.by_e, IsolatedContacts((), solution.active))

    @cached_property
    def tangent(self) -> sp.csc_array:
        """`n'^T (lam / p'') n'`, (n, n)."""
        return sp.csc_array(self.slope_by_x.T @ sp.diags_array(self.travel_stiffness) @ self.slope_by_x)

    @cached_property
    def forcing(self) -> Array:
        """`n'^T (lam / p'') n'_e`, (n, d)."""
        return np.asarray(self.slope_by_x.T @ (self.travel_stiffness[:, None] * self.slope_by_e))

    @cached_property
    def gradient(self) -> Array:
        """`n'_e^T (lam / p'') n'_e`, (d, d)."""
        return np.asarray(self.slope_by_e.T @ (self.travel_stiffness[:, None] * self.slope_by_e))


def placed_points(solution: NodalContacts, linearized: Linearization) -> IsolatedContacts:
    """Contact points of an equilibrium whose contacts determine it, where they are (K8): one factorisation."""
    problem, active = solution.problem, solution.active
    points = IsolatedContacts.of(problem.layout.wall.contacts, problem.gaps(solution.x), solution.lam, active)
    matrix = linearized.matrix(np.zeros(len(active)))
    return points.placed(turning_compliance(problem.G, matrix, points, problem.elimination_key))


def travelling_contacts(gaps: GapRows, by_e: Array, points: PlacedPoints) -> TravellingContacts:
    """Contacts at nodes and points of gaps, whose derivative and unit reactions are `gaps`; `by_e` is (m, d)."""
    G, acting = gaps
    return TravellingContacts(
        constraints_of(G, points, acting),
        np.vstack([by_e[points.at_nodes], points.value @ by_e]),
        sp.csr_array(points.slope @ G),
        points.slope @ by_e,
        points.travel_stiffness,
        points.at_nodes,
    )


def constraints_of(G: SparseRows, points: PlacedPoints, acting: SparseRows | None = None) -> PointConstraints:
    """Gaps at nodes and points kept closed."""
    return constrain_points(constrain(G, points.at_nodes, acting=acting), sp.csr_array(points.value @ G))


def turning_compliance(G: SparseRows, matrix: sp.csc_array, points: IsolatedContacts, key: Hashable | None) -> Array:
    """Turn of the gap at each point by a unit moment on its whole contact line, points pinned, (k,).

    `matrix` (n, n) is the tangent, `key` that of its elimination orders. One factorisation, a solve for each line.
    """
    constraints, slope_by_x, line = constraints_of(G, points), points.slope @ G, points.contact_line
    compliance = np.zeros(len(line))
    if not len(line):
        return compliance
    factor = constraints.factor(matrix, current_run().probe_solver, key)
    for number in range(int(line.max()) + 1):
        mine = line == number
        turned = constraints.spread(factor.solve(constraints.gather(slope_by_x.T @ mine.astype(float))))
        compliance[mine] = (slope_by_x @ turned)[mine]
    return compliance
