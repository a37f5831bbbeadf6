"""The verbs under a load and about small motions: what they ask of their analyses, print, keep and refuse."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.runs import Points
from petalfoil.errors import ConvergenceError
from petalfoil.results import Record, Scalar
from petalfoil.results.store import load

from .conftest import CASE, play

RPM = math.pi / 30.0
TITLE = "Plain [b]bearing[/b]"


def scalars(failed: bool, **own: Scalar) -> dict[str, Scalar]:
    ended: dict[str, Scalar] = {"converged": not failed, "status": "the film collapsed" if failed else "converged"}
    return ended | {"eccentricity_x": 0.0, "eccentricity_y": -1e-4, "iterations": 7} | own


class Loads:
    """The analyses as the test plays them; keeps what they were called with."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, dict[str, Any]]] = []
        self.failing: set[int] = set()
        self.interrupted: int | None = None

    def _point(self, index: int) -> bool:
        if index == self.interrupted:
            raise KeyboardInterrupt
        return index in self.failing

    def balance(self, **given: Any) -> Record:
        self.calls.append(("balance", given))
        if self.failing:
            raise ConvergenceError("no equilibrium found", history=[{"status": "lost"}], advice="push less")
        own = {
            "load_x": 0.0,
            "load_y": -50.0,
            "force_residual": 1e-12,
            "carried_by": "touching: solid contact makes 38 % of the normal forces on the journal",
        }
        return Record(analysis="balance", scalars=scalars(False, speed=100.0, **own), title=TITLE, case_toml=CASE)

    def liftoff(self, **given: Any) -> Points:
        self.calls.append(("liftoff", given))
        return Points(self._loads(given["loads"], given["contact_fraction"]), len(given["loads"]))

    def _loads(self, loads: list[float], limit: float) -> Iterator[Record]:
        for index, size in enumerate(loads):
            failed, up = self._point(index), 10.0 * size if size < 100.0 else math.inf
            own = {"load_x": 0.0, "load_y": -size, "contact_fraction_limit": limit, "liftoff_speed": up}
            own |= {
                "touchdown_speed": 0.9 * up,
                "liftoff_by_contact_film_thickness": 0.5,
                "liftoff_by_contact_fraction": math.nan,
            }
            ended = {"status": "does not lift off below 9 rpm"} if math.isinf(up) else {}
            given = scalars(failed, **own) | ended
            yield Record(analysis="liftoff", scalars=given, title=TITLE, case_toml=CASE)

    def runup(self, **given: Any) -> Points:
        self.calls.append(("runup", given))
        return Points(self._legs(given["to"], given["points"]), 2 * given["points"] - 1)

    def _legs(self, top: float, points: int) -> Iterator[Record]:
        up = np.linspace(0.0, top, points)
        for index, (leg, speed) in enumerate([("up", v) for v in up] + [("down", v) for v in up[-2::-1]]):
            failed = self._point(index)
            own = {"speed": float(speed), "leg": leg, "load_x": 0.0, "load_y": -20.0, "friction_torque": 0.1}
            yield Record(analysis="runup", scalars=scalars(failed, **own), title=TITLE, case_toml=CASE)

    def _matrices(self, speed: float, whirl: list[float], failed: bool) -> Record:
        shape = (len(whirl), 2, 2)
        entries = speed + np.array(whirl)[:, None, None] + np.arange(4.0).reshape(1, 2, 2)
        fields = {"stiffness": 1e6 * entries, "damping": np.broadcast_to(entries, shape).copy()}
        coords = {"whirl_frequency": np.array(whirl), "row": np.arange(2), "column": np.arange(2)}
        kept = {} if failed else {"fields": fields, "coords": coords}
        given = scalars(failed, speed=speed)
        return Record(analysis="coefficients", scalars=given, title=TITLE, case_toml=CASE, **kept)

    def coefficients(self, **given: Any) -> Record | Points:
        self.calls.append(("coefficients", given))
        speeds, whirl = given["speeds"], given["frequencies"]
        if speeds is None:
            return self._matrices(8000.0, whirl or [8000.0], False)
        points = (self._matrices(speed, whirl or speeds, self._point(index)) for index, speed in enumerate(speeds))
        return Points(points, len(speeds))

    def stability(self, **given: Any) -> Record | Points:
        self.calls.append(("stability", given))
        if given["speeds"] is not None or given["loads"] is not None:
            places = [(size, speed) for size in given["loads"] or [50.0] for speed in given["speeds"] or [8000.0]]
            return Points(self._table(places), len(places))
        own = {"critical_mass": math.inf, "whirl_ratio": math.nan, "threshold_speed": math.nan, "rotor_mass": 2.0}
        stable = scalars(False, speed=8000.0, **own) | {"status": "converged; stable for any rotor mass"}
        return Record(analysis="stability", scalars=stable, title=TITLE, case_toml=CASE)

    def _table(self, places: list[tuple[float, float]]) -> Iterator[Record]:
        for index, (size, speed) in enumerate(places):
            own = {"speed": speed, "load_x": 0.0, "load_y": -size, "critical_mass": size / speed, "whirl_ratio": 0.48}
            given = scalars(self._point(index), **own)
            yield Record(analysis="stability", scalars=given, title=TITLE, case_toml=CASE)


