"""Slips in several harmonics (E20)-(E22) against contacts with closed forms, and packs of contacts followed in time."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding
from petalfoil.analysis.operating_point import operating_point
from petalfoil.dynamics.friction_harmonics import OWN, FrictionHarmonics, Slips
from petalfoil.dynamics.rubbing_cycle import CHANGE, FREQUENCIES, RubbingCycle
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import ConvergenceError
from petalfoil.physics.dry_friction import equivalent_stiffness
from petalfoil.physics.sampled_friction import HalfPeriod, SampledFriction
from petalfoil.system.friction import slips
from tests.cases import case
from tests.random_packs import random_case

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def some(*shape: int, seed: int = 1) -> Complex:
    """Complex numbers that are not special."""
    random = np.random.default_rng(seed)
    return np.asarray(random.normal(size=shape) + 1j * random.normal(size=shape))


def by_doubling(law: FrictionHarmonics, free: Complex, harmonics: int) -> Slips:
    """Slips with a power of two of harmonics."""
    with running():
        found = law.settled(free, 1)
        while len(found.joint) < harmonics:
            found = law.settled(free, 2 * len(found.joint), found)
    return found


# ------------------------------------------------------------------------------------------ friction


def test_samples_of_one_harmonic_have_the_closed_form() -> None:
    """(E10) to the second order of the samples: contacts that stick, slip a little and slip far."""
    stiffness, limit = np.array([1.0, 2.0, 0.7, 1.3]), np.array([0.5, 0.9, 0.4, 0.2])
    slip = np.array([0.4, 0.5, 0.8j, -2.0 + 1.0j])
    force = SampledFriction(stiffness, limit, HalfPeriod(1)).cycle(slip[None]).force[0]
    expected = equivalent_stiffness(stiffness, limit, np.abs(slip))[0] * slip
    assert_allclose(force, expected, rtol=2e-4)
    assert force[0] == pytest.approx(stiffness[0] * slip[0], rel=1e-14)


def test_derivatives_of_friction_and_residual_are_theirs() -> None:
    """Taylor: remainders of contacts that stick and slip, below rounding where no sample begins to slip."""
    stiffness, limit = np.array([1.0, 2.0, 0.7, 1.3, 1.1]), np.array([0.5, 0.9, 0.4, 0.2, 50.0])
    slip, step = some(3, 5), some(3, 5, seed=2)
    law = SampledFriction(stiffness, limit, HalfPeriod(3))
    parts = np.concatenate([step.real, step.imag])
    change = np.einsum("kab,bk->ak", law.cycle(slip).derivative, parts)
    whole = FrictionHarmonics(stiffness, limit, some(2, 5, 5, seed=3))
    slope = whole.tangent(whole.cycle(slip)).times(step)
    by_slope = np.concatenate([slope.real, slope.imag])
    for size in (1e-5, 1e-6):
        moved = (law.cycle(slip + size * step).force - law.cycle(slip).force) / size
        assert_allclose(np.concatenate([moved.real, moved.imag]), change, atol=1e-7)
        left = [whole.left(slip + part * step, slip[0])[0] for part in (size, 0.0)]
        away = (left[0] - left[1]) / size
        assert_allclose(np.concatenate([away.real, away.imag]), by_slope, atol=1e-6)


# ------------------------------------------------------------------------------------------ contacts behind springs


def test_contacts_behind_springs_have_their_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact led through a spring is one with both in series (Jenkins): its loop, force and loss.

    With the whole spring in `r` samples alone err. With a part of it forces err by more than 5 % with one harmonic, by
    1.2 % with 4 and by less than 1e-3 with 16.
    """
    contact, spring = np.full(3, 40.0), np.array([0.5, 1.0, 2.0])
    limit, led = np.array([0.1, 0.3, 0.6]), np.array([1.0, 0.8 + 0.6j, -1.0j])
    series = 1.0 / (1.0 / contact + 1.0 / spring)
    exact = equivalent_stiffness(series, limit, np.abs(led))[0] * led
    whole, part = [], []
    for size, errors in ((1.0, whole), (0.3, part)):
        monkeypatch.setattr("petalfoil.dynamics.friction_harmonics.OWN", size)
        law = FrictionHarmonics(contact, limit, np.diag(1.0 / spring)[None].astype(complex))
        errors += [np.abs(by_doubling(law, led, n).friction[0] / exact - 1.0).max() for n in (1, 4, 16)]
    assert max(whole) < 2e-4
    assert part[0] > 0.05
    assert part[1] < 0.015
    assert part[2] < 1e-3
    loss = np.pi * np.imag(np.conj(led) * by_doubling(law, led, 16).friction[0])
    assert_allclose(loss, 4.0 * limit * (np.abs(led) - limit / series), rtol=2e-3)


