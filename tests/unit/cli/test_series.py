"""A curve keeps what is finished, whatever happens."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from petalfoil.analysis.known_verbs import find
from petalfoil.analysis.runs import Points
from petalfoil.case import Case
from petalfoil.cli.keeping import MAX_SHARE, PERIOD, Autosave, follow
from petalfoil.errors import StoreError
from petalfoil.results import Record
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Series
from petalfoil.results.store import load, save

from .conftest import point

ROOT = Path(__file__).parents[3]
THREE = ("--eccentricity", "0 um : 200 um : 3")


def interrupt() -> None:
    """Do what Ctrl-C does."""
    raise KeyboardInterrupt


def fail() -> None:
    """Do what a mistake in the program does."""
    raise ZeroDivisionError


@pytest.mark.parametrize("verb", ["curve", "static"])
def test_interrupted_curve_keeps_its_finished_points(cli, played, case, tmp_path: Path, verb: str) -> None:
    out = tmp_path / "curve.nc"
    played.after[2] = interrupt
    result = cli(verb, case, *THREE, "--json", "--out", str(out))
    assert result.exit_code == 130
    assert result.stderr == "interrupted: 2 of 3 points are finished and kept\n"
    answer = json.loads(result.stdout)
    assert (len(answer["points"]), answer["interrupted"]) == (2, True)
    stored = load(out)
    assert (stored.sizes["point"], stored.attrs["analysis"]) == (2, verb)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.toml", "curve.nc"]


STOPPED = """
import os, signal, sys
import pytest
from tests.unit.cli.conftest import Played, install
from petalfoil.cli import main

number = signal.Signals[sys.argv.pop(1)]
# Whoever runs the tests may have it ignored.
signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)
plays = Played()
plays.after[2] = lambda: os.kill(os.getpid(), number)
install(plays, pytest.MonkeyPatch())
main()
"""


@pytest.mark.parametrize(
    ("signal", "exit_code"),
    [
        pytest.param("SIGTERM", 143, marks=pytest.mark.slow),
        pytest.param("SIGINT", 130, marks=pytest.mark.slow),
        pytest.param("SIGHUP", 129, marks=pytest.mark.slow),
    ],
)
def test_a_process_that_a_signal_stops_keeps_what_is_finished(
    case, tmp_path: Path, signal: str, exit_code: int
) -> None:
    out = tmp_path / "curve.nc"
    command = [sys.executable, "-c", STOPPED, signal, "curve", case, *THREE, "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (exit_code, "interrupted: 2 of 3 points are finished and kept\n")
    assert load(out).sizes["point"] == 2


def test_curve_interrupted_before_its_first_point(cli, played, case, tmp_path: Path) -> None:
    out = tmp_path / "curve.nc"
    played.after[0] = interrupt
    result = cli("curve", case, *THREE, "--json", "--out", str(out))
    assert (result.exit_code, result.stdout, result.stderr) == (130, "", "interrupted: nothing was finished\n")
    assert not out.exists()


def test_a_fault_in_the_middle_keeps_the_finished_points(cli, played, case, tmp_path: Path) -> None:
    out = tmp_path / "curve.nc"
    played.after[2] = fail
    assert cli("curve", case, *THREE, "--out", str(out)).exit_code == 1
    assert load(out).sizes["point"] == 2


class Clock:
    """A clock the test turns."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def finished() -> Answer:
    """A curve of one point."""
    return Answer(verb="curve", layout=Series(), records=(point(0.0, 0.0),))


def test_file_is_rewritten_as_points_finish(tmp_path: Path) -> None:
    clock, out, seen = Clock(), tmp_path / "curve.nc", []

    def points() -> Iterator[Record]:
        for index in range(6):
            clock.now += 0.4 * PERIOD
            yield point(0.0, -1e-6 * index)
            seen.append(load(out).sizes["point"] if out.exists() else 0)

    answer, stopped = follow(find("curve"), Points(points(), 6), Autosave(out, clock), lambda done, text: None)
    assert (len(answer.records), stopped) == (6, 0)
    assert seen == [0, 0, 3, 3, 3, 6]


def test_slow_writing_is_done_less_often(tmp_path: Path, monkeypatch) -> None:
    clock, written = Clock(), []

    def slow(ds, path) -> None:
        clock.now += 3.0
        written.append(clock.now)

    monkeypatch.setattr("petalfoil.results.store.save", slow)
    autosave = Autosave(tmp_path / "curve.nc", clock)
    for _ in range(100):
        clock.now += 1.0
        autosave.offer(finished)
    gaps = [later - earlier for earlier, later in itertools.pairwise(written)]
    assert len(gaps) > 1
    assert all(gap >= 3.0 / MAX_SHARE for gap in gaps)


def test_a_file_that_cannot_be_rewritten_does_not_end_the_run(tmp_path: Path, monkeypatch, capsys) -> None:
    clock = Clock()

    def refuse(ds, path) -> None:
        raise StoreError("disk full")

    monkeypatch.setattr("petalfoil.results.store.save", refuse)
    autosave = Autosave(tmp_path / "curve.nc", clock)
    clock.now += PERIOD
    autosave.offer(finished)
    assert capsys.readouterr().err == "Warning: disk full; the run goes on and tries again\n"


def test_without_a_file_nothing_is_written(tmp_path: Path) -> None:
    Autosave(None).flush(finished())
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_command_goes_on_from_its_own_file(cli, case, tmp_path: Path) -> None:
    out, whole = str(tmp_path / "curve.nc"), str(tmp_path / "whole.nc")
    three = ("curve", case, "--eccentricity", "0 um : 20 um : 3")
    assert cli(*three, "--out", whole).exit_code == 0
    analysis = find("curve")
    assert analysis is not None
    run = analysis.start(Case.load(case), analysis.read({"eccentricities": [0.0, 1e-5, 2e-5]}))
    next(run.advance())
    save(analysis.answer(run, "interrupted").to_dataset(), out)
    again = cli(*three, "--resume", out, "--out", out, "--json")
    assert (again.exit_code, again.stderr) == (0, "")
    forces = [point["force_y"] for point in json.loads(again.stdout)["points"]]
    np.testing.assert_allclose(forces, load(whole)["force_y"].values, rtol=1e-6, atol=1e-6)
    assert load(out).sizes["point"] == 3
    other = cli("curve", case, "--eccentricity", "0 um : 30 um : 3", "--resume", out)
    assert (other.exit_code, other.stdout) == (2, "")
    assert "other arguments: eccentricities" in other.stderr
