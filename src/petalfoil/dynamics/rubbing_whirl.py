"""A bearing whose petals rub while the journal moves on an ellipse of a stated size (E18).

In `e = Re(a v exp(s tau))` every contact slips on a cycle of its own size, and friction has the equivalent stiffness
(E10) there. With the slips `s_v` that the ellipse `v` gives without friction, (E11) has one solution, and the force

    dF = -Z(s) v - N(s, a, v)                                                                          (E18)

is homogeneous in `v` but not linear. Unlike columns of stiffness and damping it does not depend on the directions of
the axes. With several harmonics of the slips, `N` is that of (E22). Its free whirls are in `rubbing_modes.py`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.harmonic_balance import FrictionCycle, SlidingContacts
from petalfoil.dynamics.joint_motion import JointMotion
from petalfoil.dynamics.rubbing_cycle import ONE_HARMONIC, FollowedSlips, HarmonicsTold, RubbingCycle, takes_several
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import JournalMotion, Motion, Response
from petalfoil.system.friction import against_slip, slips

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

IN_PLANE = slice(0, 2)
"""Coordinates of a journal's centre; slopes of its axis follow."""


@dataclass(frozen=True)
class HarmonicsLeft:
    """What the harmonics of slips in a whirl leave.

    Attributes
    ----------
    told : HarmonicsTold
        Harmonics, and what half as many change.
    resistance : (d,) array or None
        What resists the motion more than with half as many, for each unit of its shape [N/m]; None with one harmonic.
    """

    told: HarmonicsTold
    resistance: Complex | None


ONE_LEAVES = HarmonicsLeft(ONE_HARMONIC, None)
"""Of slips with one harmonic, which has no half."""


def half_axis(v: Complex) -> float:
    """Major half axis of the ellipse `Re(v exp(i tau))`, v of shape (2,)."""
    return float(np.sqrt(0.5 * (np.linalg.norm(v) ** 2 + abs(v @ v))))


