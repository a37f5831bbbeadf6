import json
import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import petalfoil.analysis.capacity  # noqa: F401 - declares the results of its own
from petalfoil.results import Record, summary
from petalfoil.results.rounding import without_rounding
from petalfoil.results.schema import SCALARS
from tests.unit.results import factory


def test_json_holds_every_scalar_in_si_and_nothing_else() -> None:
    record = factory.solved()
    given = summary.as_json(record)
    assert set(given) == set(record.scalars)
    assert list(given) == [name for name in SCALARS if name in given]
    assert given["speed"] == 8000.0
    assert given["eccentricity_y"] == -100e-6
    assert given["converged"] is True
    assert json.loads(json.dumps(given, allow_nan=False)) == given


def test_json_is_null_where_a_figure_is_missing_or_infinite() -> None:
    given = summary.as_json(
        Record(
            analysis="solve",
            scalars={"min_film_thickness": float("nan"), "growth_rate": np.float64("inf"), "force_x": 0.0},
        )
    )
    assert given == {"force_x": 0.0, "min_film_thickness": None, "growth_rate": None}


def test_json_of_a_failed_state_reports_no_figure_as_an_answer() -> None:
    given = summary.as_json(factory.failed())
    assert given["bearing_force"] is None
    assert given["converged"] is False


def test_rows_are_in_the_units_an_engineer_reads() -> None:
    rows = {row.label: (row.value, row.unit) for row in summary.rows(factory.solved())}
    assert rows["speed"] == ("76394", "rpm")
    assert rows["displacement y"] == ("-100.0", "µm")
    assert rows["bearing force"] == ("25.00", "N")
    assert rows["attitude angle"] == ("20.00", "deg")
    assert rows["side leakage"] == ("1.200", "mg/s")
    assert rows["maximum bending stress"] == ("150.0", "MPa")
    assert rows["status"] == ("converged", "")


def test_a_film_that_contact_holds_is_thinnest_along_it() -> None:
    record = factory.solved()
    points = [replace(record, scalars={**record.scalars, "contact_fraction": held}) for held in (0.0, 0.1)]
    labels = [summary.row("min_film_thickness_angle", point.scalars, point).label for point in points]
    assert labels == ["  at angle", "  along contact, such as at"]


def test_a_film_that_is_the_same_everywhere_has_no_place() -> None:
    record = factory.plain()
    same = {name: np.full_like(record.fields[name], 2e-5) for name in ("film_thickness", "pressure")}
    whole = replace(record, fields={**record.fields, **same})
    for name in ("min_film_thickness_angle", "peak_pressure_angle"):
        labels = [summary.row(name, point.scalars, point).label for point in (record, whole)]
        assert labels == ["  at angle", "  the same everywhere, such as at"]


def test_a_peak_that_several_petals_share_is_said_to_be_one_of_them() -> None:
    """Peaks differ by 2 kPa: more than rounding, less than an error bar of 3 kPa."""
    record = factory.solved()
    pressure = np.asarray(record.fields["pressure"]).copy()
    pressure[0, 3], pressure[1, 4] = 3e5, 3e5 - 2e3
    apart = replace(record, fields={**record.fields, "pressure": pressure})
    barred = replace(apart, errors={"peak_pressure": 3e3})
    labels = [summary.row("peak_pressure_angle", point.scalars, point).label for point in (apart, barred)]
    assert labels == ["  at angle", "  equal under 2 petals, such as at"]


def test_rows_show_a_dash_for_a_missing_figure() -> None:
    rows = {row.label: row.value for row in summary.rows(factory.failed())}
    assert rows["bearing force"] == summary.ABSENT
    assert rows["status"] == "the step length fell below its limit"


@pytest.mark.parametrize("name", ["critical_mass", "liftoff_speed", "mass_margin"])
def test_what_there_is_none_of_is_written_in_words(name: str) -> None:
    """Infinite results, of which JSON has null."""
    assert summary.cell(name, math.inf)[1:] == ("unlimited" if name == "mass_margin" else "none", "")


def test_a_cell_of_a_name_without_a_unit_of_its_own_is_shown_in_si() -> None:
    assert summary.cell("mass_balance_error", 2e-12) == ("mass balance error", "2.00e-12", "")
    assert summary.cell("film_force_x", 1.0) == ("film force x", "1.000", "N")
    assert summary.cell("stable", True) == ("stable, journal held", "yes", "")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (1.0, "1.000"),
        (9.99996, "10.00"),
        (-0.0012344, "-0.001234"),
        (123.46, "123.5"),
        (76394.4, "76394"),
        (1.2e-9, "1.20e-09"),
        (3.4e9, "3.40e+09"),
        (math.inf, "inf"),
        (math.nan, "-"),
    ],
)
def test_numbers_have_four_significant_digits(value: float, text: str) -> None:
    assert summary.number(value) == text


SIZES = {"ambient_pressure": 1e5, "journal_radius": 0.025, "length": 0.05}


@pytest.mark.parametrize(
    ("scalars", "shown"),
    [
        ({"force_x": 5e-16, "force_y": -3e-15, "bearing_force": 3e-15}, ["0", "0", "0"]),
        ({"force_x": -7.64e-14, "force_y": 20.0, "bearing_force": 20.0}, ["0", "20.00", "20.00"]),
        ({"force_x": 1e-7, "force_y": 1e-6, "bearing_force": 1e-6}, ["1.00e-07", "1.00e-06", "1.00e-06"]),
        ({"force_x": 2.7e-9, "force_y": 86.4, "bearing_force": 86.4}, ["0", "86.40", "86.40"]),
        ({"eccentricity_x": 6.1e-21, "eccentricity_y": -1e-4}, ["0", "-100.0"]),
    ],
)
def test_rounding_is_shown_as_zero(scalars: dict[str, float], shown: list[str]) -> None:
    record = Record(analysis="solve", scalars=scalars | SIZES)
    rows = {row.label: row.value for row in summary.rows(record)}
    assert [rows[summary.cell(name, 0.0).label] for name in scalars] == shown
    assert [summary.as_json(record)[name] for name in scalars] == list(scalars.values())


def test_the_compressibility_number_says_on_which_length() -> None:
    assert "radial clearance" in summary.cell("compressibility_number", 5.55).label


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("peak_pressure_angle", "peak pressure, at angle"),
        ("min_film_thickness_z", "minimum film thickness, at z"),
        ("other_power_loss", "other bearing: power loss"),
        ("least_capacity_direction", "least load capacity, in direction"),
        ("peak_pressure", "peak pressure"),
    ],
)
def test_a_label_away_from_its_table_tells_what_it_is_of(name: str, label: str) -> None:
    assert summary.label_alone(name) == label


def test_no_two_results_have_one_label_and_unit_away_from_their_table() -> None:
    shown = Counter((summary.label_alone(name), summary.shown_as(name).unit) for name in SCALARS)
    assert [label for label, count in shown.items() if count > 1] == []


def test_membrane_stress_of_petals_that_nothing_stretches_is_shown_as_zero() -> None:
    shown = [
        without_rounding(Record(analysis="balance", scalars={"max_bending_stress": 2e8, "max_membrane_stress": value}))[
            "max_membrane_stress"
        ]
        for value in (4.5e-5, 1.0)
    ]
    assert shown == [0.0, 1.0]
