"""`converge` and `solve --error`: what they ask of the grid study, print, store and say when grids fail."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.converge import converge
from petalfoil.analysis.runs import Points
from petalfoil.errors import ConvergenceError
from petalfoil.results import Record
from petalfoil.results.estimate import Estimate
from petalfoil.results.store import load
from petalfoil.results.study import GridStudy

from .conftest import CASE, play, point

LOADS = (10.25, 10.0625, 10.015625)  # 10 + h^2


class Study:
    """The grid study as the test plays it."""

    def __init__(self) -> None:
        self.asked: dict[str, Any] = {}
        self.failing: set[int] = set()
        self.interrupted_at: int | None = None
        self.bars: dict[str, float] | None = {"bearing_force": 0.25, "min_film_thickness": 2e-7}

    def converge(self, **given: Any) -> Points:
        self.asked = {name: value for name, value in given.items() if name != "progress"}
        cells = [(given["coarsest"] or 32) * 2**k for k in range(given["levels"])]
        return Points(self._grids(cells), len(cells), noun="grids", least=2)

    def _grids(self, cells: list[int]) -> Iterator[Record]:
        for number, count in enumerate(cells):
            if number == self.interrupted_at:
                raise KeyboardInterrupt
            yield _on(count, LOADS[number], number not in self.failing)

    def table(self, records: Sequence[Record]) -> list[Estimate]:
        loads = tuple(float(r.scalars["bearing_force"]) if r.converged else float("nan") for r in records)
        film = tuple(5e-6 if r.converged else float("nan") for r in records)
        return [
            Estimate(name="bearing_force", values=loads, limit=10.0, order=2.0, error=0.02, trusted=True),
            Estimate(name="min_film_thickness", values=film, limit=5e-6, order=float("nan"), error=3e-7, trusted=False),
        ]

    def solve(self, **given: Any) -> Record:
        return point(0.0, -1e-4)

    def error_bars(self, record: Record, on_grid: object) -> dict[str, float]:
        if self.bars is None:
            raise ConvergenceError("a grid study needs two grids at least")
        return self.bars


def _on(cells: int, force: float, converged: bool) -> Record:
    record = point(0.0, -1e-4, converged=converged, cells_per_pitch=cells, bearing_force=force)
    return Record(analysis="solve", scalars=record.scalars, title=record.title, case_toml=CASE)


@pytest.fixture
def study(monkeypatch: pytest.MonkeyPatch) -> Study:
    plays = Study()
    play("converge", plays.converge, monkeypatch)
    play("solve", plays.solve, monkeypatch)
    monkeypatch.setattr("petalfoil.analysis.error_bars.error_bars", plays.error_bars)
    monkeypatch.setattr(converge, "layouts", (GridStudy(conclude=plays.table),))
    return plays


def test_help_has_an_example_and_the_json_keys(cli) -> None:
    result = cli("converge", "--help")
    assert result.exit_code == 0
    assert "Example: petalfoil converge " in result.stdout
    for key in ("grids", "quantities", "values", "order", "limit", "error", "trusted"):
        assert key in result.stdout


def test_options_reach_the_study(cli, study: Study, case: str) -> None:
    arguments = ("--levels", "2", "--coarsest", "48", "--speed", "100 rad/s", "--eccentricity", "1 um, -2 um")
    assert cli("converge", case, *arguments).exit_code == 0
    assert study.asked.pop("case").title == "Plain [b]bearing[/b]"
    assert study.asked == {"levels": 2, "coarsest": 48, "speed": 100.0, "eccentricity": (1e-6, -2e-6), "load": None}
    assert cli("converge", case).exit_code == 0
    del study.asked["case"]
    assert study.asked == {"levels": 3, "coarsest": None, "speed": None, "eccentricity": None, "load": None}


def test_the_table_has_every_grid_order_limit_error_and_trust(cli, study: Study, case: str) -> None:
    result = cli("converge", case)
    assert (result.exit_code, result.stderr) == (0, "")
    lines = [line.split() for line in result.stdout.splitlines()]
    assert ["cells", "32", "64", "128", "order", "limit", "error", "trust"] in lines
    assert ["bearing", "force", "N", "10.250", "10.062", "10.016", "2.00", "10.000", "±", "0.020", "yes"] in lines
    assert [
        "minimum",
        "film",
        "thickness",
        "µm",
        "5.00",
        "5.00",
        "5.00",
        "-",
        "5.00",
        "±",
        "0.30",
        "no",
        "order",
    ] in lines


def test_json_has_the_grids_and_the_quantities(cli, study: Study, case: str) -> None:
    result = cli("converge", case, "--json")
    answer = json.loads(result.stdout)
    assert list(answer) == ["grids", "quantities", "warnings"]
    assert [grid["cells_per_pitch"] for grid in answer["grids"]] == [32, 64, 128]
    assert [grid["bearing_force"] for grid in answer["grids"]] == list(LOADS)
    assert answer["quantities"]["bearing_force"] == {
        "values": list(LOADS),
        "order": 2.0,
        "limit": 10.0,
        "error": 0.02,
        "trusted": True,
    }
    assert answer["quantities"]["min_film_thickness"]["order"] is None


def test_a_failed_grid_is_named_and_left_blank(cli, study: Study, case: str) -> None:
    study.failing = {1}
    result = cli("converge", case, "--json")
    assert result.exit_code == 3
    assert "the grid of 64 cells did not converge: the film collapsed" in result.stderr
    answer = json.loads(result.stdout)
    assert answer["quantities"]["bearing_force"]["values"] == [LOADS[0], None, LOADS[2]]
    assert answer["grids"][1]["bearing_force"] is None


def test_interrupted_it_keeps_what_is_finished(cli, study: Study, case: str) -> None:
    study.interrupted_at = 2
    result = cli("converge", case, "--json")
    assert result.exit_code == 130
    assert "2 of 3 grids are finished" in result.stderr
    answer = json.loads(result.stdout)
    assert answer["interrupted"] is True
    assert len(answer["grids"]) == 2
    study.interrupted_at = 1
    result = cli("converge", case, "--json")
    assert (result.exit_code, result.stdout) == (130, "")


def test_out_holds_the_study_and_show_repeats_it(cli, study: Study, case: str, tmp_path: Path) -> None:
    out = str(tmp_path / "study.nc")
    study.failing = {0}
    for flags in ([], ["--json"]):
        run, again = cli("converge", case, *flags, "--out", out), cli("show", out, *flags)
        assert again.stdout == run.stdout
        assert (again.exit_code, again.stderr) == (run.exit_code, run.stderr)
    ds = load(out)
    assert ds["bearing_force"].dims == ("grid",)
    assert_allclose(ds["bearing_force"].values, [float("nan"), *LOADS[1:]], rtol=1e-15)
    assert float(ds["bearing_force_limit"]) == 10.0
    assert ds["bearing_force_error"].attrs["units"] == "N"
    assert bool(ds["bearing_force_trusted"]) is True
    assert bool(ds["min_film_thickness_trusted"]) is False


def test_plot_is_drawn(cli, study: Study, case: str, tmp_path: Path) -> None:
    figure = tmp_path / "study.png"
    assert cli("converge", case, "--plot", str(figure)).exit_code == 0
    assert figure.read_bytes().startswith(b"\x89PNG")


# ---------------------------------------------------------------------------------------------- solve --error


def test_solve_shows_error_bars_on_request(cli, study: Study, case: str) -> None:
    lines = [line.split() for line in cli("solve", case, "--error").stdout.splitlines()]
    assert ["bearing", "force", "100.00", "±", "0.25", "N"] in lines
    assert ["minimum", "film", "thickness", "5.00", "±", "0.20", "µm"] in lines
    assert ["contact", "normal", "force", "12.50", "N"] in lines  # no bar is known
    assert "±" not in cli("solve", case).stdout


def test_solve_json_and_file_have_the_error_bars(cli, study: Study, case: str, tmp_path: Path) -> None:
    out = str(tmp_path / "point.nc")
    run = cli("solve", case, "--error", "--json", "--out", out)
    assert json.loads(run.stdout)["error"] == {"bearing_force": 0.25, "min_film_thickness": 2e-7}
    assert "error" not in json.loads(cli("solve", case, "--json").stdout)
    assert load(out)["bearing_force"].attrs["grid_error"] == 0.25
    for flags in ([], ["--json"]):
        assert cli("show", out, *flags).stdout == cli("solve", case, "--error", *flags).stdout


def test_without_a_second_grid_the_answer_is_given_without_bars(cli, study: Study, case: str) -> None:
    study.bars = None
    result = cli("solve", case, "--error", "--json")
    assert result.exit_code == 3
    assert result.stderr == "no error bars: a grid study needs two grids at least\n"
    answer = json.loads(result.stdout)
    assert (answer["bearing_force"], answer["error"]) == (pytest.approx(100.0), {})
