"""The table of `sensitivity`: rows, order, refusals, both faces."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import petalfoil
from petalfoil import plot
from petalfoil.analysis.differentiable import default_paths
from petalfoil.case.parameters import parameter_of, with_values
from petalfoil.cli.app import app
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.plot.parameter_effects import FARTHEST
from tests.cases import EXAMPLES, case

SMALL = case(**{"model.cells_per_pitch": 8})
PATHS = "petals.youngs_modulus, operation.speed, gas.viscosity, gas.temperature"


@pytest.fixture(scope="module")
def under_load() -> xr.Dataset:
    return petalfoil.sensitivity(SMALL, PATHS, load="20 N", of="min_film_thickness, friction_torque", step=0.02)


def test_rows_are_ordered_by_result_and_effect(under_load: xr.Dataset) -> None:
    assert list(under_load["quantity"].values) == ["min_film_thickness"] * 4 + ["friction_torque"] * 4
    size = np.abs(under_load["relative_effect"].values)
    assert np.all(np.diff(size[:4]) <= 0.0)
    assert np.all(np.diff(size[4:]) <= 0.0)


def test_speed_and_viscosity_have_the_same_relative_effect_on_the_film(under_load: xr.Dataset) -> None:
    film = under_load.isel(point=slice(0, 4))
    effect = dict(zip(film["parameter"].values, film["relative_effect"].values, strict=True))
    assert_allclose(effect["operation.speed"], effect["gas.viscosity"], rtol=1e-6)
    assert_allclose(effect["gas.temperature"], 0.0, atol=1e-12)


def test_all_results_can_be_asked_for_at_once(under_load: xr.Dataset) -> None:
    ds = petalfoil.sensitivity(SMALL, "gas.viscosity", load="20 N", of="all", step=0.02)
    names = list(ds["quantity"].values)
    assert len(set(names)) == len(names) > 10
    film = names.index("min_film_thickness")
    own = under_load["derivative"].values[list(under_load["parameter"].values).index("gas.viscosity")]
    assert ds["derivative"].values[film] == own


def test_the_effect_is_derivative_times_change(under_load: xr.Dataset) -> None:
    change = under_load["parameter_change"].values
    assert_allclose(change, 0.02 * under_load["parameter_value"].values, rtol=1e-15)
    assert_allclose(under_load["effect"].values, under_load["derivative"].values * change, rtol=1e-12)
    relative = under_load["effect"].values / under_load["quantity_value"].values
    assert_allclose(under_load["relative_effect"].values, relative, rtol=1e-12)


def test_the_figure_has_a_panel_for_each_result(under_load: xr.Dataset) -> None:
    fig = plot.tornado(under_load)
    assert [ax.get_xlabel() for ax in fig.axes] == [
        "change of the minimum film thickness [%]",
        "change of the friction torque [%]",
    ]
    longest = max(bar.get_width() for bar in fig.axes[0].patches)
    assert_allclose(longest, 100.0 * np.abs(under_load["relative_effect"].values).max(), rtol=1e-12)


def test_one_large_effect_does_not_hide_the_others(under_load: xr.Dataset) -> None:
    """Its bar is cut, its number is whole; the legend covers no bar."""
    film = under_load.isel(point=slice(0, 3)).copy(deep=True)
    film["effect"][:] = np.array([-4.098, 0.3, 0.1]) * film["quantity_value"].values
    ax = plot.tornado(film).axes[0]
    assert max(abs(bar.get_width()) for bar in ax.patches) <= FARTHEST * 30.0 * (1.0 + 1e-12)
    texts = [text.get_text() for text in ax.texts]
    assert "−410 (bar cut)" in texts
    assert "+30" in texts
    assert ax.get_legend() is None
    assert ax.figure.legends


@pytest.mark.slow
@pytest.mark.parametrize("contacts", ["points", "nodes"])
def test_a_result_that_is_zero_by_symmetry_has_no_relative_effect(contacts: str) -> None:
    centred = SMALL.replace(**{"operation.eccentricity": (0.0, 0.0)})
    with pytest.warns(UserWarning, match="without effect: .*petals.thickness"):
        ds = petalfoil.sensitivity(centred, of="force_y", contacts=contacts)
    assert "operation.eccentricity.y" in ds["parameter"].values
    assert "petals.thickness" not in ds["parameter"].values
    assert np.all(np.isnan(ds["relative_effect"].values))


def test_a_parameter_that_cannot_vary_alone_says_why() -> None:
    bumps = case("bump_foil", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
    ds = petalfoil.sensitivity(bumps, "bump_foil.top_foil_thickness, gas.viscosity")
    status = dict(zip(ds["parameter"].values, ds["status"].values, strict=True))
    assert status["gas.viscosity"] == "converged"
    assert "a top foil bends by it" in status["bump_foil.top_foil_thickness"]


def test_parameters_of_two_bearings_are_not_varied_in_one() -> None:
    rotor = {"mass": 1.0, "unbalance": 1e-6}
    one = SMALL.replace(**{"operation.load": (0.0, -20.0), "rotor": rotor})
    varied = [path for path in default_paths(one, "balance") if path.startswith("rotor.")]
    assert varied
    for path in varied:
        with_values(one, {path: 0.9 * float(parameter_of(one, path).value or 0.0) + 1e-9})  # none of them is refused
    two = one.replace(**{"rotor": rotor | {"span": 0.2, "transverse_inertia": 4e-3, "polar_inertia": 6e-4}})
    assert {"rotor.centre", "rotor.polar_inertia", "rotor.skew"} <= {*default_paths(two, "balance")}


def test_a_parameter_that_is_zero_has_an_absolute_change() -> None:
    ds = petalfoil.sensitivity(SMALL, "petals.first_root", of="bearing_force")
    assert str(ds["change_text"].values[0]).endswith("°")
    assert float(ds["parameter_change"].values[0]) == pytest.approx(1e-3)


def test_the_command_prints_the_table_and_one_json_object() -> None:
    arguments = ["sensitivity", str(EXAMPLES / "plain_journal.toml"), "--vary", "gas.viscosity"]
    shown = CliRunner().invoke(app, arguments)
    assert shown.exit_code == 0
    assert "gas.viscosity" in shown.output
    assert "bearing_force" in shown.output
    points = json.loads(CliRunner().invoke(app, [*arguments, "--json"]).output)["points"]
    assert [point["parameter"] for point in points] == ["gas.viscosity"]
    assert points[0]["contacts_hold"] is None or points[0]["contacts_hold"] > 0.0


@pytest.mark.parametrize(
    ("given", "refusal", "message"),
    [
        ({"ask": "balanse"}, UsageError, "Did you mean 'balance'"),
        ({"of": "min_film"}, UsageError, "Did you mean 'min_film_thickness'"),
        ({"vary": "petals.thicknes"}, DefinitionError, "petals.thickness"),
        ({"vary": "petals.count"}, UsageError, "petals.count is a whole number"),
        ({"vary": "petals.root_tilt"}, UsageError, "follows from other keys"),
        ({"vary": "petals.thickness,"}, UsageError, "names nothing between two commas"),
        ({"step": 0.0}, UsageError, "step"),
        ({"ask": "solve", "load": "20 N"}, UsageError, "solve holds the journal at a position"),
        ({"ask": "balance"}, UsageError, "no load to balance"),
        ({"ask": "balance", "eccentricity": "0 um, 1 um"}, UsageError, "give a load, or ask solve"),
        ({"ask": "liftoff", "load": "1 N, -20 N"}, UsageError, "does not act along -y"),
    ],
)
def test_what_cannot_be_asked_is_refused_before_anything_runs(
    given: dict[str, object], refusal: type[Exception], message: str
) -> None:
    with pytest.raises(refusal, match=message):
        petalfoil.sensitivity(SMALL, **given)


def test_the_starting_torque_is_proportional_to_friction_and_to_the_modulus() -> None:
    paths = "surface.friction_coefficient, petals.youngs_modulus"
    ds = petalfoil.sensitivity(SMALL, paths, ask="static", of="starting_torque, contact_normal_force", contacts="nodes")
    effects = {
        (str(quantity), str(path)): float(effect)
        for quantity, path, effect in zip(
            ds["quantity"].values, ds["parameter"].values, ds["relative_effect"].values, strict=True
        )
    }
    assert_allclose(effects["starting_torque", "surface.friction_coefficient"], 0.01, rtol=1e-9)
    assert_allclose(effects["starting_torque", "petals.youngs_modulus"], 0.01, rtol=1e-7)
    assert_allclose(effects["contact_normal_force", "surface.friction_coefficient"], 0.0, atol=1e-12)
    own = petalfoil.static(SMALL.replace(**{"model.contacts": "nodes"}))["starting_torque"].values[0]
    assert_allclose(ds["quantity_value"].values[list(ds["quantity"].values).index("starting_torque")], own, rtol=1e-9)


@pytest.mark.slow
def test_the_load_capacity_follows_speed_as_it_follows_viscosity() -> None:
    finer = case(**{"model.cells_per_pitch": 24})
    ds = petalfoil.sensitivity(finer, "operation.speed, gas.viscosity", ask="capacity", min_film_thickness=8e-6)
    assert set(ds["quantity"].values) == {"load_capacity"}
    assert_allclose(ds["relative_effect"].values[0], ds["relative_effect"].values[1], rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("path", ["gas.viscosity", "bearing.journal_radius"])
def test_the_load_capacity_follows_like_one_that_is_found_again(path: str) -> None:
    plain = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 24})
    limits = {"min_film_thickness": 5e-6, "direction": 0.3}
    found = petalfoil.sensitivity(plain, path, ask="capacity", **limits)
    value = float(found["parameter_value"].item())
    change = (1e-3 if path == "gas.viscosity" else 1e-6) * value
    ends = [
        petalfoil.capacity(plain.replace(**{path: value + side * change}), **limits)["load_capacity"].item()
        for side in (-1.0, 1.0)
    ]
    assert_allclose(found["derivative"].item(), (ends[1] - ends[0]) / (2.0 * change), rtol=2e-3)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ({"ask": "capacity"}, "a load capacity needs a limit"),
        ({"ask": "capacity", "min_film_thickness": 8e-6, "load": 20.0}, "capacity finds the load"),
        ({"ask": "balance", "load": 20.0, "min_film_thickness": 8e-6}, "limits of a load capacity: balance has none"),
    ],
)
def test_limits_are_those_of_a_load_capacity(arguments: dict[str, object], told: str) -> None:
    with pytest.raises(UsageError, match=told):
        petalfoil.sensitivity(SMALL, "gas.viscosity", **arguments)


def test_petals_that_remember_have_no_derivative_at_rest() -> None:
    with pytest.raises(UsageError, match="depends on their path"):
        petalfoil.sensitivity(SMALL.replace(**{"surface.petal_friction": 0.2}), "gas.viscosity", ask="static")
