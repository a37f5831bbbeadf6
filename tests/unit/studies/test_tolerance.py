"""Scatter: moments and probabilities against closed forms, and a bearing whose answer is linear."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from petalfoil.analysis.sensitivity import sensitivity
from petalfoil.case import Case
from petalfoil.errors import UnitError, UsageError
from petalfoil.studies.gradients import derivative_question
from petalfoil.studies.limits import ResultLimit, unit_of
from petalfoil.studies.plan import unit_sample
from petalfoil.studies.question import CONVERGED, NOT_CONVERGED, CaseOutcome, Question
from petalfoil.studies.run import Execution
from petalfoil.studies.sweep import sweep
from petalfoil.studies.tolerance import kept, statistics, tolerance
from petalfoil.studies.variation import read_scatter
from tests.cases import case

REFERENCE = Path(__file__).parents[2] / "verification" / "reference" / "r7_scatter.csv"
PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 16})
ALONE = Execution(workers=0)
FloatArray = NDArray[np.float64]


@pytest.fixture(autouse=True)
def _no_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studies.study_page.write_page", lambda folder, ds: None)


def reference() -> list[dict[str, str]]:
    """Springs round a circle whose stiffness scatters as the cube of their thickness: closed forms."""
    with REFERENCE.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def springs(row: dict[str, str]) -> tuple[FloatArray, FloatArray]:
    """Stiffness and preload (petal, draw) over their nominal values, drawn as in a tolerance study."""
    petals, bearing = int(row["n"]), case("paper_n8")
    (thickness,) = read_scatter(bearing, "petals.thickness", f"normal {100.0 * float(row['s'])} %")
    independent = row["mode"] == "k and d independent"
    unit = unit_sample("sobol", 4096, 2 * petals if independent else petals, seed=7)
    drawn = np.array([thickness.at(unit[:, petal]) for petal in range(petals)]) / thickness.nominal
    preload = np.full_like(drawn, float(row["d0"]))
    if independent:
        (bend,) = read_scatter(bearing, "petals.bend_radius", f"normal {100.0 * float(row['sd'])} %")
        preload *= np.array([bend.at(unit[:, petals + petal]) for petal in range(petals)]) / bend.nominal
    elif row["mode"] != "k only":  # a thicker petal is pressed in further
        preload += 3.0 * preload * (drawn - 1.0)
    return drawn**3, preload


@pytest.mark.parametrize("row", reference(), ids=lambda row: f"{row['n']} springs, s={row['s']}, {row['mode']}")
def test_springs_of_scattered_thickness_and_preload(row: dict[str, str]) -> None:
    stiffness, preload = springs(row)
    petals = len(stiffness)
    angles = 2.0 * np.pi * np.arange(petals) / petals
    pushes = stiffness * preload
    force = np.hypot(pushes.T @ np.cos(angles), pushes.T @ np.sin(angles))
    told = statistics(stiffness[0])
    assert abs(told["mean"] - float(row["E k/k0"])) < 2.0 * told["standard_error"]
    assert told["standard_deviation"] ** 2 == pytest.approx(float(row["Var k/k0^2"]), rel=0.02)
    assert statistics(pushes[0])["standard_deviation"] ** 2 == pytest.approx(float(row["Var(kd)/(k0 d0)^2"]), rel=0.02)
    rms = math.sqrt(float((force**2).mean()))
    assert rms == pytest.approx(float(row["rms |F|/(k0 d0)"]), rel=0.02)
    assert statistics(force)["mean"] == pytest.approx(float(row["mean|F| MC"]), rel=0.02)
    across = statistics(stiffness.T @ np.cos(angles) ** 2)["standard_deviation"]
    assert across == pytest.approx(float(row["std Kxx/(k0)"]), rel=0.02)
    assert 2.0 * rms / petals == pytest.approx(float(row["rms e/d0 first order"]), rel=0.02)


def test_quantiles_are_those_of_the_sample() -> None:
    told = statistics(np.array([1.0, 2.0, 3.0, 4.0, math.inf, math.nan]))
    assert (told["mean"], told["quantile_50"], told["quantile_95"]) == (2.5, 3.0, math.inf)


def outcomes(*values: float | None) -> list[CaseOutcome]:
    """Cases with these films; None of one without an answer."""
    return [
        CaseOutcome(str(number), {}, CONVERGED, records=[{"min_film_thickness": value}])
        if value is not None
        else CaseOutcome(str(number), {}, NOT_CONVERGED)
        for number, value in enumerate(values)
    ]


def test_the_interval_of_a_probability_is_that_of_clopper_and_pearson() -> None:
    limit = ResultLimit.read("min_film_thickness > 5 um")
    found = kept(limit, outcomes(*[6e-6] * 8, 4e-6, None))
    assert found["probability"] == 0.8
    assert (found["low"], found["high"]) == pytest.approx((0.44390, 0.97479), abs=2e-5)  # tables of 8 in 10
    assert found["without_answer"] == 1
    assert kept(limit, outcomes(*[6e-6] * 10))["low"] == pytest.approx(0.025 ** (1 / 10), rel=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("min_film_thicknes > 5 um", "Did you mean 'min_film_thickness'?"),
        ("min_film_thickness = 5 um", "is no limit"),
        ("min_film_thickness > 5 N", "min_film_thickness: '5 N' measures something else"),
        ("status > 5", "is no result"),
    ],
)
def test_a_limit_that_cannot_be_is_refused(text: str, words: str) -> None:
    with pytest.raises((UsageError, UnitError)) as refused:
        ResultLimit.read(text)
    assert words in str(refused.value)


def test_limits_have_units() -> None:
    assert ResultLimit.read("liftoff_speed < 15000 rpm").value == pytest.approx(500.0 * math.pi, rel=1e-15)
    assert ResultLimit.read("contact_fraction <= 5 %").value == pytest.approx(0.05, rel=1e-15)
    assert ResultLimit.read("friction_torque < 20 mN*m").value == pytest.approx(0.02, rel=1e-15)
    assert (unit_of("side_leakage"), unit_of("growth_rate"), unit_of("overlap")) == ("kg/s", "1/s", "1")


@pytest.mark.slow
def test_a_small_scatter_is_linear() -> None:
    scatter = {"gas.viscosity": "normal 0.1 %", "bearing.journal_radius": "± 5 nm"}
    ds = tolerance(
        PLAIN, scatter, "solve", limits=["bearing_force > 1 N"], samples=64, execution=ALONE, eccentricity=(0.0, -20e-6)
    )
    told = json.loads(ds.attrs["tolerance"])
    force = told["results"]["bearing_force"]
    assert ds["bearing_force"].dims == ("case",)
    assert force["mean"] == pytest.approx(force["nominal"], rel=1e-4)
    assert force["standard_deviation"] == pytest.approx(force["first_order_standard_deviation"], rel=0.05)
    assert abs(force["effects"]["gas.viscosity"]) > 0.0
    (limit,) = told["limits"]
    assert (limit["probability"], limit["without_answer"]) == (1.0, 0)


def test_a_result_that_the_analysis_does_not_give_is_refused_after_one_case(monkeypatch: pytest.MonkeyPatch) -> None:
    from petalfoil.studies import case_engine

    asked: list[str] = []
    real = case_engine.answered
    monkeypatch.setattr(case_engine, "answered", lambda task: asked.append(task.key) or real(task))
    with pytest.raises(UsageError, match="solve gives no liftoff_speed; it gives "):
        tolerance(PLAIN, {"gas.viscosity": "± 1 %"}, limits=["liftoff_speed < 1 rpm"], samples=16, execution=ALONE)
    assert len(asked) == 1


def first_order(scatter: dict[str, str], ask: str, bearing: Case = PLAIN, **arguments: Any) -> dict[str, Any]:
    ds = tolerance(bearing, scatter, ask, samples=2, execution=ALONE, **arguments)
    told: dict[str, Any] = json.loads(ds.attrs["tolerance"])
    return told


@pytest.mark.slow
def test_the_first_order_is_that_of_exact_derivatives() -> None:
    """Beside differences over a scatter so small that nothing is curved: the same effects, petal by petal."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 8})
    scatter = {"petals.thickness": "normal 0.1 nm each", "gas.viscosity": "normal 0.001 %"}
    told = first_order(scatter, "balance", bearing, load=20.0)
    assert told["first_order_by"] == "exact derivatives"
    film = told["results"]["min_film_thickness"]
    sides = [bearing.gas.viscosity * (1.0 + part) for part in (-1e-5, 1e-5)]
    films = sweep(bearing, {"gas.viscosity": sides}, "balance", load=20.0, execution=ALONE)["min_film_thickness"].values
    effects = film["effects"]
    assert len(effects) == 9
    assert effects["gas.viscosity"] == pytest.approx(0.5 * (films[1] - films[0]), rel=1e-2)
    assert film["first_order_standard_deviation"] == pytest.approx(math.hypot(*effects.values()), rel=1e-12)
    assert math.isfinite(effects["petals.thickness[2]"])


