"""``petalfoil orbit``: what it prints, writes, keeps and refuses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from typer.testing import Result

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.cli import keeping
from petalfoil.errors import ConvergenceError
from petalfoil.results.store import load

Run = Callable[..., Result]

CASE = """
title = "Plain [b]bearing[/b]"

[bearing]
journal_radius = "25 mm"
bushing_radius = "25.025 mm"
length = "50 mm"

[gas]
viscosity = "18.5 uPa*s"
ambient_pressure = "1 bar"

[operation]
speed = "20000 rpm"
eccentricity = ["0 um", "-10 um"]

[rotor]
mass = "3 kg"
unbalance = "2 um"

[model]
kind = "3d"
cells_per_pitch = 16
axial_cells = 4
"""
KEYS = {"time", "x", "y", "min_film_thickness", "contact_fraction", "steps", "factorizations", "converged", "status"}


@pytest.fixture
def rotor(tmp_path: Path) -> str:
    path = tmp_path / "rotor.toml"
    path.write_text(CASE, encoding="utf-8")
    return str(path)


def stopping(monkeypatch: pytest.MonkeyPatch, after: int, error: BaseException) -> None:
    """Let the motion end with an error after some steps."""
    taken = Orbit.advance

    def steps(self: Orbit) -> Iterator[tuple[float, str]]:
        if after == 0:
            raise error
        for number, step in enumerate(taken(self)):
            if number == after:
                raise error
            yield step

    monkeypatch.setattr(Orbit, "advance", steps)


@pytest.mark.slow
def test_json_gives_lists_over_time(cli: Run, rotor: str, tmp_path: Path) -> None:
    out = tmp_path / "orbit.nc"
    result = cli("orbit", rotor, "--revolutions", "1", "--json", "--out", str(out))
    assert (result.exit_code, result.stderr) == (0, "")
    answer = json.loads(result.stdout)
    assert answer.keys() >= KEYS
    assert {len(answer[name]) for name in ("time", "x", "y", "min_film_thickness", "contact_fraction")} == {
        answer["steps"] + 1
    }
    assert (answer["converged"], answer["status"]) == (True, "converged")
    assert_allclose([answer["x"][0], answer["y"][0]], [0.0, -1e-5], rtol=0.0, atol=1e-18)
    assert_allclose(answer["time"][-1], 3e-3, rtol=1e-9)
    stored = load(out)
    assert_allclose(stored["x"], answer["x"], rtol=0.0, atol=0.0)
    shown = cli("show", str(out), "--json")
    assert json.loads(shown.stdout) == answer


@pytest.mark.slow
def test_the_table_is_the_same_from_the_file(cli: Run, rotor: str, tmp_path: Path) -> None:
    out = tmp_path / "orbit.nc"
    result = cli("orbit", rotor, "--duration", "3 ms", "--out", str(out))
    assert result.exit_code == 0
    assert result.stdout.startswith("orbit: Plain [b]bearing[/b]\n")
    for label in ("turns", "steps", "factorisations", "failed steps", "largest displacement", "minimum film thickness"):
        assert f"\n{label} " in result.stdout
    for label in ("largest contact fraction", "dominant whirl ratio", "mass-balance error", "energy-balance error"):
        assert f"\n{label} " in result.stdout
    assert cli("show", str(out)).stdout == result.stdout


def test_a_ramp_ends_where_it_ends(cli: Run, rotor: str) -> None:
    ramp = "20000 rpm : 22000 rpm : 1 ms, 22000 rpm : 21000 rpm : 1 ms"
    result = cli("orbit", rotor, "--ramp", ramp, "--initial", "1 um, 2 um", "--load", "10 N", "--json")
    answer = json.loads(result.stdout)
    assert_allclose(answer["time"][-1], 2e-3, rtol=1e-9)
    assert_allclose(answer["shaft_speed"][-1], 21000.0 * np.pi / 30.0, rtol=1e-9)
    assert_allclose([answer["x"][0], answer["y"][0]], [1e-6, 2e-6], rtol=1e-12)


@pytest.mark.slow
def test_figure_and_animation(cli: Run, rotor: str, tmp_path: Path) -> None:
    figure, page = tmp_path / "orbit.png", tmp_path / "orbit.html"
    result = cli("orbit", rotor, "--duration", "0.2 ms", "--plot", str(figure), "--animate", str(page))
    assert result.exit_code == 0
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


# ---------------------------------------------------------------------------------------------- what is kept


def test_an_interrupt_keeps_what_is_done(cli: Run, rotor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "orbit.nc"
    stopping(monkeypatch, 20, KeyboardInterrupt())
    result = cli("orbit", rotor, "--revolutions", "5", "--json", "--out", str(out))
    assert result.exit_code == 130
    answer = json.loads(result.stdout)
    assert answer["interrupted"] is True
    assert answer["status"].startswith("interrupted after 0.")
    turns = answer["status"].removeprefix("interrupted after ")
    assert result.stderr == f"interrupted: {turns} are finished and kept\n"
    stored = load(out)
    assert stored.sizes["time"] == len(answer["time"]) == 22  # the start, 20 steps, and the one it was handed after
    monkeypatch.undo()
    more = cli("orbit", rotor, "--duration", "0.1 ms", "--restart", str(out), "--json")
    assert more.exit_code == 0
    assert_allclose(json.loads(more.stdout)["time"][0], answer["time"][-1], rtol=1e-12)


def test_an_interrupt_before_the_first_step_leaves_nothing(
    cli: Run, rotor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "orbit.nc"
    stopping(monkeypatch, 0, KeyboardInterrupt())
    result = cli("orbit", rotor, "--out", str(out))
    assert (result.exit_code, result.stderr) == (130, "interrupted: nothing was finished\n")
    assert not out.exists()


def test_a_motion_that_is_stuck_keeps_what_is_done(
    cli: Run, rotor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "orbit.nc"
    stopping(monkeypatch, 10, ConvergenceError("no step leads on", advice="refine the grid"))
    result = cli("orbit", rotor, "--revolutions", "5", "--json", "--out", str(out))
    assert result.exit_code == 3
    assert json.loads(result.stdout)["converged"] is False
    kept, *reason = result.stderr.splitlines()
    assert kept.startswith("stopped: 0.")
    assert reason == ["Error: no step leads on", "Advice: refine the grid"]
    assert load(out).sizes["time"] == 12
    assert kept == f"stopped: {_turns(out)} are finished and kept in {out}"


@pytest.mark.slow
def test_the_file_grows_with_the_motion(cli: Run, rotor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out, seen = tmp_path / "orbit.nc", []
    monkeypatch.setattr(keeping, "PERIOD", 0.0)
    monkeypatch.setattr(keeping, "MAX_SHARE", 1.0)
    taken = Orbit.advance

    def steps(self: Orbit) -> Iterator[tuple[float, str]]:
        for step in taken(self):
            if out.exists():
                ds = load(out)
                seen.append((ds.sizes["time"], str(ds["status"].item())))
            yield step

    monkeypatch.setattr(Orbit, "advance", steps)
    assert cli("orbit", rotor, "--duration", "0.2 ms", "--out", str(out)).exit_code == 0
    sizes = [size for size, _ in seen]
    assert len(sizes) >= 2
    assert sizes == sorted(sizes)
    assert seen[-1][1].startswith("not finished after 0.")
    assert load(out).sizes["time"] > sizes[-1]
    assert str(load(out)["status"].item()) == "converged"


CTRL_C = """
import os, signal, sys
from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.cli import main

