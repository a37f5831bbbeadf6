"""The whole report on coarse grids: numbers, verdicts, files, command."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

from petalfoil.cli.app import app
from petalfoil.report import reproduce
from petalfoil.report.claims import Evidence, Verdict, claims
from petalfoil.report.report_files import write
from petalfoil.results.store import load

pytestmark = pytest.mark.slow  # the evidence takes some ten seconds

# Loads at 100, 200 and 280 um on fine grids, and ratios of 10 petals to 6 (docs/paper-values.md).
LOADS = {6: (0.4696, 1.085, 3.551), 8: (8.09, 16.86, 24.93), 10: (6.714, 15.49, 27.84)}
RATIOS = (14.30, 14.28, 7.84)
TANGENT = (1.96, 1.79, 2.51)


def test_the_loads_are_those_of_fine_grids(evidence: Evidence) -> None:
    for curve in evidence.reference_2d.curves:
        assert_allclose(curve.loads(), LOADS[curve.count], rtol=0.06)
    assert_allclose(evidence.reference_2d.ratios, RATIOS, rtol=0.06)
    assert_allclose(evidence.tangent_2d.ratios, TANGENT, rtol=0.02)


def test_the_same_loads_under_the_assumptions(evidence: Evidence) -> None:
    rows = {row.assumption.name: row for row in evidence.assumptions}
    assert_allclose(rows["reference"].ratios, RATIOS, rtol=0.08)
    assert_allclose(rows["clamped_tangent"].ratios, TANGENT, rtol=0.03)
    assert_allclose(rows["hinged_30"].median_ratio, 2.8, rtol=0.08)
    assert rows["bounds"].median_ratio < 0.5
    force = {one.name: one for one in evidence.reference_interpretations}["film_normal_force"]
    assert_allclose(rows["reference"].normal_force_ratio, force.ratio, rtol=0.03)
    assert_allclose(force.ratio, 3.31, rtol=0.03)


def test_claims_stand_where_they_stand(evidence: Evidence) -> None:
    centred, twofold, two_to_four, grids, accuracy, effort = claims(evidence)
    assert centred.verdict is Verdict.MET
    assert twofold.verdict is Verdict.ELSEWHERE
    assert "clamped tangentially to the bore (tilt 0°)" in twofold.computed
    assert two_to_four.verdict is Verdict.ELSEWHERE
    assert "hinged, tilt 30°" in two_to_four.computed
    assert (grids.verdict, accuracy.verdict, effort.verdict) == (Verdict.MET,) * 3


def test_the_folder_has_the_page_and_the_data(evidence: Evidence, tmp_path: Path) -> None:
    page = write(evidence, tmp_path / "report")
    words = page.read_text(encoding="utf-8")
    links = re.findall(r'(?:src|href)="([^"]*)"', words)
    outside = [link for link in links if not link.startswith(("data:image/svg+xml;base64,", "#"))]
    assert {link for link in outside if not (page.parent / link).is_file()} == set()
    assert set(outside) == {path.name for path in page.parent.iterdir()} - {page.name}
    assert {link[1:] for link in links if link.startswith("#")} <= set(re.findall(r'id="(\w+)"', words))
    assert words.count("<img ") == 8
    assert "@import" not in words
    curve = load(page.parent / "reference_2d_n8.nc")
    assert_allclose(curve["bearing_force"].values[1:], evidence.reference_2d.curves[1].loads(), rtol=1e-12)


def test_the_data_are_the_numbers(evidence: Evidence, tmp_path: Path) -> None:
    folder = write(evidence, tmp_path).parent
    with (folder / "figure8.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    chosen = [line for line in lines if (line["assumptions"], line["petals"]) == ("reference_2d", "10")]
    assert_allclose(
        [float(line["load [N]"]) for line in chosen[1:]], evidence.reference_2d.curves[2].loads(), rtol=1e-8
    )
    with (folder / "figure6_7_2d.csv").open(encoding="utf-8") as file:
        first = [line for line in csv.DictReader(file) if line["petals"] == "6"]
    centred = evidence.reference_2d.curves[0].records[0]
    assert_allclose([float(line["h [m]"]) for line in first], centred.fields["film_thickness"][0, :, 0], rtol=1e-8)
    summary = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    points = summary["curves"]["tangent_3d"]["8"]
    assert_allclose([p["bearing_force"] for p in points[1:]], evidence.tangent_3d.curves[1].loads(), rtol=1e-12)
    assert [row["name"] for row in summary["assumptions"]] == [row.assumption.name for row in evidence.assumptions]


def test_the_command(evidence: Evidence, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reproduce, "run", lambda scope, progress: evidence)
    out = tmp_path / "report"
    shown = CliRunner().invoke(app, ["reproduce", "--out", str(out)])
    assert (shown.exit_code, shown.stderr) == (0, "")
    assert "MET UNDER OTHER ASSUMPTIONS: “increasing the number of petals" in shown.stdout
    assert str(out / "index.html") in shown.stdout
    plain = CliRunner().invoke(app, ["reproduce", "--out", str(out), "--json"])
    found = json.loads(plain.stdout)
    assert found["page"] == str(out / "index.html")
    assert np.isclose(found["wall_time"], evidence.seconds)
    assert len(found["claims"]) == 6


def test_a_folder_that_cannot_be_is_refused_before_any_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (tmp_path / "file", tmp_path / "absent" / "report"):
        refused = CliRunner().invoke(app, ["reproduce", "--out", str(place)])
        assert refused.exit_code == 2
        assert "--out" in refused.stderr
