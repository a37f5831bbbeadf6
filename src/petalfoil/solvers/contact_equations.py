"""What Newton's method on active contacts solves, and an iterate of it.

A variant is a `ContactEquations`: which equations, which bordered unknowns beside them (none at a fixed position, the
journal's position under a load or in a time step), which terms follow the reactions a correction late (friction), and
when a step ends the iteration.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints
from petalfoil.solvers.problem import (
    RESIDUAL_TOLERANCE,
    Border,
    ContactProblem,
    Linearized,
    no_border,
    positive_step,
)

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class ContactOutcome(Enum):
    """How an attempt ended."""

    CONVERGED = "converged"
    STEPS = "the steps ran out"
    OVERDETERMINED = "active contacts hold a chain at both ends"
    PENETRATED = "a gap went far below zero"
    SINGULAR = "the reduced system has no solution"
    DIVERGED = "the steps grew"


class StepVerdict(Enum):
    """What a step says about the next one."""

    GO_ON = "another step with the same tangent"
    RENEW = "the tangent no longer serves"
    REJECT = "the state before was better"
    CONVERGED = "done, if the signs are right"
    FAIL = "it leads nowhere"


class ContactFailure(ArithmeticError):
    """An attempt that cannot go on; it does not leave this file."""

    def __init__(self, outcome: ContactOutcome) -> None:
        super().__init__(outcome.value)
        self.outcome = outcome


@dataclass(frozen=True)
class ContactOptions:
    """Numbers of the method."""

    tangents: int = 12
    """Most tangents."""
    tangents_per_set: int = 60
    """Most tangents with one set of active contacts."""
    steps: int = 5
    """Most steps with one tangent: a step costs a solve, a fiftieth of another factorisation."""
    patience: int = 1
    """Times that all contacts of wrong sign change at once before the set is searched for."""
    near: float = 1e-2
    """Residual below which the same tangent is tried again."""
    gain: float = 0.1
    """Factor that such a step must take off the residual."""
    rounded: float = RESIDUAL_TOLERANCE
    """A residual below this that no longer halves is rounding, which refinement removes."""
    deepest: float = -0.5
    """A gap this far below zero (in units of the reference film) is no small correction any more."""
    revise_early: bool = True
    """Correct the active contacts after every tangent, not only when the equations are solved or a gap is negative."""
    tangent_at_entry: bool = False
    """Take the first tangent on a set where the set was entered, before its gaps close."""
    borrow: bool = False
    """A tangent of a neighbour may end the iteration, and follows contacts that change; else it serves one step."""


@dataclass(frozen=True)
class ContactState:
    """An iterate; its active gaps vanish exactly.

    Attributes
    ----------
    x, b : (n,), (d,) array
        Unknowns and bordered unknowns.
    lam : (m,) array
        Reactions, zero on open gaps.
    active : (m,) bool array
        Active contacts.
    residual : float
        Largest scaled residual of the rows of `x`.
    constraints, linearized, gaps
        Active contacts as constraints, the equations at `x`, and the gaps (m,).
    """

    x: Array
    b: Array
    lam: Array
    active: Mask
    residual: float
    constraints: ContactConstraints
    linearized: Linearized
    gaps: Array


@dataclass(frozen=True)
class Correction:
    """Changes of unknowns (n,) and of bordered unknowns (d,), and reactions of the stops (j,) after them."""

    x: Array
    b: Array
    stops: Array

    @property
    def size(self) -> float:
        """Largest change of an unknown."""
        return float(max(np.max(np.abs(self.x), initial=0.0), np.max(np.abs(self.b), initial=0.0)))


@dataclass(frozen=True)
class Step:
    """A step with the tangent at hand.

    Attributes
    ----------
    number : int
        Steps with this tangent before.
    before, after : ContactState
        Where it started, and what it reached; None if the equations cannot be evaluated there.
    length : float
        Fraction of the correction that was taken.
    size, last_size : float
        Largest change of an unknown in the correction, and in the one before (infinite if there was none).
    response : float
        Largest correction over the residual left for it that the tangent has shown; 0 while none is known.
    """

    number: int
    before: ContactState
    after: ContactState | None
    length: float
    size: float
    last_size: float
    response: float = 0.0


@dataclass(frozen=True)
class ContactEquations:
    """What is solved. This is the plain variant, at a fixed position; the others add their terms to it.

    Attributes
    ----------
    problem : ContactProblem
        The equations.
    """

    problem: ContactProblem

    @property
    def border(self) -> Border:
        """How the bordered unknowns enter."""
        return no_border(self.problem.G.shape[0])

    @property
    def border_stiffness(self) -> Array:
        """What resists the bordered unknowns beside `R x + A^T lam`, (d, d)."""
        return np.zeros((0, 0))

    @property
    def stops(self) -> slice | None:
        """Where contacts that repeat others are looked for (`constrain`); None if there must be none."""
        return None

    def at(self, b: Array) -> ContactProblem:
        """The equations at bordered unknowns `b`."""
        return self.problem

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Residual of the rows of the bordered unknowns, (d,)."""
        return np.zeros(0)

    def step_length(self, state: ContactState, correction: Correction) -> float:
        """Fraction of a correction that keeps the equations valid, at most 1."""
        return self.longest_step((state.x, state.b), correction)

    def longest_step(self, at: tuple[Array, Array], correction: Correction) -> float:
        """The same from unknowns and bordered unknowns."""
        return positive_step(self.problem, at[0], correction.x)

    def lagged(self, state: ContactState) -> Self:
        """The same with the terms that follow the reactions late taken at `state`."""
        return self

    def renewed(self, state: ContactState, before: ContactState, count: int) -> Self:
        """The same for a new tangent at `state`, the one before having been at `before`; `count` with one set."""
        return self

    def verdict(self, step: Step, options: ContactOptions) -> StepVerdict:
        """What a step says about the next one: by the residual."""
        after = step.after
        if after is None:
            return StepVerdict.REJECT if step.number else StepVerdict.FAIL
        if step.number and after.residual > options.gain * step.before.residual:
            return StepVerdict.REJECT
        stagnant = after.residual > 0.5 * step.before.residual
        if after.residual <= (options.rounded if stagnant else RESIDUAL_TOLERANCE):
            return StepVerdict.CONVERGED
        settled = np.array_equal(revise(self.problem, after), after.active)
        return StepVerdict.GO_ON if after.residual <= options.near and settled else StepVerdict.RENEW