def followed(law: FrictionHarmonics, free: Complex, steps: int) -> Complex:
    """First harmonic of friction on contacts led in equilibria by `Re(free exp(i t))`, in the second period.

    Every step solves for forces within their limits that hold back slips against them, one contact after the other.
    """
    R = law.compliances[0].real + np.diag(1.0 / law.stiffness)
    times = 2.0 * np.pi * np.arange(1, 2 * steps + 1) / steps
    way = np.real(free * np.exp(1j * times)[:, None])
    force, before, path = np.zeros(len(free)), free.real, []
    for now in way:
        wanted, start = now - before, force.copy()
        for _ in range(500):
            last = force.copy()
            for k, row in enumerate(R):
                slip = wanted[k] - row @ (force - start)
                force[k] = np.clip(force[k] + slip / R[k, k], -law.limit[k], law.limit[k])
            if np.max(np.abs(force - last)) < 1e-13:
                break
        before = now
        path.append(force.copy())
    return np.asarray(2.0 / steps * np.exp(-1j * times[steps:]) @ np.array(path[steps:]))


def test_contacts_that_move_each_other_are_those_followed_in_time() -> None:
    """Three on one leaf that give nothing themselves: twice as many harmonics, half of the error; with 32 0.3 %."""
    R = np.array([[2.0, 1.4, 0.6], [1.4, 1.8, 0.9], [0.6, 0.9, 1.2]])
    law = FrictionHarmonics(np.full(3, 1e4), np.array([0.05, 0.2, 0.1]), R[None].astype(complex))
    led = np.array([1.0, 0.9, 0.3], dtype=complex)
    exact = followed(law, led, 800)
    size = np.linalg.norm(exact)
    errors = [np.linalg.norm(by_doubling(law, led, n).friction[0] - exact) / size for n in (8, 16, 32)]
    assert errors[0] < 0.015
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.005


def test_contacts_that_move_together_keep_what_they_give_against_each_other() -> None:
    """The tangent is far from singular where all stick, and `r` is that of `R` for a contact that moves no other.

    With 0.3 of the diagonal of `R` its least eigenvalue would be 6e-5.
    """
    petals = np.array([[0.6, 0.2], [0.2, 0.6]])
    together = la.block_diag(np.kron(petals, np.ones((3, 3))) + 1e-5 * np.eye(6), 0.7)
    law = FrictionHarmonics(np.full(7, 1e6), np.full(7, 0.1), together[None].astype(complex))
    sticking = np.eye(7) + law.coupling[0].real / (1.0 / law.stiffness + law.own)
    assert np.min(np.linalg.eigvals(sticking).real) > 0.5
    assert law.own[-1] == pytest.approx(OWN * 0.7, rel=1e-9)
    assert_allclose(law.own[:-1], OWN * 1.5e-5, rtol=0.05)  # one of three that share a petal, others stuck


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1000, 1013])
def test_packs_whose_contacts_move_together_are_answered(seed: int) -> None:
    """Their slips against each other take 1e-5 of the compliance of a petal."""
    changes = {"surface.petal_friction": 0.3, "model.cells_per_pitch": 64}
    record = coefficients.record(random_case(np.random.default_rng(seed), **changes), amplitude=10e-6)
    assert record.scalars["friction_harmonics"] >= 8  # type: ignore[operator]
    assert record.scalars["friction_harmonics_change"] <= CHANGE  # type: ignore[operator]


def test_what_a_contact_has_to_itself_changes_nothing_with_many_harmonics(monkeypatch: pytest.MonkeyPatch) -> None:
    """`r` is a choice: from a tenth to all of the compliance the force changes by less than 0.5 %."""
    R = np.array([[2.0, 1.4, 0.6], [1.4, 1.8, 0.9], [0.6, 0.9, 1.2]])[None].astype(complex)
    led, forces = np.array([1.0, 0.9, 0.3], dtype=complex), []
    for part in (0.1, 0.3, 1.0):
        monkeypatch.setattr("petalfoil.dynamics.friction_harmonics.OWN", part)
        law = FrictionHarmonics(np.full(3, 1e4), np.array([0.05, 0.2, 0.1]), R)
        forces.append(by_doubling(law, led, 16).friction[0])
    for force in forces[1:]:
        assert_allclose(force, forces[0], atol=0.005 * float(np.max(np.abs(forces[0]))))
    assert np.max(np.abs(forces[2] - forces[0])) > 0.0


def test_contacts_that_hold_stick_in_every_harmonic() -> None:
    R = np.array([[2.0, 1.4], [1.4, 1.8]], dtype=complex)[None]
    law = FrictionHarmonics(np.array([5.0, 7.0]), np.full(2, 10.0), R)
    led = np.array([1.0, 0.5j])
    found = by_doubling(law, led, 8)
    stuck = np.linalg.solve(R[0] + np.diag(1.0 / law.stiffness), led)
    assert_allclose(found.friction[0], stuck, rtol=1e-12)
    assert_allclose(found.friction[1:], 0.0, atol=1e-13)


def test_slips_that_do_not_settle_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.dynamics.friction_harmonics.STEPS", 1)
    R = np.array([[2.0, 1.4], [1.4, 1.8]], dtype=complex)[None]
    law = FrictionHarmonics(np.full(2, 40.0), np.array([0.1, 0.02]), R)
    with pytest.raises(ConvergenceError, match="harmonics of friction between petals do not agree"):
        by_doubling(law, np.ones(2, dtype=complex), 4)


