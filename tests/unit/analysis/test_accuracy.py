"""An accuracy that is asked for: what misses it, finer grids, and what is told."""

import math
from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis import known_verbs
from petalfoil.analysis.accuracy import MOST_HARMONICS, finer, remark_on, shortfalls, size_of
from petalfoil.analysis.arguments import NumberWithUnit
from petalfoil.analysis.error_bars import WithErrorBars
from petalfoil.analysis.harmonics_bars import BY_HARMONICS
from petalfoil.analysis.richardson import SAFETY
from petalfoil.analysis.runs import Single
from petalfoil.case import Case, ModelKind
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from tests.cases import case

FLAT = case("paper_n8", **{"model.cells_per_pitch": 64})
Number = Annotated[float | None, NumberWithUnit(unit="1", help="A number.")]


def toy(bearing: Case, *, fails_from: int = 4096, factor: float = 50.0) -> Record:
    """A force with an error of second order: `factor` times the square of the cells' size."""
    if bearing.cells_per_pitch >= fails_from:
        raise ConvergenceError("no answer on this grid")
    force = 10.0 + factor / bearing.cells_per_pitch**2 * 64.0
    scalars: dict[str, Any] = {"bearing_force": force, "status": "converged", "converged": True}
    scalars |= {"ambient_pressure": 1e5, "journal_radius": 0.025, "length": 0.05}
    return Record(analysis="toy", title="", scalars=scalars, fields={}, coords={}, case_toml=bearing.to_toml())


def refined(accuracy: float | None, **how: Any) -> tuple[Record, list[int]]:
    """The answer of the toy, and the grids that it was asked on beside its own."""
    asked: list[int] = []

    def ask(bearing: Case, _: int | None) -> tuple[Record, ...]:
        asked.append(bearing.cells_per_pitch)
        return (toy(bearing, **how),)

    run = WithErrorBars(Single(toy(FLAT, **how)), FLAT, ask, accuracy)
    parts = [part for part, _ in run.advance()]
    assert parts == sorted(parts)
    assert all(0.0 <= part <= 1.0 for part in parts)
    (record,) = run.records()
    return record, asked


def cells(record: Record) -> int:
    """Grid of a record."""
    return Case.from_toml(record.case_toml).cells_per_pitch


def test_without_an_accuracy_the_grid_stays() -> None:
    record, asked = refined(None)
    assert cells(record) == 64
    assert sorted(asked) == [32, 128]
    assert not record.remarks


@pytest.mark.parametrize(("accuracy", "grid"), [(1e-2, 256), (2.5e-3, 512), (1e-3, 1024)])
def test_grids_are_refined_until_the_bar_is_below_and_no_further(accuracy: float, grid: int) -> None:
    record, asked = refined(accuracy)
    assert record.errors is not None
    assert cells(record) == grid
    assert sorted(asked) == sorted(set(asked))  # no grid twice
    bar = SAFETY * 3200.0 / grid**2
    assert_allclose(record.errors["bearing_force"], bar, rtol=1e-6)
    assert bar <= accuracy * float(record.scalars["bearing_force"]) < 4.0 * bar  # half the cells would not do
    assert abs(float(record.scalars["bearing_force"]) - 10.0) <= bar
    assert not record.remarks


def test_what_misses_on_the_finest_grid_is_named() -> None:
    record, _ = refined(1e-9)
    assert cells(record) == 1024
    (remark,) = record.remarks
    assert "1e-07 % is not reached" in remark
    assert "bearing force (±" in remark


def test_a_finer_grid_without_an_answer_ends_the_refinement() -> None:
    record, _ = refined(1e-9, fails_from=256)
    assert cells(record) == 128
    assert record.errors
    assert "is not reached" in record.remarks[0]


SLIPS = 2.0
"""What harmonics leave of a stiffness of 10, times their number: with the 8 that it has by itself, 2.5 %."""


def rubbing(bearing: Case, harmonics: int) -> Record:
    """A stiffness of 10 with errors of the grid, and of harmonics, which halve with each doubling."""
    by_grid, by_harmonics = 25.0 / bearing.cells_per_pitch**2, SLIPS / harmonics
    ones = np.ones((1, 2, 2))
    fields = {"stiffness": (10.0 + by_grid + by_harmonics) * ones, "stiffness_harmonics_change": by_harmonics * ones}
    coords = {"whirl_frequency": np.ones(1), "row": np.arange(2), "column": np.arange(2)}
    record = toy(bearing, factor=0.0)
    scalars = {**record.scalars, "friction_harmonics": harmonics}
    return replace(record, scalars=scalars, fields=fields, coords=coords)