def evaluate(
    equations: ContactEquations,
    at: tuple[Array, Array],
    options: ContactOptions,
    constraints: ContactConstraints,
    pushes: Array | None = None,
) -> ContactState:
    """Close the held gaps exactly; find residual and reactions there, stops pushing by `pushes` (j,) or not at all."""
    if not constraints.determinate:
        raise ContactFailure(ContactOutcome.OVERDETERMINED)
    problem, held, stops = equations.at(at[1]), constraints.held, constraints.stops
    x = at[0] + constraints.close(problem.gaps(at[0])[held])
    gaps = problem.gaps(x)
    outside = np.min(gaps, initial=0.0) < options.deepest or np.min(x[problem.positive], initial=1.0) <= 0.0
    if outside or not np.all(np.isfinite(x)) or not problem.admits(x):
        raise ContactFailure(ContactOutcome.PENETRATED)
    linearized = problem.linearize(x)
    lam, active = np.zeros(len(gaps)), held.copy()
    if pushes is not None:
        lam[stops], active[stops] = pushes, pushes > 0.0
    push = problem.acting.T
    lam[held] = constraints.reactions(linearized.residual - push @ lam if len(stops) else linearized.residual)
    left = np.abs(linearized.residual - push @ lam)
    residual = float(np.max(left / constraints.largest(linearized.row_scale), initial=0.0))
    return ContactState(x, at[1], lam, active, residual, constraints, linearized, gaps)


def revise(problem: ContactProblem, state: ContactState) -> Mask:
    """Active contacts from here on: those that push stay, those that pull are released, gaps below zero close."""
    below: Mask = state.gaps < -RESIDUAL_TOLERANCE
    if not state.active.any():
        return below
    # rows that lose digits blur reactions too
    noise = np.maximum(problem.weight, problem.G.magnitude @ state.linearized.row_scale)
    return np.where(state.active, state.lam > -RESIDUAL_TOLERANCE * noise, below)
