"""Cases of a study that begin at the solution of another: the same answers, in fewer factorisations."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

from petalfoil.analysis.derivatives import GROWTH
from petalfoil.analysis.neighbours import FROM_NEIGHBOUR, TRIALS, Memory, apart
from petalfoil.errors import UsageError
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.studies import question
from petalfoil.studies.run import Execution, resume
from petalfoil.studies.study_summary import headline
from petalfoil.studies.sweep import sweep
from tests.cases import case

PAPER = case("paper_n8", **{"model.cells_per_pitch": 8, "model.contacts": "nodes"})
ALONE = Execution(workers=0)
BESIDE = Execution(workers=0, neighbours=True)
VARY = {"gas.viscosity": "18 uPa s : 19 uPa s : 4"}


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studies.study_page.write_page", lambda folder, ds: None)


@pytest.fixture(autouse=True)
def _no_memory() -> None:
    question._memory.cache_clear()


def from_neighbours(ds: xr.Dataset) -> int:
    return int(np.sum(ds["solution_path"].values == FROM_NEIGHBOUR))


def assert_same_answers(found: xr.Dataset, alone: xr.Dataset, tolerance: float = 1e-9) -> None:
    """All results agree; counts, residuals and the path do not have to."""
    assert (found["converged"].values == alone["converged"].values).all()
    compared = 0
    for name, variable in SCALARS.items():
        if name in alone and variable.role is Role.ANSWER and variable.kind is DataType.FLOAT:
            size = float(np.nanmax(np.abs(alone[name].values), initial=0.0))
            if variable.units in ("N", "N m"):  # components of one vector, one of which may vanish
                size = max(size, float(np.nanmax(alone["bearing_force"].values)))
            if variable.units == "rad":
                size = 1.0
            near = tolerance * (10.0 if name in GROWTH else 1.0)  # an eigenvalue ends its iteration at that
            assert_allclose(found[name].values, alone[name].values, rtol=near, atol=near * size, err_msg=name)
            compared += 1
    assert compared > 2


@pytest.mark.slow
def test_a_balance_from_a_neighbour_is_that_of_the_case_itself(tmp_path: Path) -> None:
    alone = sweep(PAPER, VARY, "balance", load=20.0, execution=ALONE)
    found = sweep(PAPER, VARY, "balance", load=20.0, out=tmp_path, execution=BESIDE)
    assert from_neighbours(alone) == 0
    assert from_neighbours(found) == 3
    assert f"{from_neighbours(found)} from a neighbour" in headline(found)
    assert_same_answers(found, alone)
    assert found["factorizations"].values.sum() < 0.6 * alone["factorizations"].values.sum()
    again = resume(tmp_path, ALONE)  # it is part of the study
    assert again.identical(found)
    with pytest.raises(UsageError, match="not the same: sample, limits, budget or neighbours"):
        sweep(PAPER, VARY, "balance", load=20.0, out=tmp_path, execution=ALONE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "vary", "verb", "arguments"),
    [
        ("paper_n6", {"petals.bend_radius": "39.5 mm : 40.5 mm : 6"}, "solve", {"eccentricity": (0.0, -150e-6)}),
        ("paper_n10", {"petals.thickness": "0.15 mm : 0.2 mm : 4", "operation.speed": "0.9 : 1.1 : 2"}, "balance", {}),
        ("paper_n8", {"petals.arc_length": "44.8 mm : 45.2 mm : 5"}, "coefficients", {"load": 20.0}),
        ("plain_journal", {"bearing.journal_radius": "24.95 mm : 24.953 mm : 4"}, "balance", {"load": 50.0}),
        ("bump_foil", {"bump_foil.foundation_stiffness": "3 GPa/m : 5 GPa/m : 4"}, "balance", {"load": 50.0}),
        ("rig", {"petals.thickness": "0.148 mm : 0.152 mm : 6"}, "balance", {"load": 46.4}),
    ],
)
def test_many_bearings_have_the_same_answers(
    name: str, vary: dict[str, str], verb: str, arguments: dict[str, object]
) -> None:
    bearing = case(name, **{"model.cells_per_pitch": 24})
    if "operation.speed" in vary:
        speed = bearing.operation.speed
        vary, arguments = {**vary, "operation.speed": f"{0.9 * speed} : {1.1 * speed} : 2"}, {"load": 20.0}
    alone = sweep(bearing, vary, verb, execution=ALONE, **arguments)
    found = sweep(bearing, vary, verb, execution=BESIDE, **arguments)
    light = 3.0 if name == "paper_n6" else 1.0  # 0.7 N are left of pressures that cancel around the journal
    assert_same_answers(found, alone, light * 1e-9)
    assert from_neighbours(found) > 0


def test_the_nearest_of_the_same_size_is_chosen_while_it_is_quicker() -> None:
    assert apart({"a": 1.0, "b": 2.0}, {"a": 1.1, "b": 2.0}) < apart({"a": 1.0, "b": 2.0}, {"a": 1.0, "b": 3.0})
    assert apart({"a": 1.0}, {"b": 1.0}) == 2.0
    slow = Memory(seconds=2.0, answers=TRIALS, tried=TRIALS, cold_seconds=1.0, cold=10)
    assert not slow.is_quicker
    assert replace(slow, cold_seconds=10.0).is_quicker
    assert not replace(slow, answers=0, cold_seconds=10.0).is_quicker
    assert Memory().is_quicker
