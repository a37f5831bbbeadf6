"""A package with friction, moved a step further: what it does depends on what it did."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.friction import Friction
from petalfoil.problem.sliding import Gapped, Rubbed, Rubbing, SlidingProblem, energy_lost
from petalfoil.solvers.active_set import ActiveOptions, Outcome, State, evaluate, revise, searched
from petalfoil.solvers.linear import LinearSolver, SingularMatrixError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

AGREE = 1e-10
"""Change of the reactions, over the largest, below which the friction's limits agree with them."""

ROUNDS = 60
"""Most rounds of friction and reactions; each takes a tenth or less of the difference away."""

STEPS = 40
"""Most steps of Newton in which gaps stick or slip anew."""

SETS = 30
"""Most contact sets of a round."""

SIGNS = ActiveOptions()
"""Residual and signs of an answer."""


@dataclass(frozen=True)
class Slid:
    """A state after a step: contacts, slip and friction, and the energy that it lost to friction.

    Attributes
    ----------
    x, lam, closed, residual
        Unknowns (n,), reactions (m,), closed gaps (m,), largest scaled residual.
    rubbed : Rubbed
        Slip and friction force.
    lost : float
        Energy lost in the step (D3), in the units of the problem.
    """

    x: Array
    lam: Array
    closed: Mask
    residual: float
    rubbed: Rubbed
    lost: float


def slide(
    problem: Gapped, friction: Friction, before: tuple[Array, Array, Mask, Rubbed], solver: LinearSolver
) -> Slid | None:
    """Equilibrium from the state `before` (unknowns, reactions, closed gaps, friction); None if not found."""
    x, lam, closed, rubbed = before
    normal, scale = friction.normal(lam), 0.0
    for _ in range(ROUNDS):
        sliding = SlidingProblem(problem, Rubbing(friction, rubbed, normal))
        found = in_contact(sliding, x, closed, solver)
        if found is None:
            return None
        pushed = friction.normal(found.lam)
        scale = max(scale, float(np.max(np.abs(pushed), initial=0.0)))
        away = float(np.max(np.abs(pushed - normal), initial=0.0))
        x, closed, normal = found.x, found.closed, pushed
        if away <= AGREE * max(scale, 1e-300):
            after = sliding.rubbing.after(found.x)
            energy = energy_lost(friction, rubbed, after)
            return Slid(found.x, found.lam, found.closed, found.residual, after, energy)
    return None


def in_contact(problem: SlidingProblem, x: Array, closed: Mask, solver: LinearSolver) -> State | None:
    """The equilibrium at given limits of friction, its contact set corrected only where forces balance."""
    doubt = np.zeros(len(closed), dtype=bool)
    for count in range(SETS):
        state = settled(problem, x, closed, solver)
        if state is None:
            return None
        wanted = revise(problem, state, SIGNS)
        if np.array_equal(wanted, closed):
            return state
        doubt |= wanted != closed
        x, closed = state.x, wanted
        sought = searched(problem, state, doubt, solver) if count else None
        if isinstance(sought, State):
            x, closed = sought.x, sought.closed
    return None


def settled(problem: SlidingProblem, x: Array, closed: Mask, solver: LinearSolver) -> State | None:
    """Newton with the gaps `closed`: which gaps stick and which slip settles on the way; None if it does not."""
    state = evaluate(problem, x, closed)
    for _ in range(STEPS):
        if isinstance(state, Outcome):
            return None
        if state.residual <= SIGNS.tolerance:
            return state
        try:
            factor = solver.factor(state.ties.reduce(state.line.matrix(np.zeros(len(closed)))))
        except SingularMatrixError:
            return None
        state = evaluate(
            problem, state.x + state.ties.spread(factor.solve(-state.ties.gather(state.line.residual))), closed
        )
    return None
