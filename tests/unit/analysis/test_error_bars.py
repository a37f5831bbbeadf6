"""Error bars are declared once: the question of any analysis on nested grids, at the state that was asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.arguments import Load
from petalfoil.analysis.balance import balance
from petalfoil.analysis.coefficient_tables import entry
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.declaration import Analysis, analysis
from petalfoil.analysis.error_bars import field_bars
from petalfoil.analysis.grid_study import grid_of, grids
from petalfoil.analysis.harmonics_bars import BY_HARMONICS, harmonics_bar, harmonics_bars
from petalfoil.analysis.known_verbs import forget
from petalfoil.analysis.liftoff import liftoff
from petalfoil.analysis.richardson import SAFETY
from petalfoil.analysis.runs import Points
from petalfoil.analysis.solve import solve
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from petalfoil.cli.printed_tables import render
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Series, SinglePoint
from petalfoil.results.record import Record
from tests.cases import FAULTS, case

SMALL = {"model.cells_per_pitch": 32, "model.axial_cells": 8}
LOADED = Case.load(FAULTS / "zero_load.toml").replace(**SMALL, **{"operation.load": (0.0, -15.0)})


# ---------------------------------------------------------------------------------------------- the engine


def smooth(bearing: Case, size: float) -> Record:
    """A force with an error of second order, 3 times the square of the cells' size."""
    sizes = {"ambient_pressure": 1.0, "journal_radius": 1.0, "length": 1.0, "speed": 1.0}
    force = size + 3.0 / bearing.cells_per_pitch**2
    scalars = {**sizes, "bearing_force": force, "converged": True, "status": "converged"}
    return Record(analysis="toy", scalars=scalars, case_toml=bearing.to_toml())


def toy(case: Case, load: Load = None, *, progress: Progress | None = None) -> Record:
    """Play a point."""
    return smooth(case, -load[1] if load else 1.0)


def toys(case: Case, load: Load = None, *, progress: Progress | None = None) -> Points:
    """Play a series; its second point never converges."""

    def points() -> Iterator[Record]:
        yield smooth(case, 1.0)
        yield Record(analysis="toys", scalars={"converged": False, "status": "lost"}, case_toml=case.to_toml())
        yield smooth(case, 2.0)

    return Points(points(), 3)


@pytest.fixture
def point() -> Iterator[Analysis]:
    yield analysis(SinglePoint(), error_bars=True)(toy)
    forget("toy")


@pytest.fixture
def series() -> Iterator[Analysis]:
    yield analysis(Series(), error_bars=True)(toys)
    forget("toys")


FLAT = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 128})
BAR = 3.0 / 128**2


def test_a_point_gets_bars_at_the_state_that_was_asked_for(point: Analysis) -> None:
    record = point.record(FLAT, "7 N", error=True)
    assert_allclose(record.scalars["bearing_force"], 7.0 + BAR, rtol=1e-14)
    assert record.errors is not None
    assert_allclose(record.errors["bearing_force"], SAFETY * BAR, rtol=1e-6)
    assert point.record(FLAT, "7 N").errors is None


def test_each_point_of_a_series_gets_its_own(series: Analysis) -> None:
    records = list(series.records(FLAT, error=True))
    assert [record.errors is None for record in records] == [False, True, False]
    ds = series(FLAT, error=True)
    assert_allclose(ds["bearing_force_error"], [SAFETY * BAR, np.nan, SAFETY * BAR], rtol=1e-6)
    stored = Answer.stored(ds, series.layouts[0])
    assert [record.errors is None for record in stored.records] == [False, True, False]
    assert "±" in render(stored)
    assert "bearing_force_error" not in series(FLAT)


def test_a_run_that_is_stopped_keeps_its_records_without_bars(series: Analysis) -> None:
    run = series.start(FLAT, {"error": True})
    steps = series.advance(run)
    next(steps)
    assert run.records() == ()
    assert [record.errors for record in run.records("interrupted")] == [None]
    assert run.finished() == "1 of 3 points are finished"


def test_a_grid_without_an_answer_leaves_no_bars(monkeypatch: pytest.MonkeyPatch, point: Analysis) -> None:
    def only_fine(case: Case, load: object = None, *, progress: object = None) -> Record:
        if case.cells_per_pitch != 128:
            raise ConvergenceError("too coarse")
        return smooth(case, 1.0)

    monkeypatch.setattr(point, "question", only_fine)
    point.__dict__.pop("signature", None)
    record = point.record(FLAT, error=True)
    assert record.errors == {}
    assert "no error bars" in record.remarks[0]


