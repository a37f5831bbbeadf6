"""A rotor in two bearings that do not share its load evenly: unequal, askew, or not equally far from load and mass."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from petalfoil import (
    Case,
    balance,
    capacity,
    check,
    coefficients,
    converge,
    curve,
    liftoff,
    orbit,
    runup,
    sensitivity,
    solve,
    stability,
    static,
)
from petalfoil.analysis.known_verbs import summaries
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.cli.printed_tables import render
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.results.answer import Answer
from petalfoil.results.record import Record
from tests.cases import FAULTS, case
from tests.verification.test_campbell import exponents

RPM = math.pi / 30.0
PAIR = Case.load(FAULTS / "two_bearings_plain.toml").replace(**{"model.cells_per_pitch": 24, "model.axial_cells": 8})
SMALLER = {"journal_radius": 0.02, "bushing_radius": 0.02 + 25e-6, "length": 0.03}
UNEQUAL = PAIR.replace(**{"rotor.second": {"bearing": SMALLER}, "rotor.centre": 0.01})
STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0, "expansion": 11.5e-6}


@cache
def resting() -> Record:
    return balance.record(UNEQUAL)


# ---------------------------------------------------------------------------------------------- one bearing tells all


def test_a_second_bearing_that_says_nothing_is_the_first() -> None:
    """Solved as two bearings the pair rests where each rests alone under half of the load."""
    even, both = balance.record(PAIR).scalars, balance.record(PAIR.replace(**{"rotor.second": {}})).scalars
    for name in ("eccentricity_x", "eccentricity_y", "min_film_thickness", "bearing_force", "power_loss"):
        assert_allclose(both[name], even[name], rtol=1e-9)
    for name in ("eccentricity_x", "eccentricity_y", "force_y", "min_film_thickness"):
        assert_allclose(both[f"other_{name}"], both[name], rtol=1e-9)
    assert abs(float(both["shaft_slope_x"])) < 1e-15
    assert float(both["force_residual"]) < 1e-9


@pytest.mark.slow
def test_its_stability_is_that_of_the_pair() -> None:
    """Critical mass, threshold and modes from the impedances of both bearings, and from the pair as one wall."""
    even, both = (stability.record(of, speed=4000.0 * RPM) for of in (PAIR, PAIR.replace(**{"rotor.second": {}})))
    for name in ("critical_mass", "threshold_speed", "whirl_ratio"):
        assert_allclose(both.scalars[name], even.scalars[name], rtol=1e-7)
    for name in ("natural_frequency", "mode_growth_rate", "mode_tilt"):
        assert_allclose(both.fields[name], even.fields[name], rtol=1e-6, atol=1e-9)


# ---------------------------------------------------------------------------------------------- statics


def test_forces_and_moments_of_both_bearings_balance_the_load() -> None:
    """The second bearing solved alone at its position gives the moment that completes those of the forces."""
    s, (before, behind) = resting().scalars, UNEQUAL.rotor.places
    first, second, own = (np.array([float(s[f"{of}_{x}"]) for x in "xy"]) for of in ("force", "other_force", "moment"))
    assert_allclose(first + second, [0.0, 15.0], atol=1e-7)
    slopes = (float(s["shaft_slope_x"]), float(s["shaft_slope_y"]))
    there = (float(s["other_eccentricity_x"]), float(s["other_eccentricity_y"]))
    alone = solve.record(
        UNEQUAL.supports[1].replace(**{"operation.tilt": slopes, "operation.eccentricity": there})
    ).scalars
    assert_allclose([alone["force_x"], alone["force_y"]], second, atol=1e-6)
    others = np.array([float(alone["moment_x"]), float(alone["moment_y"])])
    assert_allclose(before * first + behind * second + own + others, 0.0, atol=1e-7)
    for k, x in enumerate("xy"):  # and the shaft is straight
        assert_allclose(there[k] - float(s[f"eccentricity_{x}"]), UNEQUAL.rotor.span * slopes[k], rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "second"),
    [
        ({"rotor.centre": 0.03}, 0.5 + 0.03 / 0.2),
        ({"rotor.centre": 0.12}, 0.5 + 0.12 / 0.2),
        ({"rotor.load_place": -0.05}, 0.5 - 0.05 / 0.2),
        ({"operation.moment": (0.0, -0.6)}, 0.5 + 0.6 / (15.0 * 0.2)),
    ],
    ids=["off-centre", "overhung", "load elsewhere", "moment"],
)
def test_long_films_share_the_load_as_a_beam_on_two_supports(changes: dict[str, object], second: float) -> None:
    """A 2-D film has no moment of its own."""
    flat = PAIR.replace(**{"rotor.span": 0.2, "model.kind": "2d", "model.cells_per_pitch": 16, **changes})
    found = balance.record(flat).scalars
    assert_allclose(float(found["other_force_y"]), 15.0 * second, rtol=1e-8)
    assert_allclose(float(found["force_y"]), 15.0 * (1.0 - second), rtol=1e-7)


def test_turned_round_the_rotor_rests_the_same() -> None:
    """With the other bearing first, results of the second are those of the first, and the shaft rises the other way."""
    turned = {"rotor.centre": -0.01, "rotor.second": {"bearing": PAIR.bearing}, "rotor.results_of": "second"}
    one, other = resting().scalars, balance.record(UNEQUAL.replace(bearing=SMALLER, **turned)).scalars
    for name in ("eccentricity_x", "eccentricity_y", "force_y", "min_film_thickness", "other_force_y"):
        assert_allclose(other[name], one[name], rtol=1e-8)
    assert_allclose(other["shaft_slope_x"], -float(one["shaft_slope_x"]), rtol=1e-8)


def test_a_seat_that_stands_askew_adds_to_the_slopes_of_the_shaft() -> None:
    """Both askew alike: the shaft turns a little to meet them. Of the second alone the first feels the shaft's only."""
    s = balance.record(PAIR.replace(**{"operation.tilt": (5e-5, 0.0)})).scalars
    assert_allclose(s["tilt_x"], 5e-5 + float(s["shaft_slope_x"]), rtol=1e-12)
    assert -5e-5 < float(s["shaft_slope_x"]) < 0.0
    there = balance.record(PAIR.replace(**{"rotor.second": {"tilt": (5e-5, 0.0)}})).scalars
    assert_allclose(there["tilt_x"], there["shaft_slope_x"], rtol=1e-12)


