"""Primal-dual interior point for equations with one-sided gaps.

Slacks `s = g(x) > 0` and reactions `lam > 0` keep `lam s = mu w` on the central path (P1), `mu -> 0`. Both are
eliminated, so that gaps enter the matrix as `H^T diag(lam / s) G` and one pattern serves every step; the equations read
their gaps as slacks, which are positive by construction. Far from the answer the barrier falls by fixed shares; near it
steps are Mehrotra's (1992, doi:10.1137/0802028): one factorisation, a predictor and a corrector.

Newton's direction may point nowhere where equilibria fold. Steps that stay short say so; the method then marches (P5):
it adds the storage of an implicit step in time, and follows the physics to a stable equilibrium, with steps that grow.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.problem import (
    POSITIVE_FRACTION,
    ContactProblem,
    Linearized,
    PrimalDualPoint,
    fraction_to_boundary,
    scaled_residual,
)
from petalfoil.solvers.sparse_lu import Factor, LinearSolver

Array = NDArray[np.float64]


@dataclass(frozen=True)
class InteriorOptions:
    """Numbers of the method."""

    max_steps: int = 80
    correctors: int = 3
    """Most centrality correctors a step."""
    boundary: float = 0.98
    """Fraction of the way to `s = 0` or `lam = 0` that a step may go."""
    near: float = 0.1
    """Scaled residual below which predictor-corrector steps pay; above it they overreach (2 % of random cases lost)."""
    calm: float = 1e-3
    """A residual that grows past this says that the last step overreached: the next is cautious again."""
    least_barrier: float = 0.0
    """Barrier below which centring does not aim."""
    short: float = 0.2
    """A step shorter than this, twice in a row, says that Newton's direction leads nowhere."""
    march: bool = False
    """Begin in time: what is found is then stable, as far as the steps resolve."""
    first_time: float = 1.0
    """First time step of a march, in radians of rotation."""
    growth: float = 3.0
    """Factor on the time step after a full step."""
    jammed: float = 0.05
    """A step shorter than this has run into the boundary: pairs are moved back toward the path."""
    shortest_time: float = 1e-2
    """Time steps below this are not the remedy."""
    longest_time: float = 1e3
    """A time step past this is no march any more."""


@dataclass(frozen=True)
class InteriorStep:
    """One line of a solve's history."""

    barrier: float
    residual: float
    infeasibility: float
    length: float
    rate: float


Watch = Callable[[PrimalDualPoint, InteriorStep], bool]


@dataclass(frozen=True)
class StepHistory:
    """How the last step went and how the next one is taken."""

    length: float = 1.0
    short: int = 0
    rate: float = 0.0
    residual: float = np.inf

    def after(self, length: float, residual: float, options: InteriorOptions) -> StepHistory:
        """The history after a step of `length` from a point with `residual`."""
        if self.rate == 0.0:
            short = self.short + 1 if length < options.short else 0
            return StepHistory(length, short, 1.0 / options.first_time if short >= 2 else 0.0, residual)
        growth = options.growth if length > 0.9 else 1.0 if length > 0.3 else 1.0 / options.growth
        arrived = length > 0.9 and residual < 1e-2 * options.near
        done = arrived or growth / self.rate > options.longest_time
        rate = 0.0 if done else min(self.rate / growth, 1.0 / options.shortest_time)
        return StepHistory(length, 0, rate, residual)


def interior_point(
    problem: ContactProblem, start: PrimalDualPoint, solver: LinearSolver, options: InteriorOptions, watch: Watch
) -> tuple[PrimalDualPoint, bool]:
    """Follow the central path from `start` until `watch` returns True; in time first, if the options say so.

    Returns
    -------
    (PrimalDualPoint, bool)
        The last point, and whether `watch` accepted it before the steps ran out.
    """
    point, history = start, StepHistory(rate=1.0 / options.first_time if options.march else 0.0)
    for _ in range(options.max_steps + 1):
        shift = point.s - problem.gaps(point.x)
        linearized = problem.linearize(point.x, shift)
        residual = scaled_residual(linearized, problem.acting.T @ point.lam)
        widest = float(np.max(np.abs(shift), initial=0.0))
        if watch(point, InteriorStep(point.barrier(problem.weight), residual, widest, history.length, history.rate)):
            return point, True
        factor = solver.factor(
            linearized.matrix(point.lam / point.s, history.rate), solver.elimination(problem.elimination_key)
        )
        newton = NewtonSystem(problem, point, linearized, factor, history.rate)
        direction = choose(newton, residual, history, options)
        length = newton.longest(direction, options)
        s, lam = point.s + length * direction.s, point.lam + length * direction.lam
        x = keep_positive(point.x, length * direction.x, problem.positive)
        point, history = PrimalDualPoint(x, s, lam), history.after(length, residual, options)
        if length < options.jammed:
            point = recentre(point, problem.weight)
    return point, False


def contact_set(
    problem: ContactProblem, point: PrimalDualPoint, solver: LinearSolver
) -> tuple[Array, NDArray[np.bool_]]:
    """The active contacts of the solution ahead of `point`, and its unknowns.

    Along the direction that aims at a barrier of zero, slacks of active contacts vanish while those of open gaps stay
    (Tapia's indicators): it does not depend on units, as comparing reactions with gaps would.
    """
    shift = point.s - problem.gaps(point.x)
    linearized = problem.linearize(point.x, shift)
    factor = solver.factor(linearized.matrix(point.lam / point.s), solver.elimination(problem.elimination_key))
    newton = NewtonSystem(problem, point, linearized, factor, 0.0)
    ahead = newton.direction(-point.lam * point.s)
    return keep_positive(point.x, ahead.x, problem.positive), -ahead.s > 0.5 * point.s


