"""The functions under a load hand their arguments on in SI units; their answers survive a file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any
from unittest.mock import ANY

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.known_verbs import find
from petalfoil.analysis.runs import Points
from petalfoil.errors import ConvergenceError, PetalfoilError, UnitError, UsageError
from petalfoil.results import Record
from petalfoil.results.layout import Series
from petalfoil.results.store import load, save
from tests.cases import case
from tests.unit.cli.conftest import play

BEARING = case("paper_n8", **{"model.cells_per_pitch": 12})
RUBBING = BEARING.replace(**{"surface.petal_friction": 0.2})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})


Called = list[dict[str, Any]]


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch) -> Called:
    """Arguments that reached an analysis, by name, defaults filled in."""
    calls: Called = []

    def answer(**given: Any) -> Points:
        calls.append(given)
        return Points(iter([Record(analysis="test", scalars={"speed": 1.0})]), 1)

    for verb in ("balance", "liftoff", "runup", "coefficients", "stability"):
        play(verb, answer, monkeypatch)
        monkeypatch.setattr(find(verb), "layouts", (Series(),))
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
def test_loads(called: Called, given: Any, force: tuple[float, float] | None) -> None:
    petalfoil.balance(PLAIN, given, speed="60 rpm")
    asked = called.pop()
    assert asked["load"] == force
    assert_allclose(asked["speed"], 2.0 * math.pi, rtol=1e-15, atol=0.0)
    petalfoil.runup(PLAIN, given, to=100.0)
    asked = called.pop()
    assert (asked["load"], asked["to"], asked["points"]) == (force, 100.0, 25)
    petalfoil.coefficients(PLAIN, load=given)
    asked = called.pop()
    assert asked == {
        "case": PLAIN,
        "frequencies": None,
        "load": force,
        "harmonics": None,
        "speed": None,
        "speeds": None,
        "amplitude": None,
        "tilt": False,
        "progress": ANY,
    }
    petalfoil.stability(PLAIN, load=given, mass="500 g")
    asked = called.pop()
    assert (asked["load"], asked["mass"], asked["speed"]) == (force, 0.5, None)


def test_lists(called: Called) -> None:
    petalfoil.liftoff(PLAIN, "10 N : 30 N : 3", contact_fraction=0.02)
    asked = called.pop()
    assert (asked["loads"], asked["contact_fraction"]) == ([10.0, 20.0, 30.0], 0.02)
    petalfoil.liftoff(PLAIN, 5)
    assert called.pop()["loads"] == [5.0]
    petalfoil.coefficients(PLAIN, np.array([1.0, 2.0]), speeds=["1 rad/s", 2])
    asked = called.pop()
    assert (asked["frequencies"], asked["speeds"]) == ([1.0, 2.0], [1.0, 2.0])
    petalfoil.coefficients(PLAIN, amplitude="2 um", speeds=[1.0])
    assert called.pop()["amplitude"] == 2e-6
    petalfoil.stability(PLAIN, loads="1 N, 2 N", speed=3.0)
    asked = called.pop()
    assert (asked["speed"], asked["loads"]) == (3.0, [1.0, 2.0])
    petalfoil.stability(PLAIN, speeds=(1, 2), load=7)
    asked = called.pop()
    assert (asked["speeds"], asked["load"]) == ([1.0, 2.0], (0.0, -7.0))


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
        ("coefficients", (PLAIN,), {"speed": 1.0, "speeds": 2.0}, UsageError, "speed says nothing beside speeds"),
        ("stability", (PLAIN,), {"mass": "5 N"}, UnitError, "a mass"),
        ("stability", (PLAIN,), {"speeds": "1 : 2"}, UsageError, "start : stop : count"),
    ],
)
def test_bad_arguments_reach_no_analysis(
    called: Called,
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


@pytest.mark.slow
def test_the_legs_of_a_run_up_share_one_dimension() -> None:
    ds = ASKED["runup"]()
    assert ds["leg"].values.tolist() == ["up", "up", "up", "down", "down"]
    assert_allclose(ds["speed"], [0.0, 750.0, 3000.0, 750.0, 0.0], rtol=1e-12, atol=0.0)


@pytest.mark.slow
def test_a_load_beyond_the_capacity_is_said_to_be_that() -> None:
    with pytest.raises(ConvergenceError, match=r"load of 1e\+09 N is beyond the capacity of the bearing: at 1e\+08 N"):
        petalfoil.balance(case("paper_n8", **{"model.cells_per_pitch": 24}), 1e9)


@pytest.mark.slow
def test_a_lift_off_beyond_the_capacity_is_said_to_be_that(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise ConvergenceError("no equilibrium found", history=[], advice="")

    monkeypatch.setattr("petalfoil.analysis.liftoff.crossings", none)
    lifted = petalfoil.liftoff(case("paper_n8", **{"model.cells_per_pitch": 12, "model.contacts": "nodes"}), [1e9])
    assert "a load of 1e+09 N is beyond the capacity of the bearing" in str(lifted["status"].values[0])