@pytest.mark.slow
def test_hot_bearings_have_temperatures_of_their_own() -> None:
    """Each is as hot as alone under its part of the load; the stiffness counts that the temperatures follow."""
    heat = {"pack_to_bushing": 2.0, "bushing_to_ambient": 1.0, "shaft_to_ambient": 0.1}
    hot = PAIR.replace(shaft=STEEL, bushing={"expansion": 11.5e-6}, heat=heat)
    hot = hot.replace(**{"model.kind": "2d", "model.cells_per_pitch": 16, "rotor.centre": 0.06, "rotor.span": 0.2})
    found = balance.record(hot).scalars
    alone = balance.record(hot.supports[1], (0.0, -15.0 * 0.8)).scalars
    assert float(found["other_shaft_temperature"]) > float(found["shaft_temperature"])
    assert_allclose(found["other_shaft_temperature"], alone["shaft_temperature"], rtol=1e-7)
    assert float(found["heat_balance_error"]) < 1e-9
    assert float(found["force_residual"]) < 1e-9
    rotor = RotorInBearings.of(hot, (0.0, -15.0))
    with running():
        rest = rotor.at(hot.operation.speed)
        for support, one in zip(rotor.supports, rotor.in_order(rest), strict=True):
            K, q = np.zeros((2, 2)), rotor.position(rest)
            for k, step in enumerate(1e-9 * np.eye(4)[:2]):
                ahead, behind = (support.force(support.moved(one, q + sign * step))[:2] for sign in (1.0, -1.0))
                K[:, k] = -(ahead - behind) / 2e-9
            assert_allclose(support.resists(one)[:2, :2], K, rtol=0.0, atol=1e-4 * np.abs(K).max())


# ---------------------------------------------------------------------------------------------- whirl