signal.signal(signal.SIGINT, signal.default_int_handler)  # whoever runs the tests may have it ignored
taken = Orbit.advance

def steps(self):
    for number, step in enumerate(taken(self)):
        if number == 5:
            os.kill(os.getpid(), signal.SIGINT)
        yield step

Orbit.advance = steps
main()
"""


@pytest.mark.slow
def test_ctrl_c_ends_with_its_code(rotor: str, tmp_path: Path) -> None:
    out = tmp_path / "orbit.nc"
    arguments = ["orbit", rotor, "--revolutions", "50", "--out", str(out)]
    done = subprocess.run(
        [sys.executable, "-c", CTRL_C, *arguments], capture_output=True, text=True, check=False, env={**os.environ}
    )
    assert done.returncode == 128 + signal.SIGINT
    assert done.stderr.startswith("interrupted: 0.")
    assert "Traceback" not in done.stderr
    assert "\nstatus " in done.stdout
    assert load(out).sizes["time"] >= 6


def _turns(path: Path) -> str:
    """How far a stored motion has come, by its status."""
    return str(load(path)["status"].item()).removeprefix("stopped after ")


# ---------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--ramp", "0 rpm : 60 rpm : -1 s"), "--ramp: the segment '0 rpm : 60 rpm : -1 s' goes back in time"),
        (("--ramp", "0 : 60 : 0 s"), "lasts no time"),
        (("--ramp", "0 : 60 : 1 s, 50 : 0 : 1 s"), "--ramp: the segment '50 : 0 : 1 s' does not join on"),
        (("--duration", "-1 ms"), "--duration: '-1 ms' is outside its range; allowed: greater than 0 s"),
        (("--duration", "1 N"), "--duration: '1 N' measures something else"),
        (("--revolutions", "0"), "--revolutions: '0' is outside its range; allowed: greater than 0"),
        (("--revolutions", "1", "--duration", "1 s"), "--revolutions says nothing beside --duration"),
        (("--initial", "1 um"), "--initial: '1 um' is not a pair"),
        (("--initial", "30 um, 0 um"), "touches the bushing"),
        (("--tolerance", "nought"), "--tolerance: 'nought' does not begin with a number"),
        (("--restart", "nothing.nc"), "nothing.nc: there is no such file"),
        (("--restart", "here.nc", "--initial", "0 um, 0 um"), "--initial says nothing beside --restart"),
        (("--restart", "here.nc", "--out", "here.nc"), "--out: here.nc is what --restart reads"),
        (("--animate", "orbit.mp4"), "--animate: orbit.mp4 has the suffix '.mp4'; known: .html, .gif"),
    ],
)
def test_what_cannot_be_is_refused(cli: Run, rotor: str, options: tuple[str, ...], reason: str) -> None:
    result = cli("orbit", rotor, *options)
    assert (result.exit_code, result.stdout) == (2, "")
    assert reason in result.stderr


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ('mass = "3 kg"', 'mass = "-3 kg"', "rotor.mass: '-3 kg' is outside its range"),
        ('mass = "3 kg"', 'mass = "3 N"', "rotor.mass"),
        ('unbalance = "2 um"', 'unbalance = "-2 um"', "rotor.unbalance"),
        ('[rotor]\nmass = "3 kg"\nunbalance = "2 um"\n', "", "needs a case with [rotor]"),
    ],
)
def test_a_rotor_that_cannot_be_is_refused(cli: Run, rotor: str, old: str, new: str, reason: str) -> None:
    Path(rotor).write_text(CASE.replace(old, new), encoding="utf-8")
    result = cli("orbit", rotor)
    assert (result.exit_code, result.stdout) == (2, "")
    assert reason in result.stderr


def test_the_motion_of_another_case_is_refused(cli: Run, rotor: str, tmp_path: Path) -> None:
    out = tmp_path / "orbit.nc"
    assert cli("orbit", rotor, "--duration", "0.05 ms", "--out", str(out)).exit_code == 0
    for old, new, section in (("50 mm", "60 mm", "bearing"), ("axial_cells = 4", "axial_cells = 8", "model")):
        Path(rotor).write_text(CASE.replace(old, new), encoding="utf-8")
        result = cli("orbit", rotor, "--restart", str(out))
        assert result.exit_code == 2
        assert f"that of another bearing: its [{section}] differs" in result.stderr
    solved = tmp_path / "solved.nc"
    Path(rotor).write_text(CASE, encoding="utf-8")
    assert cli("solve", rotor, "--out", str(solved)).exit_code == 0
    result = cli("orbit", rotor, "--restart", str(solved))
    assert result.exit_code == 2
    assert "holds no motion" in result.stderr
