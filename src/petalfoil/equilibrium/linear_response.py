"""Linear response of film, wall and contacts to a small displacement of the journal (model, question 6).

Contacts that carry load stay active, and the wall follows the journal where they touch. At whirl frequency
`nu = Omega / omega`, in `exp(i nu tau)`:

    (J + i nu S) dX = -(F_e + i nu S_e) de,     dF = F_P dP + n_e^T dlam        (E4)

Isolated contacts are points between nodes, whose travel adds to `J`, `F_e` and `dF` (E12), (E13). A motion that grows
or dies out has a complex `s` in place of `i nu`. Petals that stick to each other add to `J`. A wall that loses energy
adds `i` times its loss to `J` (B5), for frequencies above zero.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.small_motion import AT_NODES
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.travelling_contacts import TravellingContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.problem import Border
from petalfoil.solvers.reduced_model import MovedSystem
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.system.coupled import CoupledProblem, Linearization

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real at zero frequency, complex otherwise."""


@dataclass(frozen=True)
class SmallMotion:
    """The system about one state, whatever the frequency.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and position.
    linearized : Linearization
        The system there.
    contacts : TravellingContacts
        Contacts that carry load.
    sticking : (n, n) sparse or None
        What friction between petals that stick adds to the tangent (E11).
    contact_model : str
        Where its contacts are, for people.
    stuck : Friction or None
        The friction that `sticking` is of.
    """

    problem: CoupledProblem
    linearized: Linearization
    contacts: TravellingContacts
    sticking: sp.csc_array | None = None
    contact_model: str = AT_NODES
    stuck: Friction | None = None

    @classmethod
    def about(cls, solution: Solution, sticking: sp.csc_array | None = None) -> SmallMotion:
        """Small motions about an equilibrium, whose isolated contacts are points that travel."""
        linearized = solution.problem.linearize(solution.x)
        return cls(solution.problem, linearized, TravellingContacts.of(solution, linearized), sticking)

    @classmethod
    def at_nodes(cls, solution: Solution, sticking: sp.csc_array | None = None) -> SmallMotion:
        """The derivative of the discrete equations: contacts stay at their nodes."""
        problem = solution.problem
        return cls(problem, problem.linearize(solution.x), TravellingContacts.at_nodes(solution), sticking)

    @property
    def film_thickness(self) -> Array:
        """Film over the reference length [1]."""
        return self.linearized.film.H

    @property
    def frictionless(self) -> Self:
        """The same, petals sliding freely on each other."""
        return replace(self, sticking=None, stuck=None)

    @cached_property
    def steady(self) -> sp.csc_array:
        """`J`, travel of contacts and friction included."""
        fixed = self.linearized.matrix(np.zeros(len(self.problem.weight)))
        travelling = sp.csc_array(fixed + self.contacts.tangent)
        return travelling if self.sticking is None else sp.csc_array(travelling + self.sticking)

    @cached_property
    def loss(self) -> sp.csc_array | None:
        """What a wall that loses energy adds to `J`, over `i` (B5), (n, n); None of others."""
        layout = self.problem.layout
        return None if layout.loss is None else layout.among_all(layout.loss)

    @cached_property
    def whirling(self) -> sp.csc_array:
        """`J` of a motion whose frequency is above zero: complex where the wall loses energy."""
        return self.steady if self.loss is None else sp.csc_array(self.steady + 1j * self.loss)

    @cached_property
    def stored(self) -> sp.csc_array:
        """`S`, the derivative of the stored mass."""
        return self.linearized.stored

    @cached_property
    def steady_forcing(self) -> Array:
        """`F_e`, travel of contacts included, (n, n_position)."""
        return np.asarray(self._gap_forcing(0.0) + self.contacts.forcing)

    @cached_property
    def stored_forcing(self) -> Array:
        """`S_e`, (n, n_position)."""
        return np.asarray(self._gap_forcing(1.0) - self._gap_forcing(0.0))

    def _gap_forcing(self, rate: float) -> Array:
        by_e = self.problem.border.gap_derivative
        return np.column_stack([self.linearized.slack_derivative(column, rate) for column in by_e.T])

    @cached_property
    def border(self) -> Border:
        """How the journal's position enters: its rows read film, contacts and their travel."""
        rows = -self.contacts.forcing.T
        rows[:, self.problem.positive] += self.problem.border.row_derivative
        problem, nodes = self.problem, self.contacts.constraints
        rubbing = None if nodes.acting is None else problem.border.by_reactions[:, self.contacts.held]
        return Border(self.contacts.gap_by_e, rows, slice(0, rows.shape[1]), rubbing)

    @property
    def elimination_key(self) -> Hashable | None:
        """Friction and contact points join unknowns that do not meet otherwise, and have their own orders."""
        own = self.problem.elimination_key
        if self.sticking is not None:
            return own, "sticking"
        return (own, "points") if own is not None and len(self.contacts.travel_stiffness) else own

    def moved_system(self, solver: LinearSolver) -> MovedSystem:
        """The same for a reduced model, in the free unknowns `y`: `dX = basis dy + N de`; one factorisation.

        For frequencies above zero.

        `N` makes the unknowns follow the journal where it touches; the reactions' force on it is `-N^T` times the rows,
        or `pull^T` times them where it rubs.
        """
        constraints, J, S = self.contacts.constraints, self.whirling, self.stored
        N = np.column_stack([constraints.close(column) for column in self.contacts.gap_by_e.T])
        pull = -N if constraints.acting is None else self._pull
        steady, stored = J @ N + self.steady_forcing, S @ N + self.stored_forcing
        rows = self.border.row_derivative
        return MovedSystem(
            solve=constraints.factor(J, solver, self.elimination_key).solve,
            S=constraints.reduce(S),
            forcing=(constraints.balanced(steady), constraints.balanced(stored)),
            force=(constraints.gather(rows.T + J.T @ pull), constraints.gather(S.T @ pull)),
            direct=(rows @ N + pull.T @ steady - self.contacts.gradient, pull.T @ stored),
        )

    @property
    def _pull(self) -> Array:
        """Force of the reactions on the journal by the rows, (n, n_position)."""
        constraints = self.contacts.constraints
        return np.column_stack([constraints.reactions_adjoint(row) for row in self.border.by_reactions])

    def respond(self, nu: float, solver: LinearSolver) -> LinearResponse:
        """The response at whirl ratio `nu`; one factorisation."""
        return self.growing(1j * nu, solver)

    def growing(self, s: complex, solver: LinearSolver) -> LinearResponse:
        """The response to a motion in `exp(s tau)`; one factorisation."""
        turning = self.whirling if s.imag >= 0.0 else sp.csc_array(self.whirling.conj())
        matrix = sp.csc_array(turning + s * self.stored) if s else self.steady
        forcing = self.steady_forcing + s * self.stored_forcing if s else self.steady_forcing
        constraints = self.contacts.constraints
        tangent = Tangent(matrix, constraints, constraints.factor(matrix, solver, self.elimination_key))
        return LinearResponse(self, tangent, forcing)