def impedance(frequency: float) -> np.ndarray:
    """Impedance of the rotor in (x, y, a_x, a_y) from the 4 by 4 coefficients of each bearing alone, (4, 4) [SI]."""
    rest = resting().scalars
    slopes, total = (float(rest["shaft_slope_x"]), float(rest["shaft_slope_y"])), np.zeros((4, 4), dtype=complex)
    for alone, place, of in zip(UNEQUAL.supports, UNEQUAL.rotor.places, ("", "other_"), strict=True):
        where = (float(rest[f"{of}eccentricity_x"]), float(rest[f"{of}eccentricity_y"]))
        held = alone.replace(**{"operation.tilt": slopes, "operation.eccentricity": where})
        found, rows = coefficients.record(held, [frequency], tilt=True).fields, []
        for row in (("", "_force_tilt"), ("_moment_displacement", "_moment_tilt")):
            K, C = (np.hstack([found[f"{name}{b}"][0].astype(float) for b in row]) for name in ("stiffness", "damping"))
            rows.append(K + 1j * frequency * C)
        arm = np.block([[np.eye(2), place * np.eye(2)], [np.zeros((2, 2)), np.eye(2)]])
        total += arm.T @ np.vstack(rows) @ arm
    return total


@pytest.mark.slow
def test_the_critical_mass_makes_the_assembled_rotor_neutral() -> None:
    """The rotor whose mass and inertias are scaled to the critical mass has a vanishing determinant at its whirl."""
    speed, rotor = UNEQUAL.operation.speed, UNEQUAL.rotor
    found = stability.record(UNEQUAL).scalars
    frequency, heavier = float(found["whirl_ratio"]) * speed, float(found["critical_mass"]) / rotor.mass
    mass = np.diag([rotor.mass, rotor.mass, rotor.transverse_inertia, rotor.transverse_inertia])
    gyroscopic = np.zeros((4, 4))
    gyroscopic[2, 3], gyroscopic[3, 2] = rotor.polar_inertia, -rotor.polar_inertia
    Z, inertia = impedance(frequency), -(frequency**2) * mass + 1j * frequency * speed * gyroscopic
    here, away = (abs(np.linalg.det(Z + factor * heavier * inertia)) for factor in (1.0, 1.01))
    assert here < 1e-3 * away  # a hundred-thousandth of the mass


OTHER_GAS = {"viscosity": 2.2e-5, "ambient_pressure": 1.3e5}


@pytest.mark.slow
@pytest.mark.parametrize("second", [None, {"bearing": SMALLER, "gas": OTHER_GAS}], ids=["equal", "unequal"])
def test_a_motion_rests_at_the_balance_of_the_rotor(second: dict[str, object] | None) -> None:
    """Off-centre, askew, loaded elsewhere and under a moment: without unbalance nothing moves."""
    changes = {"rotor.centre": 0.02, "rotor.load_place": -0.03, "operation.tilt": (3e-5, 0.0), "rotor.second": second}
    still = {"rotor.unbalance": 0.0, "rotor.skew": 0.0, "operation.moment": (0.0, 0.1), "operation.speed": 2500.0 * RPM}
    uneven = PAIR.replace(**changes, **still)
    rest, ds = balance.record(uneven).scalars, orbit(uneven, revolutions=0.2, initial="balance")
    assert float(np.ptp(ds["x"].values)) < 1e-12
    assert float(np.ptp(ds["slope_x"].values)) < 1e-11
    assert_allclose(float(ds["slope_x"][0]), rest["shaft_slope_x"], rtol=1e-9)
    first = float(ds["x"][0] + uneven.rotor.places[0] * ds["slope_x"][0])
    assert_allclose(first, rest["eccentricity_x"], rtol=1e-9)


