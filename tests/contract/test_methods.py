"""Every method answers the same questions with the same record, and says so where it does not."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from petalfoil.analysis.balance import balance
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.curve import curve
from petalfoil.analysis.liftoff import liftoff
from petalfoil.analysis.runup import runup
from petalfoil.analysis.solve import solve
from petalfoil.analysis.stability import stability
from petalfoil.analysis.static import static
from petalfoil.case import Case, Method
from petalfoil.classic import ClassicOptions
from petalfoil.cli.app import app
from petalfoil.errors import UsageError
from petalfoil.results.dataset import to_dataset
from tests.cases import case

METHODS = pytest.mark.parametrize("method", Method)
COMPILED = pytest.mark.parametrize(
    "method", [pytest.param(one, marks=pytest.mark.compiled if one is Method.CLASSIC else ()) for one in Method]
)
"""The same for questions that take the classic method long in NumPy."""


def bearing(method: Method) -> Case:
    return case("paper_n8", **{"model.cells_per_pitch": 8, "model.method": method})


@pytest.mark.slow
@pytest.mark.compiled
def test_the_records_of_all_methods_are_alike() -> None:
    at_nodes = [bearing(method).replace(**{"model.contacts": "nodes"}) for method in Method]  # as `classic` has them
    records = [solve.record(one) for one in at_nodes]
    for part in ("scalars", "fields", "coords"):
        keys = [[key for key in getattr(record, part) if key != "known_equilibria"] for record in records]
        assert all(found == keys[0] for found in keys)
    counted = [method for method, record in zip(Method, records, strict=True) if "known_equilibria" in record.scalars]
    assert counted == [method for method in Method if method is not Method.CLASSIC]  # which looks for no others
    assert all(record.history for record in records)
    assert len({str(record.scalars["solution_path"]) for record in records}) == len(records)


@COMPILED
def test_a_record_becomes_data_with_the_case_in_it(method: Method) -> None:
    data = to_dataset(solve.record(bearing(method)))
    assert Case.from_toml(data.attrs["case"]).model.method is method
    assert bool(data["converged"])
    assert int(data["iterations"]) > 0


@COMPILED
def test_a_curve_goes_from_point_to_point(method: Method) -> None:
    told: list[float] = []
    records = list(curve.records(bearing(method), (0.0, 50e-6, 100e-6), progress=lambda share, _: told.append(share)))
    assert all(record.converged for record in records)
    assert [record.scalars["jump"] for record in records] == [False] * 3
    assert "neighbour" in str(records[2].scalars["solution_path"])
    assert told == sorted(told)
    assert 0.0 <= told[0] < told[-1] <= 1.0


@METHODS
def test_the_pack_at_rest(method: Method) -> None:
    (record,) = static.records(bearing(method))
    assert record.converged
    assert float(record.scalars["starting_torque"]) > 0.0


def limited(monkeypatch: pytest.MonkeyPatch, **limits: int) -> None:
    """Options of runs that cannot end."""

    def few_steps(options: ClassicOptions) -> None:
        for field in dataclasses.fields(ClassicOptions):
            object.__setattr__(options, field.name, limits.get(field.name, field.default))

    monkeypatch.setattr(ClassicOptions, "__init__", few_steps)


@pytest.mark.compiled
def test_a_method_that_runs_out_of_steps_says_so_with_advice(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    limited(monkeypatch, max_outer=3)
    path = tmp_path / "case.toml"
    path.write_text(bearing(Method.CLASSIC).to_toml(), encoding="utf-8")
    result = CliRunner().invoke(app, ["solve", str(path)])
    assert result.exit_code == 3
    assert "used up its outer steps" in result.stderr
    assert "newton" in result.stderr
    shown = CliRunner().invoke(app, ["curve", str(path), "--eccentricity", "0 um : 50 um : 2", "--json"])
    points = json.loads(shown.stdout)["points"]
    assert [point["converged"] for point in points] == [False, False]
    assert all("bearing_force" not in point or point["bearing_force"] is None for point in points)


def test_a_pack_that_runs_out_of_steps_is_a_failed_point(monkeypatch: pytest.MonkeyPatch) -> None:
    limited(monkeypatch, max_pack_steps=200)
    (record,) = static.records(bearing(Method.CLASSIC))
    assert not record.converged
    assert "used up its pack steps" in str(record.history[-1]["outcome"])


ASKS_FOR_NEWTON: dict[str, Callable[[Case], object]] = {
    "balance": lambda case: balance.record(case, (0.0, -5.0)),
    "coefficients": lambda case: coefficients.record(case),
    "coefficients at speeds": lambda case: coefficients.records(case, speeds=(8000.0,)),
    "stability": lambda case: stability.record(case),
    "liftoff": lambda case: liftoff.records(case, (5.0,)),
    "runup": lambda case: runup.records(case, (0.0, -5.0), to=8000.0),
}


@pytest.mark.parametrize("question", ASKS_FOR_NEWTON)
def test_questions_that_need_a_tangent_ask_for_newton(question: str) -> None:
    with pytest.raises(UsageError, match=r'model.method = "newton"'):
        ASKS_FOR_NEWTON[question](bearing(Method.CLASSIC))
