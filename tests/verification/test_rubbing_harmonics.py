"""Modes and neutral whirls at an amplitude with several harmonics of the slips: `stability` as `coefficients`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.harmonics_bars import harmonics_bar
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.stability import harmonics_told, mode_fields, stability
from petalfoil.case import Case
from petalfoil.dynamics.critical_mass import Whirl
from petalfoil.dynamics.eigenpairs import Eigenpair
from petalfoil.dynamics.more_harmonics import bettered
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.dynamics.rubbing_cycle import CHANGE, ONE_HARMONIC, FollowedSlips, HarmonicsTold, RubbingCycle
from petalfoil.dynamics.rubbing_modes import NeutralWhirls, RubbingMode, RubbingNeutral, RubbingRotor
from petalfoil.dynamics.rubbing_whirl import ONE_LEAVES, HarmonicsLeft, RubbingResponse, RubbingWhirl
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.results.record import Record
from petalfoil.system.friction import slips
from tests.cases import case

Complex = NDArray[np.complex128]

LOAD, MASS, RUBS, SPEED = (0.0, -20.0), 2.0, 10e-6, 8000.0
"""Under the rotor, its mass [kg], an amplitude at which contacts stick and slip in turn [m], speed [rad/s]."""


def bearing(*, spatial: bool = False) -> Case:
    """Eight petals with friction on a coarse grid."""
    rubs = {"surface.petal_friction": 0.3, "operation.speed": SPEED}
    if spatial:
        grid = {"model.cells_per_pitch": 8, "model.axial_cells": 4}
        return case("paper_n8_spatial", **rubs, **grid, **{"petals.theory": "shell"})
    return case("paper_n8", **rubs, **{"model.cells_per_pitch": 12})


@cache
def stuck(*, spatial: bool = False) -> Impedance:
    """The impedance of petals that stick."""
    of = bearing(spatial=spatial)
    with running():
        return RotorOnBearings(of, MASS).impedance(operating_point(of, LOAD).answer)


def rubbing(*, spatial: bool = False) -> RubbingWhirl:
    """The bearing at the amplitude."""
    return RubbingWhirl.of(stuck(spatial=spatial).motion, RUBS)


def along_x(*, spatial: bool = False) -> RubbingRotor:
    """A rotor that is a billion times as heavy across, so that it moves along x alone."""
    inertia = replace(Inertia.of_mass(MASS), mass=np.diag([MASS, 1e9 * MASS]))
    return RubbingRotor(rubbing(spatial=spatial), inertia, SPEED)


def mode_along_x(*, spatial: bool = False) -> tuple[Eigenpair, HarmonicsLeft, Eigenpair]:
    """Its mode with as many harmonics as it needs, how many, and with one."""
    rotor = along_x(spatial=spatial)
    one = rotor.near((-0.02 + 0.065j, np.array([1.0, 0.0], dtype=complex)))
    assert one is not None
    return *bettered(rotor.whirl, one, rotor.near_in), one


@pytest.mark.slow
@pytest.mark.parametrize("axis", [0, 1])
def test_the_resistance_to_a_motion_along_an_axis_is_a_column_of_stiffness_and_damping(axis: int) -> None:
    """Of `coefficients` at the same frequency and amplitude; with one harmonic its damping is another."""
    ratio, v = 0.4, np.eye(2, dtype=complex)[axis]
    record = coefficients.record(bearing(), [ratio * SPEED], load=LOAD, amplitude=RUBS)
    K, C = (np.asarray(record.fields[name], dtype=float)[0][:, axis] for name in ("stiffness", "damping"))
    with running():
        whirl = rubbing()
        several = whirl.with_enough((1j * ratio, v))
        found = several.resistance(several.at(1j * ratio), v)
        again = several.resistance(several.at(1j * ratio), v)  # from the slips of the last
        one = whirl.resistance(whirl.at(1j * ratio), v)
    expected = K + 1j * ratio * SPEED * C
    assert_allclose(found, expected, rtol=0.0, atol=1e-2 * CHANGE * float(np.linalg.norm(expected)))
    assert_allclose(again, found, rtol=1e-8)
    assert one[axis].imag > 1.1 * expected[axis].imag


@pytest.mark.slow
@pytest.mark.parametrize("spatial", [False, True], ids=["2d", "3d"])
def test_a_mode_along_a_line_solves_its_equation_with_the_cycle_of_coefficients(spatial: bool) -> None:
    """(E19) at its complex frequency, formed anew and with as many harmonics as that finds enough, to 1e-6."""
    with running():
        several, left_over, one = mode_along_x(spatial=spatial)
        bearing_ = rubbing(spatial=spatial).bearings[0]
        assert bearing_.sliding is not None
        left, taken = [], []
        for found in (several, one):
            whirl = rubbing(spatial=spatial)
            cycle = RubbingCycle.of(bearing_.sliding, bearing_.motion, found.number, whirl.amplitude)
            response = cycle.cycle.response
            friction = cycle.with_enough(slips(cycle.cycle.sliding.friction, response.units[:, 0]))
            force = (response.force_gradient[:, 0] + friction.force)[0]
            inert = MASS * (SPEED * found.number) ** 2
            left.append(abs(inert - whirl.stiffness_unit * force) / abs(inert))
            taken.append(friction.told.friction_harmonics)
    told = left_over.told
    assert told.friction_harmonics == taken[0] >= 8
    assert told.friction_harmonics_change <= CHANGE
    assert left[0] < 1e-6
    assert left[1] > 1e-2


@pytest.mark.slow
def test_a_neutral_whirl_is_a_mode_that_neither_grows_nor_dies_out() -> None:
    """With the harmonics that it needs at 2 um: of a rotor of its mass, whose mode with one harmonic is another."""
    with running():
        whirl = RubbingWhirl.of(stuck().motion, 2e-6)
        neutral = NeutralWhirls(whirl, Inertia.of_mass(MASS), SPEED)
        one = neutral.near(0.1, next(neutral.shapes(0.1)))
        assert one is not None
        several, left = bettered(whirl, one, neutral.near_in)
        assert left.told.friction_harmonics >= 8
        inertia = Inertia.of_mass(several.mass)
        mode = RubbingRotor(whirl.with_enough(several.motion), inertia, SPEED).near(several.motion)
        same = RubbingRotor(whirl, inertia, SPEED).near(several.motion)
    assert mode is not None
    assert mode.number == pytest.approx(1j * several.ratio, abs=1e-6)
    assert same is None or abs(same.number - mode.number) > 1e-3


def in_so_many(whirl: RubbingWhirl, harmonics: int) -> RubbingWhirl:
    """Slips in so many harmonics, enough or not."""
    return replace(whirl, bearings=tuple(replace(one, several=FollowedSlips(harmonics)) for one in whirl.bearings))


@pytest.mark.slow
def test_what_half_as_many_harmonics_change_of_a_mode_is_its_distance_from_that_with_half_as_many() -> None:
    """Both by solving for it, where the record has it to first order."""
    with running():
        rotor, found = along_x(), []
        known = rotor.near((-0.02 + 0.065j, np.array([1.0, 0.0], dtype=complex)))
        for harmonics in (4, 8, 16):
            assert known is not None
            several = in_so_many(rotor.whirl, harmonics)
            known = rotor.near_in(several, known)
            assert known is not None
            found.append(rotor.mode(known, several.left(known.motion)))
    for half, mode in pairwise(found):
        assert mode.change == pytest.approx(mode.s - half.s, rel=1e-2)
        frequency, growth, ratio = mode.changes(SPEED)
        assert (growth, frequency) == (pytest.approx(SPEED * mode.change.real), pytest.approx(SPEED * mode.change.imag))
        assert ratio == pytest.approx(mode.damping_ratio - half.damping_ratio, rel=1e-2)


@pytest.mark.slow
def test_what_half_as_many_harmonics_change_of_a_neutral_whirl_is_its_distance_from_that_with_half_as_many() -> None:
    with running():
        whirl, found = RubbingWhirl.of(stuck().motion, 2e-6), []
        neutral = NeutralWhirls(whirl, Inertia.of_mass(MASS), SPEED)
        known = neutral.near(0.1, next(neutral.shapes(0.1)))
        for harmonics in (8, 16):
            assert known is not None
            several = in_so_many(whirl, harmonics)
            known = neutral.near_in(several, known)
            assert known is not None
            found.append(known.leaving(several.left(known.motion)))
    half, here = found
    assert here.mass_change == pytest.approx(here.mass - half.mass, rel=5e-2)
    assert here.ratio_change == pytest.approx(here.ratio - half.ratio, rel=5e-2)


@pytest.mark.slow
@pytest.mark.parametrize("amplitude", [10e-6, 50e-6])
def test_what_harmonics_leave_in_the_bars_of_a_mode_holds_against_64_of_them(amplitude: float) -> None:
    """Of a mode along x, at sixteen frequencies of their own in place of three."""
    modes = []
    with running():
        for least in (0, 64):
            rotor = replace(along_x(), whirl=RubbingWhirl.of(stuck().motion, amplitude, least))
            v = np.array([1.0, 0.0], dtype=complex)
            stiffness = rotor.whirl.resistance(rotor.whirl.at(0.1j), v)[0]
            known = rotor.near((1j * np.sqrt(stiffness / MASS) / SPEED, v))
            assert known is not None
            modes.append(rotor.mode(*bettered(rotor.whirl, known, rotor.near_in)))
    few, many = modes
    assert few.told.friction_harmonics < many.told.friction_harmonics == 64
    fields, coords = mode_fields([few], SPEED, tilts=False)
    record = Record(analysis="stability", scalars={}, fields=fields, coords=coords, case_toml=bearing().to_toml())
    better, _ = mode_fields([many], SPEED, tilts=False)
    for name in ("natural_frequency", "mode_growth_rate", "damping_ratio"):
        bar = harmonics_bar(name, record)
        assert bar is not None
        assert abs(better[name] - fields[name]) <= bar < 0.02 * abs(fields[name])


@pytest.mark.slow
def test_what_several_harmonics_do_not_solve_keeps_one_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """Slips that do not agree, solutions that are not found, and numbers of harmonics that do not settle."""
    v, rotor = np.array([1.0, 0.0], dtype=complex), along_x()
    with running():
        one = rotor.near((-0.02 + 0.065j, v))
        assert one is not None
        assert bettered(rotor.whirl, one, lambda _, __: None) == (one, ONE_LEAVES)
        monkeypatch.setattr("petalfoil.dynamics.more_harmonics.CHANGE", 0.0)
        monkeypatch.setattr("petalfoil.dynamics.more_harmonics.ROUNDS", 1)
        assert bettered(rotor.whirl, one, lambda _, known: known) == (one, ONE_LEAVES)
        monkeypatch.setattr("petalfoil.dynamics.friction_harmonics.STEPS", 1)
        assert bettered(rotor.whirl, one, rotor.near_in) == (one, ONE_LEAVES)
        told = [str(row["outcome"]) for row in current_run().history if row["phase"] == "one harmonic"]
    assert len(told) == 3
    for outcome, words in zip(told, ("none is found", "does not settle", "do not agree with their slips"), strict=True):
        assert words in outcome


@pytest.mark.slow
def test_a_mode_that_is_not_found_again_has_ended_in_a_fold(monkeypatch: pytest.MonkeyPatch) -> None:
    """At 5 um one of the modes of one harmonic: as its friction is replaced by that of several, part by part, the
    derivative becomes singular, before all of it is."""
    mixing = {"several": 0.0}

    def mixed(self: RubbingResponse, v: Complex, scale: float) -> Complex:
        rubs, free, followed = self.rubbing(scale), self.free(v), self.bearing.several
        slip = rubs.cycle.settled(free, self.compliances[0])
        alone: Complex = rubs.cycle.sliding.equivalent(slip, scale)[0] * slip
        return alone if followed is None else alone + mixing["several"] * (followed.friction(rubs, free) - alone)

    with running():
        rotor = replace(along_x(), whirl=RubbingWhirl.of(stuck().motion, 5e-6), inertia=Inertia.of_mass(MASS))
        found = rotor.near((-0.0085945 + 0.0888382j, np.array([0.126943 - 0.232271j, 1.0])))
        assert found is not None
        assert bettered(rotor.whirl, found, rotor.near_in) == (found, ONE_LEAVES)
        several = replace(rotor, whirl=rotor.whirl.with_enough(found.motion))
        monkeypatch.setattr(RubbingResponse, "friction", mixed)
        regular = []
        for part in (0.5, 0.77, 0.8, 0.83, 0.86):
            mixing["several"] = part
            found = several.near(found.motion)
            assert found is not None
            sizes = np.linalg.svd(found.slope, compute_uv=False)
            regular.append(sizes[-1] / sizes[0])
    assert np.all(np.diff(regular[1:]) < 0.0)
    assert regular[-1] < 0.25 * regular[0]


def test_the_fewest_harmonics_are_told() -> None:
    """Of the critical whirl and the modes; one that kept one harmonic is not hidden by the others."""
    v = np.array([1.0, 0.0], dtype=complex)
    eight = RubbingNeutral(1.0, 0.5, v, HarmonicsTold(8, 1e-3), np.eye(4))
    assert harmonics_told(eight, None) == HarmonicsTold(8, 1e-3)
    assert harmonics_told(Whirl(np.inf, np.nan), None).friction_harmonics == 1
    kept = harmonics_told(eight, [mode_with(ONE_HARMONIC), mode_with(HarmonicsTold(16, 2e-3))])
    assert kept.friction_harmonics == 1
    assert np.isnan(kept.friction_harmonics_change)


def mode_with(told: HarmonicsTold) -> RubbingMode:
    """Any mode, with these harmonics."""
    return RubbingMode(1j, 1.0, 0.0, 0.0, told)


@pytest.mark.long
def test_modes_of_large_cycles_are_less_damped_than_one_harmonic_says(monkeypatch: pytest.MonkeyPatch) -> None:
    """By 10 to 35 % at 10 um; the record tells the harmonics."""
    several = stability.record(bearing(), load=LOAD, mass=MASS, amplitude=RUBS)
    monkeypatch.setattr("petalfoil.dynamics.rubbing_modes.bettered", lambda _, found, __: (found, ONE_LEAVES))
    one = stability.record(bearing(), load=LOAD, mass=MASS, amplitude=RUBS)
    assert several.scalars["friction_harmonics"] == 8
    assert 0.0 < several.scalars["friction_harmonics_change"] <= CHANGE
    assert set(several.fields["mode_friction_harmonics"]) == {8, 16}
    assert one.scalars["friction_harmonics"] == 1
    assert one.scalars["probe_factorizations"] < several.scalars["probe_factorizations"] < 2 * one.scalars[
        "probe_factorizations"
    ]  # fmt: skip
    ratios = damping(several) / damping(one)
    assert np.all((ratios > 0.65) & (ratios < 0.9))


def damping(record: Record) -> NDArray[np.float64]:
    """Damping ratios of its modes, in order."""
    return np.sort(record.fields["damping_ratio"])