@pytest.fixture
def loads(played: Any, monkeypatch: pytest.MonkeyPatch) -> Loads:
    """Let the player answer."""
    plays = Loads()
    for verb in ("balance", "liftoff", "runup", "coefficients", "stability"):
        play(verb, getattr(plays, verb), monkeypatch)
    return plays


VERBS = {
    "balance": ("balance", "--load", "50 N"),
    "liftoff": ("liftoff", "--load", "10 N, 200 N"),
    "runup": ("runup", "--load", "20 N", "--to", "300 rpm", "--points", "3"),
    "coefficients": ("coefficients", "--frequency", "10 rad/s, 20 rad/s"),
    "coefficients over speeds": ("coefficients", "--speeds", "100 rad/s, 200 rad/s, 300 rad/s"),
    "stability": ("stability", "--load", "20 N", "--mass", "2 kg"),
    "stability chart": ("stability", "--loads", "10 N, 20 N", "--speeds", "100 rad/s, 200 rad/s, 300 rad/s"),
}


@pytest.mark.parametrize("verb", ["balance", "liftoff", "runup", "coefficients", "stability"])
def test_help_has_an_example(cli: Callable[..., Any], verb: str) -> None:
    result = cli(verb, "--help")
    assert result.exit_code == 0
    assert f"Example: petalfoil {verb} " in result.stdout


@pytest.mark.parametrize("name", VERBS)
def test_json_is_one_line_and_show_repeats_what_the_run_printed(cli, loads, case, tmp_path: Path, name: str) -> None:
    verb, *options = VERBS[name]
    out = str(tmp_path / "result.nc")
    for flags in ([], ["--json"]):
        run, again = cli(verb, case, *options, *flags, "--out", out), cli("show", out, *flags)
        assert (run.exit_code, run.stderr) == (0, "")
        assert again.stdout == run.stdout
    assert run.stdout.count("\n") == 1
    assert isinstance(json.loads(run.stdout), dict)


# ---------------------------------------------------------------------------------------------- balance


@pytest.mark.parametrize(
    ("text", "force"),
    [("50 N", (0.0, -50.0)), ("0 N, -50 N", (0.0, -50.0)), ("3 N, 0.05 kN", (3.0, 50.0)), ("0 N, 5 N", (0.0, 5.0))],
)
def test_a_single_load_acts_along_minus_y(cli, loads, case, text: str, force: tuple[float, float]) -> None:
    assert cli("balance", case, "--load", text, "--speed", "60 rpm").exit_code == 0
    ((_, given),) = loads.calls
    assert_allclose(given["load"], force, rtol=1e-15, atol=0.0)
    assert_allclose(given["speed"], 2.0 * math.pi, rtol=1e-15, atol=0.0)


