"""A step of TR-BDF2: trapezium to an inner instant, backward differences from there.

Second order, one-step, L-stable, both stages with the same implicit part, so that one factorisation serves both; the
third-order combination of its three rates estimates the error (Bank et al. 1985, doi:10.1109/T-ED.1985.22232;
Hosea & Shampine 1996, doi:10.1016/0168-9274(95)00115-8). What is stepped is the gas in the cells, not pressure
and film: none gets lost.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.rotor import RotorMotion
from petalfoil.dynamics.stage import Solved, Stage, StageOptions, freely, solve_stage
from petalfoil.dynamics.stage_tangent import Tangent
from petalfoil.dynamics.time_state import Instant, TimeState
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionStep
from petalfoil.system.loaded import FilmForce
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

GAMMA = 2.0 - np.sqrt(2.0)
"""Inner instant, as a share of the step."""
IMPLICIT = GAMMA / 2.0
"""Weight of a stage's own rate."""
WEIGHT = np.sqrt(2.0) / 4.0
"""Weight of the rates at start and inner instant in the second stage."""
ERROR = ((4.0 * WEIGHT - 1.0) / 3.0, -1.0 / 3.0, 2.0 * IMPLICIT / 3.0)
"""Weights of the three rates in the difference to the embedded formula of third order."""


@dataclass(frozen=True)
class System:
    """A bearing and the rotor in it."""

    problem: StepProblem
    rotor: RotorMotion
    film: FilmForce
    friction: Friction | None = None

    def stage(self, base: TimeState, tau: float, step: float, begin: Instant) -> Stage:
        """The implicit stage at `tau` from `base` in a step from `begin`; friction goes on from there."""
        rubbing = None
        if self.friction is not None and begin.rubbed is not None:
            rubbing = FrictionStep(self.friction.in_step(begin.lam), begin.rubbed, self.friction.normal(begin.lam))
        problem = StepProblem(
            self.problem.layout,
            self.rotor.bearing_number(tau),
            base.e,
            self.problem.clock,
            1.0 / (IMPLICIT * step),
            base.mass,
            rubbing,
        )
        rotor = self.rotor
        return Stage(problem, base, rotor.inertia, rotor.gyroscopic(tau), rotor.outside(tau), self.film)


@dataclass(frozen=True)
class Stepped:
    """A step: where it leads, its inner instant, its estimated error, and the tangent at hand."""

    inner: Instant
    end: Instant
    error: float
    residual: float
    tangent: Tangent


def take_step(
    system: System, path: list[Instant], step: float, tangent: Tangent | None, work: tuple[LinearSolver, StageOptions]
) -> Stepped | None:
    """One step from the last instant of `path`; None if a stage has no answer.

    `path` is where the motion came from, latest last: the guesses of both stages go on from it.
    """
    now = path[-1]
    base = now.moving.plus(step, (IMPLICIT, now.change))
    inner = advance(system, path, base, (GAMMA, step), tangent, work)
    if inner is None:
        return None
    between, solved = inner
    base = now.moving.plus(step, (WEIGHT, now.change), (WEIGHT, between.change))
    outer = advance(system, [*path[-2:], between], base, (1.0, step), solved.tangent, work)
    if outer is None:
        return None
    end, solved = outer
    error = estimate(system, (now, between, end), step, solved.tangent)
    return Stepped(between, end, error, max(solved.residual, inner[1].residual), solved.tangent)


def advance(
    system: System,
    path: list[Instant],
    base: TimeState,
    share: tuple[float, float],
    tangent: Tangent | None,
    work: tuple[LinearSolver, StageOptions],
) -> tuple[Instant, Solved] | None:
    """The stage at a share of the step from `base`; None if it has no answer."""
    part, step = share
    begin = path[-1] if part == GAMMA else path[-2]
    tau = begin.tau + part * step
    stage = system.stage(base, tau, step, begin)
    usable = tangent if tangent is not None and abs(tangent.rate / stage.rate - 1.0) < 1e-9 else None
    latest = path[-1]
    solved = None
    for x, e in guesses(path, tau):
        solved = solve_stage(stage, (x, e, latest.closed), usable, *work)
        if solved is not None:
            break
    if solved is None:
        return None
    change = solved.moving.minus(base, stage.rate)
    return Instant(tau, solved.x, solved.lam, solved.closed, solved.moving, change, solved.rubbed), solved


def guesses(path: list[Instant], tau: float) -> list[tuple[Array, Array]]:
    """Unknowns and displacement at `tau`: through the last three instants of `path`, else as they were last."""
    latest = path[-1]
    still = (latest.x, latest.e)
    if len(path) < 3:
        return [still]
    weights = lagrange([instant.tau for instant in path[-3:]], tau)
    x = sum(w * instant.x for w, instant in zip(weights, path[-3:], strict=True))
    e = sum(w * instant.e for w, instant in zip(weights, path[-3:], strict=True))
    return [(np.asarray(x), np.asarray(e)), still]


def lagrange(knots: list[float], tau: float) -> list[float]:
    """Weights of the parabola through values at `knots`, at `tau`."""
    a, b, c = knots
    return [
        (tau - b) * (tau - c) / ((a - b) * (a - c)),
        (tau - a) * (tau - c) / ((b - a) * (b - c)),
        (tau - a) * (tau - b) / ((c - a) * (c - b)),
    ]


def estimate(system: System, instants: tuple[Instant, Instant, Instant], step: float, tangent: Tangent) -> float:
    """Local error of the step, in reference films and ambient pressures.

    The difference to the formula of third order, passed through the tangent: what is stiff must not be overestimated.
    """
    still = np.zeros_like(instants[0].e)
    nothing = TimeState(np.zeros_like(instants[0].moving.mass), still, still)
    wrong = nothing.plus(step, *zip(ERROR, (instant.change for instant in instants), strict=True))
    rate, n_wall = tangent.rate, system.problem.layout.n_wall
    residual = np.concatenate([np.zeros(n_wall), rate * wrong.mass])
    base = TimeState(wrong.mass, -wrong.e, -wrong.v)
    bare = Stage(
        system.stage(base, instants[2].tau, step, instants[0]).problem,
        base,
        system.rotor.inertia,
        system.rotor.gyroscopic(instants[2].tau),
        still,
        system.film,
    )
    settle, de, _ = freely(bare, residual, tangent, (np.ones(system.film.by_P.shape[1]), still))
    change = settle + tangent.units @ de
    pressures = change[n_wall:]
    spread = float(np.sqrt(np.mean(pressures**2))) if len(pressures) else 0.0
    return max(float(np.linalg.norm(de)), spread)
