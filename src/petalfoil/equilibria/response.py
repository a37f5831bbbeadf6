"""Linear response of film, wall and contacts to a small displacement of the journal (model, question 6).

Contacts that carry load stay closed, and the wall follows the journal where they touch. At whirl frequency
`nu = Omega / omega`, in `exp(i nu tau)`:

    (J + i nu S) dX = -(F_e + i nu S_e) de,     dF = F_P dP + by_e^T dlam        (E4)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from petalfoil.problem.balance import FilmForce
from petalfoil.problem.coupled import CoupledProblem, Linearization
from petalfoil.solvers.linear import Factor, LinearSolver
from petalfoil.solvers.ties import Ties, tie

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real at zero frequency, complex otherwise."""


@dataclass(frozen=True)
class Response:
    """Displacement of the journal at one state and frequency, ready to be applied.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and position.
    line : Linearization
        The system there.
    ties : Ties
        Contacts that carry load.
    factor : Factor
        Reduced tangent, complex where the frequency is not zero.
    rate : complex
        `i nu`.
    """

    problem: CoupledProblem
    line: Linearization
    ties: Ties
    factor: Factor
    closed: NDArray[np.bool_]
    rate: complex

    def apply(self, v: Values) -> Values:
        """Tangent, with storage at the frequency, times a change of the unknowns."""
        none = np.zeros(len(self.closed))
        steady = self.line.matrix(none)
        out: Values = steady @ v
        if self.rate:
            out = out + self.rate * ((self.line.matrix(none, 1.0) - steady) @ v)
        return out

    def forcing(self, change: Array) -> Values:
        """Change of the equations by a change of the gaps they read, (n,)."""
        steady = self.line.by_shift(change)
        if not self.rate:
            return steady
        return steady + self.rate * (self.line.by_shift(change, 1.0) - steady)

    def unit(self, k: int) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and of the closed reactions (k,) by a unit displacement along axis `k`."""
        by_e = self.problem.layout.wall.contacts.by_e[:, k]
        follow = self.ties.close(by_e[self.closed])
        force = self.apply(follow) + self.forcing(by_e)
        change = follow + self.ties.spread(self.factor.solve(-self.ties.gather(force)))
        return change, self.ties.reactions(self.apply(change) + self.forcing(by_e))

    def force_gradient(self) -> Values:
        """`dF/de` of film and contacts on the journal, (2, 2), over unit of force and length [1]."""
        film, by_e = FilmForce.of(self.problem), self.problem.layout.wall.contacts.by_e[self.closed]
        columns = []
        for k in (0, 1):
            change, reaction = self.unit(k)
            columns.append(film.by_P @ change[self.problem.positive] + by_e.T @ reaction)
        return np.column_stack(columns)


def respond(state: tuple[CoupledProblem, Array, NDArray[np.bool_]], nu: float, solver: LinearSolver) -> Response:
    """Factorise the response at `state` (problem, unknowns, closed gaps) and whirl ratio `nu`; one factorisation."""
    problem, x, closed = state
    line, ties, rate = problem.linearize(x), tie(problem.G, closed), 1j * nu
    none = np.zeros(len(closed))
    matrix = line.matrix(none)
    if nu:
        matrix = matrix + rate * (line.matrix(none, 1.0) - matrix)
    factor = solver.factor(ties.reduce(matrix.tocsc()), ties.rank(problem.rank))
    return Response(problem, line, ties, factor, closed, rate)