@dataclass(frozen=True)
class RubbingBearing:
    """One bearing.

    Attributes
    ----------
    motion : Motion
        Small motions without friction.
    sliding : SlidingContacts or None
        Contacts that slide and carry load; None without any.
    by_shaft : (n_position, d) array
        Displacement of its journal by the coordinates of the motion.
    units : (float, float)
        Unit of length of the first bearing over its own, unit of force of its own over that of the first.
    several : FollowedSlips or None
        Slips in several harmonics (E22); None where they have one (E11).
    least : int
        Fewest harmonics of several; 0 for as many as change friction.
    """

    motion: Motion
    sliding: SlidingContacts | None
    by_shaft: Array
    units: tuple[float, float]
    several: FollowedSlips | None = None
    least: int = 0

    @classmethod
    def of(cls, motion: Motion, by_shaft: Array, units: tuple[float, float], least: int) -> RubbingBearing:
        """From small motions in which petals stick."""
        sliding = None if motion.stuck is None else SlidingContacts.of_stuck(motion.stuck)
        return cls(motion.frictionless, sliding, by_shaft, units, least=least)

    def at(self, s: complex) -> RubbingResponse:
        """The response to motions in `exp(s tau)`: a factorisation, and a solve for each contact.

        As many as `rubbing_cycle.frequencies` where slips have several harmonics.
        """
        if self.sliding is not None and self.several is not None:
            rubbing = RubbingCycle.of(self.sliding, self.motion, s, 1.0, self.least)
            return RubbingResponse(self, rubbing.cycle.response, rubbing.compliances)
        response = self.motion.growing(s, current_run().probe_solver)
        if self.sliding is None:
            return RubbingResponse(self, response, np.zeros((1, 0, 0), dtype=complex))
        return RubbingResponse(self, response, FrictionCycle(self.sliding, response, 1.0).compliance()[None])

    def with_enough(self, motion: tuple[complex, Complex], scale: float) -> RubbingBearing:
        """With as many harmonics of the slips as a motion `s`, `v` of the shaft needs.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        s, v = motion
        if self.sliding is None:
            return self
        rubbing = RubbingCycle.of(self.sliding, self.motion, s, scale, self.least)
        free = RubbingResponse(self, rubbing.cycle.response, rubbing.compliances).free(v)
        return replace(self, several=FollowedSlips(rubbing.with_enough(free).told.friction_harmonics))


@dataclass(frozen=True)
class RubbingResponse:
    """One bearing at one rate of change, factorised.

    Attributes
    ----------
    bearing : RubbingBearing
        The bearing.
    response : Response
        Linear response without friction.
    compliances : (m, k, k) array
        Slips against unit friction forces, at the frequency and at its harmonics as far as slips have them.
    """

    bearing: RubbingBearing
    response: Response
    compliances: Complex

    def sticks(self, v: Complex, scale: float) -> float:
        """Part of the amplitude `scale`, of a shaft that moves by `v`, up to which contacts stick; inf without any."""
        sliding = self.bearing.sliding
        if sliding is None or not len(sliding.limit):
            return np.inf
        free = self.free(v)
        stiffness = sliding.friction.stiffness
        slip = np.linalg.solve(np.eye(len(free)) + self.compliances[0] * stiffness, free)
        return float(np.min(sliding.limit / (stiffness * scale * sliding.friction.magnitude(slip))))

    def force(self, v: Complex, scale: float) -> Complex:
        """Force on the shaft that moves by `scale * v` (d,), over `scale` and the units of the first bearing; (d,) [1].

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        sliding = self.bearing.sliding
        total = self.response.force_gradient @ self.displacement(v)
        if sliding is not None:
            against = against_slip(sliding.friction, self.friction(v, scale), len(self.response.units))
            total = total + self.response.forced(-against)[1]
        return self.on_shaft(total)

    def on_shaft(self, force: Complex) -> Complex:
        """A force on the journal as one on the shaft, over the units of the first bearing, (d,)."""
        return np.asarray(self.bearing.units[1] * (self.bearing.by_shaft.T @ force), dtype=np.complex128)

    def displacement(self, v: Complex) -> Complex:
        """Displacement of the journal over its unit of length, of a shaft that moves by `v`."""
        return np.asarray(self.bearing.units[0] * (self.bearing.by_shaft @ v), dtype=np.complex128)

    def free(self, v: Complex) -> Complex:
        """Slips without friction by `v`, (k,)."""
        sliding = cast(SlidingContacts, self.bearing.sliding)  # asked for only where there are contacts
        return slips(sliding.friction, self.response.units @ self.displacement(v))

    def rubbing(self, scale: float) -> RubbingCycle:
        """The whirl of contacts."""
        sliding = cast(SlidingContacts, self.bearing.sliding)
        return RubbingCycle(FrictionCycle(sliding, self.response, scale), self.compliances)

    def friction(self, v: Complex, scale: float) -> Complex:
        """First harmonic of the friction forces over `scale`, (k,)."""
        rubbing, free = self.rubbing(scale), self.free(v)
        if self.bearing.several is not None:
            return self.bearing.several.friction(rubbing, free)
        slip = rubbing.cycle.settled(free, self.compliances[0])
        return np.asarray(rubbing.cycle.sliding.equivalent(slip, scale)[0] * slip)

    def left(self, v: Complex, scale: float) -> tuple[HarmonicsTold, Complex] | None:
        """What half as many harmonics change, also of the force on the shaft (d,); None where slips have one."""
        if self.bearing.several is None:
            return None
        count, free = self.bearing.several.harmonics, self.free(v)
        force, half = (self.rubbing(scale).force(free, harmonics) for harmonics in (count, count // 2))
        return HarmonicsTold.between(count, force, half), self.on_shaft(force - half)


@dataclass(frozen=True)
class RubbingWhirl:
    """Bearings of a rotor whose journals whirl at one amplitude.

    Attributes
    ----------
    bearings : tuple of RubbingBearing
        One, or both.
    amplitude : float
        Largest displacement of a journal's centre, over the reference length [1].
    stiffness_unit : float
        Unit of force over unit of length [N/m].
    """

    bearings: tuple[RubbingBearing, ...]
    amplitude: float
    stiffness_unit: float

    @classmethod
    def of(cls, motion: JournalMotion, amplitude: float, least: int = 0) -> RubbingWhirl:
        """From small motions in which petals stick, at an amplitude [m]; slips have `least` harmonics or more."""
        scales = motion.problem.layout.scales
        if isinstance(motion, JointMotion):
            each = zip(motion.parts, motion.by_shaft, motion.units, strict=True)
            bearings = tuple(RubbingBearing.of(*one, least) for one in each)
        else:
            alone = cast(Motion, motion)  # what is not both bearings is one
            bearings = (RubbingBearing.of(alone, np.eye(alone.problem.layout.n_position), (1.0, 1.0), least),)
        return cls(bearings, amplitude / scales.length, scales.force / scales.length)

    @property
    def frictionless(self) -> JournalMotion:
        """Small motions without friction, of one bearing or of both."""
        if len(self.bearings) == 1:
            return self.bearings[0].motion
        return JointMotion(tuple(one.motion for one in self.bearings), tuple(one.by_shaft for one in self.bearings))

    def scale(self, v: Complex) -> float:
        """Amplitude over the major half axis of the largest ellipse that `v` (d,) stands for."""
        return self.amplitude / max(half_axis((one.by_shaft @ v)[IN_PLANE]) for one in self.bearings)

    def at(self, s: complex) -> tuple[RubbingResponse, ...]:
        """The responses to motions in `exp(s tau)`."""
        return tuple(one.at(s) for one in self.bearings)

    def with_enough(self, motion: tuple[complex, Complex]) -> RubbingWhirl:
        """With as many harmonics of the slips as a motion `s`, `v` needs."""
        scale = self.scale(motion[1])
        return replace(self, bearings=tuple(one.with_enough(motion, scale) for one in self.bearings))

    def left(self, motion: tuple[complex, Complex]) -> HarmonicsLeft:
        """What the harmonics of the slips in a motion `s`, `v` leave."""
        s, v = motion
        each = [one for one in (response.left(v, self.scale(v)) for response in self.at(s)) if one is not None]
        if not each:
            return ONE_LEAVES
        change = -self.stiffness_unit * np.sum([force for _, force in each], axis=0)
        return HarmonicsLeft(HarmonicsTold.most_of([told for told, _ in each]), change)

    @property
    def takes_several(self) -> bool:
        """Whether slips of all bearings have several harmonics."""
        each = [takes_several(one.sliding) for one in self.bearings if one.sliding is not None]
        return bool(each) and all(each)

    def sticks(self, motion: tuple[complex, Complex]) -> float:
        """Amplitude over the reference length up to which all contacts stick in a motion `s`, `v`."""
        s, v = motion
        return self.amplitude * min(one.sticks(v, self.scale(v)) for one in self.at(s))

    def resistance(self, responses: tuple[RubbingResponse, ...], v: Complex) -> Complex:
        """`Z v + N(v)` [N/m], what resists an ellipse of the shape `v`, for each unit of `v`; (d,)."""
        scale = self.scale(v)
        total: Complex = -self.stiffness_unit * np.sum([one.force(v, scale) for one in responses], axis=0)
        return total
