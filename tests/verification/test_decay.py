"""A journal that is led to and fro, and rotors whose swings die out: damping against that of harmonic balance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.impedance import cycle_impedance, elastic, elastic_and_sliding, sliding_at
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.analysis.release_at_nodes import released
from petalfoil.case import Case, Rotor
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.critical_mass import whirl_impedance
from petalfoil.dynamics.harmonic_balance import SlidingContacts
from petalfoil.dynamics.natural_modes import natural_modes
from petalfoil.dynamics.rotor_motion import Inertia, RotorMotion
from petalfoil.dynamics.rubbing_cycle import RubbingCycle
from petalfoil.dynamics.rubbing_modes import RubbingRotor
from petalfoil.dynamics.rubbing_whirl import RubbingWhirl
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import Motion
from petalfoil.equilibrium.solution import Solution
from petalfoil.system.friction import slips
from tests.cases import case
from tests.verification.test_sliding_histories import swings

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LOAD, MASS = 20.0, 0.1
"""Load on the journal [N] and mass of the rotor [kg]."""

HEAVY = 1e7
"""Inertia of a led journal over that which moves as the unit of force moves it: it does not feel the bearing."""


def rubbing(name: str, friction: float, cells: int) -> Case:
    """One of the examples under the load, with friction between petals."""
    return case(name, **{
        "model.cells_per_pitch": cells, "surface.petal_friction": friction, "surface.friction_width": 1e-11,
        "operation.load": (0.0, -LOAD),
    })  # fmt: skip


# ------------------------------------------------------------------------------------------ a led journal


@dataclass(frozen=True)
class LedRotor(RotorMotion):
    """A rotor that nothing but a force `-M a nu^2 cos(nu tau)` moves."""

    amplitude: Array
    ratio: float

    @classmethod
    def along(cls, rotor: RotorMotion, amplitude: Array, ratio: float) -> LedRotor:
        """From `amplitude` (d,) [1] at a frequency [1 / unit of time]."""
        own = {name: getattr(rotor, name) for name in ("load", "unbalance", "rotating", "schedule", "clock")}
        d = len(amplitude)
        return cls(HEAVY / ratio**2 * np.eye(d), np.zeros((d, d)), **own, amplitude=amplitude, ratio=ratio)

    def outside(self, tau: float) -> Array:
        """The force, (d,) [1]."""
        return np.asarray(-self.inertia @ self.amplitude * self.ratio**2 * np.cos(self.ratio * tau))


def led(bearing: Case, amplitude: float, ratio: float, steps: int) -> tuple[complex, complex]:
    """`K + i Omega C` [N/m] along x of the second cycle of a journal that is led along x, and that of harmonic balance.

    Contacts of both are at the same nodes.
    """
    with running():
        answer = operating_point(bearing, None).answer
        sliding, scales, speed = sliding_at(bearing, answer), answer.problem.layout.scales, bearing.operation.speed
        assert sliding is not None
        rubs = cycle_impedance(SmallMotion.at_nodes(answer), ratio * speed, speed, (sliding, amplitude))
        x, y = answer.problem.displacement * scales.length
        begun = Orbit.begin(
            bearing.replace(rotor=Rotor(mass=MASS)), OrbitRequest(duration=1.0, initial=(x + amplitude, y))
        )
        rotor = LedRotor.along(begun.system.rotor, np.array([amplitude / scales.length, 0.0]), ratio)
        system, start, period = replace(begun.system, rotor=rotor), begun.start, 2.0 * np.pi / ratio
        start = released(
            system, 0.0, (start.x, start.lam, start.active), (start.moving.e, np.zeros_like(start.moving.e))
        )
        options = MarchOptions(tolerance=1e-5, first=period / steps, longest=period / steps, fixed=True)
        times, force = [], []
        for stepped in march(system, start, 2.0 * period, options):
            there = stepped.end
            problem = system.problem.at(displacement=there.e, bearing_number=rotor.bearing_number(there.tau))
            times.append(there.tau)
            force.append(problem.journal_force(there.x, there.lam)[0] * scales.force)
    tau, F = np.array(times[-steps - 1 :]), np.array(force[-steps - 1 :])
    first = 2.0 / period * np.trapezoid(F * np.exp(-1j * ratio * tau), tau)
    return complex(-first / amplitude), complex(rubs.stiffness[0, 0], ratio * speed * rubs.damping[0, 0])


@pytest.mark.slow
def test_a_led_journal_loses_what_harmonic_balance_says() -> None:
    """Eight petals, contacts of both at the same nodes: within 0.5 %, friction in proportion to the amplitude.

    Normal forces, film and contacts then change little.
    """
    for amplitude in (2e-6, 8e-6):
        loop, harmonic = led(rubbing("paper_n8", amplitude * 312.5, 24), amplitude, 0.7, 60)
        assert loop.imag == pytest.approx(harmonic.imag, rel=0.005)
        assert loop.real == pytest.approx(harmonic.real, rel=0.005)


# ------------------------------------------------------------------------------------------ swings that die out


def passing(motion: Motion, sliding: SlidingContacts, amplitude: float, guess: complex, harmonics: int = 16) -> complex:
    """`s` [rad/s] with which a rotor swings along x past an amplitude [m]: `m s^2 + Z(s, a) = 0`, by secants."""
    scales, speed = motion.problem.layout.scales, motion.problem.layout.case.operation.speed

    def left(s: complex) -> complex:
        rubbing = RubbingCycle.of(sliding, motion, s / speed, amplitude / scales.length)
        response = rubbing.cycle.response
        friction = rubbing.force(slips(sliding.friction, response.units[:, 0]), harmonics)
        gradient = response.force_gradient[0, 0] + friction[0]
        return complex(MASS * s**2 - gradient * scales.force / scales.length)

    last, s = guess, 1.001 * guess
    while abs(s - last) > 1e-7 * abs(s):
        last, s = s, s - left(s) * (s - last) / (left(s) - left(last))
    return s


def swung(bearing: Case, released: float, turns: float) -> tuple[Solution, list[tuple[float, complex]]]:
    """The balance, and amplitude [m] and `s` [rad/s] of each swing along x of a rotor released beside it."""
    answer = operating_point(bearing, None).answer
    x, y = answer.problem.displacement * answer.problem.layout.scales.length
    rotor = bearing.replace(rotor=Rotor(mass=MASS))
    record = orbit.record(rotor, revolutions=turns, initial=(x + released, y), tolerance=1e-4)
    sizes, times = swings(record.coords["time"].astype(float), np.asarray(record.fields["x"], dtype=float))
    found = []
    for k in range(len(sizes) - 1):
        frequency = 2.0 * np.pi / (times[k] + times[k + 1])
        rate = np.log(sizes[k] / sizes[k + 1]) * frequency / np.pi
        found.append((float(np.sqrt(sizes[k] * sizes[k + 1])), complex(-rate, frequency)))
    return answer, found


def damping_ratio(s: complex) -> float:
    """`-Re s / |s|`."""
    return -s.real / abs(s)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [pytest.param(0.02, marks=pytest.mark.long), 0.1])
def test_a_rotor_on_the_rig_decays_as_harmonic_balance_says(friction: float) -> None:
    """Swings of 5 to 9 um with contact points that travel: damping ratios within 5 %."""
    bearing = rubbing("rig", friction, 24)
    with running():
        answer, decay = swung(bearing, 10e-6, 0.8)
        points, sliding = elastic_and_sliding(bearing, answer)
        assert sliding is not None
        for amplitude, s in decay[:3]:
            expected = damping_ratio(passing(points.frictionless, sliding, amplitude, s))
            assert damping_ratio(s) == pytest.approx(expected, rel=0.05)


@pytest.mark.long
def test_what_harmonic_balance_misses_of_the_rigs_swings_is_the_film() -> None:
    """On the default grid: over the same ratio with hardly any friction 1.02 at first, then 1 within 0.5 %.

    Harmonic balance is linear in the film, of which the first swing is three times as large. Friction's part alone is
    a tenth of the damping. In the first swing it is a quarter more than in cycles, in those that follow within 6 %.
    """

    def compared(friction: float) -> Array:
        """Amplitudes, damping ratios of swings and of harmonic balance; (3, swings)."""
        bearing = rubbing("rig", friction, 192)
        with running():
            answer, decay = swung(bearing, 10e-6, 0.8)
            points, sliding = elastic_and_sliding(bearing, answer)
            assert sliding is not None
            expected = [damping_ratio(passing(points.frictionless, sliding, size, s)) for size, s in decay[:4]]
        return np.array([[size for size, _ in decay[:4]], [damping_ratio(s) for _, s in decay[:4]], expected])

    (size, found, expected), (of, measured, film) = compared(0.1), compared(1e-5)
    assert_allclose(film, film[0], rtol=1e-3)
    over = np.interp(size, of[::-1], (measured / film)[::-1])
    left = found / expected / over
    assert 1.01 < left[0] < 1.03
    assert_allclose(left[1:], 1.0, atol=5e-3)
    alone = (found - over * film[0]) / (expected - film[0])
    assert 1.2 < alone[0] < 1.3
    assert_allclose(alone[1:], 1.0, atol=0.06)


@pytest.mark.long
@pytest.mark.parametrize("cells", [48, 128])
def test_small_swings_on_fine_grids_decay_as_harmonic_balance_says(cells: int) -> None:
    """Eight petals, swings of 7 to 9 um, nearly all of the damping friction: 3 to 5 % more, frequencies within 1 %.

    A swing that dies out takes no energy from the springs of contacts that slip at both turns, which harmonic balance
    counts as stiffness: friction's part of it is 5 %. In a cycle both agree (`test_friction_in_time.py`).

    Contacts at nodes hold the journal by 11 % less damping on 128 cells, within whose cells their points stay.
    """
    bearing = rubbing("paper_n8", 0.0025, cells)
    with running():
        answer, decay = swung(bearing, 10e-6, 13.0)
        points, sliding = elastic_and_sliding(bearing, answer)
        assert sliding is not None
        for amplitude, s in decay[:2]:
            expected = passing(points.frictionless, sliding, amplitude, s)
            assert 1.0 < damping_ratio(s) / damping_ratio(expected) < 1.05
            assert s.imag == pytest.approx(expected.imag, rel=0.01)


@pytest.mark.long
def test_a_rotor_decays_as_the_mode_of_its_amplitude_on_the_default_grid() -> None:
    """Eight petals, swings of 41 and 33 um: the mode (E19) that moves along x, within 5 %."""
    bearing = rubbing("paper_n8", 0.0125, 128)
    speed = bearing.operation.speed
    with running():
        answer, decay = swung(bearing, 50e-6, 13.0)
        motion = elastic(bearing, answer)
        start = natural_modes(whirl_impedance(motion.frictionless), Inertia.of_mass(MASS), speed)
        assert start
        for amplitude, s in decay[:2]:
            rotor = RubbingRotor(RubbingWhirl.of(motion, amplitude), Inertia.of_mass(MASS), speed)
            mode = rotor.near((s / speed, np.array([1.0, 0.0], dtype=complex)))
            assert mode is not None
            assert abs(mode.v[1]) < 0.1 * abs(mode.v[0])
            assert damping_ratio(s) == pytest.approx(damping_ratio(mode.number), rel=0.05)
            assert_allclose(s.imag, mode.number.imag * speed, rtol=0.05)
