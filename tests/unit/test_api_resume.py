"""A series that was stopped goes on from the points that it wrote, and ends as if it had not been stopped."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import petalfoil
from petalfoil.analysis.known_verbs import find
from petalfoil.case import Case
from petalfoil.errors import StoreError, UsageError
from petalfoil.results.store import save
from tests.cases import case

PETALS = case("paper_n8", **{"model.cells_per_pitch": 12})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})
SLIDING = PETALS.replace(**{"surface.petal_friction": 0.2, "model.cells_per_pitch": 8})

SERIES: dict[str, tuple[Case, str, dict[str, Any]]] = {
    "curve": (PETALS, "curve", {"eccentricities": "0 um : 200 um : 4"}),
    "curve of a plain bearing": (PLAIN, "curve", {"eccentricities": "2 um : 15 um : 3"}),
    "run-up and down": (PETALS, "runup", {"load": 20.0, "to": 2000.0, "points": 3}),
    "lift-off": (PETALS, "liftoff", {"loads": [10.0, 20.0]}),
    "static": (PETALS, "static", {"eccentricities": "0 um : 100 um : 3"}),
    "static loop": (SLIDING, "static", {"eccentricities": "0 um : 60 um : 3", "loop": True}),
    "coefficients": (PETALS, "coefficients", {"speeds": "4000, 8000", "load": 20.0}),
    "stability chart": (PETALS, "stability", {"speeds": "6000, 8000", "loads": "10 N, 20 N"}),
    "grid study": (PLAIN, "converge", {"coarsest": 16, "levels": 3}),
}
COUNTS = {"iterations", "factorizations", "pack_iterations", "probe_factorizations", "coarse_factorizations"}
COSTS = {"wall_time", "residual"} | COUNTS
"""What is not the same when points are computed in two runs."""

CLOSE = {"reaction_balance_error", "mass_balance_error", "force_residual"}
"""Rounding."""


def stopped_after(number: int, bearing: Case, verb: str, given: dict[str, Any]) -> xr.Dataset:
    """What a series has written after some points."""
    analysis = find(verb)
    assert analysis is not None
    run = analysis.start(bearing, analysis.read(given))
    assert len(list(islice(run.advance(), number))) == number
    return analysis.answer(run, "interrupted").to_dataset()


QUICK = ("grid study",)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[] if n in QUICK else pytest.mark.slow) for n in SERIES])
def test_a_series_that_goes_on_ends_as_if_it_had_not_been_stopped(name: str, tmp_path: Path) -> None:
    bearing, verb, given = SERIES[name]
    whole = getattr(petalfoil, verb)(bearing, **given)
    save(stopped_after(2 if verb == "converge" else 1, bearing, verb, given), tmp_path / "part.nc")
    resumed = getattr(petalfoil, verb)(bearing, **given, resume=tmp_path / "part.nc")
    assert resumed.sizes == whole.sizes
    assert set(resumed.variables) == set(whole.variables)
    assert resumed.attrs["asked"] == whole.attrs["asked"]
    assert len(json.loads(resumed.attrs["history"])) == len(json.loads(whole.attrs["history"]))
    for key in set(whole.variables) - COSTS - CLOSE:
        a, b = resumed[key].values, whole[key].values
        if a.dtype.kind == "f" and a.size:
            scale = float(np.nanmax(np.abs(b))) if np.any(np.isfinite(b)) else 1.0
            np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-6 * scale, err_msg=str(key))
        elif key != "solution_path":
            np.testing.assert_array_equal(a, b, err_msg=str(key))


@pytest.mark.slow
def test_points_that_are_done_are_not_computed_again() -> None:
    bearing, verb, given = SERIES["lift-off"]
    part = stopped_after(1, bearing, verb, given)
    told: list[str] = []
    petalfoil.liftoff(bearing, **given, resume=part, progress=lambda _, text: told.append(text))
    assert not any("10 N" in text for text in told)
    assert told[-1] == "liftoff: 2 of 2 points"


@pytest.mark.slow
def test_a_curve_goes_on_along_the_branch_it_was_on_and_not_on_one_found_from_nothing(monkeypatch: Any) -> None:
    """Where the last point is found differently from nothing, the points before it are followed again."""
    from petalfoil.analysis import curve as module

    bearing, verb, given = SERIES["curve"]
    part, walks = stopped_after(2, bearing, verb, given), []
    along = module._along
    monkeypatch.setattr(module, "_along", lambda cases, base: walks.append(len(cases)) or along(cases, base))
    petalfoil.curve(bearing, **given, resume=part)
    assert walks == [1]
    part["force_y"].values[-1] *= 1.01  # as if another branch had been stored
    walks.clear()
    petalfoil.curve(bearing, **given, resume=part)
    assert walks == [1, 2]


@pytest.mark.parametrize(
    ("bearing", "change", "reason"),
    [
        (PETALS, {"eccentricities": "0 um : 200 um : 5"}, "other arguments: eccentricities"),
        (PETALS, {"speed": 7000.0}, "other arguments: speed"),
        (PETALS.replace(**{"gas.viscosity": 2e-5}), {}, "that of another case"),
    ],
)
def test_the_points_of_another_question_are_refused(bearing: Case, change: dict[str, Any], reason: str) -> None:
    own, verb, given = SERIES["curve"]
    part = stopped_after(1, own, verb, given)
    with pytest.raises(UsageError, match=reason):
        petalfoil.curve(bearing, **(given | change), resume=part)


def test_results_that_are_no_points_are_refused(tmp_path: Path) -> None:
    part = stopped_after(1, *SERIES["curve"])
    with pytest.raises(UsageError, match="no series of static"):
        petalfoil.static(PETALS, resume=part)
    with pytest.raises(UsageError, match="no series that could go on"):
        petalfoil.coefficients(PETALS, resume=part)
    with pytest.raises(StoreError, match="there is no such file"):
        petalfoil.curve(PETALS, "0 um", resume=tmp_path / "none.nc")
    with pytest.raises(UsageError, match=r"resume: .* is neither a result"):
        petalfoil.curve(PETALS, "0 um", resume=5)
