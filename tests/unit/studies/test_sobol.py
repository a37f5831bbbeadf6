"""Sobol' indices against closed forms, and of a bearing."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import pytest

from petalfoil.case import parameter_of
from petalfoil.errors import UsageError
from petalfoil.studies.plan import points_at
from petalfoil.studies.question import CONVERGED, NOT_CONVERGED, CaseOutcome, Question
from petalfoil.studies.run import Execution
from petalfoil.studies.sobol import indices, plan_of, sobol_indices, sobol_study
from petalfoil.studies.variation import Interval
from tests.cases import case

PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 16})
PAPER = case("paper_n8")
ISHIGAMI = {"S1": (0.31391, 0.44241, 0.0), "ST": (0.55759, 0.44241, 0.24368)}
"""Of Ishigami's function with a = 7, b = 0.1 (Homma and Saltelli 1996)."""


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studies.study_page.write_page", lambda folder, ds: None)


def ishigami(points: Sequence[dict[str, float | int]], fail: Sequence[int] = ()) -> list[CaseOutcome]:
    found = []
    for number, point in enumerate(points):
        x, y, z = (np.pi * (2.0 * float(value) - 1.0) for value in point.values())
        force = float(np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x))
        status = NOT_CONVERGED if number in fail else CONVERGED
        found.append(CaseOutcome("", dict(point), status, records=[{"bearing_force": force}]))
    return found


def unit_study() -> tuple[tuple[Interval, ...], list[dict[str, float | int]]]:
    paths = ("petals.thickness", "petals.arc_length", "petals.bend_radius")
    variations = tuple(Interval(parameter_of(PAPER, path), 0.0, 1.0) for path in paths)
    from SALib.sample import sobol

    problem = {"num_vars": 3, "names": list(paths), "bounds": [[0.0, 1.0]] * 3}
    return variations, points_at(variations, sobol.sample(problem, 1024, calc_second_order=False, seed=0))


def test_indices_of_a_known_function() -> None:
    variations, points = unit_study()
    told = indices(variations, ishigami(points), "bearing_force", seed=0)
    assert (told["blocks"], told["answered"]) == (1024, 1024)
    assert told["variance"] == pytest.approx(13.8446, rel=0.02)
    for number, variation in enumerate(variations):
        for key, known in ISHIGAMI.items():
            found = told["parameters"][variation.path]
            assert found[key] == pytest.approx(known[number], abs=max(0.01, found[f"{key}_conf"]))


@pytest.mark.slow
def test_blocks_without_an_answer_are_left_out_and_told() -> None:
    variations, points = unit_study()
    told = indices(variations, ishigami(points, fail=range(7, 100)), "bearing_force", seed=0)
    assert (told["blocks"], told["answered"]) == (1024, 1024 - 19)
    assert told["parameters"]["petals.thickness"]["ST"] == pytest.approx(0.5576, abs=0.08)
    few = indices(variations, ishigami(points, fail=range(10, 5120)), "bearing_force", seed=0)
    assert few["parameters"] == {}


@pytest.mark.slow
def test_the_indices_of_a_bearing_add_up_where_it_is_nearly_linear() -> None:
    vary = {"gas.viscosity": "± 2 %", "operation.speed": "3900 rad/s : 4100 rad/s"}
    ds = sobol_indices(PLAIN, vary, samples=16, execution=Execution(workers=0), eccentricity=(0.0, -5e-6))
    told = json.loads(ds.attrs["sobol"])["bearing_force"]
    assert ds.sizes["case"] == 64
    first = [one["S1"] for one in told["parameters"].values()]
    assert sum(first) == pytest.approx(1.0, abs=0.35)
    assert told["parameters"]["operation.speed"]["ST"] > told["parameters"]["gas.viscosity"]["ST"]


@pytest.mark.parametrize("samples", [0, 7, 100])
def test_samples_are_a_power_of_two(samples: int) -> None:
    with pytest.raises(UsageError, match="not a power of two from 8 on"):
        sobol_study(PLAIN, {"gas.viscosity": "± 2 %"}, Question("solve"), samples=samples)


def test_a_sample_has_one_case_for_each_parameter_and_two_more() -> None:
    study = sobol_study(
        PLAIN, {"gas.viscosity": "± 2 %", "bearing.length": "40 mm : 60 mm"}, Question("solve"), samples=8
    )
    assert len(plan_of(study).points) == 8 * 4