def rubbing(bearing: Case, change: float) -> Record:
    """A stiffness with an error of second order in each entry, and what half as many harmonics change it by."""
    ones = np.ones((1, 2, 2))
    fields = {"stiffness": (5.0 + 3.0 / bearing.cells_per_pitch**2) * ones, "stiffness_harmonics_change": change * ones}
    coords = {"whirl_frequency": np.ones(1), "row": np.arange(2), "column": np.arange(2)}
    scalars = {"converged": True}
    return Record(analysis="toy", scalars=scalars, fields=fields, coords=coords, case_toml=bearing.to_toml())


def test_what_more_harmonics_change_is_added_to_the_bar_from_the_grids() -> None:
    for change in (0.0, 0.25, -0.25):
        answers = {grid_of(one): (rubbing(one, change),) for one in grids(FLAT)}
        bars = field_bars(rubbing(FLAT, change), 0, answers)["stiffness_error"]
        assert_allclose(bars, SAFETY * BAR + BY_HARMONICS * abs(change), rtol=1e-6)


def test_bars_of_numbers_and_modes_have_what_more_harmonics_change() -> None:
    """A number without slips keeps its bar; one whose slips have one harmonic has none."""
    scalars = {"critical_mass_harmonics_change": -0.2, "whirl_ratio_harmonics_change": np.nan}
    fields, coords = {"damping_ratio_harmonics_change": np.array([-0.1])}, {"mode": np.ones(1)}
    record = replace(rubbing(FLAT, 0.0), scalars=scalars, fields=fields, coords=coords)
    bars = harmonics_bars(record, {"bearing_force": 1.0, "critical_mass": 0.5, "whirl_ratio": 0.1})
    assert bars == {"bearing_force": 1.0, "critical_mass": pytest.approx(0.5 + BY_HARMONICS * 0.2)}
    assert_allclose(harmonics_bar("damping_ratio", record), [BY_HARMONICS * 0.1])
    assert harmonics_bar("natural_frequency", record) is None
    parts = {"natural_frequency_harmonics_change": [0.0, 3.0], "mode_growth_rate_harmonics_change": [2.0, -1.0]}
    both = {name: np.array(values) for name, values in parts.items()}
    mode = replace(record, fields=both, coords={"mode": np.array([1, 2])})
    assert_allclose(harmonics_bar("natural_frequency", mode), BY_HARMONICS * np.array([math.sqrt(2.0), 3.0]))
    assert_allclose(harmonics_bar("mode_growth_rate", mode), BY_HARMONICS * np.array([2.0, math.sqrt(5.0)]))


def test_with_one_harmonic_there_is_no_bar() -> None:
    answers = {grid_of(one): (rubbing(one, np.nan),) for one in grids(FLAT)}
    record = rubbing(FLAT, np.nan)
    bars = field_bars(record, 0, answers)["stiffness_error"]
    assert np.all(np.isnan(bars))
    barred = replace(record, fields={**record.fields, "stiffness_error": bars})
    assert entry("stiffness", 0, 0)(barred, 0) == record.fields["stiffness"][0, 0, 0]


def test_a_table_over_load_and_speed_has_none() -> None:
    with pytest.raises(UsageError, match="not for a table over load and speed"):
        stability(LOADED, speeds=[3000.0], error=True)


def test_the_option_stands_in_every_analysis_of_a_state() -> None:
    for verb in (solve, balance, liftoff, coefficients, stability):
        assert "error" in verb.arguments
        assert "error" in verb.signature.parameters


# ---------------------------------------------------------------------------------------------- the analyses


def test_a_balance_has_bars_on_its_position() -> None:
    record = balance.record(LOADED, error=True)
    assert record.errors is not None
    fine = balance.record(LOADED.replace(**{"model.cells_per_pitch": 128, "model.axial_cells": 32}))
    for name in ("eccentricity_x", "eccentricity_y", "min_film_thickness"):
        assert 0.0 < record.errors[name] < 0.02 * abs(float(record.scalars[name]))
        assert abs(float(fine.scalars[name]) - float(record.scalars[name])) <= record.errors[name]


@pytest.mark.slow
def test_stability_and_coefficients_have_bars() -> None:
    found = stability.record(LOADED, error=True)
    assert found.errors is not None
    assert {"critical_mass", "threshold_speed", "whirl_ratio"} <= set(found.errors)
    assert 0.0 < found.errors["critical_mass"] < float(found.scalars["critical_mass"])
    several = coefficients(LOADED, speeds=[3000.0, 4000.0], error=True)
    assert np.all(several["eccentricity_y_error"] > 0.0)


