"""Friction between petals on a journal in a small whirl of a stated amplitude, slips in as many harmonics as they need.

The force on the journal is that of the first harmonic of friction, which alone works on a sinusoidal displacement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.friction_harmonics import FrictionHarmonics, Slips
from petalfoil.dynamics.harmonic_balance import FrictionCycle, SlidingContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import Motion
from petalfoil.errors import ConvergenceError
from petalfoil.system.friction import against_slip, slips

Complex = NDArray[np.complex128]

FREQUENCIES = 3
"""Harmonics at whose own frequency petals and film are solved: 1, 3 and 5. Above, contacts move as at the last: the
film hardly yields there. With all of them the loss of bearings changes by up to 2e-3 of it, from six on by 2e-4."""

FEWEST, MOST = 4, 32
"""Odd harmonics to begin with; the most."""

CHANGE = 5e-3
"""Change of the friction on the journal by twice as many harmonics, over it, at which they are enough."""

LARGEST = 2048
"""Most slips, one or two of each contact, with several harmonics: the step of Newton takes time in their cube."""


@dataclass(frozen=True)
class HarmonicsTold:
    """Odd harmonics of the slips, and by how much half as many would change the friction on the journal, over it.

    One harmonic has no half; the change is not known (nan).
    """

    friction_harmonics: int
    friction_harmonics_change: float

    @classmethod
    def between(cls, harmonics: int, force: Complex, half: Complex) -> HarmonicsTold:
        """From the force on the journal with so many and with half as many."""
        size = float(np.linalg.norm(force))
        return cls(harmonics, float(np.linalg.norm(force - half)) / size if size > 0.0 else 0.0)

    @classmethod
    def most_of(cls, told: list[HarmonicsTold]) -> HarmonicsTold:
        """The most harmonics, and the largest change."""
        changes = [one.friction_harmonics_change for one in told]
        return cls(max(one.friction_harmonics for one in told), float(np.max(changes)))

    @classmethod
    def fewest_of(cls, told: list[HarmonicsTold]) -> HarmonicsTold:
        """The fewest harmonics, and the largest change: not known where one of them is not."""
        changes = [one.friction_harmonics_change for one in told]
        return cls(min(one.friction_harmonics for one in told), float(np.max(changes)))


ONE_HARMONIC = HarmonicsTold(1, np.nan)
"""What is told of slips with one harmonic."""


def frequencies(least: int) -> int:
    """Harmonics at whose own frequency petals and film are solved; more where at least so many harmonics are asked for.

    They are a quarter of these, at least twice the usual, so that what is left is a small part of what harmonics leave.
    """
    return FREQUENCIES if least == 0 else max(2 * FREQUENCIES, least // 4)


def takes_several(sliding: SlidingContacts) -> bool:
    """Whether slips have several harmonics: of contacts that are not too many."""
    return len(sliding.limit) <= LARGEST


@dataclass(frozen=True)
class JournalForce:
    """Force on the journal, over unit of force and length [1], by one displacement or by each.

    Attributes
    ----------
    force : (d,) or (d, d) array
        The force, a column for each displacement.
    change : (d,) or (d, d) array
        By how much it differs from that with half as many harmonics; nan with one harmonic, which has no half.
    told : HarmonicsTold
        Harmonics, and the largest change.
    """

    force: Complex
    change: Complex
    told: HarmonicsTold


@dataclass(frozen=True)
class RubbingCycle:
    """A whirl of one frequency with friction.

    Attributes
    ----------
    cycle : FrictionCycle
        Contacts, response without friction and amplitude.
    compliances : (m, k, k) array
        Slips against unit friction forces at the harmonics 1, 3, 5 and so on; at the first where slips have one.
    least : int
        Fewest harmonics that are enough, however little they change friction; 0 for any.
    """

    cycle: FrictionCycle
    compliances: Complex
    least: int = 0

    @classmethod
    def of(cls, sliding: SlidingContacts, motion: Motion, s: complex, amplitude: float, least: int = 0) -> RubbingCycle:
        """A whirl in `exp(s tau)`, from small motions without friction, at an amplitude over the reference length.

        As many factorisations as `frequencies`, and as many solves for each contact. Slips have at least so many
        harmonics as `least` says.
        """
        harmonics = range(1, 2 * frequencies(least), 2) if takes_several(sliding) else range(1, 2)
        solver = current_run().probe_solver
        each = [
            FrictionCycle(sliding, motion.growing(complex(s.real, h * s.imag), solver), amplitude) for h in harmonics
        ]
        return cls(each[0], np.array([one.compliance() for one in each]), least)

    def force_gradient(self) -> JournalForce:
        """`dF/de` of film and contacts on the journal, (d, d).

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        response = self.cycle.response
        each = [self.with_enough(slips(self.cycle.sliding.friction, unit)) for unit in response.units.T]
        by_friction = np.column_stack([one.force for one in each])
        change = np.column_stack([one.change for one in each])
        told = HarmonicsTold.most_of([one.told for one in each])
        return JournalForce(response.force_gradient + by_friction, change, told)

    def with_enough(self, free: Complex) -> JournalForce:
        """Force of friction on the journal with as many harmonics as it needs, over the amplitude.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        if len(self.compliances) == 1:
            one = self.force(free, 1)
            return JournalForce(one, np.full_like(one, np.nan), ONE_HARMONIC)
        found, told = self.with_harmonics(free, FEWEST), HarmonicsTold(FEWEST, np.inf)
        force = half = self.on_journal(found.friction[0])
        while self.wants_more(told):
            half, harmonics = force, 2 * told.friction_harmonics
            found = self.with_harmonics(free, harmonics, found)
            force = self.on_journal(found.friction[0])
            told = HarmonicsTold.between(harmonics, force, half)
        return JournalForce(force, force - half, told)

    def wants_more(self, told: HarmonicsTold) -> bool:
        """Whether twice as many harmonics are to be tried."""
        changes = told.friction_harmonics_change > CHANGE and told.friction_harmonics < MOST
        return changes or told.friction_harmonics < self.least

    def force(self, free: Complex, harmonics: int) -> Complex:
        """Force of friction on the journal with so many harmonics, a power of 2, over the amplitude.

        `free` (k,) are the slips without friction.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        return self.on_journal(
            self.one(free)[1] if harmonics == 1 else self.with_harmonics(free, harmonics).friction[0]
        )

    def on_journal(self, friction: Complex) -> Complex:
        """Force on the journal by friction forces (k,), over the amplitude."""
        response = self.cycle.response
        return response.forced(-against_slip(self.cycle.sliding.friction, friction, len(response.units)))[1]

    def one(self, free: Complex) -> tuple[Complex, Complex]:
        """Slips and friction forces of one harmonic by (E11), (k,) each, over the amplitude.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        slip = self.cycle.settled(free, self.compliances[0])
        return slip, self.cycle.sliding.equivalent(slip, self.cycle.amplitude)[0] * slip

    def with_harmonics(self, free: Complex, harmonics: int, last: Slips | None = None) -> Slips:
        """Slips of so many harmonics (E22) from half as many, and so on from one; or from `last`, of so many or less.

        Samples begin where the slips without friction are largest together, so that turning their phase turns that of
        friction and changes nothing else.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        sliding = self.cycle.sliding
        directions, limit = sliding.friction.directions, sliding.limit / self.cycle.amplitude
        law = FrictionHarmonics(sliding.friction.stiffness, limit, self.compliances, directions)
        phase = complex(np.exp(0.5j * np.angle(complex(np.sum(free**2)))))
        if last is None:
            found = self.begun(law, free / phase, harmonics)
        else:
            found = law.solved(last.turned(1.0 / phase).joint, free / phase, 0)
        while len(found.joint) < harmonics:
            found = law.settled(free / phase, 2 * len(found.joint), found)
        current_run().note("harmonic balance", steps=found.steps, contacts=len(free), harmonics=harmonics)
        return found.turned(phase)

    def begun(self, law: FrictionHarmonics, free: Complex, harmonics: int) -> Slips:
        """The first slips, of one harmonic along lines, by a Newton's method that begins where contacts stick.

        Of contacts that slip in a plane, and where that method is lost, those of one harmonic are (E11), of which the
        first `FEWEST` follow.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        if law.directions == 1:
            try:
                return law.settled(free, 1)
            except ConvergenceError as failure:
                current_run().note("harmonic balance", outcome=f"slips of (E11) lead on: {failure}")
        return law.settled(free, min(FEWEST, harmonics), law.joined(*self.one(free)))


@dataclass
class FollowedSlips:
    """Slips in a number of harmonics, each solution the start of the next, for whirls near each other.

    Attributes
    ----------
    harmonics : int
        Odd harmonics, a power of 2.
    last : Slips or None
        The last solution.
    """

    harmonics: int
    last: Slips | None = None

    def friction(self, rubbing: RubbingCycle, free: Complex) -> Complex:
        """First harmonic of the friction forces over the amplitude, (k,), from the slips without friction.

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        self.last = rubbing.with_harmonics(free, self.harmonics, self.last)
        return np.asarray(self.last.friction[0])
