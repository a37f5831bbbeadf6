"""The journal released from unknowns, reactions and contacts at nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.time_state import AtNodes, Instant, TimeState
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.system.friction import FrictionState

Array = NDArray[np.float64]


def released(
    system: RotorBearing, tau: float, state: tuple[Array, Array, NDArray[np.bool_]], moving: tuple[Array, Array]
) -> Instant:
    """An instant from unknowns, reactions and active contacts, position and velocity: its rates by the equations."""
    (x, lam, closed), (e, v), rotor = state, moving, system.rotor
    problem = system.problem.at(displacement=e, bearing_number=rotor.bearing_number(tau))
    force = problem.journal_force(x, lam) + rotor.outside(tau) - rotor.gyroscopic(tau) @ v
    speeding = np.asarray(np.linalg.solve(rotor.inertia, force), dtype=np.float64)
    stored, storing = problem.stored(x), problem.storing(x, lam)
    change = TimeState(storing + problem.filled(stored, storing), v, speeding)
    friction = None if system.friction is None else FrictionState.fresh(system.friction, x, lam)
    return Instant(tau, TimeState(stored, e, v), change, AtNodes(x, lam, closed), friction)
