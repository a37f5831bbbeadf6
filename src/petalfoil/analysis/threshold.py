"""The speed at which a rigid rotor on the bearing becomes unstable."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.operating_point import Vector, applied_load, at, operating_point
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.case.plausibility import MAX_MACH, surface_mach
from petalfoil.dynamics.critical_mass import Whirl, least_damping, whirls_at_any_mass
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import GRAVITY
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import JournalMotion
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError

RANGE, FACTOR = 16.0, 1.3
"""Speeds between which the threshold is looked for, over the case's, and the factor between looks."""

PRECISION = 1e-6
"""Relative precision of the threshold speed: two or three looks more than 1e-3 takes, for the margin is smooth."""

FARTHEST, FORETOLD = 3, 0.4
"""Most factors between looks where no mass is critical, and the part of the loss of a whirl, at any whirl ratio, that
may be foretold to be gone at the next one."""

Array = NDArray[np.float64]
Threshold = tuple[float, str]
"""Threshold speed [rad/s], nan where there is none, and how the search ended."""


def rotor_mass(case: Case, load: Vector | None, mass: float | None) -> float:
    """The mass of the rotor [kg]: as asked, else the case's, else the load's; nan where nothing tells it."""
    if mass is not None:
        return mass
    if case.rotor is not None:
        return case.rotor.mass
    if load is None and case.operation.load is None:
        return math.nan
    weight = float(np.hypot(*applied_load(case, load)))  # a load without a mass is taken for a weight
    return weight / GRAVITY if weight > 0.0 else math.nan


def margin(whirl: Whirl, mass: float) -> float:
    """Logarithm of the critical mass over `mass`: positive where the rotor is stable."""
    if not whirl.mass > 0.0:
        return -NEVER
    return math.log(whirl.mass / mass) if math.isfinite(whirl.mass) else NEVER


NEVER = 50.0
"""Margin of a bearing on which a rotor of any mass is stable; with the other sign, of one on which any whirls."""


@dataclass(frozen=True)
class AtOwnSpeed:
    """What is known at the case's speed: the equilibrium, the impedance about it, and its neutral whirl."""

    answer: Solution
    impedance: Impedance
    whirl: Whirl


def threshold_speed(
    rotor: RotorOnBearings, load: Vector | None, start: AtOwnSpeed, *, grows: bool = False
) -> Threshold:
    """Speed at which the rotor becomes unstable, within the range, from what is known at the case's speed.

    Upward from a stable bearing, downward from an unstable one. A speed without an equilibrium ends the search. The
    critical mass is what is followed: where a mode `grows` below it, there is nothing to follow.
    """
    if whirls_at_any_mass(start.impedance.motion):
        return math.nan, ""  # and at any speed
    if math.isnan(rotor.mass):
        return math.nan, "no threshold speed: give a mass or a load"
    if grows and margin(start.whirl, rotor.mass) > 0.0:
        return math.nan, "no threshold speed: a mode of the rotor grows already, below the critical mass"
    margin_at = margins(rotor, load, start)
    known, here = rotor.case.operation.speed, margin(start.whirl, rotor.mass)
    factor = FACTOR if here > 0.0 else 1.0 / FACTOR
    first, last = sorted((known, known * RANGE if here > 0.0 else known / RANGE))
    try:
        while first <= known * factor <= last:
            ahead, there = looked_ahead(margin_at, known, factor, (first, last))
            if (there > 0.0) != (here > 0.0):
                return neutral_speed(margin_at, (known, here), (ahead, there))
            known, here = ahead, there
    except ConvergenceError as failure:
        current_run().note("threshold", outcome=str(failure))
        return math.nan, f"no threshold speed: no operating point beyond {in_rpm(known)}"
    if here > 0.0:
        beyond = beyond_the_model(rotor.case, known)
        ended = f"end of the search: {beyond}" if beyond else "end of the search"
        return math.nan, f"no threshold speed found up to {in_rpm(known)} ({ended})"
    return math.nan, f"no threshold speed found down to {in_rpm(known)} (end of the search): it is unstable there"


def looked_ahead(
    margin_at: FollowedMargin, known: float, factor: float, limits: tuple[float, float]
) -> tuple[float, float]:
    """The next speed [rad/s] from a `known` one, and its margin: several factors ahead of looks far from whirling.

    Where the rotor is unstable there, the first speed between is looked at from the known one, as if that had come
    first, and no speed as far ahead until all before it are known.
    """
    first, last = limits
    for factors in range(margin_at.factors, 1, -1):
        ahead = known * factor**factors
        if first <= ahead <= last and ahead < margin_at.unstable:
            before, there = margin_at.last, margin_at(ahead)
            if there > 0.0:
                return ahead, there
            margin_at.last, margin_at.unstable = before, ahead
            break
    return known * factor, margin_at(known * factor)


def beyond_the_model(case: Case, speed: float) -> str:
    """What is said of a speed [rad/s] at which the gas is faster than the film's equations allow; else empty."""
    mach = surface_mach(case, speed)
    if not mach > MAX_MACH:
        return ""
    return f"the journal's surface moves at Mach {mach:.2g} there, and the film is modelled up to {MAX_MACH:g}"


def told_with_mach(case: Case, speed: float, ended: str) -> str:
    """What is said of a threshold speed [rad/s], how the search `ended` and whether it is beyond the model, as one."""
    beyond = beyond_the_model(case, speed)
    if not beyond:
        return ended
    return f"{ended}, and {beyond}" if ended else f"threshold speed: {beyond}"