def test_a_single_load_with_a_sign_is_refused_with_both_ways_to_write_it(cli, loads, case) -> None:
    refused = cli("balance", case, "--load=-5 N")
    assert refused.exit_code == 2
    assert "--load: '-5 N' is negative" in refused.stderr
    assert "'0 N, -5 N' downward and '0 N, 5 N' upward" in refused.stderr
    assert not loads.calls


@pytest.mark.parametrize(
    ("options", "noted"),
    [
        (("--speed", "60000"), "--speed: '60000' has no unit and is read in rad/s (572960 rpm)"),
        (("--load", "20"), "--load: '20' has no unit and is read in N;"),
        (("--load", "0, -20"), "--load: '0, -20' has no unit and is read in N;"),
    ],
)
def test_a_number_without_a_unit_is_noted_with_how_it_was_read(cli, loads, case, options, noted: str) -> None:
    answer = cli("balance", case, *options, "--json")
    assert f"Note: {noted}" in answer.stderr
    assert json.loads(answer.stdout)["load_y"] == -50.0


def test_numbers_with_units_and_zeros_are_not_noted(cli, loads, case) -> None:
    assert "Note" not in cli("balance", case, "--load", "0, -20 N", "--speed", "60 rpm").stderr


def test_balance_leaves_the_load_to_the_case(cli, loads, case) -> None:
    cli("balance", case)
    assert loads.calls[0][1]["load"] is None


def test_balance_json_and_table(cli, loads, case) -> None:
    answer = json.loads(cli("balance", case, "--json").stdout)
    assert (answer["load_x"], answer["load_y"], answer["force_residual"]) == (0.0, -50.0, 1e-12)
    assert answer["carried_by"] == "touching: solid contact makes 38 % of the normal forces on the journal"
    assert "touching: solid contact makes 38 % of the normal forces on the journal" in cli("balance", case).stdout


def test_a_balance_that_is_not_found(cli, loads, case) -> None:
    loads.failing = {0}
    result = cli("balance", case, "--json")
    assert result.exit_code == 3
    assert json.loads(result.stdout)["converged"] is False
    assert "Advice: push less" in result.stderr


# ---------------------------------------------------------------------------------------------- liftoff


def test_liftoff_json_lists_figures_in_the_order_of_the_loads(cli, loads, case) -> None:
    answer = json.loads(cli("liftoff", case, "--load", "10 N, 200 N", "--contact-fraction", "0.02", "--json").stdout)
    ((_, given),) = loads.calls
    assert (given["loads"], given["contact_fraction"]) == ([10.0, 200.0], 0.02)
    assert (answer["loads"], answer["liftoff_speed"], answer["touchdown_speed"]) == (
        [10.0, 200.0],
        [100.0, None],
        [90.0, None],
    )
    assert answer["status"] == ["converged", "does not lift off below 9 rpm"]
    assert answer["liftoff_by_contact_fraction"] == [None, None]


def test_liftoff_table_is_in_rpm_and_says_why_there_is_no_speed(cli, loads, case) -> None:
    result = cli("liftoff", case, "--load", "10 N, 200 N")
    lines = [line.split() for line in result.stdout.splitlines()]
    (first,) = (line for line in lines if line[:1] == ["1"])
    assert first[1:4] == ["-10.00", "954.9", "859.4"]
    assert "does not lift off below 9 rpm" in result.stdout


def test_a_load_that_fails_is_named(cli, loads, case) -> None:
    loads.failing = {1}
    result = cli("liftoff", case, "--load", "10 N : 30 N : 3", "--json")
    assert result.exit_code == 3
    assert result.stderr == "point 2 of 20 N did not converge: the film collapsed\n"
    assert json.loads(result.stdout)["liftoff_speed"] == [100.0, None, 300.0]