def test_every_entry_of_stiffness_and_damping_has_its_bar() -> None:
    ds = coefficients(LOADED, error=True)
    fine = coefficients(LOADED.replace(**{"model.cells_per_pitch": 128, "model.axial_cells": 32}))
    for name in ("stiffness", "damping"):
        bars, largest = ds[f"{name}_error"].values, float(np.abs(ds[name]).max())
        assert ds[f"{name}_error"].dims == ds[name].dims
        assert np.all((bars > 0.0) & (bars < 0.1 * largest))
        assert np.all(np.abs(fine[name].values - ds[name].values) <= bars)
    assert "±" in render(Answer.stored(ds, coefficients.layouts[0]))
    assert "stiffness_error" not in coefficients(LOADED)


# ---------------------------------------------------------------------------------------------- a load in the case


def test_a_load_in_the_case_is_balanced() -> None:
    """The answer once was 5e-16 N at the centre."""
    record, balanced = solve.record(LOADED), balance.record(LOADED)
    assert_allclose(float(record.scalars["bearing_force"]), 15.0, rtol=1e-8)
    for name in ("eccentricity_x", "eccentricity_y", "load_y", "force_residual"):
        assert record.scalars[name] == balanced.scalars[name]
    assert str(record.scalars["solution_path"]).startswith("at the position that balances the load")


def test_a_grid_study_balances_the_load_on_every_grid() -> None:
    for ds in (
        petalfoil.converge(LOADED, levels=2, coarsest=16),
        petalfoil.converge(LOADED.replace(**{"operation.load": None}), load="15 N", levels=2, coarsest=16),
    ):
        assert_allclose(ds["bearing_force"], [15.0, 15.0], rtol=1e-8)
        assert 0.0 < float(ds["eccentricity_y_error"]) < 1e-6
    bars = solve.record(LOADED, error=True).errors
    assert bars is not None
    assert bars["eccentricity_y"] > 0.0
    assert not {"bearing_force", "force_x", "force_y"} & {*bars}  # given


@pytest.mark.slow
def test_a_film_that_is_held_at_contact_has_no_error_bar() -> None:
    """At a hundredth of the speed the journal touches on every grid: the minimum film thickness is a constant."""
    touching = case(
        "paper_n8", **{"model.cells_per_pitch": 32, "operation.speed": 10.0, "operation.load": (0.0, -15.0)}
    )
    record = solve.record(touching.replace(**{"operation.eccentricity": (0.0, 0.0)}), error=True)
    assert record.scalars["min_film_thickness"] == touching.surface.contact_film_thickness
    assert record.errors is not None
    assert not {"min_film_thickness", "knudsen_number"} & {*record.errors}
    assert record.errors["contact_fraction"] > 0.0


def test_which_of_load_and_eccentricity_is_meant_is_asked() -> None:
    both = LOADED.replace(**{"operation.eccentricity": (0.0, -5e-6)})
    for verb in (petalfoil.solve, petalfoil.converge):
        with pytest.raises(UsageError, match=r"both operation\.load and operation\.eccentricity"):
            verb(both)
    record = solve.record(both, eccentricity=(0.0, -5e-6))
    assert record.scalars["eccentricity_y"] == -5e-6
    assert "load_y" not in record.scalars


def test_the_classic_method_is_not_asked_for_a_balance() -> None:
    classic = case("paper_n6", **{"model.method": "classic", "operation.eccentricity": (0.0, 0.0)})
    with pytest.raises(UsageError, match="the classic method finds no position"):
        solve.record(classic.replace(**{"operation.load": (0.0, -10.0)}))


def test_rounding_has_no_bar_in_the_table() -> None:
    free = LOADED.replace(**{"operation.load": (0.0, 0.0)})
    lines = render(Answer.stored(balance(free, error=True), balance.layouts[0])).splitlines()
    assert [line.split() for line in lines if line.startswith("displacement")] == [
        ["displacement", "x", "0", "µm"],
        ["displacement", "y", "0", "µm"],
    ]


def test_an_eccentricity_of_the_call_goes_before_the_load_of_the_case() -> None:
    record = solve.record(LOADED, eccentricity=(0.0, 0.0))
    assert record.scalars["eccentricity_y"] == 0.0
    assert math.hypot(*(float(record.scalars[f"force_{axis}"]) for axis in "xy")) < 1e-9
