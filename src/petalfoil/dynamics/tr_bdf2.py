"""A step of TR-BDF2: trapezium to an inner instant, backward differences from there.

The scheme is of second order, one-step and L-stable. Both stages have the same implicit part, so that one factorisation
serves both. The third-order combination of its three rates estimates the error (Bank et al. 1985,
doi:10.1109/T-ED.1985.22232; Hosea & Shampine 1996, doi:10.1016/0168-9274(95)00115-8). The gas in the cells is stepped,
not pressure and film: no gas is lost.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.line_path import line_guesses, on_lines_instant
from petalfoil.dynamics.line_stage import LineStage
from petalfoil.dynamics.point_path import (
    KNOTS,
    at_points_instant,
    foretelling,
    nodal_friction,
    point_friction,
    point_guesses,
    weighted,
)
from petalfoil.dynamics.point_stage import PointStage
from petalfoil.dynamics.rotor_motion import RotorMotion
from petalfoil.dynamics.stage import Stage, StageOptions, StageSolution, solve_sliding_stage, solve_stage
from petalfoil.dynamics.time_state import AtNodes, Instant, TimeState
from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.line_stretches import Stretches
from petalfoil.equilibrium.line_tangent import LineResiduals, LineTangent
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.contact_newton import border_change
from petalfoil.solvers.tangent import BorderedTangent
from petalfoil.system.friction import FrictionStep
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.point_friction import RubbingStepEquations
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import PRESSURE

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

GAMMA = 2.0 - np.sqrt(2.0)
"""Inner instant, as a fraction of the step."""
IMPLICIT = GAMMA / 2.0
"""Weight of a stage's own rate."""
WEIGHT = np.sqrt(2.0) / 4.0
"""Weight of the rates at start and inner instant in the second stage."""
ERROR = ((4.0 * WEIGHT - 1.0) / 3.0, -1.0 / 3.0, 2.0 * IMPLICIT / 3.0)
"""Weights of the three rates in the difference to the embedded formula of third order."""


Tangents = BorderedTangent | ElementTangent | LineTangent


@dataclass(frozen=True)
class RotorBearing:
    """A bearing, or two on one shaft, and the rotor in it.

    Attributes
    ----------
    problem : StepProblem or ShaftStep
        The bearing.
    rotor : RotorMotion
        The rotor.
    friction : Friction or None
        Friction between its petals.
    points : PointLayout or None
        The same bearing with contacts between nodes; None where they are at nodes.
    compiled : bool
        Whether stages with contact points are evaluated in compiled loops (`compiled_stages.py`).
    lines : bool
        Whether contacts are lines between the nodes of a 3-D film.
    """

    problem: StepProblem | ShaftStep
    rotor: RotorMotion
    friction: Friction | None = None
    points: PointLayout | None = None
    compiled: bool = False
    lines: bool = False

    @property
    def between_nodes(self) -> bool:
        """Whether contacts are points or lines between nodes."""
        return self.points is not None or self.lines

    @property
    def at_nodes(self) -> Self:
        """The same with contacts at nodes."""
        return replace(self, points=None, lines=False) if self.between_nodes else self

    def stage(self, base: TimeState, tau: float, step: float, begin: Instant, options: StageOptions) -> Stage:
        """The implicit stage at `tau` from `base` in a step from `begin`; friction goes on from there."""
        rotor, friction, at_points = self.rotor, None, None
        if self.friction is not None and begin.friction is not None:
            if self.points is not None:
                at_points = point_friction(self.points, self.friction, begin)
            else:
                friction = FrictionStep.beginning(self.friction, nodal_friction(self.friction, begin), begin.lam)
        problem = replace(
            self.problem,
            bearing_number=rotor.bearing_number(tau),
            displacement=base.e,
            rate=1.0 / (IMPLICIT * step),
            start=base.stored,
        )
        still = (problem, base, rotor.inertia, rotor.gyroscopic(tau), rotor.outside(tau), options)
        return Stage(*still, friction, point_friction=at_points)


@dataclass(frozen=True)
class AcceptedStep:
    """A step: where it leads, its inner instant, its estimated error, and the tangent at hand."""

    inner: Instant
    end: Instant
    error: float
    residual: float
    tangent: Tangents


@dataclass(frozen=True)
class Reached:
    """Where a stage leads: the instant, its largest scaled residual, and the tangent that found it."""

    instant: Instant
    residual: float
    tangent: Tangents