def test_an_analysis_without_derivatives_has_its_first_order_by_differences(monkeypatch: pytest.MonkeyPatch) -> None:
    scatter, place = {"gas.viscosity": "normal 0.01 %"}, (0.0, -5e-6)
    exact = first_order(scatter, "solve", eccentricity=place)
    monkeypatch.setattr("petalfoil.studies.gradients.DIFFERENTIABLE", ())
    told = first_order(scatter, "solve", eccentricity=place)
    assert (exact["first_order_by"], told["first_order_by"]) == ("exact derivatives", "differences")
    for name in ("bearing_force", "peak_pressure", "friction_torque"):
        effect = told["results"][name]["effects"]["gas.viscosity"]
        assert exact["results"][name]["effects"]["gas.viscosity"] == pytest.approx(effect, rel=1e-5)


def test_arguments_without_a_derivative_are_not_asked_for_one() -> None:
    bearing, by = case("paper_n8"), ["gas.viscosity"]
    assert derivative_question(bearing, Question("balance", {"moment": [0.0, 0.1]}), by, ["all"]) is None
    assert derivative_question(bearing, Question("liftoff", {"loads": [1.0, 2.0]}), by, ["all"]) is None
    asked = derivative_question(bearing, Question("liftoff", {"loads": [20.0]}), by, ["all"])
    assert asked is not None
    assert asked.arguments == {"load": 20.0, "ask": "liftoff", "vary": ["gas.viscosity"], "of": ["all"]}


@pytest.mark.slow
@pytest.mark.parametrize("contacts", ["nodes", "points"])
def test_derivatives_are_those_of_the_contacts_of_the_case(contacts: str) -> None:
    """Those of `sensitivity` with the same contacts, which differ by more than a hundredth from each other."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 16, "model.contacts": contacts})
    told = first_order({"petals.thickness": "normal 0.1 %"}, "balance", bearing, load=40.0)
    effect = told["results"]["min_film_thickness"]["effects"]["petals.thickness"]
    assert bearing.petals is not None
    slope = {
        place: float(
            sensitivity.record(
                bearing, ["petals.thickness"], ask="balance", of=["min_film_thickness"], load=40.0, contacts=place
            ).scalars["derivative_above"]
        )
        * 1e-3
        * float(bearing.petals.thickness)
        for place in ("nodes", "points")
    }
    assert abs(slope["nodes"] - slope["points"]) > 1e-2 * abs(slope["points"])
    assert effect == pytest.approx(slope[contacts], rel=1e-6)