def rubbed(accuracy: float, fails_from: int = 4096) -> tuple[Record, list[tuple[int, int | None]]]:
    """The answer of petals that rub, and the grids and harmonics that it was asked with beside its own."""
    asked: list[tuple[int, int | None]] = []

    def ask(bearing: Case, harmonics: int | None) -> tuple[Record, ...]:
        asked.append((bearing.cells_per_pitch, harmonics))
        if harmonics is not None and harmonics >= fails_from:
            raise ConvergenceError("slips do not agree")
        return (rubbing(bearing, harmonics or 8),)

    run = WithErrorBars(Single(rubbing(FLAT, 8)), FLAT, ask, accuracy)
    for _ in run.advance():
        pass
    (record,) = run.records()
    return record, asked


def test_harmonics_are_doubled_where_they_leave_the_larger_part_of_a_bar() -> None:
    """At 1 % harmonics alone are refined: 32 leave 0.8 %; at 0.25 % the grid is too."""
    assert "accuracy" in petalfoil.coefficients.arguments  # which declares the fields
    record, asked = rubbed(1e-2)
    assert (cells(record), record.scalars["friction_harmonics"]) == (64, 32)
    assert len(asked) == len(set(asked))
    bar = float(np.max(record.fields["stiffness_error"]))
    by_grid = 25.0 / 64**2 - 25.0 / 128**2 + SAFETY * 25.0 / 128**2  # the finest of its three grids has 128 cells
    assert_allclose(bar, BY_HARMONICS * SLIPS / 32 + by_grid, rtol=1e-6)
    assert bar <= 1e-2 * 10.0
    assert not record.remarks
    finest, _ = rubbed(2.5e-3)
    assert (cells(finest), finest.scalars["friction_harmonics"]) == (128, 128)
    assert not finest.remarks


def test_a_bar_that_harmonics_hold_above_the_accuracy_says_so() -> None:
    """No grid would help, so that none is tried."""
    record, asked = rubbed(1e-4)
    assert record.scalars["friction_harmonics"] == MOST_HARMONICS[ModelKind.TWO_D]
    assert max(grid for grid, _ in asked) < 1024
    (remark,) = record.remarks
    assert "0.01 % is not reached" in remark
    assert "of it from harmonics of slips" in remark
    assert "128 are the most that are tried" in remark


def test_harmonics_without_an_answer_end_the_refinement() -> None:
    record, _ = rubbed(1e-2, fails_from=32)
    assert record.scalars["friction_harmonics"] == 16
    assert "32 harmonics of slips has no answer: slips do not agree" in record.remarks[0]


def test_slips_of_one_harmonic_have_a_bar_that_nothing_narrows() -> None:
    """Nothing tells what more would change: finer grids are not tried."""

    def one_harmonic(bearing: Case) -> Record:
        record = rubbing(bearing, 1)
        unknown = {**record.fields, "stiffness_harmonics_change": np.full((1, 2, 2), math.nan)}
        return replace(record, fields=unknown)

    run = WithErrorBars(Single(one_harmonic(FLAT)), FLAT, lambda other, _: (one_harmonic(other),), 1e-2)
    grids = [text for _, text in run.advance()]
    (known,) = run.records()
    assert grids == ["grid 32", "grid 128"]
    assert "unknown, as one harmonic of slips has no half" in known.remarks[0]


def test_sizes_that_bars_are_compared_with() -> None:
    scalars = {"force_x": -1e-9, "bearing_force": 20.0, "attitude_angle": 0.1, "contact_fraction": 0.02}
    scalars |= {"min_film_thickness": 5e-6}
    assert size_of("force_x", scalars) == 20.0
    assert size_of("attitude_angle", scalars) == 1.0
    assert size_of("contact_fraction", scalars) == 1.0
    assert size_of("min_film_thickness", scalars) == 5e-6


