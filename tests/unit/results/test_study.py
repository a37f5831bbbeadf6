"""A grid study as labelled data and back; digits follow from error bars."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from petalfoil.results import Record
from petalfoil.results.answer import Answer
from petalfoil.results.estimate import Estimate
from petalfoil.results.store import load, save
from petalfoil.results.study import GridStudy, error_bars_of, estimates_of, with_error_bars
from petalfoil.results.summary import with_bar

NAN = float("nan")
RECORDS = [
    Record(analysis="solve", scalars={"cells_per_pitch": 32, "bearing_force": 2.5, "converged": True}),
    Record(analysis="solve", scalars={"cells_per_pitch": 64, "converged": False, "status": "lost"}),
]
ESTIMATE = Estimate(name="bearing_force", values=(2.5, NAN), limit=2.25, order=1.9, error=0.5, trusted=True)


def test_a_study_goes_through_a_file_unchanged(tmp_path: Path) -> None:
    layout = GridStudy(conclude=lambda _: [ESTIMATE])
    estimates = layout.estimates(RECORDS)
    ds = Answer(verb="converge", layout=layout, records=tuple(RECORDS), estimates=estimates).to_dataset()
    save(ds, tmp_path / "study.nc")
    again = load(tmp_path / "study.nc")
    xr.testing.assert_identical(again, ds)
    (found,) = estimates_of(again)
    assert repr(found) == repr(ESTIMATE)  # nan is not equal to itself
    assert ds["cells_per_pitch"].values.tolist() == [32, 64]
    assert ds.attrs["analysis"] == "converge"


def test_error_bars_are_attributes_of_their_figures() -> None:
    ds = xr.Dataset({"bearing_force": 2.5, "min_film_thickness": 1e-6})
    marked = with_error_bars(ds, {"bearing_force": 0.25})
    assert error_bars_of(marked) == {"bearing_force": 0.25}
    assert error_bars_of(ds) == {}


@pytest.mark.parametrize(
    ("name", "values", "error", "expected"),
    [
        ("bearing_force", [16.8763, 16.86], 0.1132, (["16.88", "16.86"], "0.11")),
        ("bearing_force", [16.8763, NAN], 12.0, (["17", "-"], "12")),
        ("bearing_force", [16.8763], 1200.0, (["17"], "1200")),
        ("min_film_thickness", [7.7438e-6], 4.1e-8, (["7.744"], "0.041")),
        ("bearing_force", [16.8763], 0.0, (["16.88"], "0")),
        ("bearing_force", [16.8763], 1e-12, (["16.88"], "1.00e-12")),
        ("bearing_force", [2e-13], 5e-8, (["0"], "5e-08")),
        ("bearing_force", [2e-7], 5e-8, (["2.00e-07"], "5e-08")),
    ],
)
def test_a_value_has_the_digits_that_its_bar_leaves(
    name: str, values: list[float], error: float, expected: tuple[list[str], str]
) -> None:
    assert with_bar(name, values, error) == expected
