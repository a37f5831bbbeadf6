"""Free whirls of a rotor while petals rub, at a stated amplitude: natural modes and the neutral whirl (E18), (E19).

    omega^2 (M s^2 + G s) v + Z(s) v + N(s, a, v) = 0                  with complex s                    (E19)

A natural mode passes the amplitude `a` with the frequency `Im s` and decays or grows there at the rate `Re s`; a
neutral whirl goes on with it. Both are solved by Levenberg and Marquardt's method in `s` (or the eigenvalue) and the
shape `v`, one of whose coordinates is 1. Modes are led from those in which petals stick, by raising the amplitude from
the largest at which all of them do; those without friction are tried as well. Searches have one harmonic of the slips;
what they find is solved for again with as many as it needs (`more_harmonics.py`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.critical_mass import SCAN, Whirl, whirl_impedance, whirls_at_any_mass
from petalfoil.dynamics.eigenpairs import Eigenpair, solved, solved_from
from petalfoil.dynamics.more_harmonics import bettered
from petalfoil.dynamics.natural_modes import APART, Mode, natural_modes, orbit, same, shows, tilt_of, upper
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.dynamics.rubbing_cycle import ONE_HARMONIC, HarmonicsTold
from petalfoil.dynamics.rubbing_whirl import IN_PLANE, ONE_LEAVES, HarmonicsLeft, RubbingWhirl
from petalfoil.equilibrium.run_context import current_run

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

RAISED = 2.0
"""Factor between amplitudes that a mode is led through."""

FAR = 20.0
"""Logarithms of whirl ratio and mass over those begun with beyond which a search has gone astray."""

LOOKS = (0.1, 0.25, 0.5, 0.9)
"""Whirl ratios near which neutral whirls are looked for: those of gas bearings are at a half and below."""


@dataclass(frozen=True)
class RubbingMode(Mode):
    """A natural mode at an amplitude.

    Attributes
    ----------
    told : HarmonicsTold
        Harmonics of its slips.
    change : complex
        By how much `s` differs from that with half as many, to first order; nan with one.
    """

    told: HarmonicsTold
    change: complex = complex(math.nan, math.nan)

    def changes(self, speed: float) -> tuple[float, float, float]:
        """The same of natural frequency [rad/s], growth rate [1/s] and damping ratio [1], at a speed [rad/s]."""
        half = self.s - self.change
        return self.change.imag * speed, self.change.real * speed, self.damping_ratio + half.real / abs(half)


@dataclass(frozen=True)
class RubbingNeutral(Whirl):
    """A neutral whirl at an amplitude.

    Attributes
    ----------
    v : (d,) array
        Its shape.
    told : HarmonicsTold
        Harmonics of its slips.
    slope : (2 d, 2 d) array
        Derivative of the real residual by the logarithms of ratio and of mass times its square, and by the shape.
    mass_change, ratio_change : float
        By how much mass [kg] and ratio differ from those with half as many, to first order; nan with one.
    """

    v: Complex
    told: HarmonicsTold
    slope: Array
    mass_change: float = math.nan
    ratio_change: float = math.nan

    @property
    def motion(self) -> tuple[complex, Complex]:
        """`s` and `v`."""
        return 1j * self.ratio, self.v

    def leaving(self, left: HarmonicsLeft) -> RubbingNeutral:
        """The same with what its harmonics leave."""
        if left.resistance is None:
            return replace(self, told=left.told)
        by_ratio, by_inertia = moved_by(self.slope, left.resistance)
        mass_change = self.mass * (by_inertia - 2.0 * by_ratio)  # of mass times the square of the ratio
        return replace(self, told=left.told, mass_change=mass_change, ratio_change=self.ratio * by_ratio)


def moved_by(slope: Array, change: Complex) -> tuple[float, float]:
    """Both parts of the number by which a solution moves where the residual changes by `change`, to first order."""
    moved = np.linalg.solve(slope, -np.concatenate([change.real, change.imag]))
    return float(moved[0]), float(moved[len(moved) // 2])


# ------------------------------------------------------------------------------------------ natural modes


def across(v: Complex) -> Complex:
    """A shape at right angles to `v` in the plane of the journal: the other of a pair of modes."""
    other = v.copy()
    other[IN_PLANE] = -v[1].conj(), v[0].conj()
    return other


@dataclass(frozen=True)
class RubbingRotor:
    """A rotor on bearings whose petals rub.

    Attributes
    ----------
    whirl : RubbingWhirl
        The bearings and the amplitude.
    inertia : Inertia
        The rotor's.
    speed : float
        Angular speed of the shaft [rad/s].
    """

    whirl: RubbingWhirl
    inertia: Inertia
    speed: float

    def modes(self, stuck: Impedance) -> list[RubbingMode]:
        """The natural modes at the amplitude that show a resonance or grow, by frequency.

        `stuck` is the impedance of petals that stick. Modes that are lost on the way, and those that several harmonics
        make one, are counted by the run log.
        """
        every = [self.led(start) for start in self.starts(stuck)]
        every += [self.near(start) for start in self.starts(whirl_impedance(self.whirl.frictionless))]
        known = [one for one in every if one is not None]
        every += [self.near((one.number, across(one.v))) for one in known]
        alone = apart((self.mode(one, ONE_LEAVES), one) for one in every if one is not None)
        better = [bettered(self.whirl, one, self.near_in) for _, one in alone]
        kept = apart((self.mode(one, left), one) for one, left in better)
        modes = [mode for mode, _ in kept if shows(mode.s)]
        lost, joined = sum(one is None for one in every), len(alone) - len(kept)
        current_run().note("modes", found=len(modes), lost=lost, joined=joined)
        return sorted(modes, key=lambda mode: mode.s.imag)

    def near_in(self, whirl: RubbingWhirl, known: Eigenpair) -> Eigenpair | None:
        """The mode near a known one, with other harmonics."""
        other = replace(self, whirl=whirl)
        return solved_from(other.residual, known, float(np.linalg.norm(self.inert(known.number))))

    def starts(self, impedance: Impedance) -> Iterator[tuple[complex, Complex]]:
        """Eigenvalues and shapes of the modes on a linear bearing."""
        for mode in natural_modes(impedance, self.inertia, self.speed):
            D = self.inert(mode.s) + impedance.at(mode.s)
            yield mode.s, np.linalg.svd(D)[2][-1].conj()

    def inert(self, s: complex) -> Complex:
        """`omega^2 (M s^2 + G s)`, (d, d) [N/m]."""
        return np.asarray(self.speed**2 * (self.inertia.mass * s**2 + self.inertia.gyroscopic * s))

    def near(self, start: tuple[complex, Complex]) -> Eigenpair | None:
        """The mode near `start`; None if none is found."""
        return solved(self.residual, start, float(np.linalg.norm(self.inert(start[0]))))

    def residual(self, s: complex, v: Complex) -> Complex:
        """What is left of (E19) [N/m], (d,)."""
        left: Complex = self.inert(s) @ v + self.whirl.resistance(self.whirl.at(s), v)
        return left

    def led(self, start: tuple[complex, Complex]) -> Eigenpair | None:
        """The mode at the amplitude, from one in which petals stick; None where it is lost."""
        amplitude, found = self.whirl.amplitude, None
        sticks = min(self.whirl.sticks(start), amplitude)
        for step in range(math.ceil(math.log(amplitude / sticks, RAISED)), -1, -1):
            whirl = replace(self.whirl, amplitude=amplitude / RAISED**step)
            found = replace(self, whirl=whirl).near(start)
            if found is None:
                return None
            start = found.number, found.v
        return found

    def mode(self, found: Eigenpair, left: HarmonicsLeft) -> RubbingMode:
        """A solution as a mode. Its participation (E9) is that of the nonlinear equations, the amplitude held."""
        by_mass = found.unit * complex(*moved_by(found.slope, self.inert(found.number) @ found.v))
        share = 2.0 * abs(by_mass / found.number)
        mode = RubbingMode(upper(found.number), share, orbit(found.v), tilt_of(found.v), left.told)
        if left.resistance is None:
            return mode
        change = found.unit * complex(*moved_by(found.slope, left.resistance))
        return replace(mode, change=change if found.number.imag > 0.0 else change.conjugate())


def apart(modes: Iterable[tuple[RubbingMode, Eigenpair]]) -> list[tuple[RubbingMode, Eigenpair]]:
    """Those that differ, with their solutions."""
    kept: list[tuple[RubbingMode, Eigenpair]] = []
    for mode, found in modes:
        if not any(same(mode, other) for other, _ in kept):
            kept.append((mode, found))
    return kept


# ------------------------------------------------------------------------------------------ the neutral whirl


@dataclass(frozen=True)
class NeutralWhirls:
    """Whirls at the amplitude that neither grow nor die out, for rotors of any mass.

    Attributes
    ----------
    whirl : RubbingWhirl
        The bearings and the amplitude.
    inertia : Inertia
        That of a rotor of any mass, whose inertias are in proportion to it.
    speed : float
        Angular speed of the shaft [rad/s].
    """

    whirl: RubbingWhirl
    inertia: Inertia
    speed: float

    def least(self) -> Whirl:
        """The one of the smallest mass; infinite if none is found.

        They are looked for from several whirl ratios, and there from the shapes of linear bearings (petals that stick,
        petals without friction) and from circles both ways.
        """
        if whirls_at_any_mass(self.whirl.frictionless):
            return Whirl(0.0, 0.5)
        found = [self.near(nu, v) for nu in LOOKS for v in self.shapes(nu)]
        alone: list[RubbingNeutral] = []
        for whirl in (one for one in found if one is not None):
            if not any(alike(whirl, other) for other in alone):
                alone.append(whirl)
        better = [one.leaving(left) for one, left in (bettered(self.whirl, one, self.near_in) for one in alone)]
        return min(better, key=lambda one: one.mass, default=Whirl(np.inf, np.nan))

    def near_in(self, whirl: RubbingWhirl, known: RubbingNeutral) -> RubbingNeutral | None:
        """The neutral whirl near a known one, with other harmonics."""
        other, resists = replace(self, whirl=whirl), known.mass * (known.ratio * self.speed) ** 2
        pair = Eigenpair(0.0, known.v, known.slope, 1.0, int(np.flatnonzero(known.v == 1.0)[0]))
        found = solved_from(other.residual_near(known.ratio, resists), pair, resists * float(np.linalg.norm(known.v)))
        return other.neutral(found, known.ratio, resists)

    def shapes(self, nu: float) -> Iterator[Complex]:
        """Shapes to begin with at a whirl ratio."""
        gradient = self.whirl.frictionless.growing(1j * nu, current_run().probe_solver).force_gradient
        yield from np.linalg.eig(np.linalg.solve(self.shape(nu), gradient))[1].T
        for turn in (1j, -1j):
            circle = np.zeros(len(gradient), dtype=complex)
            circle[IN_PLANE] = 1.0, -turn
            yield circle

    def shape(self, nu: float) -> Complex:
        """`(M - i G / nu) / m`, inertia over mass at a whirl ratio, (d, d) [1]."""
        return np.asarray((self.inertia.mass - 1j * self.inertia.gyroscopic / nu) / self.inertia.mass[0, 0])

    def near(self, nu: float, v: Complex) -> RubbingNeutral | None:
        """The neutral whirl near a whirl ratio and a shape; None if none is found there, or none of a positive mass."""
        resists = self.whirl.resistance(self.whirl.at(1j * nu), v)
        value = float((v.conj() @ resists / (v.conj() @ self.shape(nu) @ v)).real)
        if not value > 0.0:
            return None

        found = solved(self.residual_near(nu, value), (0.0, v), value * float(np.linalg.norm(v)))
        return self.neutral(found, nu, value)

    def residual_near(self, nu: float, value: float) -> Callable[[complex, Complex], Complex]:
        """Residual by the logarithms of the ratio over `nu` and of the inertia over `value`, and by the shape."""

        def residual(logarithms: complex, v: Complex) -> Complex:
            by_ratio, by_size = np.clip([logarithms.real, logarithms.imag], -FAR, FAR)
            ratio, size = within(nu * math.exp(by_ratio)), value * math.exp(by_size)
            left: Complex = self.whirl.resistance(self.whirl.at(1j * ratio), v) - size * (self.shape(ratio) @ v)
            return left

        return residual

    def neutral(self, found: Eigenpair | None, nu: float, value: float) -> RubbingNeutral | None:
        """A solution of these as a neutral whirl; None where it went astray."""
        if found is None or max(abs(found.number.real), abs(found.number.imag)) >= FAR:
            return None
        ratio = nu * math.exp(found.number.real)
        if within(ratio) != ratio:
            return None
        mass = value * math.exp(found.number.imag) / (ratio * self.speed) ** 2
        return RubbingNeutral(mass, ratio, found.v, ONE_HARMONIC, found.slope)


def alike(one: Whirl, other: Whirl) -> bool:
    """Whether two solutions are the same neutral whirl."""
    return abs(one.mass - other.mass) <= APART * one.mass and abs(one.ratio - other.ratio) <= APART * one.ratio


def within(ratio: float) -> float:
    """The nearest whirl ratio of those that are looked at."""
    return float(np.clip(ratio, SCAN[0], SCAN[-1]))