# ---------------------------------------------------------------------------------------------- runup


def test_runup_json_has_two_legs(cli, loads, case) -> None:
    answer = json.loads(cli(*_with(case, VERBS["runup"]), "--json").stdout)
    ((_, given),) = loads.calls
    assert (given["load"], given["points"]) == ((0.0, -20.0), 3)
    assert_allclose(given["to"], 300.0 * RPM, rtol=1e-14, atol=0.0)
    assert list(answer) == ["up", "down", "warnings"]
    assert_allclose([point["speed"] / RPM for point in answer["up"]], [0.0, 150.0, 300.0], rtol=1e-12, atol=0.0)
    assert_allclose([point["speed"] / RPM for point in answer["down"]], [150.0, 0.0], rtol=1e-12, atol=0.0)


def test_an_interrupted_run_up_keeps_its_finished_points(cli, loads, case, tmp_path: Path) -> None:
    out = tmp_path / "runup.nc"
    loads.interrupted = 4
    result = cli(*_with(case, VERBS["runup"]), "--json", "--out", str(out))
    assert result.exit_code == 130
    assert result.stderr == "interrupted: 4 of 5 points are finished and kept\n"
    answer = json.loads(result.stdout)
    assert (len(answer["up"]), len(answer["down"]), answer["interrupted"]) == (3, 1, True)
    assert load(out)["leg"].values.tolist() == ["up", "up", "up", "down"]


def test_a_point_of_a_run_up_that_fails_is_named(cli, loads, case) -> None:
    loads.failing = {3}
    result = cli(*_with(case, VERBS["runup"]))
    assert result.exit_code == 3
    assert result.stderr == "point 4 down at 150 rpm did not converge: the film collapsed\n"


# ---------------------------------------------------------------------------------------------- coefficients


def test_coefficients_json_is_by_frequency_row_and_column(cli, loads, case) -> None:
    answer = json.loads(cli("coefficients", case, "--frequency", "10 rad/s : 30 rad/s : 3", "--json").stdout)
    assert loads.calls[0][1]["frequencies"] == [10.0, 20.0, 30.0]
    assert (answer["speed"], answer["whirl_frequency"]) == (8000.0, [10.0, 20.0, 30.0])
    assert np.shape(answer["stiffness"]) == np.shape(answer["damping"]) == (3, 2, 2)
    assert answer["stiffness"][1][1] == [8022e6, 8023e6]


def test_coefficients_over_speeds(cli, loads, case) -> None:
    loads.failing = {1}
    result = cli("coefficients", case, "--speeds", "100 rad/s, 200 rad/s, 300 rad/s", "--json")
    given = loads.calls[0][1]
    assert (given["speeds"], given["frequencies"]) == ([100.0, 200.0, 300.0], None)
    assert (result.exit_code, result.stderr.count("\n")) == (3, 1)
    points = json.loads(result.stdout)["points"]
    assert [point["speed"] for point in points] == [100.0, 200.0, 300.0]
    assert [point["stiffness"] is None for point in points] == [False, True, False]


def test_petals_rub_at_the_amplitude_asked_for(cli, loads, case) -> None:
    cli("coefficients", case, "--amplitude", "2 um")
    cli("coefficients", case, "--speeds", "100, 200", "--amplitude", "2 um")
    cli("coefficients", case)
    assert [given["amplitude"] for _, given in loads.calls] == [2e-6, 2e-6, None]


