"""Linear response of film, wall and contacts to a small displacement of the journal (model, question 6).

Contacts that carry load stay closed, and the wall follows the journal where they touch. At whirl frequency
`nu = Omega / omega`, in `exp(i nu tau)`:

    (J + i nu S) dX = -(F_e + i nu S_e) de,     dF = F_P dP + by_e^T dlam        (E4)

A motion that grows or dies out has a complex `s` in place of `i nu`. Petals that stick to each other add to `J`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import Ties, tie
from petalfoil.solvers.sparse_lu import Factor, LinearSolver
from petalfoil.sparsity import Elimination, TiedOrder
from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.loaded import FilmForce

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real at zero frequency, complex otherwise."""


@dataclass(frozen=True)
class Motion:
    """The system about one state, whatever the frequency.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and position.
    line : Linearization
        The system there.
    closed : (m,) bool array
        Gaps that carry load.
    ties : Ties
        These gaps, eliminated.
    held : (n, n) sparse or None
        What friction between petals adds to the tangent, real where they stick (E11).
    """

    problem: CoupledProblem
    line: Linearization
    closed: NDArray[np.bool_]
    ties: Ties
    held: sp.csc_array | None = None

    @classmethod
    def about(cls, answer: Solution, held: sp.csc_array | None = None) -> Motion:
        """Small motions about an equilibrium."""
        problem, closed = answer.problem, answer.in_contact
        return cls(problem, problem.linearize(answer.x), closed, tie(problem.G, closed), held)

    @cached_property
    def smooth(self) -> sp.csc_array:
        """`J` without friction."""
        return self.line.matrix(np.zeros(len(self.closed)))

    @cached_property
    def steady(self) -> sp.csc_array:
        """`J`, friction included."""
        return self.smooth if self.held is None else sp.csc_array(self.smooth + self.held)

    @cached_property
    def stored(self) -> sp.csc_array:
        """`M`, the derivative of the stored mass."""
        return self.line.matrix(np.zeros(len(self.closed)), 1.0) - self.smooth

    @cached_property
    def rank(self) -> TiedOrder | None:
        """Orders of elimination; friction joins unknowns that do not meet otherwise, and has its own."""
        return self.ties.rank(self.problem.rank if self.held is None else Elimination())

    def respond(self, nu: float, solver: LinearSolver) -> Response:
        """Factorise the response at whirl ratio `nu`; one factorisation."""
        return self.growing(1j * nu, solver)

    def growing(self, s: complex, solver: LinearSolver) -> Response:
        """Factorise the response to a motion in `exp(s tau)`; one factorisation."""
        matrix = self.steady + s * self.stored if s else self.steady
        factor = solver.factor(self.ties.reduce(matrix.tocsc()), self.rank)
        return Response(self, factor, s)


@dataclass(frozen=True)
class Response:
    """Displacement of the journal at one state and frequency, ready to be applied.

    Attributes
    ----------
    motion : Motion
        The state.
    factor : Factor
        Reduced tangent, complex where the frequency is not zero.
    rate : complex
        `s`: `i nu` for a whirl.
    """

    motion: Motion
    factor: Factor
    rate: complex = 0.0

    def apply(self, v: Values) -> Values:
        """Tangent, with storage at the frequency, times a change of the unknowns."""
        out: Values = self.motion.steady @ v
        return out + self.rate * (self.motion.stored @ v) if self.rate else out

    def forcing(self, change: Array) -> Values:
        """Change of the equations by a change of the gaps they read, (n,)."""
        line = self.motion.line
        steady = line.by_shift(change)
        if not self.rate:
            return steady
        return steady + self.rate * self.stored_forcing(change)

    def stored_forcing(self, change: Array) -> Array:
        """Change of the stored mass by a change of the gaps it reads, (n,)."""
        line = self.motion.line
        return line.by_shift(change, 1.0) - line.by_shift(change)

    def unit(self, k: int) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and of the closed reactions (k,) by a unit displacement along axis `k`."""
        by_e, ties = self.motion.problem.layout.wall.contacts.by_e[:, k], self.motion.ties
        follow = ties.close(by_e[self.motion.closed])
        forcing = self.forcing(by_e)
        change = follow + ties.spread(self.factor.solve(-ties.gather(self.apply(follow) + forcing)))
        return change, ties.reactions(self.apply(change) + forcing)

    def pushed(self, push: Values) -> tuple[Values, Values]:
        """The same by forces on the unknowns (n,), the journal held."""
        ties = self.motion.ties
        change = ties.spread(self.factor.solve(ties.gather(push)))
        return change, ties.reactions(self.apply(change) - push)

    def force(self, change: Values, reactions: Values) -> Values:
        """`dF` of film and contacts on the journal by changes of the unknowns and of the closed reactions, (2,) [1]."""
        problem = self.motion.problem
        by_e = problem.layout.wall.contacts.by_e[self.motion.closed]
        force: Values = FilmForce.of(problem).by_P @ change[problem.positive] + by_e.T @ reactions
        return force

    def units(self) -> tuple[Values, Values]:
        """Both unit displacements: changes of the unknowns (n, 2), and `dF/de` (2, 2) of film and contacts (E4) [1]."""
        both = [self.unit(k) for k in range(self.motion.problem.layout.wall.contacts.by_e.shape[1])]
        columns = [self.force(change, reactions) for change, reactions in both]
        return np.column_stack([change for change, _ in both]), np.column_stack(columns)

    def slope(self) -> Values:
        """Derivative of `dF/de` by `s`, (2, 2) [1]: with the same factor, from (E4) differentiated."""
        ties, by_e = self.motion.ties, self.motion.problem.layout.wall.contacts.by_e
        columns = []
        for k in (0, 1):
            stored = self.motion.stored @ self.unit(k)[0] + self.stored_forcing(by_e[:, k])
            change = ties.spread(self.factor.solve(-ties.gather(stored)))
            columns.append(self.force(change, ties.reactions(self.apply(change) + stored)))
        return np.column_stack(columns)

    def force_gradient(self) -> Values:
        """`dF/de` of film and contacts on the journal, (2, 2), over unit of force and length [1]."""
        return self.units()[1]
