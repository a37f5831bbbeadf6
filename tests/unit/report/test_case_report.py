"""The report of a case: parts, refusals, inputs, the page, its files, the command."""

from __future__ import annotations

import base64
import json
import math
import re
from pathlib import Path

import pytest
from numpy.testing import assert_allclose
from typer.testing import CliRunner

import petalfoil
from petalfoil.case import Case
from petalfoil.cli.app import app
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.report import case_page, case_report, case_results, pdf, reproduce
from petalfoil.report.case_results import Part, Request
from petalfoil.report.report_files import refuse_foreign
from petalfoil.results.answer import Answer
from petalfoil.results.layout import SinglePoint
from petalfoil.results.record import Record
from petalfoil.results.store import load
from tests.cases import EXAMPLES, case

SMALL = case("paper_n6", **{"model.cells_per_pitch": 8, "operation.eccentricity": ["0 um", "0 um"]})


def quiet(part: float, text: str) -> None:
    """Report no progress."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report without error bars."""
    out = tmp_path_factory.mktemp("report")
    assert petalfoil.design_report(SMALL, out, load="5 N", mass="1 kg", error=False) == out / "index.html"
    return out


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    """Its page."""
    return (folder / "index.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_page_stands_alone(page: str) -> None:
    links = re.findall(r'(?:src|href)="([^"]*)"', page)
    assert all(link.startswith(("data:image/svg+xml;base64,", "#")) for link in links)
    assert {link[1:] for link in links if link.startswith("#")} <= set(re.findall(r'id="(\w+)"', page))
    for drawing in re.findall(r"base64,([^\"]*)", page):
        assert b"</svg>" in base64.b64decode(drawing)
    assert "@import" not in page


@pytest.mark.slow
def test_the_numbers_of_the_page_are_those_of_the_files(folder: Path, page: str) -> None:
    point = load(folder / "operating_point.nc")
    assert_allclose(float(point["load_y"]), -5.0)
    assert f"{float(point['min_film_thickness']) * 1e6:#.4g} µm" in page
    assert_allclose(float(load(folder / "load_2.nc")["load_y"]), -10.0)
    numbers = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    assert set(numbers) == {"pack", "operating_point", "load_0_5", "load_1_5", "load_2", "liftoff", "coefficients",
                            "stability"}  # fmt: skip
    assert_allclose(numbers["operating_point"]["min_film_thickness"], float(point["min_film_thickness"]))
    assert Case.load(folder / "case.toml") == SMALL


@pytest.mark.slow
def test_inputs_tell_what_was_given(page: str) -> None:
    rows = re.findall(r"<tr><td><code>([\w.]+)</code></td><td>.*?</td>\s*<td.*?>(.*?)</td><td>(\w+)</td></tr>", page)
    found = {key: (value, given) for key, value, given in rows}
    assert found["petals.thickness"] == ("176 µm", "given")
    assert found["surface.petal_friction"] == ("0", "default")


@pytest.mark.slow
def test_the_commands_compute_it_again(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    part = Part(name="again", title="", verb="balance", arguments={"load": (0.0, -5.0)})
    assert part.command == 'petalfoil balance case.toml --load "0 N, -5 N" --out again.nc'
    monkeypatch.chdir(folder)
    done = CliRunner().invoke(app, ["balance", "case.toml", "--load", "0 N, -5 N", "--out", "again.nc"])
    assert done.exit_code == 0
    files = [case_page._file(part, load(folder / name)) for name in ("again.nc", "operating_point.nc")]
    assert files[0]["digest"] == files[1]["digest"]


@pytest.mark.slow
def test_a_part_without_a_result_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4, "operation.speed": 0.0})
    parts = case_results.compute(Request(case=plain, load=(0.0, -30.0), error=False), quiet)
    refused = {part.name: part for part in parts if part.refusal is not None}
    assert isinstance(refused["stability"].refusal, UsageError)
    assert not refused["stability"].is_failed
    words = case_page.render(Request(case=plain, load=(0.0, -30.0), error=False), parts, 1.0, "today")
    assert "stability needs a turning shaft" in words