@dataclass(frozen=True)
class LinearResponse:
    """Response to the journal's displacement at one state and frequency.

    Attributes
    ----------
    motion : SmallMotion
        The state.
    factorised : Tangent
        The factorised system at the frequency, complex where this is not zero.
    forcing : (n, n_position) array
        Derivative of its rows by the journal's position.
    """

    motion: SmallMotion
    factorised: Tangent
    forcing: Values

    @cached_property
    def tangent(self) -> BorderedTangent:
        """The same with the journal's position bordered: a solve for each of its coordinates."""
        return BorderedTangent.of(self.factorised, self.motion.border, self.forcing)

    @property
    def force_gradient(self) -> Values:
        """`dF/de` of film and contacts on the journal, (n_position, n_position), over unit of force and length [1]."""
        return np.asarray(self.tangent.gradient - self.motion.contacts.gradient)

    @property
    def units(self) -> Values:
        """Change of the unknowns by a unit of each coordinate of the journal, (n, n_position)."""
        return self.tangent.units

    def moved(self, forces: Values) -> Values:
        """Change of the unknowns by forces on them, the journal held in place; (n, k) each."""
        constraints, factor = self.factorised.constraints, self.factorised.factor
        pushes = np.column_stack([constraints.balanced(force) for force in forces.T])
        moved = factor.solve(pushes.astype(self.units.dtype))
        return np.column_stack([constraints.spread(column) for column in moved.T])

    def forced(self, force: Values) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and force on the journal held in place (n_position,), by forces (n,) on them."""
        change, reactions = self.tangent.respond(-force)
        return change, self.tangent.border.rows(change, reactions)

    def slope(self) -> Values:
        """Derivative of `dF/de` by `s` [1]: with the same factor, from (E4) differentiated."""
        rates = self.motion.stored @ self.tangent.units + self.motion.stored_forcing
        return np.column_stack([self.forced(-rate)[1] for rate in rates.T])
