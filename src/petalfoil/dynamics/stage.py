"""One implicit stage in time: film, wall, contacts and rotor in one Newton, exact in its contacts.

Every stage of the scheme asks for a state whose rates lead to it from a base: with `rate` one over its implicit part,

    film     net outflow + rate (m - m_base) = 0                         (O2)
    rotor    M rate^2 (e - e_base - v_base / rate) = F + loads           (O3)

and wall and contacts as at rest. The journal's position is bordered. One factorisation serves as many corrections,
stages and steps as it contracts; unlike an equilibrium, a stage therefore ends by the size of its correction, not by
its residual.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.time_state import TimeState
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.sliding_newton import SlidingNewton, SlidingOptions
from petalfoil.solvers.contact_equations import (
    ContactEquations,
    ContactOptions,
    ContactState,
    Correction,
    Step,
    StepVerdict,
)
from petalfoil.solvers.contact_newton import contact_newton
from petalfoil.solvers.problem import Border, ContactProblem, fraction_to_boundary
from petalfoil.solvers.tangent import BorderedTangent
from petalfoil.system.friction import FrictionProblem, FrictionState, FrictionStep
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.point_friction import PointFriction
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TANGENTS, TANGENTS_SLIDING = 3, 20
"""Tangents with one contact set; where petals stick and slip, the tangent changes with them."""

TANGENTS_EXACT = 4
"""Most factorisations of a stage with exact friction."""

CYCLING = 3
"""Tangents with one contact set after which sticking and slipping may recur in turns: secants replace derivatives."""

FILM_FRACTION = 0.95
"""Fraction of the way to a closed film that a step may go."""

DIVERGING = 2.0
"""Growth of the correction past which the iteration diverges."""

CONTACTS = ContactOptions(
    patience=2,  # a step of a rubbing rotor fails where the set is searched for earlier
    tangents=24,
    tangents_per_set=TANGENTS,
    steps=8,
    deepest=-np.inf,
    revise_early=False,
    tangent_at_entry=True,
    borrow=True,
)
"""A step that would pierce the film ends short of that, to have the gaps closed that it ran into."""

CONTACTS_SLIDING = replace(CONTACTS, tangents=160, tangents_per_set=TANGENTS_SLIDING)
"""The same with friction between petals."""


TOLD = 2.0
"""Correction that a residual is taken to ask for, over the largest one that a residual of its size has asked for with
the tangent at hand: a stage whose tangent is known by others ends after one correction."""


def told(response: float, residual: float) -> float:
    """Correction that a residual asks for, as its tangent has been seen to answer; no limit where it has not."""
    return TOLD * response * residual if response else np.inf


def left_after(size: float, contraction: float) -> float:
    """Sum of the corrections after one of a `size`, as long as they contract on so; at most its own size."""
    return size * min(1.0, contraction / max(1.0 - contraction, 0.1))


@dataclass(frozen=True)
class StageOptions:
    """Numbers of a stage."""

    accuracy: float = 1e-6
    """Correction after which a stage is done [reference films, ambient pressures]."""
    slow: float = 0.2
    """Contraction past which the tangent is renewed."""
    slow_sliding: float = 0.6
    """The same with friction, whose limits follow the reactions a correction late."""


@dataclass(frozen=True)
class Stage(ContactEquations):
    """What a stage asks for.

    Attributes
    ----------
    problem : StepProblem or ShaftStep
        Film and wall with the stage's base mass, speed and rate; its displacement does not matter.
    base : TimeState
        Where the rates lead from.
    inertia, gyroscopic : (d, d) array
        `M`, and what turns velocities across [1].
    outside : (d,) array
        Loads at the stage's time over the unit of force [1].
    options : StageOptions
        Numbers of the stage.
    friction : FrictionStep or None
        Friction between the petals.
    tangents : int
        Tangents made so far with the contact set at hand.
    point_friction : PointFriction or None
        The same at contact points, of a stage that has them.
    """

    problem: StepProblem | ShaftStep
    base: TimeState
    inertia: Array
    gyroscopic: Array
    outside: Array
    options: StageOptions
    friction: FrictionStep | None = None
    tangents: int = 0
    point_friction: PointFriction | None = None

    @property
    def rate(self) -> float:
        """One over the implicit part of the step."""
        return self.problem.rate

    @property
    def border(self) -> Border:
        """How the journal's position enters."""
        return self.problem.border

    @property
    def border_stiffness(self) -> Array:
        """Inertia and gyroscopic terms of an implicit step."""
        return self.inertia * self.rate**2 + self.gyroscopic * self.rate

    @property
    def stops(self) -> slice | None:
        """The journal alone can open contacts that close a chain between journal and bushing."""
        return self.problem.journal

    def at(self, b: Array) -> ContactProblem:
        """Film and wall at a displacement, friction included."""
        problem = self.problem.at(displacement=b)
        return problem if self.friction is None else FrictionProblem(problem, self.friction)

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Force left over for acceleration at displacement `b` (O3), (d,) [1]."""
        reached = b - self.base.e - self.base.v / self.rate
        turned = self.gyroscopic @ (self.rate * (b - self.base.e))
        force = self.problem.journal_force(x, lam) + self.outside
        return np.asarray(force - self.inertia @ (self.rate**2 * reached) - turned)

    def longest_step(self, at: tuple[Array, Array], correction: Correction) -> float:
        """Pressures and film stay positive."""
        film = self.problem.at(displacement=at[1]).film(at[0])
        ahead = self.problem.at(displacement=at[1] + correction.b).film(at[0] + correction.x)
        return min(super().longest_step(at, correction), FILM_FRACTION * fraction_to_boundary(film, ahead - film))

    def lagged(self, state: ContactState) -> Self:
        """Friction limited by the reactions of `state`."""
        return self if self.friction is None else replace(self, friction=self.friction.limited(state.lam))

    def renewed(self, state: ContactState, before: ContactState, count: int) -> Self:
        """The same; after some tangents with secants of the friction."""
        if self.friction is None or not (count or self.tangents):
            return self
        friction = self.friction.limited(state.lam)
        secant = friction.between(state.x, before.x) if count >= CYCLING else friction
        return replace(self, friction=secant, tangents=count)

    def verdict(self, step: Step, options: ContactOptions) -> StepVerdict:
        """By the size of the correction, and how fast it falls."""
        sliding = self.friction is not None
        if step.size > DIVERGING * step.last_size:
            return StepVerdict.REJECT if sliding else StepVerdict.FAIL
        if step.after is None:
            return StepVerdict.FAIL
        contraction = step.size / step.last_size if step.number else self.options.slow
        error = left_after(step.size, contraction)
        if not sliding:
            error = min(error, told(step.response, step.after.residual))
        if step.length < 1.0:
            return StepVerdict.RENEW
        if error <= self.options.accuracy:
            return StepVerdict.CONVERGED
        slow = self.options.slow_sliding if sliding else self.options.slow
        one_step = sliding and self.tangents >= CYCLING - 1
        return StepVerdict.RENEW if one_step or (step.number and contraction > slow) else StepVerdict.GO_ON

    def gaining(self, rates: Array | None) -> Self:
        """The same where what is stored gains by `rates` (n_stored,) beside what the equations of each cell say."""
        if rates is None:
            return self
        return replace(self, problem=replace(self.problem, start=self.problem.start + rates / self.rate))

    def moving(self, x: Array, e: Array) -> TimeState:
        """Gas, position and velocity of a state of this stage."""
        stored = self.problem.at(displacement=e).stored(x)
        return TimeState(stored, e, self.rate * (e - self.base.e))


@dataclass(frozen=True)
class StageSolution:
    """What a stage reaches, and the tangent that found it."""

    state: ContactState
    moving: TimeState
    tangent: BorderedTangent
    friction: FrictionState | None


def solve_stage(
    stage: Stage, start: tuple[Array, Array, Mask], tangent: BorderedTangent | None
) -> StageSolution | None:
    """Find the stage's state from `start`: unknowns, displacement, active contacts; None if there is none near it."""
    options = CONTACTS if stage.friction is None else CONTACTS_SLIDING
    contacts, _ = contact_newton(stage, start, current_run().film_solver, options, tangent)
    if contacts is None:
        return None
    state = contacts.state
    friction = None if stage.friction is None else stage.friction.limited(state.lam).after(state.x)
    return StageSolution(state, stage.moving(state.x, state.b), contacts.tangent, friction)


def solve_sliding_stage(
    stage: Stage,
    start: tuple[Array, Array, Mask],
    forces: tuple[Array, Array],
    tangent: BorderedTangent | None,
) -> StageSolution | None:
    """The same of petals that slide along themselves: contacts and friction as one.

    `forces` are reactions (m,) and friction forces (k,) near by.
    """
    if stage.friction is None:
        raise ValueError("a stage without friction")
    options = SlidingOptions(stage.options.accuracy, stage.options.slow, stage.options.slow_sliding, TANGENTS_EXACT)
    friction, smooth = stage.friction, replace(stage, friction=None)
    newton = SlidingNewton(smooth, friction.friction, friction.before, options)
    found = newton.solved((*start, *forces), tangent)
    if found is None:
        return None
    state, after = newton.state(*found)
    return StageSolution(state, stage.moving(state.x, state.b), found[1], after)