def test_csv_has_its_units_in_the_header(cli, loads, case, tmp_path: Path) -> None:
    path = tmp_path / "k.csv"
    assert cli("coefficients", case, "--speeds", "100, 200", "--frequency", "10, 20", "--csv", str(path)).exit_code == 0
    head, *lines = list(csv.reader(path.read_text(encoding="utf-8").splitlines()))
    assert head[:2] == ["speed [rad/s]", "whirl_frequency [rad/s]"]
    assert head[4:] == [f"{m}_{e} [{u}]" for m, u in (("K", "N/m"), ("C", "N s/m")) for e in ("xx", "xy", "yx", "yy")]
    assert [line[:2] for line in lines] == [["100.0", "10.0"], ["100.0", "20.0"], ["200.0", "10.0"], ["200.0", "20.0"]]
    assert [float(x) for x in lines[-1][4:]] == [220e6, 221e6, 222e6, 223e6, 220.0, 221.0, 222.0, 223.0]


AXES = (
    "--speeds", "500 rad/s, 100 rad/s, 200 rad/s, 300 rad/s, 400 rad/s",
    "--frequency", "50 rad/s, 10 rad/s, 20 rad/s, 30 rad/s, 40 rad/s",
)  # fmt: skip


# ---------------------------------------------------------------------------------------------- stability


def test_stability_json_is_null_where_nothing_whirls(cli, loads, case) -> None:
    answer = json.loads(cli(*_with(case, VERBS["stability"]), "--json").stdout)
    assert (loads.calls[0][1]["load"], loads.calls[0][1]["mass"]) == ((0.0, -20.0), 2.0)
    assert (answer["critical_mass"], answer["whirl_ratio"], answer["threshold_speed"]) == (None, None, None)
    assert answer["status"] == "converged; stable for any rotor mass"


def test_a_chart_is_by_load_and_speed(cli, loads, case, tmp_path: Path) -> None:
    out = tmp_path / "chart.nc"
    answer = json.loads(cli(*_with(case, VERBS["stability chart"]), "--json", "--out", str(out)).stdout)
    given = loads.calls[0][1]
    assert (given["speeds"], given["loads"]) == ([100.0, 200.0, 300.0], [10.0, 20.0])
    assert (answer["loads"], answer["speeds"]) == ([10.0, 20.0], [100.0, 200.0, 300.0])
    assert_allclose(answer["critical_mass"][1], [0.2, 0.1, 20.0 / 300.0], rtol=1e-14, atol=0.0)
    stored = load(out)
    assert stored["critical_mass"].dims == ("load", "speed")
    assert float(stored["critical_mass"].sel(load=10.0, speed=200.0)) == 0.05


def test_an_interrupted_chart_has_holes(cli, loads, case, tmp_path: Path) -> None:
    out = tmp_path / "chart.nc"
    loads.interrupted = 4
    result = cli(*_with(case, VERBS["stability chart"]), "--json", "--out", str(out))
    assert result.exit_code == 130
    answer = json.loads(result.stdout)
    assert answer["critical_mass"][1] == [0.2, None, None]
    shown = json.loads(cli("show", str(out), "--json").stdout)
    assert shown == {key: value for key, value in answer.items() if key != "interrupted"}


@pytest.mark.parametrize(
    ("options", "asked"),
    [
        (("--speeds", "100, 200"), ([100.0, 200.0], None, None)),
        (("--loads", "5 N"), (None, [5.0], None)),
        (("--loads", "5 N", "--speed", "100"), (None, [5.0], None)),
        (("--speeds", "100", "--load", "7 N"), ([100.0], None, (0.0, -7.0))),
    ],
)
def test_one_axis_of_a_chart_is_enough(cli, loads, case, options: tuple[str, ...], asked: tuple[Any, ...]) -> None:
    assert cli("stability", case, *options).exit_code == 0
    ((_, given),) = loads.calls
    assert (given["speeds"], given["loads"], given["load"]) == asked


# ---------------------------------------------------------------------------------------------- refusals