def neutral_speed(
    margin_at: Callable[[float], float], known: tuple[float, float], ahead: tuple[float, float]
) -> Threshold:
    """Speed between two (speed, margin) of opposite signs at which the margin changes sign.

    The margins of both ends are not computed anew: where equilibria overlap, the one followed depends on where it is
    followed from, and with it the sign.
    """
    from scipy.optimize import brentq  # 0.2 s: only where it is needed

    seen = dict([known, ahead])

    def remembered(speed: float) -> float:
        if speed not in seen:
            seen[speed] = margin_at(speed)
        return seen[speed]

    speed = float(brentq(remembered, min(known[0], ahead[0]), max(known[0], ahead[0]), rtol=PRECISION))
    jumps = all(min(abs(m) for m in seen.values() if (m > 0.0) == side) > JUMP for side in (True, False))
    return speed, "at the threshold speed the critical mass jumps past the rotor's" if jumps else ""


JUMP = 0.1
"""Margin on both sides of a threshold beyond which it changes sign in a jump: near a threshold a followed equilibrium
changes it by some thousandths."""


def margins(rotor: RotorOnBearings, load: Vector | None, start: AtOwnSpeed) -> FollowedMargin:
    """The margin over speed [rad/s], under the load or at the case's position, followed from the case's speed."""
    case = rotor.case
    wanted = None if load is None and case.operation.load is None else applied_load(case, load)
    balances: EquilibriaOverSpeed
    if wanted is not None:
        balances = SpeedLine(case, wanted, known=start.answer, temperatures=start.answer.problem.temperatures)
    elif case.heat is None and start.answer.friction is None:
        balances = PositionLine(case, start.answer)
    else:
        balances = PositionAnew(case)
    margin_at = FollowedMargin(rotor, wanted, balances, start.impedance.motion)
    margin_at.learn(start.impedance, case.operation.speed, margin(start.whirl, rotor.mass))
    return margin_at


class EquilibriaOverSpeed(Protocol):
    """Equilibria over speed."""

    seeks: bool
    """Whether contacts between nodes are looked for."""

    def at(self, speed: float) -> Solution:
        """The equilibrium at a speed [rad/s]."""


@dataclass
class PositionLine:
    """Equilibria at the case's position, each followed from the one before."""

    case: Case
    known: Solution
    seeks: bool = True

    def at(self, speed: float) -> Solution:
        """The equilibrium at `speed` [rad/s].

        Raises
        ------
        ConvergenceError
            None was found.
        """
        before, problem = self.known, self.known.problem
        found, _ = advance(before, problem.at(bearing_number=problem.layout.bearing_number(speed)))
        self.known = reported(self.case, found, before) if self.seeks else replace(found, elements_sought=True)
        return self.known


@dataclass
class PositionAnew:
    """Equilibria at the case's position, each from nothing: with temperatures, or with friction of a path."""

    case: Case
    seeks: bool = True

    def at(self, speed: float) -> Solution:
        """The equilibrium at `speed` [rad/s].

        Raises
        ------
        ConvergenceError
            None was found.
        """
        return operating_point(at(self.case, speed), None).answer


@dataclass
class FollowedMargin:
    """The margin over speed, each equilibrium from the last one, with contacts of one kind.

    Attributes
    ----------
    rotor : RotorOnBearings
        Rotor and bearing.
    load : (x, y) or None
        The load [N]; None at the case's position.
    balances : EquilibriaOverSpeed
        Equilibria with contacts at nodes, for speeds at which contact points are not followed.
    last : JournalMotion
        Small motions about the last equilibrium.
    damping : (speed, (ratio,) array) or None
        The last speed [rad/s], and the least loss of a whirl of any mass at each whirl ratio there (`least_damping`);
        None where a mass is critical.
    factors : int
        How many factors the next look may be ahead: more than one where a rotor of any mass was stable at the last two
        looks, and no more than `FORETOLD` of a loss is foretold to be gone then.
    unstable : float
        Least speed farther ahead at which the rotor was found unstable [rad/s].
    """

    rotor: RotorOnBearings
    load: Vector | None
    balances: EquilibriaOverSpeed
    last: JournalMotion
    damping: tuple[float, Array] | None = None
    factors: int = 1
    unstable: float = math.inf

    def __call__(self, speed: float) -> float:
        """The margin at `speed` [rad/s]."""
        impedance = self.rotor.followed(self.last, speed, self.load)
        if impedance is None:
            self.balances.seeks = not isinstance(self.last, SmallMotion)
            impedance = self.rotor.impedance(self.balances.at(speed))
        self.last = impedance.motion
        found = margin(self.rotor.whirl(impedance, speed), self.rotor.mass)
        self.learn(impedance, speed, found)
        return found

    def learn(self, impedance: Impedance, speed: float, found: float) -> None:
        """How far ahead the next look may be, from the impedance at a `speed` [rad/s] and the margin `found` there."""
        before, self.damping, self.factors = self.damping, None, 1
        if found != NEVER or self.rotor.amplitude is not None:
            return
        inertia = None if self.rotor.case.bearings == 1 else self.rotor.inertia
        self.damping = speed, least_damping(impedance, inertia)
        if before is not None:
            self.factors = factors_ahead(before, self.damping)


def factors_ahead(before: tuple[float, Array], here: tuple[float, Array]) -> int:
    """How many factors the next look may be ahead, by what is left of each loss (ratio,) from a speed to another."""
    passed = abs(math.log(here[0] / before[0])) / math.log(FACTOR)
    for factors in range(FARTHEST, 1, -1):
        if np.all(here[1] >= (1.0 - FORETOLD * passed / factors) * before[1]):
            return factors
    return 1


def in_rpm(speed: float) -> str:
    """A speed as people read it."""
    return f"{speed * 30.0 / math.pi:.0f} rpm"
