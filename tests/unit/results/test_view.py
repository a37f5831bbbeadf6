"""What a notebook shows of a result and of a case."""

from __future__ import annotations

from pathlib import Path

import petalfoil
from tests.cases import case

SMALL = case("paper_n6", **{"model.cells_per_pitch": 8, "title": "Six <petals>"})


def test_a_point_shows_its_table(tmp_path: Path) -> None:
    point = petalfoil.solve(SMALL)
    lines = repr(point.petalfoil).splitlines()
    assert lines[0] == "solve: Six <petals>"
    assert any(line.startswith("bearing force") and line.endswith("N") for line in lines)
    page = point.petalfoil._repr_html_()
    assert "<b>solve: Six &lt;petals&gt;</b><table><tr><td>status</td><td>converged</td>" in page
    petalfoil.save(point, tmp_path / "point.nc")
    assert repr(petalfoil.load(tmp_path / "point.nc").petalfoil) == repr(point.petalfoil)


def test_a_series_shows_a_line_for_each_point() -> None:
    head, *lines = repr(petalfoil.curve(SMALL, "0 um : 20 um : 2").petalfoil).splitlines()[1:]
    assert "bearing force [N]" in head
    assert len([line for line in lines if not line.startswith("Warning")]) == 2


def test_other_results_are_shown_as_xarray_does() -> None:
    point = petalfoil.solve(SMALL).expand_dims("load")
    assert point.petalfoil.tables() == ()
    assert "xr-" in point.petalfoil._repr_html_()


def test_a_case_shows_what_it_gives() -> None:
    page = case("paper_n6")._repr_html_()
    assert "<td><code>petals.thickness</code></td><td>176 µm</td>" in page
    assert "surface.petal_friction" not in page
