"""Exit codes and what a user reads when something goes wrong."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from petalfoil.errors import ConvergenceError, PackError
from petalfoil.results.store import load

from .conftest import point


def raising(error: BaseException):
    """Give a function that raises."""

    def fail(*args, **kwargs):
        raise error

    return fail


NO_ANSWER = ConvergenceError("stopped at a residual of 0.1", history=[{"status": "stalled"}], advice="a lower speed")


def test_no_converged_answer(cli, played, case) -> None:
    played.single = raising(NO_ANSWER)
    result = cli("solve", case)
    assert (result.exit_code, result.stdout) == (3, "")
    assert result.stderr == "Error: stopped at a residual of 0.1\nAdvice: a lower speed\n"


def test_no_converged_answer_as_json(cli, played, case) -> None:
    played.single = raising(NO_ANSWER)
    result = cli("solve", case, "--json")
    assert result.exit_code == 3
    answer = json.loads(result.stdout)
    assert (answer["error"], answer["status"]) == ("stopped at a residual of 0.1", "stalled")
    assert answer["converged"] is False


def test_a_record_that_did_not_converge_counts_as_none(cli, played, case) -> None:
    played.single = lambda: point(0.0, -1e-4, converged=False)
    result = cli("solve", case, "--json")
    assert result.exit_code == 3
    assert result.stderr == "the run at (0, -100) um did not converge: the film collapsed\n"
    assert json.loads(result.stdout)["bearing_force"] is None


def test_failed_points_are_named_and_the_rest_is_given_out(cli, played, case, tmp_path: Path) -> None:
    played.failing = {1}
    out = tmp_path / "curve.nc"
    result = cli("curve", case, "--eccentricity", "0 um : 200 um : 3", "--json", "--out", str(out))
    assert result.exit_code == 3
    assert result.stderr.splitlines() == ["point 2 at (0, -100) um did not converge: the film collapsed"]
    assert [p["bearing_force"] is None for p in json.loads(result.stdout)["points"]] == [False, True, False]
    assert load(out)["converged"].values.tolist() == [True, False, True]


@pytest.mark.parametrize("flags", [[], ["--json"]])
def test_a_bad_case_leaves_standard_output_empty(cli, played, case, flags: list[str]) -> None:
    played.single = raising(PackError("too thick by 0.1 mm"))
    result = cli("solve", case, *flags)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == "Error: too thick by 0.1 mm\n"


@pytest.mark.parametrize(
    "arguments",
    [
        ("solve",),
        ("solve", "{case}", "--spede", "8000 rad/s"),
        ("solve", "{case}", "--speed", "fast"),
        ("solve", "{case}", "--eccentricity", "0 um : 280 um : 15"),
        ("solve", "no-such-case.toml"),
        ("curve", "{case}"),
        ("curve", "{case}", "--eccentricity", "0 um : 280 um : 1.5"),
        ("curve", "{case}", "--eccentricity", "0 um : 280 um : 15", "--direction", "down"),
        ("show", "no-such-result.nc"),
        ("show", "{case}"),
        ("sovle", "{case}"),
    ],
)
def test_bad_usage(cli, played, case, arguments: tuple[str, ...]) -> None:
    result = cli(*(argument.format(case=case) for argument in arguments))
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr
    assert "Traceback" not in result.stderr
    assert played.calls == []


def test_a_fault_is_reported_with_a_log(cli, played, case) -> None:
    played.single = raising(ZeroDivisionError("by\nzero"))
    result = cli("solve", case, "--json")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.count("\n") == 1
    assert result.stderr.startswith("Internal error, please report it: ZeroDivisionError: by zero; ")
    log = Path(re.search(r"the details are in (\S+)", result.stderr)[1])
    assert "Traceback" in log.read_text(encoding="utf-8")


def test_a_fault_without_a_place_for_its_log_is_still_reported(cli, played, case, monkeypatch) -> None:
    monkeypatch.setattr("tempfile.NamedTemporaryFile", raising(OSError("no space")))
    played.single = raising(ZeroDivisionError("by zero"))
    result = cli("solve", case)
    assert result.exit_code == 1
    assert result.stderr.endswith("ZeroDivisionError: by zero; no log could be written (no space)\n")


def test_interrupted_before_anything_was_finished(cli, played, case) -> None:
    played.single = raising(KeyboardInterrupt())
    result = cli("solve", case)
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr == "interrupted: nothing was finished\n"


def test_several_problems_of_a_case_stand_in_lines_of_their_own(cli, tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text('[petals]\nmount = "welded"\n"wid\\nth" = 1\n', encoding="utf-8")
    lines = cli("check", str(path)).stderr.splitlines()
    assert re.fullmatch(r"Error: .*case.toml: \d+ problems", lines[0])
    assert all(line.startswith("  - ") for line in lines[1:])
    assert any("Did you mean 'clamped'?" in line for line in lines)
    assert any(r"petals.wid\nth: is not a known key" in line for line in lines)  # a break in a key makes no line