def recentre(point: PrimalDualPoint, weight: Array) -> PrimalDualPoint:
    """Move pairs that ran into the boundary back toward the path: slack and reaction grow by the same factor (P4).

    A pair far below the mean product blocks every direction; the equations pay with a residual that Newton removes.
    """
    product, least = point.lam * point.s / weight, 0.1 * point.barrier(weight)
    factor = np.sqrt(np.maximum(1.0, least / product))
    return PrimalDualPoint(point.x, point.s * factor, point.lam * factor)


def choose(newton: NewtonSystem, residual: float, history: StepHistory, options: InteriorOptions) -> Direction:
    """Direction toward a lower barrier: cautious far from the answer and on a march, Mehrotra's near it (P3)."""
    point, weight = newton.point, newton.problem.weight
    mu, now = point.barrier(weight), point.lam * point.s
    overreached = residual > max(history.residual, options.calm)
    far = residual > options.near or overreached or history.rate > 0.0
    if far:
        shares = (0.5, 0.8, 1.0) if history.rate > 0.0 else (0.1, 0.3, 0.8)
        centring = shares[0] if history.length > 0.9 else shares[1] if history.length > 0.5 else shares[2]
        return newton.direction(max(centring * mu, options.least_barrier) * weight - now)
    predictor = newton.direction(min(mu, options.least_barrier) * weight - now)
    reach = newton.longest(predictor, options)
    ahead = PrimalDualPoint(point.x, point.s + reach * predictor.s, point.lam + reach * predictor.lam).barrier(weight)
    least = 0.0 if history.length > 0.9 else 0.1 if history.length > 0.5 else 0.8
    centring = min(max((ahead / mu) ** 3 if mu > 0.0 else 0.0, least), 1.0)
    second = predictor.s * predictor.lam if history.length > 0.5 and reach > 0.1 else 0.0
    target = max(centring * mu, options.least_barrier) * weight
    return straighten(newton, target - now - second, target, options)


def straighten(newton: NewtonSystem, product: Array, target: Array, options: InteriorOptions) -> Direction:
    """Pull pairs that the step would carry off the path back toward it, as long as that lengthens the step.

    Gondzio's multiple centrality correctors (1996, doi:10.1007/BF00249643): solves with the factor at hand, which cost
    a fiftieth of another factorisation each.
    """
    point = newton.point
    best = newton.direction(product)
    length = newton.longest(best, options)
    for _ in range(options.correctors):
        if length > 0.95:
            break
        ahead = min(1.0, length + 0.3)
        reached = (point.s + ahead * best.s) * (point.lam + ahead * best.lam)
        pull = np.maximum(np.clip(reached, 0.1 * target, 10.0 * target) - reached, -10.0 * target)
        trial = newton.direction(product + pull)
        longer = newton.longest(trial, options)
        if longer < length + 0.03:
            break
        best, length, product = trial, longer, product + pull
    return best


@dataclass(frozen=True)
class Direction:
    """A direction in unknowns, slacks and reactions."""

    x: Array
    s: Array
    lam: Array

    @property
    def parts(self) -> tuple[Array, Array, Array]:
        """(x, s, lam)."""
        return self.x, self.s, self.lam


@dataclass(frozen=True)
class NewtonSystem:
    """Newton's equations at one point, factorised."""

    problem: ContactProblem
    point: PrimalDualPoint
    linearized: Linearized
    factor: Factor
    rate: float

    @cached_property
    def open_by(self) -> Array:
        """Slacks less gaps, (m,)."""
        return np.asarray(self.point.s - self.problem.gaps(self.point.x))

    @cached_property
    def balanced(self) -> Array:
        """What all directions balance, whatever they change `lam s` by, (n,)."""
        imbalance = self.linearized.residual - self.problem.acting.T @ self.point.lam
        return np.asarray(self.linearized.slack_derivative(self.open_by, self.rate) - imbalance)

    def direction(self, product: Array) -> Direction:
        """Direction that aims at a change `product` (m,) of `lam s`, at `F = H^T lam` and at `s = g` (P2)."""
        G, H, s, lam, open_by = self.problem.G, self.problem.acting, self.point.s, self.point.lam, self.open_by
        dx = self.factor.solve(self.balanced + H.T @ ((product + lam * open_by) / s))
        ds = G @ dx - open_by
        return Direction(dx, ds, (product - lam * ds) / s)

    def longest(self, direction: Direction, options: InteriorOptions) -> float:
        """Largest step of at most 1 that keeps the fractions to the boundary of slacks and reactions."""
        reach_s = options.boundary * fraction_to_boundary(self.point.s, direction.s)
        reach_lam = options.boundary * fraction_to_boundary(self.point.lam, direction.lam)
        return min(1.0, reach_s, reach_lam)


def keep_positive(x: Array, change: Array, kept: slice) -> Array:
    """Add `change`; unknowns that must stay positive go only a fraction of the way to zero, each by itself.

    One of them does not hold up the others: where the film opens, pressures of a few per cent of ambient are common.
    """
    moved = x + change
    moved[kept] = np.maximum(moved[kept], (1.0 - POSITIVE_FRACTION) * x[kept])
    return moved