REFUSED = {
    "a load of another kind": (("balance", "--load", "50 m"), "--load"),
    "three parts of a load": (("balance", "--load", "1 N, 2 N, 3 N"), "--load"),
    "no number": (("balance", "--load", "much"), "--load"),
    "a range where one load is meant": (("stability", "--load", "1 N : 9 N : 3"), "--load"),
    "a range without count": (("liftoff", "--load", "1 N : 2 N"), "--load"),
    "a contact fraction that is none": (
        ("liftoff", "--load", "1 N", "--contact-fraction", "few"),
        "--contact-fraction",
    ),
    "no top speed": (("runup", "--load", "1 N"), "--to"),
    "a top speed in newtons": (("runup", "--load", "1 N", "--to", "1 N"), "--to"),
    "points that are no number": (("runup", "--to", "1 rpm", "--points", "many"), "--points"),
    "a frequency in newtons": (("coefficients", "--frequency", "1 N"), "--frequency"),
    "an amplitude in newtons": (("coefficients", "--amplitude", "1 N"), "--amplitude"),
    "one speed and several": (("coefficients", "--speed", "1", "--speeds", "1, 2"), "--speeds"),
    "no speeds for ROSS": (("coefficients", "--ross", "b.toml"), "--ross"),
    "few frequencies for ROSS": (("coefficients", *AXES[:2], "--frequency", "1", "--ross", "b.toml"), "--ross"),
    "a node without a table": (("coefficients", "--node", "2"), "--node"),
    "a node that is none": (("coefficients", *AXES[:2], "--ross", "b.toml", "--node", "-1"), "--node"),
    "a tag that is no name": (("coefficients", *AXES[:2], "--ross", "b.toml", "--tag", "a\\b"), "--tag"),
    "few speeds for ROSS 2": (("coefficients", "--speeds", "1, 2", "--ross2", "b.toml"), "--ross2"),
    "frequencies without the speeds for ROSS 2": (("coefficients", *AXES, "--ross2", "b.toml"), "--ross2"),
    "a speed twice for ROSS": (("coefficients", "--speeds", "1, 1, 2, 3, 4", "--ross", "b.toml"), "--ross"),
    "a suffix that ROSS does not read": (("coefficients", *AXES, "--ross", "b.xlsx"), "--ross"),
    "a suffix that is no table's": (("coefficients", "--csv", "b.txt"), "--csv"),
    "a folder that is not there": (("coefficients", "--csv", "nowhere/b.csv"), "--csv"),
    "a mass in metres": (("stability", "--mass", "1 m"), "--mass"),
    "a mass for a chart": (("stability", "--loads", "1 N", "--mass", "1 kg"), "--mass"),
    "one load and several": (("stability", "--loads", "1 N", "--load", "1 N"), "--load"),
}


@pytest.mark.parametrize("option", ["--load", "--loads"])
@pytest.mark.parametrize(("verb", "asked"), [("liftoff", {"loads": [5.0]}), ("balance", {"load": (0.0, -5.0)})])
def test_load_and_loads_are_one_option(cli, loads, case, option: str, verb: str, asked: dict[str, Any]) -> None:
    assert cli(verb, case, option, "5 N").exit_code == 0
    ((_, given),) = loads.calls
    assert given.items() >= asked.items()


def test_liftoff_json_has_its_lists_when_every_load_fails(cli, loads, case) -> None:
    loads.failing = {0, 1}
    answer = json.loads(cli("liftoff", case, "--load", "20 N, 30 N", "--json").stdout)
    assert answer["liftoff_speed"] == answer["touchdown_speed"] == [None, None]


@pytest.mark.parametrize("name", REFUSED)
def test_malformed_usage_starts_nothing(cli, loads, case, name: str) -> None:
    (verb, *options), named = REFUSED[name]
    result = cli(verb, case, *options, "--json")
    assert (result.exit_code, result.stdout) == (2, "")
    assert named in result.stderr
    assert loads.calls == []


def _with(case: str, call: tuple[str, ...]) -> tuple[str, ...]:
    """A call with the case where it belongs."""
    verb, *options = call
    return (verb, case, *options)
