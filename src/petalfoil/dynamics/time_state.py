"""State of film, wall, contacts and rotor at an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.system.friction import FrictionState
from petalfoil.system.point_equations import PointState

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class TimeState:
    """Gas in each cell, position and velocity of the journal: a state in time, or its rate of change.

    Attributes
    ----------
    stored : (n_stored,) array
        Gas in the cell of each pressure unknown, then what a wall that loses energy stores (`StepProblem.stored`) [1].
    e, v : (d,) array
        Displacement over the reference length and its change per unit of time [1].
    """

    stored: Array
    e: Array
    v: Array

    def plus(self, step: float, *rates: tuple[float, TimeState]) -> TimeState:
        """The state plus `step` times the weighted `rates`."""
        stored, e, v = self.stored, self.e, self.v
        for weight, rate in rates:
            stored = stored + step * weight * rate.stored
            e = e + step * weight * rate.e
            v = v + step * weight * rate.v
        return TimeState(stored, e, v)

    def minus(self, base: TimeState, rate: float) -> TimeState:
        """Rate of change since `base`: the difference times `rate`."""
        return TimeState(rate * (self.stored - base.stored), rate * (self.e - base.e), rate * (self.v - base.v))


@dataclass(frozen=True)
class Instant:
    """The whole state at a time.

    Attributes
    ----------
    tau : float
        Time [units of time].
    x : (n,) array
        Deflections and pressures [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    active : (m,) bool array
        Contacts that carry load.
    moving : TimeState
        Gas, position, velocity.
    change : TimeState
        Their rates of change.
    friction : FrictionState or None
        Slip and friction of the petals; of contact points the slip is that of the step which led here.
    points : PointState or None
        Petals, film and contacts where these are points between nodes, of which unknowns, reactions and active contacts
        are samples then; None where contacts are at nodes.
    """

    tau: float
    x: Array
    lam: Array
    active: Mask
    moving: TimeState
    change: TimeState
    friction: FrictionState | None = None
    points: PointState | None = None

    @property
    def e(self) -> Array:
        """Displacement over the reference length, (d,) [1]."""
        return self.moving.e
