"""A rotor in two bearings: one convention of load and mass in every verb, and a conical mode beside the cylindrical."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.balance import balance
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.liftoff import liftoff
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.runup import runup
from petalfoil.analysis.solve import solve
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.analysis.stability import stability
from petalfoil.case import Case, warnings_of
from petalfoil.cli.printed_tables import render
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.errors import DefinitionError
from petalfoil.results.answer import Answer
from petalfoil.results.record import Record
from tests.cases import FAULTS, case

RPM = math.pi / 30.0
PAIR = Case.load(FAULTS / "two_bearings_plain.toml")
ALONE = PAIR.replace(rotor={"mass": 1.53}, **{"operation.load": (0.0, -7.5)})
"""One of its bearings, with half of the mass and half of the load."""


@cache
def stable_at(rpm: float) -> Record:
    return stability.record(PAIR, speed=rpm * RPM)


# ---------------------------------------------------------------------------------------------- one convention


def test_each_bearing_carries_half_of_the_load() -> None:
    both, one = balance.record(PAIR).scalars, balance.record(ALONE).scalars
    for name in ("eccentricity_x", "eccentricity_y", "bearing_force"):
        assert_allclose(both[name], one[name], rtol=1e-9)
    assert both["load_y"] == -15.0
    assert_allclose(float(both["bearing_force"]), 7.5, rtol=1e-8)


def test_a_load_followed_over_speed_is_shared_too() -> None:
    both, one = SpeedLine(PAIR, (0.0, -15.0)), SpeedLine(ALONE, (0.0, -7.5))
    for speed in (500.0, 800.0):
        assert_allclose(both.at(speed).problem.displacement, one.at(speed).problem.displacement, rtol=1e-9)


def test_coefficients_are_those_of_one_bearing() -> None:
    both, one = (coefficients.record(of).fields for of in (PAIR, ALONE))
    assert_allclose(both["stiffness"], one["stiffness"], rtol=1e-7)


@pytest.mark.slow
def test_a_rotor_that_hardly_resists_tilting_is_two_masses_on_two_bearings() -> None:
    """Threshold 4415 rpm; the mass once was halved without the load, which gave 8563 rpm."""
    light = PAIR.replace(**{"rotor.transverse_inertia": 1e-4, "rotor.polar_inertia": 1e-5})
    both, one = (stability.record(of).scalars for of in (light, ALONE))
    assert_allclose(float(one["threshold_speed"]) / RPM, 4415.0, rtol=1e-3)
    assert_allclose(both["threshold_speed"], one["threshold_speed"], rtol=1e-4)
    assert_allclose(both["critical_mass"], 2.0 * float(one["critical_mass"]), rtol=1e-4)
    assert both["rotor_mass"] == 3.06


@pytest.mark.slow
def test_every_verb_shares_the_load_of_a_pack() -> None:
    """Two packs under a load are each one pack under half of it, wherever a load is balanced."""
    grid = {"model.cells_per_pitch": 24, "operation.eccentricity": (0.0, 0.0)}
    both = case("paper_n8", rotor={"mass": 2.0, "span": 0.2}, **grid, **{"operation.load": (0.0, -20.0)})
    one = case("paper_n8", rotor={"mass": 1.0}, **grid, **{"operation.load": (0.0, -10.0)})
    for verb in (balance, solve):
        assert_allclose(*(float(verb(of)["eccentricity_y"]) for of in (both, one)), rtol=1e-9)
    assert_allclose(*(runup(of, to=5000.0, points=3)["friction_torque"] for of in (both, one)), rtol=1e-9)
    assert_allclose(
        float(liftoff(both, 20.0)["liftoff_speed"][0]), float(liftoff(one, 10.0)["liftoff_speed"][0]), rtol=1e-9
    )
    assert_allclose(*(coefficients(of)["stiffness"] for of in (both, one)), rtol=1e-7)
    masses = [float(stability.record(of).scalars["critical_mass"]) for of in (both, one)]
    assert masses[0] == math.inf or masses[0] <= 2.0 * masses[1] * (1.0 + 1e-6)


def test_inertias_that_are_not_given_are_those_of_a_cylinder() -> None:
    """And a warning tells them."""
    bare = PAIR.replace(rotor={"mass": 3.06, "span": 0.2})
    inertia = RotorOnBearings(bare, 3.06).inertia
    transverse, polar = 3.06 * (0.2**2 / 12.0 + 0.02**2 / 4.0), 0.5 * 3.06 * 0.02**2
    assert_allclose(np.diag(inertia.mass)[2:], transverse / 0.1**2, rtol=1e-12)
    assert_allclose(inertia.gyroscopic[2, 3], polar / 0.1**2, rtol=1e-12)
    assert any(f"{transverse:.4g} kg m^2 is taken" in said for said in warnings_of(bare, {}))
    assert not any("is taken" in said for said in warnings_of(PAIR, {}))
    with pytest.raises(DefinitionError, match="polar_inertia is given alone"):
        PAIR.replace(rotor={"mass": 3.06, "span": 0.2, "polar_inertia": 1e-4})


# ---------------------------------------------------------------------------------------------- the conical mode


@pytest.mark.slow
def test_the_conical_mode_loses_stability_first() -> None:
    found = stable_at(7500.0)
    assert_allclose(float(found.scalars["threshold_speed"]) / RPM, 2900.0, rtol=1e-2)
    there = stability.record(PAIR, speed=float(found.scalars["threshold_speed"])).scalars
    assert_allclose(float(there["critical_mass"]), 3.06, rtol=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize(("rpm", "growth"), [(4000.0, 10.5), (7500.0, 61.0)])
def test_growth_of_the_conical_mode(rpm: float, growth: float) -> None:
    """Against the eigenvalues of the four equations of motion on stiffness and damping over frequency."""
    modes = stable_at(rpm).fields
    fastest = int(np.argmax(modes["mode_growth_rate"]))
    assert_allclose(modes["mode_growth_rate"][fastest], growth, rtol=0.03)
    assert modes["mode_tilt"][fastest] > 0.999
    assert modes["whirl_direction"][fastest] > 0.9


@pytest.mark.slow
def test_a_slow_rotor_is_stable_in_both_modes() -> None:
    modes = stable_at(2000.0).fields
    assert np.all(modes["mode_growth_rate"].astype(float) < 0.0)
    assert {round(float(tilt)) for tilt in modes["mode_tilt"]} == {0, 1}


def test_translation_is_that_of_two_bearings_side_by_side() -> None:
    one = stability.record(ALONE, speed=4000.0 * RPM).fields
    pair = stable_at(4000.0).fields
    for name in ("natural_frequency", "mode_growth_rate"):
        assert_allclose(pair[name][pair["mode_tilt"] < 0.5], one[name], rtol=1e-6)


@pytest.mark.slow
def test_gyroscopic_moments_part_the_conical_modes() -> None:
    """A disk with `I_p = 2 I_t` does not whirl conically at half the speed: its moments outweigh its inertia."""
    disk = PAIR.replace(**{"rotor.polar_inertia": 0.16})
    modes = stability.record(disk, speed=4000.0 * RPM).fields
    growing = modes["mode_growth_rate"].astype(float) > 0.0
    assert not np.any(growing & (modes["mode_tilt"] > 0.5) & (modes["whirl_direction"] > 0.5))


def test_inertia_of_the_whole_rotor() -> None:
    rotor = PAIR.rotor
    assert rotor is not None
    inertia = Inertia.of(rotor)
    assert_allclose(np.diag(inertia.mass), [3.06, 3.06, 8.0, 8.0], rtol=1e-12)
    assert_allclose(inertia.gyroscopic[2:, 2:], [[0.0, 0.1], [-0.1, 0.0]], rtol=1e-12)
    assert RotorOnBearings(PAIR, 1.0).inertia.mass[0, 0] == 1.0


def test_a_table_over_load_and_speed_counts_the_conical_mode() -> None:
    ds = stability(PAIR, speeds=[4000.0 * RPM], loads=[15.0])
    assert_allclose(float(ds["critical_mass"].squeeze()), stable_at(4000.0).scalars["critical_mass"], rtol=1e-4)


@pytest.mark.slow
def test_the_end_of_the_search_is_no_threshold() -> None:
    safe = PAIR.replace(**{"rotor.transverse_inertia": 1e-6, "rotor.polar_inertia": 0.0, "rotor.mass": 1e-3})
    found = stability.record(safe, speed=2000.0 * RPM).scalars
    assert math.isnan(float(found["threshold_speed"]))
    assert "no threshold speed found up to" in str(found["status"])
    assert "rpm (end of the search" in str(found["status"])


# ---------------------------------------------------------------------------------------------- the motion


@pytest.mark.slow
def test_the_summary_of_a_motion_shows_what_the_journals_do() -> None:
    """The axis's middle moves 3 µm at the speed, the journals 15 µm at half of it."""
    ds = orbit(PAIR, revolutions=40.0)
    assert_allclose(float(ds["amplitude"]), 15e-6, rtol=0.05)
    assert_allclose(float(ds["dominant_whirl_ratio"]), 0.487, atol=0.01)
    assert_allclose(float(ds["tilt_amplitude"]) * 0.1, 15e-6, rtol=0.1)
    said = render(Answer.stored(ds, orbit.layouts[0]))
    assert "tilt, last turns" in said
    assert "whirl ratio of the tilt" in said
    assert_allclose(float(ds["tilt_whirl_ratio"]), float(ds["dominant_whirl_ratio"]), atol=0.01)
