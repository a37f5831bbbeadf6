"""The package alone, from nothing: a convex programme with one answer, whatever the start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.run_log import RunLog
from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.contact_newton import ActiveOptions, active_set
from petalfoil.solvers.interior_point import InteriorOptions, Step, contact_set, interior_point
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.package import PackageProblem

Array = NDArray[np.float64]

FIRST_PRODUCT = 100.0
"""First reactions times slacks over the deepest penetration of the free shape. 100 to 1000 serve alike; 10 and less
stay short of the boundary for long (up to 58 steps where 20 serve)."""

CONVEX = InteriorOptions(near=np.inf, calm=np.inf, boundary=0.995, correctors=5)
"""The package alone is convex: Mehrotra's steps serve from the start, close to the boundary."""

SEARCHING = ActiveOptions(patience=0)
"""Its contact set is searched for at once: swaps save nothing here."""

REST_GOALS = (1e-6, 1e-9, 1e-12)
"""Barriers at which the contact set of the package alone is read and tried."""


def unloaded(problem: CoupledProblem) -> PackageProblem:
    """The package without film pressure."""
    return PackageProblem(problem, np.zeros(problem.layout.n_wall))


def free_start(package: PackageProblem) -> ConePoint:
    """A start from the free shape: slacks as wide as it penetrates, reactions to match."""
    x = np.zeros(package.layout.n_wall)
    gaps = package.gaps(x)
    depth = max(1.0, -float(np.min(gaps, initial=0.0)))
    s = np.maximum(gaps, depth)
    return ConePoint(x, s, FIRST_PRODUCT * depth * package.weight / s)


def assembled(problem: CoupledProblem, barrier: float, work: RunLog) -> ConePoint:
    """The assembled package on its central path at `barrier`, extended by ambient pressures: a start for the film."""
    package = unloaded(problem)
    if not problem.layout.n_wall:
        s = package.gaps(np.zeros(0))
        return ConePoint(np.ones(problem.layout.n), s, barrier * package.weight / s)
    options = replace(CONVEX, least_barrier=barrier)

    def content(step: Step) -> bool:
        return step.barrier < 2.0 * barrier and step.infeasibility < 1e-3 and step.residual < 1e-2

    watch = work.watch("package", content)
    point, _ = interior_point(package, free_start(package), work.package_solver, options, watch)
    ambient = np.ones(problem.layout.n - problem.layout.n_wall)
    return ConePoint(np.concatenate([point.x, ambient]), point.s, point.lam)


def at_rest(problem: CoupledProblem, work: RunLog) -> tuple[Array, NDArray[np.bool_]] | None:
    """Deflections of the assembled package (n_wall,) and its closed gaps (m,); None if not found."""
    package = unloaded(problem)
    start = free_start(package)
    for goal in REST_GOALS:
        watch = work.watch("package", settled(goal))
        start, found = interior_point(package, start, work.package_solver, CONVEX, watch)
        if not found:
            return None
        x, touching = contact_set(package, start, work.package_solver)
        closed, outcome = active_set(package, x, touching, work.package_solver, SEARCHING)
        work.note("package contacts", outcome=outcome.value)
        if closed is not None:
            return closed.x, closed.closed
    return None


def settled(goal: float) -> Callable[[Step], bool]:
    """Stop at the barrier `goal`, equations and gaps met well enough to read the contact set."""
    return lambda step: step.barrier < goal and max(step.residual, step.infeasibility) < 1e-4
