"""Tables for other programs hold every number of a result, with its unit."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.errors import UsageError
from petalfoil.results import spreadsheet
from petalfoil.results.spreadsheet import points, write_table
from tests.cases import case

SMALL = case("paper_n6", **{"model.cells_per_pitch": 8})


@pytest.fixture(scope="module")
def curve() -> xr.Dataset:
    """Two points."""
    return petalfoil.curve(SMALL, "0 um : 20 um : 2")


def test_a_csv_has_a_row_for_each_point(curve: xr.Dataset, tmp_path: Path) -> None:
    write_table(curve, tmp_path / "curve.csv")
    with (tmp_path / "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["bearing_force [N]"]) for row in rows] == curve["bearing_force"].values.tolist()
    assert [row["status"] for row in rows] == ["converged"] * 2


@pytest.mark.slow
def test_an_error_bar_stands_behind_its_quantity() -> None:
    point = petalfoil.solve(SMALL, error=True)
    head, row = points(point)
    place = head.index("bearing_force [N]")
    assert head[place + 1] == "bearing_force_error [N]"
    assert row[place : place + 2] == [point["bearing_force"].item(), point["bearing_force"].attrs["grid_error"]]


def test_a_workbook_has_results_fields_names_and_case(curve: xr.Dataset, tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    write_table(curve, tmp_path / "curve.xlsx")
    book = openpyxl.load_workbook(tmp_path / "curve.xlsx", read_only=True)
    assert {"results", "names", "case", "point_petal_phi_exposed_z"} <= set(book.sheetnames)
    head, *rows = book["point_petal_phi_exposed_z"].iter_rows(values_only=True)
    pressure = [row[head.index("pressure [Pa]")] for row in rows]
    assert_allclose(pressure, curve["pressure"].values.ravel(), rtol=1e-15)  # a workbook holds 16 digits
    assert ("bearing_force", "N", "magnitude of the force on the journal") in book["names"].iter_rows(values_only=True)
    assert any(row[0] == "[petals]" for row in book["case"].iter_rows(values_only=True))


def test_what_cannot_be_written_is_refused(curve: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UsageError, match="suffix"):
        write_table(curve, tmp_path / "curve.ods")
    monkeypatch.setattr(spreadsheet, "find_spec", lambda name: None)
    with pytest.raises(UsageError, match="petalfoil\\[excel\\]"):
        write_table(curve, tmp_path / "curve.xlsx")
    monkeypatch.undo()
    pytest.importorskip("openpyxl")
    monkeypatch.setattr(spreadsheet, "MAX_ROWS", 10)
    with pytest.warns(UserWarning, match="is left out"):
        write_table(curve, tmp_path / "curve.xlsx")


def test_no_text_is_a_formula() -> None:
    assert spreadsheet._cell("=1+1") == "'=1+1"
    assert spreadsheet._cell(float("nan")) is None
    assert spreadsheet._cell(float("inf")) == "Infinity"
