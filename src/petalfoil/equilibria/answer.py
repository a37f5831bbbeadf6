"""An equilibrium of film, wall and contacts, and how it was reached."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.problem.coupled import CoupledProblem
from petalfoil.solvers.active_set import Closed
from petalfoil.solvers.cone import ConePoint, scaled_residual

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Answer:
    """A converged state.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and journal position that it belongs to.
    x : (n,) array
        Deflections and pressures [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    residual : float
        Largest scaled residual: wall and film rows by their sizes, complementarity by `|min(g, lam)|`.
    way : str
        How it was reached, for people.
    closed : Closed or None
        Contact set and last tangent; None where the interior point had the last word.
    """

    problem: CoupledProblem
    x: Array
    lam: Array
    residual: float
    way: str
    closed: Closed | None = field(default=None, repr=False)

    @property
    def in_contact(self) -> NDArray[np.bool_]:
        """Gaps that carry load, (m,)."""
        if self.closed is not None:
            return self.closed.closed
        return self.lam / self.problem.weight > self.problem.gaps(self.x)


def total_residual(problem: CoupledProblem, x: Array, lam: Array) -> float:
    """Largest scaled residual of a state, from the state alone.

    Rows of wall and film by their sizes; gaps and reactions (over their weight) by `|min(g, lam)|`, which is zero
    exactly when both are non-negative and one of them vanishes.
    """
    rows = scaled_residual(problem.linearize(x), problem.G.T @ lam)
    mismatch = np.minimum(problem.gaps(x), lam / problem.weight)
    return max(rows, float(np.max(np.abs(mismatch), initial=0.0)))


def from_closed(problem: CoupledProblem, closed: Closed, way: str) -> Answer:
    """The answer of the active set."""
    return Answer(problem, closed.x, closed.lam, total_residual(problem, closed.x, closed.lam), way, closed)


def from_point(problem: CoupledProblem, point: ConePoint, way: str) -> Answer:
    """The answer of the interior point, its slacks dropped."""
    return Answer(problem, point.x, point.lam, total_residual(problem, point.x, point.lam), way)
