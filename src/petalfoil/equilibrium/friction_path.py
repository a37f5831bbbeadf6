"""A problem with friction between its petals, moved a step further: what it does depends on what it did.

F(x) + B^T T = G^T lam,  gaps as without friction       (C1) with (D2)
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.cone import ConeProblem, Linearized
from petalfoil.solvers.contact_newton import ActiveOptions, ContactState, Outcome, evaluate, revise, searched
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.system.friction import FrictionState, FrictionStep, energy_lost, held_together

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

AGREE = 1e-9
"""Change of the reactions, over the largest, below which the friction's limits agree with them."""

STEPS = 60
"""Most steps of Newton with one contact set: gaps stick or slip anew on the way, and friction follows the reactions."""

CYCLING = 2
"""Steps after which sticking and slipping may come back to where they were: secants take the derivatives' place."""

SETS = 30
"""Most contact sets of a round."""

SIGNS = ActiveOptions()
"""Residual and signs of an answer."""


@dataclass(frozen=True)
class FrictionProblem:
    """A problem with friction on some of its gaps.

    Attributes
    ----------
    base : ConeProblem
        The problem without friction; its first unknowns are the deflections.
    rubbing : FrictionStep
        Friction in this step.
    """

    base: ConeProblem
    rubbing: FrictionStep
    rank: None = field(default=None, init=False)

    @property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps, (m, n)."""
        return self.base.G

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,)."""
        return self.base.weight

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive."""
        return self.base.positive

    def gaps(self, x: Array) -> Array:
        """Gaps at `x`, (m,)."""
        return self.base.gaps(x)

    def admits(self, x: Array) -> bool:
        """The equations can be evaluated at `x`."""
        return self.base.admits(x)

    def linearize(self, x: Array, shift: Array | None = None) -> FrictionLinearization:
        """The equations at `x`."""
        return FrictionLinearization(self.base.linearize(x, shift), self.rubbing, x)


@dataclass(frozen=True)
class FrictionLinearization:
    """The equations with friction at one point."""

    line: Linearized
    rubbing: FrictionStep
    x: Array

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        return self.rubbing.law(self.x)

    @cached_property
    def residual(self) -> Array:
        """`F(x) + B^T T`, (n,)."""
        out, B = self.line.residual.copy(), self.rubbing.friction.slip
        out[: B.shape[1]] += B.T @ self._law[1]
        return out

    @property
    def size(self) -> Array:
        """What each row's residual is measured by, (n,)."""
        return self.line.size

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent with `B^T (dT/ds) B`, (n, n)."""
        held = held_together(self.rubbing.friction, self._law[2], len(self.x))
        return sp.csc_array(self.line.matrix(theta, rate) + held)

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Friction reads slips, not gaps."""
        return self.line.by_shift(shift, rate)


@dataclass(frozen=True)
class FrictionResult:
    """A state after a step: contacts, slip and friction, and the energy that it lost to friction.

    Attributes
    ----------
    x, lam, closed, residual
        Unknowns (n,), reactions (m,), closed gaps (m,), largest scaled residual.
    rubbed : FrictionState
        Slip and friction force.
    lost : float
        Energy lost in the step (D3), in the units of the problem.
    """

    x: Array
    lam: Array
    closed: Mask
    residual: float
    rubbed: FrictionState
    lost: float


def slide(
    problem: ConeProblem, friction: Friction, before: tuple[Array, Array, Mask, FrictionState], solver: LinearSolver
) -> FrictionResult | None:
    """Equilibrium from the state `before` (unknowns, reactions, closed gaps, friction); None if not found."""
    x, lam, closed, rubbed = before
    friction = friction.in_step(lam)
    rubbing, doubt = FrictionStep(friction, rubbed, friction.normal(lam)), np.zeros(len(closed), dtype=bool)
    for count in range(SETS):
        found = settled(problem, rubbing, (x, closed), solver)
        if found is None:
            return None
        state, rubbing = found
        sliding = FrictionProblem(problem, rubbing)
        wanted = revise(sliding, state, SIGNS)
        if np.array_equal(wanted, closed):
            after = rubbing.after(state.x)
            return FrictionResult(
                state.x, state.lam, closed, state.residual, after, energy_lost(friction, rubbed, after)
            )
        doubt |= wanted != closed
        x, closed = state.x, wanted
        sought = searched(sliding, state, doubt, solver) if count else None
        if isinstance(sought, ContactState):
            x, closed = sought.x, sought.closed
    return None


def settled(
    problem: ConeProblem, rubbing: FrictionStep, start: tuple[Array, Mask], solver: LinearSolver
) -> tuple[ContactState, FrictionStep] | None:
    """Newton with the gaps of `start` closed until forces balance and friction agrees with them; None if it fails."""
    (x, closed), friction = start, rubbing.friction
    state, last = evaluate(FrictionProblem(problem, rubbing), x, closed), x
    for step in range(STEPS):
        if isinstance(state, Outcome):
            return None
        normal = friction.normal(state.lam)
        away, most = (float(np.max(np.abs(part), initial=0.0)) for part in (normal - rubbing.normal, normal))
        if state.residual <= SIGNS.tolerance and away <= AGREE * most:
            return state, rubbing
        rubbing = replace(rubbing, normal=normal)
        leading = rubbing.between(state.x, last) if step >= CYCLING else rubbing
        line = FrictionProblem(problem, leading).linearize(state.x)
        try:
            factor = solver.factor(state.ties.reduce(line.matrix(np.zeros(len(closed)))))
        except SingularMatrixError:
            return None
        change = state.ties.spread(factor.solve(-state.ties.gather(line.residual)))
        last = state.x
        state = evaluate(FrictionProblem(problem, rubbing), state.x + change, closed)
    return None
