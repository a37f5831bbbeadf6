"""Motions with contact points: of which bearings, and the journal released from petals, film and contacts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.point_path import at_points_instant
from petalfoil.dynamics.time_state import Instant, TimeState
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_friction import PointFriction, RubbingStepEquations
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.point_step import PointStepEquations
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]


def points_in_time(layout: BearingLayout, friction: Friction | None) -> PointLayout | None:
    """Where contacts of a motion lie between nodes; None of petals whose friction has a width or two directions."""
    smooth = friction is None or (friction.exact and friction.directions == 1)
    return layout.elements if smooth else None


def released_at_points(
    system: RotorBearing, tau: float, state: PointState, moving: tuple[Array, Array], pulls: Array | None = None
) -> Instant:
    """An instant from petals, film and contact points with friction forces `pulls` (j,); without any, none yet."""
    (e, v), rotor, friction = moving, system.rotor, None
    equations = equations_at(system, tau, state, e, pulls)
    if system.friction is not None:
        held = np.zeros(len(state.points.reaction)) if pulls is None else pulls
        friction = PointFriction(equations.whole, system.friction.coefficient, state, held).state(state, held)
    force = equations.force + rotor.outside(tau) - rotor.gyroscopic(tau) @ v
    speeding = np.asarray(np.linalg.solve(rotor.inertia, force), dtype=np.float64)
    stored, storing = equations.film.mass, -equations.film.residual
    change = TimeState(storing + equations.problem.filled(stored, storing), v, speeding)
    start = at_points_instant(tau, equations, TimeState(stored, e, v), change)
    return replace(start, friction=friction)


def equations_at(
    system: RotorBearing, tau: float, state: PointState, e: Array, pulls: Array | None = None
) -> PointStepEquations:
    """The equations of contact points at a state, at a displacement `e` (d,) and with friction forces `pulls` (j,)."""
    whole, problem = system.points, system.problem.at(displacement=e, bearing_number=system.rotor.bearing_number(tau))
    if whole is None or not isinstance(problem, StepProblem):
        raise TypeError("contacts of this motion are at nodes")
    if pulls is None:
        return PointStepEquations(whole, problem, state)
    return RubbingStepEquations(whole, problem, state, friction_force=pulls)
