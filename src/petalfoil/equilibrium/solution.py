"""An equilibrium of film, wall and contacts, and how it was reached."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.cone import ConePoint, Linearized, scaled_residual
from petalfoil.solvers.contact_newton import Closed
from petalfoil.system.coupled import RESIDUAL_TOLERANCE, CoupledProblem

Array = NDArray[np.float64]

REFINEMENTS = 4
"""Corrections below the last digit: one usually ends them, and none helps after three."""

WORTH = 0.5
"""A correction that leaves more than this of the residual is the last."""


@dataclass(frozen=True)
class RefinedState:
    """Deflections and pressures, with what of the deflections lies below the last digit of `x`.

    Attributes
    ----------
    x : (n,) array
        Deflections and pressures [1].
    fine : (n_wall,) array
        Rest of the deflections, smaller than the last digit of `x` [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    """

    x: Array
    fine: Array
    lam: Array


@dataclass(frozen=True)
class Solution:
    """A converged state.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and journal position that it belongs to.
    state : RefinedState
        Deflections, pressures, reactions.
    residual : float
        Largest scaled residual: wall rows by ambient pressure, film rows by their flows, complementarity by
        `|min(g, lam)|`.
    way : str
        How it was reached, for people.
    closed : Closed or None
        Contact set and last tangent; None where the interior point had the last word.
    """

    problem: CoupledProblem
    state: RefinedState
    residual: float
    way: str
    closed: Closed | None = field(default=None, repr=False)

    @property
    def x(self) -> Array:
        """Deflections and pressures, (n,) [1]."""
        return self.state.x

    @property
    def lam(self) -> Array:
        """Contact reactions, (m,) [1]."""
        return self.state.lam

    @property
    def in_contact(self) -> NDArray[np.bool_]:
        """Gaps that carry load, (m,)."""
        if self.closed is not None:
            return self.closed.closed
        return self.lam / self.problem.weight > self.problem.gaps(self.x)


def total_residual(problem: CoupledProblem, state: RefinedState, line: Linearized | None = None) -> float:
    """Largest scaled residual of a state, from the state alone; `line` is its linearisation, if it is at hand.

    Rows of wall and film by their sizes; gaps and reactions (over their weight) by `|min(g, lam)|`, which is zero
    exactly when both are non-negative and one of them vanishes.
    """
    line = line or problem.linearize(state.x, fine=state.fine)
    rows = scaled_residual(line, problem.G.T @ state.lam)
    mismatch = np.minimum(problem.gaps(state.x), state.lam / problem.weight)
    return max(rows, float(np.max(np.abs(mismatch), initial=0.0)))


def from_closed(problem: CoupledProblem, closed: Closed | None, way: str) -> Solution | None:
    """The answer of the active set, refined below the last digit of its deflections; None if it is none."""
    if closed is None:
        return None
    return accepted(Solution(problem, *refine(problem, closed), way, closed))


def from_point(problem: CoupledProblem, point: ConePoint, way: str) -> Solution | None:
    """The answer of the interior point, its slacks dropped; None if it is none."""
    state = RefinedState(point.x, np.zeros(problem.layout.n_wall), point.lam)
    return accepted(Solution(problem, state, total_residual(problem, state), way))


def accepted(answer: Solution) -> Solution | None:
    """`answer`, if its residual makes it one."""
    return answer if answer.residual <= RESIDUAL_TOLERANCE else None


def refine(problem: CoupledProblem, closed: Closed) -> tuple[RefinedState, float]:
    """The answer after iterative refinement with the tangent at hand (R1), and its residual; no factorisation.

    Deflections are corrected below their last digit, so that the wall's rows, which lose it as `dphi^-4`, balance.
    """
    n, ties = problem.layout.n_wall, closed.ties
    state = RefinedState(closed.x, np.zeros(n), closed.lam)
    if not n:
        return state, total_residual(problem, state, closed.line)
    line = problem.linearize(state.x, fine=state.fine)
    best, least = state, total_residual(problem, state, line)
    for _ in range(REFINEMENTS):
        change = ties.spread(closed.factor.solve(-ties.gather(line.residual)))
        rest = state.fine + change[:n]
        x = state.x + np.concatenate([rest, change[n:]])
        fine = rest - (x[:n] - state.x[:n])  # exactly what the sum has lost
        line = problem.linearize(x, fine=fine)
        lam = np.zeros(len(closed.closed))
        lam[closed.closed] = ties.reactions(line.residual)
        state = RefinedState(x, fine, lam)
        before, residual = least, total_residual(problem, state, line)
        if residual < least:
            best, least = state, residual
        if residual > WORTH * before:
            break
    return best, least