@pytest.mark.slow
def test_a_motion_in_unequal_bearings_grows_as_the_modes_say() -> None:
    """Another size and another gas in the second bearing: rate of growth to 1 %, frequency to 0.1 %."""
    changes = {"rotor.second": {"bearing": SMALLER, "gas": OTHER_GAS}, "rotor.unbalance": 1e-10, "rotor.skew": 1e-9}
    quiet = UNEQUAL.replace(**changes, **{"operation.speed": 7500.0 * RPM})
    modes = stability.record(quiet).fields
    fastest = int(np.argmax(modes["mode_growth_rate"].astype(float)))
    ds = orbit(quiet, revolutions=16.0, initial="balance", tolerance=1e-7)
    time = ds["time"].values
    instants = np.linspace(0.5 * time[-1], time[-1], 150)
    path = CubicSpline(time, ds["slope_x"].values + 1j * ds["slope_y"].values)(instants)
    found = exponents(path - path.mean(), instants[1] - instants[0])
    nearest = found[np.argmin(np.abs(found.imag - float(modes["natural_frequency"][fastest])))]
    assert_allclose(nearest.real, float(modes["mode_growth_rate"][fastest]), rtol=1e-2)
    assert_allclose(nearest.imag, float(modes["natural_frequency"][fastest]), rtol=1e-3)
    assert float(ds["mass_balance_error"]) < 1e-6


# ---------------------------------------------------------------------------------------------- one convention


LOADED = case(
    "rig",
    rotor={"mass": 6.0, "span": 0.2},
    **{"model.cells_per_pitch": 12, "operation.eccentricity": (0.0, 0.0), "operation.speed": 12000.0 * RPM},
    **{"operation.load": (0.0, -60.0)},
)
HALF = LOADED.replace(rotor={"mass": 3.0}, **{"operation.load": (0.0, -30.0)})
UNLOADED = {"operation.load": None}
AT_NODES = {"model.contacts": "nodes"}
"""Contacts of a rotor in two bearings in motion."""


def of_one(case: Case) -> float:
    """A load or mass of one bearing, from that of the rotor."""
    return 1.0 / case.bearings


MEANT: dict[str, Callable[[Case], object]] = {
    "check": lambda c: check(c)["radial_clearance"],
    "balance": lambda c: [balance.record(c).scalars[name] for name in ("eccentricity_y", "min_film_thickness")],
    "solve": lambda c: [solve.record(c).scalars[name] for name in ("eccentricity_y", "min_film_thickness")],
    "curve": lambda c: curve(c.replace(**UNLOADED), [5e-6])["force_y"].values,
    "static": lambda c: static(c.replace(**UNLOADED), [5e-6])["force_y"].values,
    "coefficients": lambda c: coefficients.record(c, [1500.0]).fields["stiffness"],
    "runup": lambda c: runup(c, to=9000.0 * RPM, points=3)["friction_torque"].values[:3],
    "liftoff": lambda c: liftoff(c, [30.0 * c.bearings])["liftoff_speed"].values,
    "orbit": lambda c: orbit(c.replace(**AT_NODES), revolutions=0.01, initial="balance")["y"].values[0],
    "stability": lambda c: [of_one(c) * float(stability.record(c).scalars[name]) for name in ("critical_mass",)],
    "converge": lambda c: converge(c, levels=2, coarsest=16)["min_film_thickness"].values,
    "capacity": lambda c: of_one(c) * capacity_at(c),
    "sensitivity": lambda c: sensitivity(c, "surface.contact_film_thickness", of="min_film_thickness")["derivative"],
}
"""What each analysis is asked of a rotor under its load, or with its mass."""

OF_ONE_BEARING = {"sensitivity"}
"""Analyses that are refused of two bearings that are told apart."""


def capacity_at(case: Case) -> float:
    """Load capacity at a high speed [N]."""
    fast = case.replace(**{"operation.speed": 40000.0 * RPM, "rotor.second": None})
    return float(capacity.record(fast, contact_fraction=0.1).scalars["load_capacity"])


