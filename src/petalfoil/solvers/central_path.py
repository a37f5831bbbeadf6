"""The central path, followed through its folds by its arc length (P7).

On the central path `F(x) = G^T lam`, `g(x) = s` and `lam s = mu w`. It begins at a single point for a large barrier
`mu`, stays bounded, and so leads to an answer as `mu -> 0`; but it may turn back in `mu` on the way, and there an
interior point, which only lowers `mu`, fails. Keller's continuation by arc length (1977) takes `mu` as an unknown and
passes. Which way leads ahead is told by the determinant, so that the path is never taken for its way back (P8).

Slacks and reactions are one variable `z = lam / w - s` each: `s`, `lam / w` are `(sqrt(z^2 + 4 mu) -+ z) / 2`, smooth
and positive for every `z`, and their product is `mu`. Contacts may so open and close within a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.interior_point import keep_positive
from petalfoil.solvers.problem import ContactProblem, Linearized, PrimalDualPoint, scaled_residual
from petalfoil.solvers.sparse_lu import Factor, LinearSolver, SingularMatrixError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PathOptions:
    """Numbers of the method."""

    weight: float = 10.0
    """Weight of the mean square of the unknowns beside that of `ln mu` in the arc length."""
    tolerance: float = 1e-6
    """Largest scaled residual, and distance of slacks from gaps, of a point of the path."""
    first: float = 1.0
    """First step of arc length."""
    longest: float = 4.0
    shortest: float = 1e-7
    """A step below this leads nowhere."""
    steps: int = 200
    start_corrections: int = 40
    corrections: int = 8
    """Most Newton steps that bring a point onto the path, the first point and every other."""
    few: int = 3
    many: int = 6
    """Corrections up to which the next step is longer, and from which on it is shorter."""
    longer: float = 1.8
    shorter: float = 0.7
    refused: float = 0.35
    """Factors on the step."""
    aligned: float = 0.7
    """Cosine between old and new tangent below which a step is refused: it may have leapt to another part."""
    unavoidable: float = 1e-4
    """Step below which a bend is taken as it is."""


FARTHEST = 1e9
"""Unknowns and slacks beyond this (in units of the reference film) are no bearing's."""


@dataclass(frozen=True)
class Change:
    """Change of the unknowns (n,), of `z` (m,) and of `ln mu`."""

    x: Array
    z: Array
    t: float

    def times(self, factor: float) -> Change:
        """The change, `factor` times."""
        return Change(factor * self.x, factor * self.z, factor * self.t)

    def along(self, other: Change, weight: float) -> float:
        """Scalar product with another change, in the metric of the arc length."""
        return float(weight * (self.x @ other.x) / len(self.x) + self.t * other.t)


@dataclass(frozen=True)
class PathPoint:
    """A point on the path or near it, with Newton's equations there."""

    problem: ContactProblem
    solver: LinearSolver
    x: Array
    z: Array
    t: float

    @cached_property
    def barrier(self) -> float:
        """`mu`."""
        return float(np.exp(self.t))

    @cached_property
    def _root(self) -> Array:
        return np.sqrt(self.z**2 + 4.0 * self.barrier)

    @cached_property
    def s(self) -> Array:
        """Slacks, (m,)."""
        return np.where(self.z < 0.0, 0.5 * (self._root - self.z), 2.0 * self.barrier / (self._root + np.abs(self.z)))

    @cached_property
    def lam(self) -> Array:
        """Reactions, (m,)."""
        return self.problem.weight * (self.barrier / self.s)

    @cached_property
    def open_by(self) -> Array:
        """Slacks over the gaps, (m,)."""
        return self.s - self.problem.gaps(self.x)

    @cached_property
    def linearized(self) -> Linearized:
        """The equations, which read their gaps as slacks."""
        return self.problem.linearize(self.x, self.open_by)

    @cached_property
    def residual(self) -> float:
        """Largest scaled residual, or distance of slacks from gaps; infinite where the point cannot be evaluated."""
        values = np.concatenate([self.x, self.z, [self.t]])
        if not np.all(np.abs(values) < FARTHEST) or np.min(self.x[self.problem.positive], initial=1.0) <= 0.0:
            return np.inf
        apart = float(np.max(np.abs(self.open_by), initial=0.0))
        found = max(scaled_residual(self.linearized, self.problem.acting.T @ self.lam), apart)
        return found if np.isfinite(found) else np.inf

    @cached_property
    def factor(self) -> Factor:
        """Tangent by `x` with `z` eliminated."""
        return self.solver.factor(
            self.linearized.matrix(self.lam / self.s), self.solver.elimination(self.problem.elimination_key)
        )

    def newton(self) -> Change:
        """Newton's step onto the path at this barrier.

        With `ds = -(s / root) dz`, `d lam = w (lam / w root) dz` and `ds = G dx - open_by`.
        """
        G, H, theta = self.problem.G, self.problem.acting, self.lam / self.s
        imbalance = self.linearized.residual - H.T @ self.lam
        dx = self.factor.solve(
            -imbalance + self.linearized.slack_derivative(self.open_by) + H.T @ (theta * self.open_by)
        )
        return Change(dx, (self.open_by - G @ dx) * self._root / self.s, 0.0)

    def tangent(self) -> Change:
        """Change along the path by `ln mu`: at fixed `z`, slacks and reactions over weight grow by `mu / root`."""
        G, H, grown = self.problem.G, self.problem.acting, self.barrier / self.s
        dx = self.factor.solve(H.T @ (self.problem.weight * grown))
        return Change(dx, grown - (G @ dx) * self._root / self.s, 1.0)

    def moved(self, change: Change) -> PathPoint:
        """The point after a change; unknowns that must stay positive go at most a fraction of the way to zero."""
        x = keep_positive(self.x, change.x, self.problem.positive)
        return PathPoint(self.problem, self.solver, x, self.z + change.z, self.t + change.t)


