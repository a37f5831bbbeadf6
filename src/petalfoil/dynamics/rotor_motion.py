"""The rotor's equation of motion (65) in the units of the problem.

    M e'' = F_film + F_contact + load + rotating load + unbalance      (O1)

A rigid rotor whose mass centre is `u` off the axis: the unbalance is `m u (omega^2 n - alpha t)` with `n` the direction
of the mass centre and `t` across it, turned with the shaft. In two bearings, `2 l` apart, the shaft's slopes `a` about
the mass centre move too, as `l a`, with the moments over `l`:

    I_t a_x'' + I_p omega a_y' = M_x + (I_t - I_p) chi omega^2 n_x,  I_t a_y'' - I_p omega a_x' = M_y + ...        (O5)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, Rotor
from petalfoil.dynamics.speed_schedule import Schedule
from petalfoil.errors import UsageError
from petalfoil.system.scales import Scales

Array = NDArray[np.float64]

GRAVITY = 9.80665
"""Standard gravity [m/s^2]."""


@dataclass(frozen=True)
class Clock:
    """Units of time.

    Attributes
    ----------
    rate : float
        Units of time in a second [rad/s].
    bearing_number : float
        Bearing number of one radian per unit of time, `Lam_t` [1].
    """

    rate: float
    bearing_number: float

    @classmethod
    def of(cls, case: Case, scales: Scales, schedule: Schedule) -> Clock:
        """A radian at the highest speed; where nothing turns, the time in which a film of reference size drains."""
        radius, viscosity = case.bearing.journal_radius, case.gas.viscosity
        rate = schedule.top or 1.0 / scales.bearing_number(viscosity, 1.0, radius)
        return cls(rate, scales.bearing_number(viscosity, rate, radius))


@dataclass(frozen=True)
class Inertia:
    """Inertia of a rigid rotor in the coordinates of its position, `d` of them: `mass e'' + omega gyroscopic e'`.

    Attributes
    ----------
    mass : (d, d) array
        Of a shaft that tilts: `diag(m, m, I_t / l^2, I_t / l^2)` [kg].
    gyroscopic : (d, d) array
        Of a shaft that tilts: `I_p / l^2` between its slopes [kg].
    """

    mass: Array
    gyroscopic: Array

    @classmethod
    def of_mass(cls, mass: float) -> Inertia:
        """A mass [kg] whose axis keeps its direction."""
        return cls(mass * np.eye(2), np.zeros((2, 2)))

    @classmethod
    def of(cls, rotor: Rotor) -> Inertia:
        """The whole rotor."""
        if not rotor.lever:
            return cls.of_mass(rotor.mass)
        transverse, polar = rotor.transverse_inertia / rotor.lever**2, rotor.polar_inertia / rotor.lever**2
        gyroscopic = np.zeros((4, 4))
        gyroscopic[2, 3], gyroscopic[3, 2] = polar, -polar
        return cls(np.diag([rotor.mass, rotor.mass, transverse, transverse]), gyroscopic)

    @property
    def least(self) -> float:
        """Least inertia of a coordinate [kg]."""
        return float(np.diag(self.mass).min())


@dataclass(frozen=True)
class RotorMotion:
    """Masses and loads of the rotor; `d` is 2, or 4 for two bearings on a shaft that tilts.

    Attributes
    ----------
    inertia : (d, d) array
        `M`: masses times `h_ref rate^2 / F_ref` [1].
    turning : (d, d) array
        Gyroscopic matrix at one unit of speed, `rate` [1].
    load : (d,) array
        Constant load over the unit of force [1].
    unbalance : (along, tilt)
        `m u / F_ref`, and `(I_t - I_p) chi / (l F_ref)` of a shaft whose principal axis is askew by `chi` [s^2].
    rotating : (force, speed)
        Rotating load over the unit of force [1] and its speed [rad/s]; None turns with the shaft.
    schedule : Schedule
        Speed of the shaft.
    clock : Clock
        Units of time.
    """

    inertia: Array
    turning: Array
    load: Array
    unbalance: tuple[float, float]
    rotating: tuple[float, float | None]
    schedule: Schedule
    clock: Clock

    @classmethod
    def of(cls, case: Case, scales: Scales, schedule: Schedule, load: tuple[float, float] | None = None) -> RotorMotion:
        """The rotor of `case` under `load` [N], by default the case's load, without one its weight along -y.

        Raises
        ------
        UsageError
            The case has no rotor.
        """
        if case.rotor is None:
            raise UsageError(NO_ROTOR)
        rotor = case.rotor.with_inertias(case.bearing.journal_radius)
        clock, given = Clock.of(case, scales, schedule), constant_load(case, load)
        unit, lever = scales.length * clock.rate**2 / scales.force, rotor.lever
        inertia, force, askew = Inertia.of(rotor), np.array(given) / scales.force, 0.0
        if lever:
            weighs = load is None and case.operation.load is None  # a weight acts at the mass centre
            moment = moment_on_rotor(case, (0.0, 0.0) if weighs else given)
            force = np.append(force, np.array(moment) / (lever * scales.force))
            askew = (rotor.transverse_inertia - rotor.polar_inertia) * rotor.skew / (lever * scales.force)
        return cls(
            inertia=unit * inertia.mass,
            turning=unit * inertia.gyroscopic,
            load=force,
            unbalance=(rotor.mass * rotor.unbalance / scales.force, askew),
            rotating=(rotor.rotating_load / scales.force, rotor.rotating_speed),
            schedule=schedule,
            clock=clock,
        )

    def gyroscopic(self, tau: float) -> Array:
        """Gyroscopic matrix at time `tau`, (d, d) [1]."""
        return self.turning * (self.schedule.speed(tau / self.clock.rate) / self.clock.rate)

    def resistance(self, tau: float, rate: float) -> Array:
        """What resists the position in an implicit step that ends at `tau`, `M rate^2 + N rate`; (d, d) [1]."""
        return np.asarray(self.inertia * rate**2 + self.gyroscopic(tau) * rate)

    def outside(self, tau: float) -> Array:
        """All that acts on the rotor but the bearings, at time `tau` [units of time], (d,) [1]."""
        t = tau / self.clock.rate
        omega, alpha, angle = self.schedule.speed(t), self.schedule.acceleration(t), self.schedule.angle(t)
        along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        turning = omega**2 * along - alpha * across
        force, speed = self.rotating
        turned = angle if speed is None else speed * t
        total: Array = self.load.copy()
        total[:2] += force * np.array([np.cos(turned), np.sin(turned)]) + self.unbalance[0] * turning
        if len(total) > 2:
            total[2:] += self.unbalance[1] * turning
        return total

    def bearing_number(self, tau: float) -> float:
        """Bearing number at time `tau` [1]."""
        return self.clock.bearing_number * self.schedule.speed(tau / self.clock.rate) / self.clock.rate


def moment_on_rotor(case: Case, load: tuple[float, float]) -> tuple[float, float]:
    """Moment about the mass centre of a load [N] where it acts, with that of the case [N m]."""
    arm = 0.0 if case.rotor is None else case.rotor.load_arm
    m_x, m_y = case.operation.moment or (0.0, 0.0)
    return m_x + arm * load[0], m_y + arm * load[1]


NO_ROTOR = "the motion of a rotor needs a case with [rotor]: give its mass there"


def constant_load(case: Case, load: tuple[float, float] | None = None) -> tuple[float, float]:
    """The constant load [N]: `load`, by default the case's, without one the rotor's weight along -y.

    Raises
    ------
    UsageError
        The case has no rotor.
    """
    if case.rotor is None:
        raise UsageError(NO_ROTOR)
    return load or case.operation.load or (0.0, -case.rotor.mass * GRAVITY)