def test_a_swing_that_dies_out_is_no_cycle() -> None:
    """A mass on a spring `K` with one contact: its damping ratio is `1 + Re Z_f / K` that of its cycles, within 0.5 %.

    The contact holds as much energy at every turn, so that the loss is taken from `K` alone.
    """
    K, stiffness, limit, step = 1.0, 0.5, 0.01, 5e-4
    x, v, force, turns = 0.1, 0.0, 0.0, [0.1]
    while len(turns) < 4:  # leapfrog
        half = v - 0.5 * step * (K * x + force)
        force = float(np.clip(force + stiffness * step * half, -limit, limit))
        x += step * half
        now = half - 0.5 * step * (K * x + force)
        if now * v < 0.0:
            turns.append(x)
        v = now
    sizes = 0.5 * np.abs(np.diff(turns))[1:]  # the first begins without friction
    decrement = np.log(sizes[0] / sizes[1]) / np.pi
    size = np.array([np.sqrt(sizes[0] * sizes[1])])
    friction = complex(equivalent_stiffness(np.array([stiffness]), np.array([limit]), size)[0][0])
    s = complex(np.sqrt(-(K + friction)))
    assert friction.real / K > 0.1
    ratio = decrement / np.hypot(1.0, decrement) * abs(s) / abs(s.real)
    assert ratio == pytest.approx(1.0 + friction.real / K, rel=5e-3)


# ------------------------------------------------------------------------------------------ eight petals


def eight_petals(amplitude: float) -> RubbingCycle:
    """A whirl along the axes at 8000 rad/s."""
    bearing = case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": 24})
    answer = operating_point(bearing, (0.0, -20.0)).answer
    motion, sliding = elastic_and_sliding(bearing, answer)
    assert sliding is not None
    return RubbingCycle.of(sliding, motion.frictionless, 1j, amplitude / answer.problem.layout.scales.length)


@pytest.mark.slow
def test_one_harmonic_is_the_first_one_alone_when_asked_for() -> None:
    """(E11) to 1e-9; with as many harmonics as it needs the loss of eight petals at 10 um is 20 and 25 % less."""
    with running():
        whirl = eight_petals(10e-6)
        one, several = whirl.cycle.force_gradient(), whirl.force_gradient()
        for column, unit in enumerate(whirl.cycle.response.units.T):
            by_friction = whirl.force(slips(whirl.cycle.sliding.friction, unit), 1)
            found = whirl.cycle.response.force_gradient[:, column] + by_friction
            assert_allclose(found, one[:, column], rtol=0.0, atol=1e-9 * float(np.max(np.abs(one))))
    assert several.told.friction_harmonics >= 8
    assert several.told.friction_harmonics_change <= CHANGE
    assert_allclose(np.diag(several.force).imag / np.diag(one).imag, [0.798, 0.754], atol=0.01)


@pytest.mark.slow
def test_a_turn_of_the_phase_turns_friction_alone() -> None:
    with running():
        whirl = eight_petals(10e-6)
        free = slips(whirl.cycle.sliding.friction, whirl.cycle.response.units @ np.array([1.0, 0.4j]))
        turn = np.exp(0.7j)
        assert_allclose(whirl.force(turn * free, 8), turn * whirl.force(free, 8), rtol=1e-8)


@pytest.mark.slow
def test_more_frequencies_change_the_loss_little(monkeypatch: pytest.MonkeyPatch) -> None:
    """Contacts that move above the fifth harmonic as at the fifth: 0.5 % of the friction on the journal."""
    forces = []
    for count in (FREQUENCIES, 8):
        monkeypatch.setattr("petalfoil.dynamics.rubbing_cycle.FREQUENCIES", count)
        with running():
            whirl = eight_petals(10e-6)
            assert len(whirl.compliances) == count
            forces.append(whirl.force(slips(whirl.cycle.sliding.friction, whirl.cycle.response.units[:, 1]), 8))
    assert 0.0 < np.linalg.norm(forces[1] - forces[0]) < 0.005 * np.linalg.norm(forces[1])


@pytest.mark.slow
def test_large_packs_have_one_harmonic(monkeypatch: pytest.MonkeyPatch) -> None:
    """And say so."""
    whole = {"model.cells_per_pitch": 8, "model.axial_cells": 4, "surface.petal_friction": 0.3}

    def told() -> dict[str, object]:
        return coefficients.record(
            case("paper_n8_spatial", **whole), [4000.0], load=(0.0, -10.0), amplitude=1e-6
        ).scalars

    assert told()["friction_harmonics"] == 8
    monkeypatch.setattr("petalfoil.dynamics.rubbing_cycle.LARGEST", 8)
    one = told()
    assert one["friction_harmonics"] == 1
    assert np.isnan(float(str(one["friction_harmonics_change"])))
