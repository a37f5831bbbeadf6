"""State of film, wall, contacts and rotor at an instant."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_stretches import Stretches
from petalfoil.system.friction import FrictionState
from petalfoil.system.point_equations import PointEquations, PointState

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


class AtNodes(NamedTuple):
    """What there is at the nodes.

    Attributes
    ----------
    x : (n,) array
        Deflections and pressures [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    active : (m,) bool array
        Contacts that carry load.
    """

    x: Array
    lam: Array
    active: Mask


@dataclass(frozen=True)
class Instant:
    """The whole state at a time.

    Attributes
    ----------
    tau : float
        Time [units of time].
    moving : TimeState
        Gas, position, velocity.
    change : TimeState
        Their rates of change.
    found : AtNodes or callable
        What there is at the nodes, or what gives it when it is asked for: steps with contact points do not.
    friction : FrictionState or None
        Slip and friction of the petals; of contact points the slip is that of the step which led here.
    equations : PointEquations or None
        Petals, film and contacts where these are points between nodes, of which what is at the nodes is sampled then;
        None where contacts are at nodes.
    lines : LineContacts or None
        Contacts in 3-D where they are lines between nodes; None of others.
    stretches : Stretches or None
        What its gaps leave of stretches of contacts at nodes; None where that has not been asked for.
    """

    tau: float
    moving: TimeState
    change: TimeState
    found: AtNodes | Callable[[], AtNodes]
    friction: FrictionState | None = None
    equations: PointEquations | None = None
    lines: LineContacts | None = None
    stretches: Stretches | None = None

    @property
    def between_nodes(self) -> bool:
        """Whether contacts are points or lines between nodes."""
        return self.equations is not None or self.lines is not None

    @property
    def points(self) -> PointState | None:
        """State with contact points; None where contacts are at nodes, or lines."""
        return None if self.equations is None else self.equations.state

    @cached_property
    def nodal(self) -> AtNodes:
        """What there is at the nodes."""
        return self.found if isinstance(self.found, AtNodes) else self.found()

    @property
    def x(self) -> Array:
        """Deflections and pressures at the nodes, (n,) [1]."""
        return self.nodal.x

    @property
    def lam(self) -> Array:
        """Contact reactions at the nodes over the unit of nodal force, (m,) [1]."""
        return self.nodal.lam

    @property
    def active(self) -> Mask:
        """Contacts at the nodes that carry load, (m,)."""
        return self.nodal.active

    @property
    def e(self) -> Array:
        """Displacement over the reference length, (d,) [1]."""
        return self.moving.e