def test_a_part_that_did_not_converge_makes_the_command_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lost = Part(name="stability", title="Stability", verb="stability", refusal=ConvergenceError("lost", advice="more"))
    monkeypatch.setattr(case_report, "compute", lambda request, progress: (lost,))
    done = CliRunner().invoke(app, ["report", str(EXAMPLES / "paper_n6.toml"), "--out", str(tmp_path / "out")])
    assert done.exit_code == 3
    assert "Stability: lost" in done.stderr
    assert "lost To try: more." in (tmp_path / "out" / "index.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("verb", "name", "status", "told"),
    [
        ("liftoff", "liftoff_speed", "does not lift off below 9000 rpm", "none: does not lift off below 9000 rpm"),
        ("stability", "critical_mass", "converged; stable for any rotor mass; more", "none: stable for any rotor mass"),
        ("stability", "critical_mass", "converged; a mode grows, though no mass is critical",
         "none: a mode grows, though no mass is critical"),
    ],
)  # fmt: skip
def test_a_headline_without_a_number_has_the_reason_of_its_result(verb: str, name: str, status: str, told: str) -> None:
    record = Record(analysis=verb, scalars={"converged": True, "status": status, name: math.inf})
    answer = Answer(verb=verb, layout=SinglePoint(), records=(record,))
    (row,) = case_page._headline(Part(name=verb, title=verb, verb=verb, answer=answer), name)
    assert row.value == told


def test_arguments_are_refused_by_their_names(tmp_path: Path) -> None:
    path = str(EXAMPLES / "paper_n6.toml")
    refused = CliRunner().invoke(app, ["report", path, "--out", str(tmp_path), "--mass", "-1 kg"])
    assert refused.exit_code == 2
    assert "--mass" in refused.stderr
    with pytest.raises(petalfoil.UnitError, match="load"):
        petalfoil.design_report(SMALL, tmp_path, load="3 m")


def test_a_pdf_needs_something_that_prints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pdf.shutil, "which", lambda name: None)
    monkeypatch.setattr(pdf, "find_spec", lambda name: None)
    with pytest.raises(UsageError, match="needs a browser"):
        petalfoil.design_report(SMALL, tmp_path / "out", print_pdf=True)
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_the_page_prints(folder: Path, tmp_path: Path) -> None:
    try:
        pdf.printer()
    except UsageError as nothing:
        pytest.skip(str(nothing))
    pdf.write_pdf(folder / "index.html", tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_weasyprint_prints_where_there_is_no_browser(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    try:
        import weasyprint  # noqa: F401
    except (ImportError, OSError) as missing:  # the package, or the Pango that it loads
        pytest.skip(f"needs petalfoil[pdf] and Pango: {missing}")
    monkeypatch.setattr(pdf.shutil, "which", lambda name: None)
    assert pdf.printer() == "weasyprint"
    pdf.write_pdf(folder / "index.html", tmp_path / "report.pdf")
    printed = (tmp_path / "report.pdf").read_bytes()
    assert printed.startswith(b"%PDF")
    assert len(printed) > 20_000  # its figures are in it


def test_a_folder_of_others_is_refused_before_any_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is there stays: the pages of the paper and the report of a case do not write over each other."""
    monkeypatch.setattr(case_report, "compute", lambda request, progress: pytest.fail("nothing is to be computed"))
    monkeypatch.setattr(reproduce, "run", lambda scope, progress: pytest.fail("nothing is to be computed"))
    case_file, of_paper, of_case = tmp_path / "small.toml", tmp_path / "paper", tmp_path / "report"
    case_file.write_text(SMALL.to_toml(), encoding="utf-8")
    for folder, names in ((of_paper, ("figure8.csv", "report.json", "index.html")), (of_case, case_report.OWN)):
        folder.mkdir()
        for name in names:
            (folder / name).write_text("mine", encoding="utf-8")
    for command in (["report", str(case_file), "--out", str(of_paper)], ["reproduce", "--out", str(of_case)]):
        refused = CliRunner().invoke(app, command)
        assert refused.exit_code == 2
        assert "holds other files" in " ".join(refused.stderr.split())
    assert (of_case / "case.toml").read_text(encoding="utf-8") == "mine"
    refuse_foreign(of_case, case_report.OWN)  # an earlier report is written anew
    refuse_foreign(tmp_path / "absent", case_report.OWN)
