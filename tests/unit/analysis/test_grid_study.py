"""Grids are nested, failures are told, and the limit of a smooth problem is met."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.converge import converge
from petalfoil.analysis.grid_study import error_bars, grid_of, grid_records, grids, of_one_size, resolution, table
from petalfoil.analysis.solve import point as solved
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError, PackError, UsageError
from petalfoil.results import Record
from petalfoil.results.estimate import Estimate
from tests.cases import case

FLAT = case("paper_n8")
SPATIAL = case("paper_n8_spatial")
JOURNAL = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 64})


def cells_of(cases: list[Case]) -> list[tuple[int, int]]:
    return [grid_of(one) for one in cases]


def on(base: Case, cells: int, axial: int | None = None) -> Case:
    return base.replace(**{"model.cells_per_pitch": cells, "model.axial_cells": axial})


# ---------------------------------------------------------------------------------------------- grids


@pytest.mark.parametrize(
    ("own", "expected"),
    [(32, [32, 64, 128]), (64, [32, 64, 128]), (128, [32, 64, 128]), (256, [64, 128, 256]), (50, [50, 100, 200])],
)
def test_the_own_grid_is_the_finest_as_long_as_coarser_ones_can_be_had(own: int, expected: list[int]) -> None:
    assert cells_of(grids(on(FLAT, own))) == [(cells, 0) for cells in expected]


def test_the_length_is_divided_in_step() -> None:
    assert cells_of(grids(on(SPATIAL, 48, 24), levels=2)) == [(24, 12), (48, 24)]
    assert cells_of(grids(on(SPATIAL, 48, 14), levels=2)) == [(48, 14), (96, 28)]  # half of 14 cannot be halved
    assert cells_of(grids(on(SPATIAL, 48, 14).replace(**{"model.symmetry": False}), levels=2)) == [(24, 7), (48, 14)]
    assert cells_of(grids(on(SPATIAL, 32, 16), levels=3, coarsest=24)) == [(24, 12), (48, 24), (96, 48)]
    assert cells_of(grids(on(SPATIAL, 64, 4), levels=2, coarsest=16)) == [(16, 4), (32, 8)]


def test_speed_and_position_go_to_every_grid() -> None:
    for record in converge.records(JOURNAL, speed=100.0, eccentricity=(1e-6, 2e-6), levels=2, coarsest=16):
        names = ("speed", "eccentricity_x", "eccentricity_y")
        assert [record.scalars[name] for name in names] == [100.0, 1e-6, 2e-6]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"levels": 1}, "levels: .* at least 2 and at most 10"),
        ({"levels": 11}, "at least 2 and at most 10"),
        ({"levels": "three"}, "levels: 'three' is not a whole number"),
        ({"coarsest": 15}, "coarsest: .* at least 16"),
    ],
)
def test_grids_that_tell_nothing_are_refused(arguments: dict[str, Any], reason: str) -> None:
    with pytest.raises(UsageError, match=reason):
        converge.records(FLAT, **arguments)


def test_a_position_without_room_is_refused_before_any_grid() -> None:
    with pytest.raises(PackError):
        converge.records(FLAT, eccentricity=(0.0, 1e-3))


# ---------------------------------------------------------------------------------------------- studies


def named(estimates: list[Estimate]) -> dict[str, Estimate]:
    return {estimate.name: estimate for estimate in estimates}


@pytest.fixture(scope="module")
def smooth() -> list[Record]:
    """A plain gas bearing: no contact, second order."""
    return list(converge.records(JOURNAL, levels=3, coarsest=32))


def test_a_smooth_figure_has_order_two_and_its_limit(smooth: list[Record]) -> None:
    found = named(table(smooth))["bearing_force"]
    fine = named(table(list(converge.records(JOURNAL, levels=3, coarsest=128))))["bearing_force"]
    assert found.trusted
    assert_allclose(found.order, 2.0, atol=0.1)
    assert abs(found.limit - fine.limit) < found.error
    assert found.error < 2e-3 * found.limit
    assert_allclose(fine.limit, found.limit, rtol=5e-5)
    assert [len(record.coords["phi_exposed"]) - 1 for record in smooth] == [32, 64, 128]


def test_figures_without_a_value_are_left_out_and_no_bookkeeping_is_in(smooth: list[Record]) -> None:
    names = named(table(smooth))
    assert {"bearing_force", "min_film_thickness", "peak_pressure", "friction_torque", "attitude_angle"} <= set(names)
    assert not {"wall_time", "residual", "speed", "iterations", "stable", "converged"} & set(names)
    centred = list(converge.records(JOURNAL, eccentricity=(0.0, 0.0), levels=2, coarsest=16))
    assert "attitude_angle" not in named(table(centred))


def test_error_bars_belong_to_the_own_grid(smooth: list[Record]) -> None:
    bars = error_bars(solved(JOURNAL), solved)
    load = named(table(smooth))["bearing_force"]  # 32, 64, 128: the grids of a case with 64 cells, too
    assert_allclose(bars["bearing_force"], abs(load.values[1] - load.values[2]) + load.error, rtol=1e-6)
    assert abs(load.values[1] - load.limit) < bars["bearing_force"]


# ---------------------------------------------------------------------------------------------- failures


def point(cells: int, **scalars: float) -> Record:
    """A record of a grid; without figures, one that failed."""
    known = {"ambient_pressure": 1e5, "journal_radius": 0.02, "length": 0.04, "cells_per_pitch": cells}
    outcome = {"converged": bool(scalars), "status": "converged" if scalars else "not converged: lost"}
    return Record(analysis="solve", scalars={**known, **outcome, **scalars})


def test_a_failed_grid_is_recorded_and_the_others_go_on() -> None:
    def play(case: Case, progress: Any) -> Record:
        if case.cells_per_pitch == 64:
            raise ConvergenceError("no equilibrium found", history=[{"phase": "film"}], advice="try")
        return solved(case, progress)

    records = list(grid_records(grids(JOURNAL, levels=3, coarsest=32), play))
    assert [record.converged for record in records] == [True, False, True]
    assert records[1].scalars["status"] == "not converged: no equilibrium found"
    assert records[1].history == [{"phase": "film"}]
    load = named(table(records))["bearing_force"]
    assert [math.isnan(value) for value in load.values] == [False, True, False]
    assert load.limit == load.values[2]
    assert_allclose(load.error, 3.0 * abs(load.values[2] - load.values[0]), rtol=1e-12)
    assert not load.trusted


@pytest.mark.parametrize(
    ("lost", "limit"),
    [((), 1.0), ((0,), 1.0), ((3,), 1.0), ((1,), 1.0 + 2.0**-6), ((0, 1), 1.0 + 2.0**-6)],
)
def test_the_last_unbroken_grids_count(lost: tuple[int, ...], limit: float) -> None:
    figures = [{"bearing_force": 1.0 + 4.0**-level} for level in range(4)]
    records = [point(16 * 2**k, **({} if k in lost else figures[k])) for k in range(4)]
    (load,) = table(records)
    assert load.limit == limit
    assert load.trusted == (limit == 1.0)


def test_a_force_that_is_rounding_is_no_failure_to_converge() -> None:
    records = [
        point(16 * 2**k, bearing_force=force, min_film_thickness=force) for k, force in enumerate((3e-13, 1e-13, 4e-13))
    ]
    found = named(table(records))
    assert found["bearing_force"].trusted
    assert found["bearing_force"].error == resolution(records[0])["N"] == 1e-8 * 1e5 * 0.04 * 0.04
    assert not found["min_film_thickness"].trusted


def test_two_answers_are_the_least() -> None:
    with pytest.raises(ConvergenceError, match=r"two grids at least.*32: not converged: lost"):
        table([point(16, bearing_force=1.0), point(32), point(64)])


def test_angles_are_compared_the_short_way_round() -> None:
    turn = 2.0 * math.pi
    records = [point(16 * 2**k, min_film_thickness_angle=(0.02 - 0.01 * k) % turn) for k in range(4)]
    (angle,) = table(records)
    assert_allclose(angle.values[-1], turn - 0.01, rtol=1e-12)
    assert angle.error < 0.1
    (halved,) = table([point(16, min_film_thickness_angle=0.0), point(32, min_film_thickness_angle=3.0)])
    assert halved.error == math.pi


def test_the_place_of_a_film_that_contact_holds_has_no_error_bar() -> None:
    angles = [point(16 * 2**k, min_film_thickness_angle=float(k), contact_fraction=0.1 * k) for k in range(3)]
    assert "min_film_thickness_angle" not in named(table(angles))  # one of many places
    free = [replace(one, scalars={**one.scalars, "contact_fraction": 0.0}) for one in angles]
    assert "min_film_thickness_angle" in named(table(free))


def test_progress_rises_from_grid_to_grid() -> None:
    told: list[tuple[float, str]] = []
    petalfoil.converge(JOURNAL, levels=2, coarsest=16, progress=lambda share, text: told.append((share, text)))
    shares = [share for share, _ in told]
    assert shares == sorted(shares)
    assert 0.0 <= shares[0] < 1.0 / 3.0 < shares[-1] <= 1.0
    assert told[0][1].startswith("grid 16, ")
    assert told[-2][1].startswith("grid 32, ")
    assert told[-1] == (1.0, "converge: 2 of 2 grids")


# ---------------------------------------------------------------------------------------------- what a film has


@pytest.mark.parametrize(
    ("name", "angles", "limit"),
    [
        ("min_film_thickness_angle", [350.0, 358.0, 360.0], 0.67),
        ("min_film_thickness_angle", [5.0, 1.0, 359.0], 357.0),
        ("attitude_angle", [-170.0, -178.0, 180.0], 179.33),
    ],
)
def test_the_limit_of_an_angle_is_in_one_turn(name: str, angles: list[float], limit: float) -> None:
    values = [math.radians(math.remainder(angle, 360.0) if min(angles) < 0.0 else angle % 360.0) for angle in angles]
    records = [
        Record(analysis="solve", scalars={name: value, "converged": True, "cells_per_pitch": 16 << number})
        for number, value in enumerate(values)
    ]
    (estimate,) = [one for one in table([with_sizes(record) for record in records]) if one.name == name]
    assert math.degrees(estimate.limit) == pytest.approx(limit, abs=0.5)


def with_sizes(record: Record) -> Record:
    """The record with the sizes that the resolution of forces is told by."""
    return replace(record, scalars=record.scalars | {"ambient_pressure": 1e5, "journal_radius": 0.025, "length": 0.05})


@pytest.mark.parametrize(("bearing", "has"), [("2d", False), ("3d", True)])
def test_only_a_3d_film_has_an_axial_place_and_leaks(bearing: str, has: bool) -> None:
    changes: dict[str, object] = {"model.kind": bearing, "model.cells_per_pitch": 16}
    journal = case("plain_journal", **(changes | ({"model.axial_cells": 4} if has else {})))
    record = solved(journal)
    assert [name in record.scalars for name in ("side_leakage", "min_film_thickness_z")] == [has, has]


def test_no_entry_of_a_matrix_is_better_known_than_the_matrix() -> None:
    bars = np.array([[[3.0, 0.0], [0.0, 5.0]], [[1.0, 1.0], [1.0, 1.0]]])
    least = math.sqrt(34.0 / 4.0)
    assert_allclose(of_one_size(bars), [[[3.0, least], [least, 5.0]], [[1.0, 1.0], [1.0, 1.0]]])
    assert_allclose(of_one_size(np.array([[math.nan, 1.0], [2.0, 3.0]])), [[math.nan, 1.0], [2.0, 3.0]])
