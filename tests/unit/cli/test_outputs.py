"""Places are looked at before the run, and an answer is given out whatever happens to them."""

from __future__ import annotations

import errno
import json
from dataclasses import replace
from pathlib import Path

import pytest

from petalfoil.cli.outputs import FIGURE_SUFFIXES
from petalfoil.errors import StoreError
from petalfoil.plot.canvas import figure_format
from petalfoil.results.layout import SinglePoint
from petalfoil.results.store import load, save

from .conftest import point


@pytest.mark.parametrize(
    "bad",
    [
        ("--out", "result.txt", "the suffix '.txt'; known: .nc"),
        ("--out", "result", "the suffix ''; known: .nc"),
        ("--out", "missing/result.nc", "there is no folder"),
        ("--out", "folder.nc", "is a folder"),
        ("--plot", "figure.bmp", "the suffix '.bmp'; known: .png"),
        ("--plot", "missing/figure.png", "there is no folder"),
    ],
)
def test_bad_places_are_refused_before_the_run(cli, played, case, tmp_path: Path, bad: tuple[str, str, str]) -> None:
    option, place, says = bad
    (tmp_path / "folder.nc").mkdir()
    result = cli("solve", case, option, str(tmp_path / place))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(f"Error: {option}: ")
    assert says in result.stderr
    assert played.calls == []


def test_folder_that_takes_no_file(cli, played, case, tmp_path: Path, monkeypatch) -> None:
    def refuse(*args, **kwargs) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr("tempfile.TemporaryFile", refuse)
    result = cli("solve", case, "--out", str(tmp_path / "result.nc"))
    assert result.exit_code == 2
    assert result.stderr.endswith("result.nc cannot be written: Permission denied\n")
    assert played.calls == []


def test_looking_leaves_nothing_behind_and_a_former_file_alone(cli, played, case, tmp_path: Path) -> None:
    out = tmp_path / "result.nc"
    out.write_bytes(b"former")

    def look():
        assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "result.nc"]
        assert out.read_bytes() == b"former"
        raise StoreError("far enough")

    played.single = look
    assert cli("solve", case, "--out", str(out)).stderr == "Error: far enough\n"
    assert out.read_bytes() == b"former"


def test_an_answer_whose_file_fails_is_still_printed(cli, played, case, tmp_path: Path, monkeypatch) -> None:
    def refuse(ds, path) -> None:
        raise StoreError("disk full")

    monkeypatch.setattr("petalfoil.results.store.save", refuse)
    result = cli("solve", case, "--json", "--out", str(tmp_path / "result.nc"))
    assert (result.exit_code, result.stderr) == (2, "Error: disk full\n")
    assert json.loads(result.stdout)["converged"] is True


def test_figure_is_drawn_from_the_labelled_answer(cli, played, case, tmp_path: Path, monkeypatch) -> None:
    drawn = []
    monkeypatch.setattr("petalfoil.plot.summary", lambda ds: ds, raising=False)
    monkeypatch.setattr("petalfoil.plot.save", lambda ds, path: drawn.append((ds, path)), raising=False)
    figure = tmp_path / "figure.png"
    assert cli("solve", case, "--plot", str(figure)).exit_code == 0
    ((ds, path),) = drawn
    assert (ds.attrs["analysis"], path) == ("solve", figure)


def test_what_did_not_converge_is_not_drawn(cli, played, case, tmp_path: Path) -> None:
    figure = tmp_path / "figure.png"
    played.single = lambda: point(0.0, -1e-4, converged=False)
    result = cli("solve", case, "--json", "--plot", str(figure))
    assert result.exit_code == 3
    assert json.loads(result.stdout)["converged"] is False
    assert result.stderr.startswith(f"nothing converged, so {figure} is not drawn\n")
    assert not figure.exists()


def test_known_suffixes_are_those_the_figures_can_be_written_in() -> None:
    assert [f".{figure_format(Path('figure').with_suffix(suffix))}" for suffix in FIGURE_SUFFIXES] == list(
        FIGURE_SUFFIXES
    )


def test_a_foreign_file_brings_no_control_character_to_the_terminal(cli, tmp_path: Path) -> None:
    title, status = "a\x1b]0;owned\x07", "converged; \x1b[2Jgone"
    record = replace(point(0.0, -1e-4, status=status), title=title)
    save(SinglePoint().to_dataset([record], "solve"), tmp_path / "foreign.nc")
    result = cli("show", str(tmp_path / "foreign.nc"))
    assert result.exit_code == 0
    assert "\x1b" not in result.stdout + result.stderr
    assert r"a\x1b]0;owned\x07" in result.stdout
    assert r"\x1b[2Jgone" in result.stdout


DOUBTS = ("gas.viscosity: 18.5 Pa*s is outside 5e-06 to 0.0001 Pa*s", "knudsen_number: 0.2")


def test_warnings_are_in_table_json_and_file_and_shown_again(cli, played, case, tmp_path: Path) -> None:
    played.single = lambda: replace(point(0.0, -1e-4), warnings=DOUBTS)
    out = str(tmp_path / "result.nc")
    run = cli("solve", case, "--json", "--out", out)
    assert (run.exit_code, run.stderr) == (0, "")
    assert json.loads(run.stdout)["warnings"] == list(DOUBTS)
    assert load(out).attrs["warnings"].splitlines() == list(DOUBTS)
    assert cli("show", out, "--json").stdout == run.stdout
    table = cli("solve", case).stdout
    assert table == cli("show", out).stdout
    assert [line for line in table.splitlines() if line.startswith("Warning: ")] == [f"Warning: {d}" for d in DOUBTS]


def test_the_warnings_of_a_series_are_told_once_with_their_number(cli, played, case, tmp_path: Path) -> None:
    played.after = {}
    texts = iter(["max_bending_stress: 3 GPa", "max_bending_stress: 4 GPa", "max_bending_stress: 5 GPa"])
    played.dressed = lambda record: replace(record, warnings=(next(texts),))
    answer = json.loads(cli("curve", case, "--eccentricity", "0 um : 200 um : 3", "--json").stdout)
    assert answer["warnings"] == ["max_bending_stress: 3 GPa (2 more points alike)"]


def test_no_warnings_are_an_empty_list(cli, played, case, tmp_path: Path) -> None:
    out = str(tmp_path / "result.nc")
    assert json.loads(cli("solve", case, "--json", "--out", out).stdout)["warnings"] == []
    assert "warnings" not in load(out).attrs
