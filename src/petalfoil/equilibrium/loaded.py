"""An equilibrium under a load, and the force that is left over in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.solution import Solution
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.loaded import FilmForce

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Balance:
    """An equilibrium under a load.

    Attributes
    ----------
    answer : Solution
        The state, at the journal's position.
    force_residual : float
        Force left over, over the load [1].
    """

    answer: Solution
    force_residual: float


def journal_force(problem: CoupledProblem, P: Array, lam: Array) -> Array:
    """Force of film and contacts on the journal over the unit of force, (2,) [1]."""
    force: Array = FilmForce.of(problem).at(P) + problem.layout.wall.contacts.by_e.T @ lam
    return force


def force_residual(answer: Solution, load: Array) -> float:
    """Force left over, over the load [1]."""
    force = journal_force(answer.problem, answer.x[answer.problem.positive], answer.lam)
    return float(np.hypot(*(force + load)) / size_of(load))


def size_of(load: Array) -> float:
    """What a force left over is measured by: the load, or a thousandth of the unit of force if it is less."""
    return max(float(np.hypot(*load)), 1e-3)