def test_entries_of_a_field_are_compared_with_the_largest() -> None:
    assert "accuracy" in petalfoil.coefficients.arguments  # which declares the fields
    record = replace(
        toy(FLAT), errors={}, coords={"whirl_frequency": np.ones(1), "row": np.arange(2), "column": np.arange(2)}
    )
    stiffness, bars = np.array([[[4.0, 0.0], [0.0, -10.0]]]), np.array([[[0.1, 0.2], [0.0, 0.1]]])
    fields = {"stiffness": stiffness, "stiffness_error": bars}
    missed = shortfalls([replace(record, fields=fields)], 0.01)
    assert_allclose(list(missed.values()), [0.02])
    assert not shortfalls([replace(record, fields=fields)], 0.02)
    assert remark_on(replace(record, fields=fields), 0.02).remarks == ()
    unknown = {**fields, "stiffness_error": np.full((1, 2, 2), math.nan)}
    assert shortfalls([replace(record, fields=unknown)], 0.5)


def test_grids_end_where_accuracy_gets_dear() -> None:
    assert finer(case("paper_n8", **{"model.cells_per_pitch": 1024})) is None
    spatial = case("paper_n8_spatial", **{"model.cells_per_pitch": 64, "model.axial_cells": 24})
    ahead = finer(spatial)
    assert ahead is not None
    assert (ahead.cells_per_pitch, ahead.axial_cells) == (128, 48)
    assert finer(ahead) is None


@pytest.mark.parametrize("wrong", [0.0, 2.0, "much", "1 mm"])
def test_accuracies_that_make_no_sense_are_refused(wrong: object) -> None:
    with pytest.raises((UsageError, petalfoil.PetalfoilError), match="accuracy"):
        petalfoil.solve(FLAT, accuracy=wrong)


@pytest.mark.slow
def test_a_solution_is_refined_to_the_accuracy() -> None:
    coarse = case("paper_n10", **{"model.cells_per_pitch": 32, "operation.eccentricity": (0.0, -2e-4)})
    ds = petalfoil.solve(coarse, accuracy="0.5 %")
    fine = petalfoil.solve(coarse.replace(**{"model.cells_per_pitch": 512}))
    assert Case.from_toml(ds.attrs["case"]).cells_per_pitch > 32
    for name in ("bearing_force", "min_film_thickness", "peak_pressure"):
        bar = ds[name].attrs["grid_error"]
        assert bar <= 0.005 * abs(float(ds[name]))
        assert abs(float(ds[name]) - float(fine[name])) <= bar


WITHOUT_BARS = {"check", "converge", "sensitivity"}
"""What solves nothing, is a study of grids itself, or tells derivatives."""


def test_every_verb_has_both_arguments() -> None:
    declared = {verb: known_verbs.find(verb) for verb in known_verbs.summaries()}
    told = {verb for verb, one in declared.items() if one is not None and {"error", "accuracy"} <= set(one.arguments)}
    assert told == set(declared) - WITHOUT_BARS


@pytest.mark.slow
def test_points_of_curves_have_bars() -> None:
    small = FLAT.replace(**{"model.cells_per_pitch": 32})
    curve = petalfoil.curve(small, [0.0, 1e-4], error=True)
    assert np.all(curve["min_film_thickness_error"] > 0.0)
    rest = petalfoil.static(small, [0.0, 1e-4], error=True)
    assert np.all(rest["contact_normal_force_error"] > 0.0)


@pytest.mark.slow
def test_natural_modes_have_bars() -> None:
    plain = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 32})
    ds = petalfoil.stability(plain, load="15 N", mass="1 kg", error=True)
    for name in ("natural_frequency", "mode_growth_rate", "damping_ratio"):
        assert ds[f"{name}_error"].shape == ds[name].shape
    assert float(ds["natural_frequency_error"][0]) < 0.05 * float(ds["natural_frequency"][0])


@pytest.mark.slow
def test_a_motion_has_bars_and_one_that_goes_on_has_none() -> None:
    rotor = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 24, "rotor.mass": 1.0})
    rotor = rotor.replace(**{"rotor.unbalance": 2e-6})
    motion = petalfoil.orbit(rotor, revolutions=1.0, load="15 N", tolerance=1e-2, error=True)
    assert 0.0 < motion["amplitude"].attrs["grid_error"] < float(motion["amplitude"])
    with pytest.raises(UsageError, match="leave restart out"):
        petalfoil.orbit(rotor, revolutions=1.0, restart=motion, load="15 N", error=True)
