"""The functions under a load hand their arguments on in SI units; their answers survive a file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.errors import PetalfoilError, UnitError, UsageError
from petalfoil.results.store import load, save
from tests.cases import case

BEARING = case("paper_n8", **{"model.cells_per_pitch": 12})
RUBBING = BEARING.replace(**{"surface.petal_friction": 0.2})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch) -> list[tuple[tuple[Any, ...], dict[str, Any]]]:
    """Arguments that reached an analysis; the answers are labels instead of results."""
    calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = []

    def analysis(*args: Any, **kwargs: Any) -> list[Any]:
        calls.append((args, kwargs))
        return [("leg", "record")]

    for target in (
        "balance.run", "liftoff.iterate", "runup.iterate", "coefficients.run", "coefficients.iterate", "stability.run",
        "stability.iterate",
    ):  # fmt: skip
        monkeypatch.setattr(f"petalfoil.analysis.{target}", analysis)
    monkeypatch.setattr("petalfoil.results.dataset.to_dataset", lambda record: record)
    monkeypatch.setattr("petalfoil.results.dataset.curve_dataset", lambda records, analysis: (records, analysis))
    monkeypatch.setattr("petalfoil.results.chart.chart_dataset", lambda records: ("chart", records))
    return calls


@pytest.mark.parametrize(
    ("given", "force"),
    [
        (50.0, (0.0, -50.0)),
        ("50 N", (0.0, -50.0)),
        ("3 N, -50 N", (3.0, -50.0)),
        (("3 N", -50), (3.0, -50.0)),
        (np.array([3.0, -50.0]), (3.0, -50.0)),
        (None, None),
    ],
)
def test_loads(called: list[Any], given: Any, force: tuple[float, float] | None) -> None:
    petalfoil.balance(PLAIN, given, speed="60 rpm")
    args, kwargs = called.pop()
    assert args == (PLAIN, force)
    assert_allclose(kwargs["speed"], 2.0 * math.pi, rtol=1e-15, atol=0.0)
    petalfoil.runup(PLAIN, given, to=100.0)
    assert called.pop() == ((PLAIN, force, 100.0), {"points": 25, "progress": None})
    petalfoil.coefficients(PLAIN, load=given)
    assert called.pop() == ((PLAIN, None), {"load": force, "speed": None, "amplitude": None, "progress": None})
    petalfoil.stability(PLAIN, load=given, mass="500 g")
    assert called.pop() == ((PLAIN,), {"load": force, "mass": 0.5, "speed": None, "progress": None})


def test_lists(called: list[Any]) -> None:
    assert petalfoil.liftoff(PLAIN, "10 N : 30 N : 3", share=0.02) == ([("leg", "record")], "liftoff")
    assert called.pop() == ((PLAIN, [10.0, 20.0, 30.0]), {"share": 0.02, "progress": None})
    petalfoil.liftoff(PLAIN, 5)
    assert called.pop()[0] == (PLAIN, [5.0])
    assert petalfoil.coefficients(PLAIN, np.array([1.0, 2.0]), speeds=["1 rad/s", 2]) == (
        [("leg", "record")],
        "coefficients",
    )
    assert called.pop() == ((PLAIN, [1.0, 2.0], [1.0, 2.0]), {"load": None, "amplitude": None, "progress": None})
    petalfoil.coefficients(PLAIN, amplitude="2 um", speeds=[1.0])
    assert called.pop()[1]["amplitude"] == 2e-6
    petalfoil.coefficients(PLAIN, amplitude=1e-6)
    assert called.pop()[1]["amplitude"] == 1e-6
    assert petalfoil.stability(PLAIN, loads="1 N, 2 N", speed=3.0) == ("chart", [("leg", "record")])
    assert called.pop()[0] == (PLAIN, [3.0], [1.0, 2.0])
    petalfoil.stability(PLAIN, speeds=(1, 2), load=7)
    assert called.pop() == ((PLAIN, [1.0, 2.0], None), {"load": (0.0, -7.0), "progress": None})


@pytest.mark.parametrize(
    ("verb", "args", "kwargs", "error", "reason"),
    [
        ("balance", (PLAIN, (1.0, 2.0, 3.0)), {}, UsageError, "neither a value nor a pair"),
        ("balance", (PLAIN, "5 m"), {}, UnitError, "a force"),
        ("balance", ("case.toml", 5.0), {}, UsageError, "is not a Case"),
        ("liftoff", (PLAIN, []), {}, UsageError, "loads: give at least one"),
        ("runup", (PLAIN, 5.0), {"to": "5 N"}, UnitError, "angular speed"),
        ("coefficients", (PLAIN, []), {}, UsageError, "frequencies: give at least one"),
        ("coefficients", (PLAIN,), {"amplitude": "5 N"}, UnitError, "a length"),
        ("stability", (PLAIN,), {"mass": "5 N"}, UnitError, "a mass"),
        ("stability", (PLAIN,), {"speeds": "1 : 2"}, UsageError, "start : stop : count"),
    ],
)
def test_bad_arguments_reach_no_analysis(
    called: list[Any],
    verb: str,
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
    error: type[PetalfoilError],
    reason: str,
) -> None:
    with pytest.raises(error, match=reason):
        getattr(petalfoil, verb)(*args, **kwargs)
    assert called == []


ASKED: dict[str, Any] = {
    "balance": lambda: petalfoil.balance(BEARING, 20.0),
    "liftoff": lambda: petalfoil.liftoff(BEARING, [400.0]),
    "runup": lambda: petalfoil.runup(BEARING, 20.0, to=3000.0, points=3),
    "coefficients": lambda: petalfoil.coefficients(PLAIN, [0.0, 500.0], load=5.0),
    "coefficients where petals rub": lambda: petalfoil.coefficients(RUBBING, [500.0], load=5.0, amplitude="1 um"),
    "coefficients over speeds": lambda: petalfoil.coefficients(PLAIN, speeds=[500.0, 1000.0]),
    "stability": lambda: petalfoil.stability(PLAIN, load=5.0, mass=0.1),
    "stability chart": lambda: petalfoil.stability(PLAIN, speeds=[500.0, 1000.0], loads=[5.0, 10.0]),
}


@pytest.mark.parametrize("name", ASKED)
def test_an_answer_survives_its_file(tmp_path: Path, name: str) -> None:
    ds = ASKED[name]()
    assert ds.attrs["analysis"] == name.split()[0]
    assert bool(np.all(ds["converged"]))
    save(ds, tmp_path / "result.nc")
    xr.testing.assert_identical(load(tmp_path / "result.nc"), ds)


def test_the_legs_of_a_run_up_share_one_dimension() -> None:
    ds = ASKED["runup"]()
    assert ds["leg"].values.tolist() == ["up", "up", "up", "down", "down"]
    assert_allclose(ds["speed"], [0.0, 750.0, 3000.0, 750.0, 0.0], rtol=1e-12, atol=0.0)