def take_step(
    bearing: RotorBearing, path: list[Instant], step: float, tangent: Tangents | None, options: StageOptions
) -> AcceptedStep | None:
    """One step from the last instant of `path`; None if a stage has no solution.

    `path` is where the motion came from, latest last: the guesses of both stages extrapolate it. `tangent` is that of a
    step of the same length.
    """
    now = path[-1]
    base = now.moving.plus(step, (IMPLICIT, now.change))
    at = now.tau + GAMMA * step
    first_stage = bearing.stage(base, at, step, now, options).gaining(gained(bearing, path, at))
    inner = advance(bearing, first_stage, at, path, tangent)
    if inner is None:
        return None
    between = inner.instant
    base = now.moving.plus(step, (WEIGHT, now.change), (WEIGHT, between.change))
    end, further = now.tau + step, [*path[1 - KNOTS :], between]
    last_stage = bearing.stage(base, end, step, now, options).gaining(gained(bearing, further, end))
    outer = advance(bearing, last_stage, end, further, inner.tangent)
    if outer is None:
        return None
    error = estimate(bearing, (now, between, outer.instant), step, outer.tangent)
    return AcceptedStep(between, outer.instant, error, max(inner.residual, outer.residual), outer.tangent)


def gained(bearing: RotorBearing, path: list[Instant], tau: float) -> Array | None:
    """Rates at which cells gain gas through a film without ends at `tau` (F6d), (n_stored,); None of one with ends.

    They go on in a straight line from the latest two instants of `path`: of second order like the steps.
    """
    if not bearing.problem.without_ends:
        return None
    rates = [bearing.problem.filled(one.moving.stored, one.change.stored) for one in path[-2:]]
    if len(rates) == 1:
        return rates[0]
    before, now = path[-2:]
    ahead = (tau - now.tau) / (now.tau - before.tau)
    return np.asarray((1.0 + ahead) * rates[1] - ahead * rates[0])


def advance(
    bearing: RotorBearing, stage: Stage, tau: float, path: list[Instant], tangent: Tangents | None
) -> Reached | None:
    """Where a stage leads at `tau`, within a step or at its end; None if it has no solution."""
    last = path[-1]
    if bearing.points is not None:
        return advance_points(PointStage(bearing.points, stage, bearing.compiled), tau, path, tangent)
    if bearing.lines:
        before = last.stretches or Stretches.of(last.lines, len(last.active))
        return advance_lines(LineStage(stage, before), tau, path, tangent)
    for x, e in guesses(path, tau):
        at_nodes = tangent if isinstance(tangent, BorderedTangent) else None
        found = solved(stage, (x, e, last.active), last, at_nodes)
        if found is not None:
            state, moving = found.state, found.moving
            change = moving.minus(stage.base, stage.rate)
            nodal = AtNodes(state.x, state.lam, state.active)
            instant = Instant(tau, moving, change, nodal, found.friction)
            return Reached(instant, state.residual, found.tangent)
    return None


def advance_points(stage: PointStage, tau: float, path: list[Instant], tangent: Tangents | None) -> Reached | None:
    """The same with contact points."""
    at_points = tangent if isinstance(tangent, ElementTangent) else None
    for start in point_guesses(stage.whole, path, tau):
        found = stage.solved(start, at_points)
        if found is not None:
            change = found.moving.minus(stage.stage.base, stage.stage.rate)
            instant = at_points_instant(tau, found.equations, found.moving, change)
            if stage.stage.point_friction is not None and isinstance(found.equations, RubbingStepEquations):
                slid = stage.stage.point_friction.state(found.equations.state, found.equations.friction_force)
                instant = replace(instant, friction=slid)
            return Reached(instant, found.residual, found.tangent)
    return None


def advance_lines(stage: LineStage, tau: float, path: list[Instant], tangent: Tangents | None) -> Reached | None:
    """The same with contact lines."""
    problem = stage.stage.problem
    if not isinstance(problem, StepProblem):
        raise TypeError("contacts of a shaft in two bearings are at nodes")
    on_lines = tangent if isinstance(tangent, LineTangent) and path[-1].lines is not None else None
    for start in line_guesses(problem, path, tau):
        found = stage.solved(start, on_lines)
        if found is not None:
            change = found.moving.minus(stage.stage.base, stage.stage.rate)
            return Reached(on_lines_instant(tau, found.equations, found.moving, change), found.residual, found.tangent)
    return None


