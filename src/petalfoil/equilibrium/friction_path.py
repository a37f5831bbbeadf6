"""A problem with friction between its petals, moved a step further: what it does depends on what it did."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_equations import ContactEquations, ContactOptions, ContactState, Step, StepVerdict
from petalfoil.solvers.contact_newton import contact_newton
from petalfoil.solvers.problem import ContactProblem
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionProblem, FrictionState, FrictionStep, energy_lost

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

AGREE = 1e-9
"""Change of the reactions, over the largest, below which the friction's limits agree with them."""

CYCLING = 2
"""Tangents with one contact set after which sticking and slipping may recur in turns: secants replace derivatives."""

SLIDING = ContactOptions(tangents=600, steps=1, revise_early=False)
"""Friction follows the reactions a correction late: it is solved on one contact set before the set is corrected."""


@dataclass(frozen=True)
class FrictionEquations(ContactEquations):
    """The variant with friction, whose limits follow the reactions and whose tangent may be a secant."""

    problem: FrictionProblem

    def renewed(self, state: ContactState, before: ContactState, count: int) -> Self:
        """Limits by the reactions of `state`; secants after some tangents."""
        step = self.problem.step.limited(state.lam)
        return replace(
            self, problem=replace(self.problem, step=step.between(state.x, before.x) if count >= CYCLING else step)
        )

    def verdict(self, step: Step, options: ContactOptions) -> StepVerdict:
        """By the residual; and the limits must agree with the reactions."""
        verdict = super().verdict(step, options)
        if verdict is not StepVerdict.CONVERGED or step.after is None:
            return verdict
        normal = self.problem.step.friction.normal(step.after.lam)
        away = np.max(np.abs(normal - self.problem.step.normal), initial=0.0)
        return verdict if away <= AGREE * np.max(normal, initial=0.0) else StepVerdict.RENEW


@dataclass(frozen=True)
class FrictionResult:
    """A state after a step: contacts, slip and friction, and the energy that it lost to friction.

    Attributes
    ----------
    x, lam, active, residual
        Unknowns (n,), reactions (m,), active contacts (m,), largest scaled residual.
    friction : FrictionState
        Slip and friction force.
    lost : float
        Energy lost in the step (D3), in the units of the problem.
    """

    x: Array
    lam: Array
    active: Mask
    residual: float
    friction: FrictionState
    lost: float


def slide(
    problem: ContactProblem, friction: Friction, before: FrictionResult, solver: LinearSolver
) -> FrictionResult | None:
    """Equilibrium of `problem` after the state `before`; None if not found."""
    step = FrictionStep.beginning(friction, before.friction, before.lam)
    equations = FrictionEquations(FrictionProblem(problem, step))
    contacts, _ = contact_newton(equations, (before.x, np.zeros(0), before.active), solver, SLIDING)
    if contacts is None:
        return None
    state = contacts.state
    after = step.limited(state.lam).after(state.x)
    lost = energy_lost(step.friction, before.friction, after)
    return FrictionResult(state.x, state.lam, state.active, state.residual, after, lost)