@pytest.mark.slow
def test_load_and_mass_mean_the_same_in_every_verb() -> None:
    """The whole rotor's in every verb: as an even pair, as two bearings, and as one bearing with half of both."""
    assert set(MEANT) == set(summaries())
    both = LOADED.replace(**{"rotor.second": {}})
    for verb, asked in MEANT.items():
        one, alone = (np.asarray(asked(where), dtype=float) for where in (LOADED, HALF))
        assert_allclose(alone, one, rtol=1e-5 if verb == "capacity" else 1e-6, err_msg=verb)
        if verb not in OF_ONE_BEARING:
            assert_allclose(np.asarray(asked(both), dtype=float), one, rtol=1e-6, err_msg=verb)
    assert [stability.record(c).scalars["rotor_mass"] for c in (LOADED, both)] == [6.0, 6.0]


@pytest.mark.slow
def test_the_bearing_that_is_nearer_to_its_limit_bounds_the_capacity_of_both() -> None:
    """Petals in 2-D, whose contact points a search for one bearing would follow: the other one would be beyond."""
    off_the_middle = {"mass": 4.0, "span": 0.2, "centre": 0.02, "second": {}}
    petals = case("paper_n8", rotor=off_the_middle, **{"model.cells_per_pitch": 16})
    scalars = capacity.record(petals, min_film_thickness=4e-6).scalars
    assert_allclose(scalars["other_min_film_thickness"], 4e-6, rtol=2e-6)
    assert float(scalars["min_film_thickness"]) > 5e-6
    assert int(scalars["factorizations"]) < 200  # a search that halves its bracket takes 383
    load = float(scalars["load_capacity"])
    films = [balance.record(petals, part * load).scalars["other_min_film_thickness"] for part in (1.0, 1.01)]
    assert_allclose(films[0], 4e-6, rtol=1e-5)
    assert float(films[1]) < 3.99e-6


# ---------------------------------------------------------------------------------------------- in and out


def test_the_second_bearing_may_have_a_file_of_its_own(tmp_path: Path) -> None:
    """Its tables stand in the result, so that no file is needed to run it again."""
    (tmp_path / "second.toml").write_text(UNEQUAL.supports[1].to_toml())
    written = PAIR.to_toml().replace("[rotor]\n", '[rotor]\nsecond = { file = "second.toml" }\n')
    (tmp_path / "rotor.toml").write_text(written)
    found = Case.load(tmp_path / "rotor.toml")
    assert found.supports[1].bearing == UNEQUAL.supports[1].bearing
    assert Case.from_toml(found.to_toml()) == found
    petals = {"file": str(Path(__file__).parents[2] / "examples" / "paper_n8_spatial.toml")}
    assert PAIR.replace(**{"rotor.second": petals}).supports[1].petals is not None
    back = case("paper_n8_spatial", rotor={"mass": 1.0, "span": 0.3, "second": {"file": str(tmp_path / "second.toml")}})
    assert back.supports[1].petals is None


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rotor": {"mass": 1.0, "centre": 0.1}}, "of a rotor in two bearings: give its span"),
        ({"rotor.second": {"file": "nowhere.toml"}}, r"rotor\.second: nowhere\.toml: there is no such file"),
        ({"rotor.second": {"petal": {}}}, r"rotor\.second\.petal: is not a known key"),
        ({"rotor.second": {"bearing": {**SMALLER, "journal_radius": 0.03}}}, r"rotor\.second\.bearing\.journal_radius"),
        ({"rotor.second": {"tilt": (1.0, 0.0)}}, r"rotor\.second\.tilt"),
        ({"rotor.second": {"model": {"kind": "2d"}}}, r"rotor\.second\.model\.kind"),
        ({"rotor.results_of": "third"}, r"rotor\.results_of"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(changes: dict[str, object], words: str) -> None:
    with pytest.raises(DefinitionError, match=words):
        PAIR.replace(**changes)


def test_verbs_that_are_of_one_bearing_say_so() -> None:
    with pytest.raises(UsageError, match="derivatives are those of one bearing"):
        sensitivity(UNEQUAL)
    with pytest.raises(UsageError, match="about its balance"):
        stability(UNEQUAL.replace(**{"operation.load": None}))


def test_the_table_tells_both_bearings() -> None:
    said = render(Answer.stored(balance(UNEQUAL), balance.layouts[0]))
    assert "other bearing: displacement x" in said
    assert "slope of the shaft x" in said
    assert "[rotor.second.bearing]" in resting().case_toml
