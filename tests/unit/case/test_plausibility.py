"""Warnings: a case that triggers each, one close by that does not, and none in the examples."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import petalfoil
from petalfoil.case import Case, warnings_of, warnings_of_errors
from petalfoil.equilibrium.small_motion import AT_POINTS
from tests.cases import FAULTS, case

PETALS, PLAIN = "paper_n8", "plain_journal"
SOUND = math.sqrt(1.4 * 287.05 * 293.15)  # m/s


def only(found: list[str], key: str) -> str:
    """The one warning there is; it names `key`, and is one line with a reason and an advice."""
    assert len(found) == 1, found
    assert found[0].startswith(f"{key}: ")
    assert ";" in found[0]
    assert "\n" not in found[0]
    return found[0]


# name: (example, key, value that is warned of, value close by that is not)
INPUTS: dict[str, tuple[str, str, Any, Any]] = {
    "a soft metal": (PETALS, "petals.youngs_modulus", "0.9 GPa", "1.1 GPa"),
    "a hard metal": (PETALS, "petals.youngs_modulus", "1001 GPa", "999 GPa"),
    "a modulus typed in MPa": (PETALS, "petals.youngs_modulus", 200e3, 200e9),
    "a thin gas": (PETALS, "gas.viscosity", "4.9 uPa*s", "5.1 uPa*s"),
    "a thick gas": (PETALS, "gas.viscosity", "101 uPa*s", "99 uPa*s"),
    "a viscosity typed in mPa s": (PETALS, "gas.viscosity", 0.0185, 18.5e-6),
    "a pressure typed in bar": (PLAIN, "gas.ambient_pressure", 1.0, 1e5),
    "a deep vacuum": (PLAIN, "gas.ambient_pressure", "9 mbar", "11 mbar"),
    "a high pressure": (PLAIN, "gas.ambient_pressure", "101 bar", "99 bar"),
    "a temperature typed in Celsius": (PLAIN, "gas.temperature", 20, "20 degC"),
    "a flame": (PLAIN, "gas.temperature", 1501, 1499),
    "a heavy gas": (PLAIN, "gas.gas_constant", 19.9, 20.1),
    "a fast surface": (PETALS, "operation.speed", 0.701 * SOUND / 25e-3, 0.699 * SOUND / 25e-3),
    "a metal that hardly contracts": (PETALS, "petals.poisson_ratio", "0.29 %", 0.29),
    "thousands with a point": (PETALS, "operation.speed", "60.000 rpm", "60000 rpm"),
    "a speed typed in rpm": (PETALS, "operation.speed", 60000, "60000 rpm"),
    "a tight bushing": (PLAIN, "bearing.bushing_radius", "25.0024 mm", "25.0026 mm"),
    "a wide bushing": (PLAIN, "bearing.bushing_radius", "28.8 mm", "28.7 mm"),
    "a short bearing": (PLAIN, "bearing.length", "4.9 mm", "5.1 mm"),
    "a long bearing": (PLAIN, "bearing.length", "501 mm", "499 mm"),
    "an unbalance in mm": ("orbit_n8", "rotor.unbalance", "0.51 mm", "0.49 mm"),
}


@pytest.mark.parametrize("name", INPUTS)
def test_an_unusual_input_is_warned_of(name: str) -> None:
    example, key, unusual, usual = INPUTS[name]
    slow = {"operation.speed": "110 rpm", "operation.eccentricity": (0, 0), "surface.contact_film_thickness": "0.1 um"}
    only(warnings_of(case(example, **{**slow, key: unusual}), {}), key)
    assert warnings_of(case(example, **{**slow, key: usual}), {}) == []


def test_a_speed_in_rpm_is_told_how_to_be_written() -> None:
    text = only(warnings_of(case(PETALS, **{"operation.speed": 60000}), {}), "operation.speed")
    assert "1500 m/s, Mach 4.4, above 0.7" in text
    assert "'60000 rpm'" in text


def test_a_molar_gas_constant_is_warned_of() -> None:
    molar = warnings_of(case(PLAIN, **{"gas.gas_constant": 8.314, "operation.speed": 1000}), {})
    assert "the specific gas constant is wanted" in only(molar, "gas.gas_constant")


def test_a_light_gas_takes_higher_speeds() -> None:
    fast = case(PETALS, **{"operation.speed": 20000})
    assert warnings_of(fast, {})
    assert warnings_of(fast.replace(gas={"name": "helium", "ambient_pressure": "1 bar"}), {}) == []


def test_the_answer_s_own_speed_counts() -> None:
    assert only(warnings_of(case(PETALS), {"speed": 12000.0}), "operation.speed")


# name: (key, example, scalars that are warned of, scalars close by that are not)
ANSWERS: dict[str, tuple[str, str, dict[str, Any], dict[str, Any]]] = {
    "stress": ("max_bending_stress", PETALS, {"max_bending_stress": 2.01e9}, {"max_bending_stress": 1.99e9}),
    "Knudsen": ("knudsen_number", PLAIN, {"knudsen_number": 0.101}, {"knudsen_number": 0.099}),
    "mixed lubrication": (
        "min_film_thickness", PETALS, {"min_film_thickness": 2.99e-6}, {"min_film_thickness": 3.01e-6},
    ),
    "a thin film on the way to speed": (
        "min_film_thickness", PLAIN, {"min_film_thickness": 1.1e-6}, {"min_film_thickness": 1.1e-6, "speed": 2000.0},
    ),
    "pressed bumps": ("max_deflection", "bumps", {"max_deflection": 201e-6}, {"max_deflection": 199e-6}),
    "contact": (
        "contact_fraction", PETALS, {"contact_fraction": 0.02, "speed": 8000.0}, {"contact_fraction": 5e-4},
    ),
    "contact below operating speed": (
        "contact_fraction", PETALS, {"contact_fraction": 0.5}, {"contact_fraction": 0.5, "speed": 7999.0},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ANSWERS)
def test_an_implausible_answer_is_warned_of(name: str) -> None:
    key, example, implausible, plausible = ANSWERS[name]
    one = bumps() if example == "bumps" else case(example)
    only(warnings_of(one, implausible), key)
    assert warnings_of(one, plausible) == []


def bumps() -> Case:
    """A bump foil whose bumps are 200 um high."""
    strip = {"bump_pitch": "4 mm", "bump_half_length": "1.5 mm", "bump_half_angle": 2.0 * math.atan(0.2 / 1.5)}
    metal = {"thickness": "0.1 mm", "youngs_modulus": "210 GPa", "poisson_ratio": 0.3}
    return case("bump_foil", bump_foil={**strip, **metal})


def test_a_turbulent_film_is_warned_of() -> None:
    """At a pressure that the surface speed of 52 m/s makes turbulent: Re = 84 p / bar, vortices from 1303 on."""
    dense, less = (case(PLAIN, **{"gas.ambient_pressure": pressure}) for pressure in ("16 bar", "15 bar"))
    assert "the Reynolds number of a film of the radial clearance" in only(warnings_of(dense, {}), "operation.speed")
    assert warnings_of(less, {}) == []


def test_a_turbulent_film_under_petals_is_warned_of() -> None:
    dense = case(PETALS, **{"gas.ambient_pressure": "10 bar"})
    told = only(warnings_of(dense, {"min_film_thickness": 60e-6}), "operation.speed")
    assert "of the minimum film thickness, 60 µm" in told
    assert warnings_of(dense, {"min_film_thickness": 10e-6}) == []


def test_a_wide_error_bar_is_warned_of() -> None:
    scalars = {"bearing_force": 10.0, "force_x": 1e-9, "min_film_thickness": 4e-6, "status": "converged"}
    (told,) = warnings_of_errors(scalars, {"bearing_force": 1.01, "force_x": 1.0, "min_film_thickness": 1e-6})
    assert told.startswith("min_film_thickness: its error bar is 25 % of it (and those of bearing_force), over 10 %")
    assert warnings_of_errors(scalars, {"bearing_force": 0.99, "force_x": 1.0, "min_film_thickness": 1e-8}) == []
    assert warnings_of_errors({"bearing_force": 0.0}, {"bearing_force": 1.0}) == []
    sizes = {"ambient_pressure": 1e5, "journal_radius": 25e-3, "length": 50e-3}  # 125 N
    assert warnings_of_errors(sizes | {"bearing_force": 2e-9}, {"bearing_force": 2e-6}) == []
    assert warnings_of_errors(sizes | {"bearing_force": 2e-9}, {"bearing_force": 2e-4}) != []


@pytest.mark.slow
def test_error_bars_of_a_coarse_grid_are_told_with_the_answer() -> None:
    coarse = case(PETALS, **{"model.cells_per_pitch": 8, "operation.eccentricity": ("0 um", "-200 um")})
    told = petalfoil.solve(coarse, error=True).attrs.get("warnings", "")
    fine = petalfoil.solve(coarse.replace(**{"model.cells_per_pitch": 64}), error=True).attrs.get("warnings", "")
    assert "error bar" in told
    assert "error bar" not in fine


def test_contact_at_rest_is_no_matter_for_a_warning() -> None:
    assert warnings_of(case(PETALS, **{"operation.speed": 0.0}), {"contact_fraction": 1.0, "speed": 0.0}) == []


def test_a_stated_yield_strength_replaces_the_limit() -> None:
    soft = case(PETALS, **{"petals.yield_strength": "300 MPa"})
    text = only(warnings_of(soft, {"max_bending_stress": 3.3e8}), "max_bending_stress")
    assert "330 MPa exceeds 300 MPa, the yield strength" in text
    assert warnings_of(soft, {"max_bending_stress": 2.9e8}) == []
    hard = case(PETALS, **{"petals.yield_strength": "2.5 GPa"})
    assert warnings_of(hard, {"max_bending_stress": 2.4e9}) == []


def test_a_viscosity_that_is_wrong_is_told_once() -> None:
    """18.5 cP in place of uPa s makes the mean free path a thousand times too long: that is no second fault."""
    for name, words in (("knudsen_number", "minimum film"), ("contact_knudsen_number", "the contact film")):
        assert words in only(warnings_of(case(PETALS), {name: 67.0}), name)
        (told,) = warnings_of(case(PETALS, **{"gas.viscosity": "18.5 cP"}), {name: 67.0})
        assert told.startswith("gas.viscosity: ")


def test_slip_changes_the_advice() -> None:
    thin = {"knudsen_number": 0.3}
    assert "set model.slip = true" in only(warnings_of(case(PLAIN), thin), "knudsen_number")
    assert "set model.slip" not in only(warnings_of(case(PLAIN, **{"model.slip": True}), thin), "knudsen_number")


def test_what_is_absent_is_not_judged() -> None:
    empty = {
        "max_bending_stress": math.nan,
        "knudsen_number": math.nan,
        "contact_fraction": math.nan,
        "speed": math.nan,
    }
    assert warnings_of(case(PETALS), empty) == []
    assert warnings_of(case(PLAIN), {"status": "no convergence"}) == []


# ---------------------------------------------------------------------------------------------- measured shapes


def measured(rows: Any, **changes: object) -> Case:
    return case(PETALS, **{"petals.free_shape": rows, "petals.bend_radius": None}, **changes)


def rows_of(count: int, scatter: float = 0.0) -> list[list[float]]:
    pack = case(PETALS).pack
    assert pack is not None
    angles = np.linspace(0.0, pack.petal_angle, count)
    deviation = scatter * np.random.default_rng(4).standard_normal(count)
    deviation[0] = 0.0
    return np.column_stack([angles, pack.free_radius(angles) + deviation]).tolist()


def test_a_coarse_measured_shape_is_warned_of() -> None:
    text = only(warnings_of(measured(rows_of(8)), {}), "petals.free_shape")
    assert "its estimated error is up to 6.3 µm" in text
    assert warnings_of(measured(rows_of(12)), {}) == []
    assert "5 rows are too few" in only(warnings_of(measured(rows_of(5)), {}), "petals.free_shape")


def test_scatter_is_warned_of_unless_it_is_stated() -> None:
    scattered = measured(rows_of(100, 5e-6))
    assert "estimated error is up to 24 µm" in only(warnings_of(scattered, {}), "petals.free_shape")
    assert warnings_of(scattered.replace(**{"petals.free_shape_tolerance": "5 um"}), {}) == []
    assert warnings_of(measured(rows_of(100, 0.1e-6)), {}) == []


def test_a_table_stretched_to_reach_the_edge_is_warned_of() -> None:
    """Its last row stands 0.1 degrees too far; the same rows without that are exact."""
    stretched = Case.load(FAULTS / "free_shape_12_points.toml")
    assert "up to 3.6 µm" in only(warnings_of(stretched, {}), "petals.free_shape")
    assert warnings_of(Case.load(FAULTS / "free_shape_last_row_rounded.toml"), {}) == []


# ---------------------------------------------------------------------------------------------- whole runs


def scalars_of(answer: Any) -> dict[str, Any]:
    return {name: variable.item() for name, variable in answer.data_vars.items() if not variable.dims}


@pytest.mark.slow
def test_fourteen_gigapascals_are_warned_of() -> None:
    one = Case.load(FAULTS / "stress_14GPa.toml")
    answer = scalars_of(petalfoil.solve(one))
    assert answer["min_film_thickness"] == pytest.approx(one.surface.contact_film_thickness, rel=1e-9)
    stress, contact = warnings_of(one, answer)
    assert stress.startswith("max_bending_stress: 13.7")
    assert contact.startswith("contact_fraction: at operating speed solid contact makes 99 % of the normal forces")
    assert answer["contact_model"] == AT_POINTS


def test_a_foil_pack_that_has_bottomed_out_is_warned_of() -> None:
    one = case(PETALS, **{"model.cells_per_pitch": 16})
    contact, solid, nodes = warnings_of(one, scalars_of(petalfoil.balance(one, load=(0.0, -500.0))))
    assert contact.startswith("contact_fraction: ")
    assert solid.startswith("bottomed_out: the foil pack has bottomed out")
    assert nodes.startswith("contact_model: no equilibrium with contact points was found")
    assert warnings_of(one, scalars_of(petalfoil.balance(one, load=(0.0, -10.0)))) == []


def test_friction_between_petals_is_said_to_be_no_prediction() -> None:
    rubbing = case("paper_n8", **{"surface.petal_friction": 0.2, "petals.theory": "inextensible"})
    (warning,) = [line for line in warnings_of(rubbing, {}) if line.startswith("surface.petal_friction: ")]
    assert "a sixtieth of the slip" in warning
    for other in (case("paper_n8"), case("paper_n8", **{"surface.petal_friction": 0.2})):
        assert not any("petal_friction" in line for line in warnings_of(other, {}))