def solved(
    stage: Stage, start: tuple[Array, Array, Mask], last: Instant, tangent: BorderedTangent | None
) -> StageSolution | None:
    """The stage's state from `start`; of petals that slide along themselves with contacts and friction as one.

    `last` is the instant before, whose forces are near by.
    """
    if stage.friction is None or not stage.friction.friction.exact:
        return solve_stage(stage, start, tangent)
    known = last.friction if last.friction is not None and last.points is None else stage.friction.before
    return solve_sliding_stage(stage, start, (last.lam, known.force), tangent)


def guesses(path: list[Instant], tau: float) -> list[tuple[Array, Array]]:
    """Unknowns and displacement at `tau`: foretold from the latest instants of `path`, else as they were last."""
    latest, known = path[-1], path[-KNOTS:]
    still = (latest.x, latest.e)
    if len(known) < 3 or any(instant.between_nodes for instant in known):
        return [still]
    weights = foretelling([instant.tau for instant in known], tau)
    x, e = (weighted(weights, values) for values in ([i.x for i in known], [i.e for i in known]))
    return [(x, e), still]


def estimate(
    bearing: RotorBearing, instants: tuple[Instant, Instant, Instant], step: float, tangent: Tangents
) -> float:
    """Local error of the step, in reference films and ambient pressures.

    The difference to the formula of third order, passed through the tangent, so that stiff parts are not overestimated.
    """
    still = np.zeros_like(instants[0].e)
    nothing = TimeState(np.zeros_like(instants[0].moving.stored), still, still)
    wrong = nothing.plus(step, *zip(ERROR, (instant.change for instant in instants), strict=True))
    end, unknowns = instants[2].tau, bearing.problem.layout.unknowns
    if isinstance(tangent, ElementTangent):
        pressures, de = response_at_points(rotor_errors(bearing.rotor, wrong, end, step), wrong.stored, tangent)
    elif isinstance(tangent, LineTangent):
        rows = bearing.problem.rows_of(wrong.stored)
        change, de = response_on_lines(rotor_errors(bearing.rotor, wrong, end, step), rows, tangent)
        pressures = change[unknowns[PRESSURE]]
    else:
        base = TimeState(wrong.stored, -wrong.e, -wrong.v)
        stage = replace(bearing.stage(base, end, step, instants[0], StageOptions()), outside=still)
        residual, ambient = stage.rate * stage.problem.rows_of(wrong.stored), np.ones(unknowns.n)
        settled, de, _ = border_change(stage, residual, (ambient, still), tangent)
        pressures = (settled + tangent.units @ de)[unknowns[PRESSURE]]
    spread = float(np.sqrt(np.mean(pressures**2))) if len(pressures) else 0.0
    return max(float(np.linalg.norm(de)), spread)


def rotor_errors(rotor: RotorMotion, wrong: TimeState, tau: float, step: float) -> tuple[float, Array]:
    """Rate of a step that ends at `tau`, and the force (d,) that errors in position and velocity stand for in it."""
    rate = 1.0 / (IMPLICIT * step)
    return rate, rotor.resistance(tau, rate) @ wrong.e + rate * (rotor.inertia @ wrong.v)


def response_at_points(errors: tuple[float, Array], stored: Array, tangent: ElementTangent) -> tuple[Array, Array]:
    """Change of pressures (n_film,) and displacement (d,) by errors `stored` (n_film,) and in position and velocity.

    `errors` are the rate of the step and the force of the rotor's errors.
    """
    (rate, pull), whole = errors, tangent.equations.whole
    film, residual = slice(whole.n_wall, whole.n_wall + whole.n_film), np.zeros(tangent.n)
    residual[film] = rate * stored
    change, de = tangent.correction(residual, -pull)
    return change[film], de


def response_on_lines(errors: tuple[float, Array], rows: Array, tangent: LineTangent) -> tuple[Array, Array]:
    """Change of all unknowns (n,) and displacement (d,) for contact lines; errors in what is stored are `rows` (n,)."""
    rate, pull = errors
    closed, slopes = np.zeros(len(tangent.place)), np.zeros(len(tangent.numbers))
    change, _, de = tangent.moved(LineResiduals(rate * rows, closed, slopes, -pull), None)
    return change, de
