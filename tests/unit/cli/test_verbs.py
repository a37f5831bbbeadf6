"""What each verb asks of its analysis and prints."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from petalfoil import __version__
from petalfoil.results.store import load

from .conftest import point


def test_version(cli) -> None:
    result = cli("--version")
    assert (result.exit_code, result.stdout, result.stderr) == (0, f"petalfoil {__version__}\n", "")


@pytest.mark.parametrize("verb", ["solve", "curve", "static", "check", "show"])
def test_help_has_an_example(cli, verb: str) -> None:
    result = cli(verb, "--help")
    assert result.exit_code == 0
    assert f"Example: petalfoil {verb} " in result.stdout


@pytest.mark.parametrize("call", [["-h"], ["solve", "-h"], ["show", "-h"]])
def test_h_is_help(cli, call: list[str]) -> None:
    assert cli(*call).stdout == cli(*call[:-1], "--help").stdout


@pytest.mark.parametrize(("typed", "expected"), [("petalfoil lift", "liftoff"), ("petalfoil liftoff --lo", "--loads")])
def test_a_shell_completes_verbs_and_their_options(typed: str, expected: str) -> None:
    asked = {"_PETALFOIL_COMPLETE": "complete_zsh", "_TYPER_COMPLETE_ARGS": typed}
    command = [sys.executable, "-m", "petalfoil"]
    done = subprocess.run(command, env=os.environ | asked, capture_output=True, text=True, check=True)
    assert expected in done.stdout


def test_solve_passes_its_options_on(cli, played, case) -> None:
    result = cli("solve", case, "--speed", "100 rad/s", "--eccentricity", "-5 um, 1 um", "--json")
    assert result.exit_code == 0, result.stderr
    ((name, (definition,), options),) = played.calls
    assert (name, definition.title) == ("solve", "Plain [b]bearing[/b]")
    assert (options["speed"], options["eccentricity"]) == (100.0, (-5e-6, 1e-6))


def test_solve_leaves_to_the_case_what_is_not_given(cli, played, case) -> None:
    cli("solve", case)
    options = played.calls[0][2]
    assert options["speed"] is None
    assert options["eccentricity"] is None


def test_solve_json_is_the_only_thing_on_standard_output(cli, played, case) -> None:
    played.single = lambda: point(0.0, -1e-4, attitude_angle=float("nan"))
    result = cli("solve", case, "--json")
    answer = json.loads(result.stdout)
    assert result.stdout.count("\n") == 1
    assert result.stderr == ""
    assert (answer["eccentricity_y"], answer["iterations"], answer["converged"]) == (-1e-4, 7, True)
    assert answer["attitude_angle"] is None


def test_solve_prints_a_table_in_engineers_units(cli, played, case) -> None:
    result = cli("solve", case)
    assert result.exit_code == 0
    assert result.stdout.startswith("solve: Plain [b]bearing[/b]\n")  # a user's title is text, not markup
    speed = next(line for line in result.stdout.splitlines() if line.startswith("speed"))
    assert speed.split() == ["speed", "76394", "rpm"]
    assert "\x1b" not in result.stdout


def test_curve_goes_along_its_direction(cli, played, case) -> None:
    result = cli("curve", case, "--eccentricity", "0 um : 200 um : 3", "--direction", "180 deg", "--json")
    assert result.exit_code == 0, result.stderr
    ((_, (_, distances), options),) = played.calls
    assert distances == [0.0, 1e-4, 2e-4]
    assert_allclose(options["direction"], math.pi, rtol=1e-14, atol=0.0)
    answer = json.loads(result.stdout)
    assert list(answer) == ["points", "warnings"]
    assert_allclose([p["eccentricity_x"] for p in answer["points"]], [0.0, -1e-4, -2e-4], rtol=1e-12, atol=0.0)


def test_curve_points_downward_by_default(cli, played, case) -> None:
    cli("curve", case, "--eccentricity", "100 um")
    assert_allclose(played.calls[0][2]["direction"], -0.5 * math.pi, rtol=1e-14, atol=0.0)


def test_curve_table_has_a_line_a_point(cli, played, case) -> None:
    played.failing = {1}
    result = cli("curve", case, "--eccentricity", "0 um : 200 um : 3")
    lines = [line.split() for line in result.stdout.splitlines()]
    lines = [line for line in lines if line and line[0].isdigit()]
    assert [line[0] for line in lines] == ["1", "2", "3"]
    assert [line[-1] == "failed" for line in lines] == [False, True, False]
    assert "200.0" in lines[2]


def test_static_json_has_preload_and_starting_torque(cli, played, case) -> None:
    result = cli("static", case, "--json")
    answer = json.loads(result.stdout)
    assert (answer["preload"], answer["starting_torque"], len(answer["points"])) == (12.5, 0.25, 1)


def test_static_has_no_preload_without_the_centred_point(cli, played, case) -> None:
    answer = json.loads(cli("static", case, "--eccentricity", "10 um : 20 um : 2", "--json").stdout)
    assert (answer["preload"], answer["starting_torque"], len(answer["points"])) == (None, None, 2)


def test_check_prints_derived_figures(cli, played, case) -> None:
    played.single = lambda: point(0.0, 0.0, overlap=1.5, radial_clearance=1e-3)
    assert json.loads(cli("check", case, "--json").stdout)["overlap"] == 1.5
    assert "radial clearance" in cli("check", case).stdout


@pytest.mark.parametrize("verb", ["solve", "check"])
def test_out_holds_the_answer(cli, played, case, tmp_path: Path, verb: str) -> None:
    out = tmp_path / "result.nc"
    assert cli(verb, case, "--out", str(out)).exit_code == 0
    assert float(load(out)["eccentricity_y"]) == -1e-4


@pytest.mark.parametrize(
    "arguments",
    [("solve",), ("curve", "--eccentricity", "0 um : 200 um : 3"), ("static", "--eccentricity", "0 um : 200 um : 3")],
)
def test_show_repeats_what_the_run_printed(cli, played, case, tmp_path: Path, arguments: tuple[str, ...]) -> None:
    out = str(tmp_path / "result.nc")
    played.failing = {1}
    verb, *options = arguments
    for flags in ([], ["--json"]):
        run, again = cli(verb, case, *options, *flags, "--out", out), cli("show", out, *flags)
        assert again.stdout == run.stdout
        assert (again.exit_code, again.stderr) == (run.exit_code, run.stderr)