def follow_central_path(
    problem: ContactProblem,
    start: PrimalDualPoint,
    barriers: tuple[float, float],
    solver: LinearSolver,
    options: PathOptions,
) -> PrimalDualPoint | None:
    """The point of the path at the last of two `barriers`, from near its point at the first; None if it is lost."""
    try:
        first = PathPoint(problem, solver, start.x, start.lam / problem.weight - start.s, float(np.log(barriers[0])))
        point = onto_path(first, options)
        if point is None:
            return None
        ahead, step = unit(point.tangent(), -1.0, options), options.first
        for _ in range(options.steps):
            found = advance(point, ahead, step, options)
            if found is None:
                return None
            point, ahead, step = found
            if point.barrier <= barriers[1]:
                return PrimalDualPoint(point.x, point.s, point.lam)
            if point.barrier > LOST * barriers[0]:
                return None
    except SingularMatrixError:
        return None
    return None


LOST = 1e3
"""Factor beyond the first barrier at which the path has been confused with its way back."""


def onto_path(point: PathPoint, options: PathOptions) -> PathPoint | None:
    """The point of the path at the barrier of `point`; None if Newton's method does not lead there."""
    for _ in range(options.start_corrections):
        if point.residual <= options.tolerance or not np.isfinite(point.residual):
            break
        point = point.moved(point.newton())
    return point if point.residual <= options.tolerance else None


def unit(tangent: Change, direction: float, options: PathOptions) -> Change:
    """The tangent of unit arc length, along or against `ln mu`."""
    return tangent.times(direction / np.sqrt(tangent.along(tangent, options.weight)))


def advance(
    point: PathPoint, ahead: Change, step: float, options: PathOptions
) -> tuple[PathPoint, Change, float] | None:
    """The next point, its tangent and the next step; None if no step leads on.

    The determinant of Newton's matrix changes its sign where `ln mu` turns back, and nowhere else. So it tells the way
    ahead also where a step has leapt to another part of a folded path (P8).
    """
    way = np.sign(ahead.t) * point.factor.determinant_sign
    while step >= options.shortest:
        reached, corrections = correct(point, ahead, step, options)
        if reached is not None:
            tangent = reached.tangent()
            forward = unit(tangent, way * reached.factor.determinant_sign, options)
            if ahead.along(forward, options.weight) > options.aligned or step < options.unavoidable:
                grow = options.longer if corrections <= options.few else 1.0
                shrink = options.shorter if corrections >= options.many else 1.0
                return reached, forward, min(step * grow * shrink, options.longest)
        step *= options.refused
    return None


def correct(point: PathPoint, ahead: Change, step: float, options: PathOptions) -> tuple[PathPoint | None, int]:
    """The point of the path at arc length `step` along `ahead`, and the Newton steps to it; None if they fail.

    Newton's step at fixed barrier plus as much of the tangent as keeps the arc length.
    """
    trial = point.moved(ahead.times(step))
    for count in range(options.corrections + 1):
        if not np.isfinite(trial.residual):
            return None, count
        if trial.residual <= options.tolerance:
            return trial, count
        try:
            newton, tangent = trial.newton(), trial.tangent()
        except SingularMatrixError:
            return None, count
        gone = Change(trial.x - point.x, trial.z - point.z, trial.t - point.t)
        missing = step - ahead.along(gone, options.weight) - ahead.along(newton, options.weight)
        share = float(np.clip(missing / ahead.along(tangent, options.weight), -LARGEST, LARGEST))
        whole = Change(newton.x + share * tangent.x, newton.z + share * tangent.z, share)
        trial = trial.moved(whole)
    return None, options.corrections


LARGEST = 3.0
"""Most change of `ln mu` in one correction."""
