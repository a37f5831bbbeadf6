"""Slips in a plane in several harmonics (E20b): closed forms, lines in the plane, contacts followed in time, 3-D."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding
from petalfoil.analysis.operating_point import operating_point
from petalfoil.dynamics.friction_harmonics import FrictionHarmonics
from petalfoil.dynamics.rubbing_cycle import CHANGE, RubbingCycle
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import ConvergenceError
from petalfoil.physics.sampled_disk import SampledDisk
from petalfoil.physics.sampled_friction import HalfPeriod, SampledFriction
from petalfoil.system.friction import slips
from tests.cases import case
from tests.verification.test_friction_harmonics import by_doubling, some

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def parts_of(values: Complex) -> Array:
    """Real parts of all harmonics, then imaginary ones."""
    return np.concatenate([values.real, values.imag])


def test_derivatives_of_friction_in_a_plane_are_theirs() -> None:
    """Taylor: contacts that stick, slip a little and slip far; compliances that differ by 50; of the residual too."""
    compliance = np.array([[1.0, 0.5, 1.4, 0.8], [0.02, 0.5, 0.3, 2.0]])
    limit, slip, step = np.array([0.5, 0.9, 90.0, 0.2]), some(3, 8), some(3, 8, seed=2)
    law = SampledDisk(compliance, limit, HalfPeriod(3))
    cycle, (size, scale) = law.cycle(slip), (1e-6, 1e-6)
    assert np.any(np.linalg.norm(cycle.start, axis=0) < limit)
    moves = parts_of(step).reshape(6, 2, 4).transpose(2, 1, 0).reshape(4, 12)
    change = np.einsum("kab,kb->ka", cycle.derivative, moves).reshape(4, 2, 6).transpose(2, 1, 0).reshape(6, 8)
    moved = parts_of(law.cycle(slip + size * step).force - cycle.force) / size
    assert_allclose(moved, change, atol=scale * float(np.max(np.abs(change))))
    whole = FrictionHarmonics(np.full(8, 2.0), np.tile(limit, 2), some(2, 8, 8, seed=3), 2)
    left, at = whole.left(slip, slip[0])
    away = (whole.left(slip + size * step, slip[0])[0] - left) / size
    slope = whole.tangent(at).times(step)
    assert_allclose(away, slope, atol=scale * float(np.max(np.abs(slope))))


def test_a_step_of_newton_solves_its_equations() -> None:
    """All of them, by GMRES, to what a step may leave."""
    whole = FrictionHarmonics(np.full(12, 2.0), np.full(12, 0.4), some(2, 12, 12, seed=3) + 9.0 * np.eye(12), 2)
    slip, right = some(4, 12), some(4, 12, seed=5)
    tangent = whole.tangent(whole.cycle(slip))
    left = tangent.times(tangent.solve(right)) - right
    assert np.linalg.norm(left) <= 1e-2 * np.linalg.norm(right)
    assert np.linalg.norm(tangent.times(right) - right) > 0.5 * np.linalg.norm(right)


def test_slips_along_a_line_of_the_plane_are_those_of_a_line() -> None:
    """Of equal compliance in both directions, along any line; of unequal ones along an axis. Exactly."""
    slip, limit, time = some(3, 5), np.array([0.5, 0.9, 0.4, 0.2, 50.0]), HalfPeriod(3)
    stiffness = np.array([1.0, 2.0, 0.7, 1.3, 1.1])
    line = SampledFriction(stiffness, limit, time).cycle(slip).force
    for angle, other in ((0.0, 40.0), (0.5 * np.pi, 1.0), (0.7, 1.0)):
        c, s = np.cos(angle), np.sin(angle)
        found = SampledDisk(np.array([1.0 / stiffness, 1.0 / (other * stiffness)]), limit, time)
        force = found.cycle(np.hstack([c * slip, s * slip])).force
        assert_allclose(force, np.hstack([c * line, s * line]), atol=1e-11)


def test_a_contact_that_is_led_round_has_its_closed_form() -> None:
    """Its spring touches the circle that its foot goes round: it lags by an angle whose cosine is `L/A`.

    To the first order of the samples, 1 % of the force with 128; a foot that is not left behind sticks.
    """
    limit = np.array([0.3, 0.8, 2.0])
    held = np.minimum(limit, 1.0)
    exact = held * (held + 1j * np.sqrt(1.0 - held**2))
    errors = []
    for harmonics in (1, 16):
        law = SampledDisk(np.ones((2, 3)), limit, HalfPeriod(harmonics))
        assert len(law.time.basis) == (128 if harmonics == 1 else 248)
        slip = np.zeros((harmonics, 6), dtype=complex)
        slip[0] = np.repeat([1.0, -1.0j], 3)
        force = law.cycle(slip).force[0].reshape(2, 3)
        assert_allclose(force[1], -1j * force[0], atol=1e-12)
        errors.append(float(np.max(np.abs(force[0] - exact))))
    assert errors[0] < 0.01
    assert errors[1] < 0.55 * errors[0]


def coupled() -> tuple[FrictionHarmonics, Complex]:
    """Two contacts that move each other in both directions, along the shaft a third as much."""
    R = np.array([[2.0, 1.2, 0.3, -0.2], [1.2, 1.8, 0.1, 0.2], [0.3, 0.1, 0.7, 0.3], [-0.2, 0.2, 0.3, 0.6]])
    law = FrictionHarmonics(np.full(4, 40.0), np.tile([0.15, 0.3], 2), R[None].astype(complex), 2)
    return law, np.array([1.0, 0.9, 0.5j, 0.4])


def followed(law: FrictionHarmonics, free: Complex, steps: int) -> Complex:
    """First harmonic of friction on contacts led in equilibria by `Re(free exp(i t))`, in the second period.

    Every step solves by projections: forces within their disks that hold back slips against them.
    """
    R = law.compliances[0].real + np.diag(1.0 / law.stiffness)
    pull = 1.0 / float(np.linalg.norm(R, 2))
    times = 2.0 * np.pi * np.arange(1, 2 * steps + 1) / steps
    force, before, path = np.zeros(len(free)), free.real, []
    for now in np.real(free * np.exp(1j * times)[:, None]):
        wanted = now - before + R @ force
        for _ in range(2000):
            trial = (force + pull * (wanted - R @ force)).reshape(2, -1)
            size = np.linalg.norm(trial, axis=0)
            ahead = (trial * np.minimum(1.0, law.limit[: len(size)] / np.maximum(size, 1e-300))).ravel()
            change, force = float(np.max(np.abs(ahead - force))), ahead
            if change < 1e-12:
                break
        before = now
        path.append(force)
    return np.asarray(2.0 / steps * np.exp(-1j * times[steps:]) @ np.array(path[steps:]))


@pytest.mark.slow
def test_contacts_in_a_plane_that_move_each_other_are_those_followed_in_time() -> None:
    """Twice as many harmonics, less than 0.7 of the error; with 32 0.5 %. One is 10 % off."""
    law, led = coupled()
    exact = followed(law, led, 400)
    size = np.linalg.norm(exact)
    errors = [np.linalg.norm(by_doubling(law, led, n).friction[0] - exact) / size for n in (1, 8, 16, 32)]
    assert errors[0] > 0.05
    assert errors[1] < 0.02
    assert errors[2] < 0.7 * errors[1]
    assert errors[3] < 0.005


def test_contacts_that_nothing_moves_along_the_shaft_are_those_of_lines() -> None:
    """As in a pack whose state is uniform along the shaft: the same slips and forces to 1e-9, none along it."""
    R = np.array([[2.0, 1.4, 0.6], [1.4, 1.8, 0.9], [0.6, 0.9, 1.2]])
    whole = np.zeros((6, 6), dtype=complex)
    whole[:3, :3], whole[3:, 3:] = R, 0.02 * R
    limit, led = np.array([0.05, 0.2, 0.1]), np.array([1.0, 0.9j, 0.3])
    line = by_doubling(FrictionHarmonics(np.full(3, 1e2), limit, R[None].astype(complex)), led, 8)
    plane = FrictionHarmonics(np.full(6, 1e2), np.tile(limit, 2), whole[None], 2)
    found = by_doubling(plane, np.concatenate([led, np.zeros(3)]), 8)
    assert_allclose(found.friction[:, :3], line.friction, atol=1e-9)
    assert_allclose(found.friction[:, 3:], 0.0, atol=1e-12)


def test_forces_that_do_not_repeat_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.physics.sampled_disk.LAPS", 1)
    law, led = coupled()
    with pytest.raises(ConvergenceError, match="do not repeat in 1 half periods"):
        by_doubling(law, led, 4)


# ------------------------------------------------------------------------------------------ eight petals in 3-D


@cache
def eight_petals(amplitude: float) -> RubbingCycle:
    """A whirl along the axes at 4000 rad/s of petals that slip along themselves and along the shaft."""
    grid = {"model.cells_per_pitch": 8, "model.axial_cells": 4}
    bearing = case("paper_n8_spatial", **grid, **{"surface.petal_friction": 0.3, "petals.theory": "shell"})
    with running():
        answer = operating_point(bearing, (0.0, -20.0)).answer
        motion, sliding = elastic_and_sliding(bearing, answer)
        assert sliding is not None
        assert sliding.friction.directions == 2
        ratio = 4000.0 / bearing.operation.speed
        length = answer.problem.layout.scales.length
        return RubbingCycle.of(sliding, motion.frictionless, 1j * ratio, amplitude / length)


@pytest.mark.slow
def test_one_harmonic_in_3d_is_the_first_one_alone_when_asked_for() -> None:
    """(E11) to 1e-9."""
    whirl = eight_petals(5e-6)
    with running():
        one = whirl.cycle.force_gradient()
        for column, unit in enumerate(whirl.cycle.response.units.T):
            by_friction = whirl.force(slips(whirl.cycle.sliding.friction, unit), 1)
            found = whirl.cycle.response.force_gradient[:, column] + by_friction
            assert_allclose(found, one[:, column], rtol=0.0, atol=1e-9 * float(np.max(np.abs(one))))


@pytest.mark.slow
def test_harmonics_settle_in_3d_and_a_turn_of_the_phase_turns_friction_alone() -> None:
    """From 8 to 16 harmonics the friction on the journal changes by 0.3 %; one harmonic has 30 % more loss at 5 um."""
    whirl = eight_petals(5e-6)
    free, turn = slips(whirl.cycle.sliding.friction, whirl.cycle.response.units[:, 0]), np.exp(0.7j)
    with running():
        one, eight, sixteen = (whirl.force(free, harmonics) for harmonics in (1, 8, 16))
        assert_allclose(whirl.force(turn * free, 8), turn * eight, rtol=1e-7)
    assert np.linalg.norm(sixteen - eight) <= 3e-3 * np.linalg.norm(sixteen)
    assert 0.7 <= sixteen[0].imag / one[0].imag <= 0.8


@pytest.mark.slow
def test_coefficients_in_3d_tell_their_harmonics() -> None:
    grid = {"model.cells_per_pitch": 8, "model.axial_cells": 4}
    bearing = case("paper_n8_spatial", **grid, **{"surface.petal_friction": 0.3, "petals.theory": "shell"})
    record = coefficients.record(bearing, [4000.0], load=(0.0, -20.0), amplitude=5e-6)
    assert record.scalars["friction_harmonics"] >= 8
    assert 0.0 < record.scalars["friction_harmonics_change"] <= CHANGE
