"""The verbs as functions hand their arguments on in SI units; what the analyses answer is tested with them."""

import math
from typing import Any

import pytest

import petalfoil
from petalfoil.errors import PetalfoilError, UnitError, UsageError
from tests.cases import EXAMPLES, case

PLAIN = case("plain_journal")


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch) -> list[tuple[tuple[Any, ...], dict[str, Any]]]:
    """Arguments that reached an analysis; the answers are labels instead of results."""
    calls: list[tuple[tuple[Any, ...], dict[str, Any]]] = []

    def analysis(*args: Any, **kwargs: Any) -> list[str]:
        calls.append((args, kwargs))
        return ["record"]

    for target in ("equilibrium.run", "load_curve.iterate", "static.iterate", "check.run", "grid_study.run"):
        monkeypatch.setattr(f"petalfoil.analysis.{target}", analysis)
    monkeypatch.setattr("petalfoil.results.dataset.to_dataset", lambda record: record)
    monkeypatch.setattr("petalfoil.analysis.grid_study.table", lambda records: f"estimates of {records[0]}")
    monkeypatch.setattr("petalfoil.analysis.grid_study.error_bars", lambda record, progress: {"bearing_force": 0.5})
    for target in ("study_dataset", "with_error_bars"):
        monkeypatch.setattr(f"petalfoil.results.study.{target}", lambda *both: both)
    monkeypatch.setattr("petalfoil.results.dataset.curve_dataset", lambda records, analysis: (records, analysis))
    return calls


def test_solve(called: list[Any]) -> None:
    assert petalfoil.solve(PLAIN) == ["record"]
    assert called.pop() == ((PLAIN,), {"speed": None, "eccentricity": None, "progress": None})
    petalfoil.solve(PLAIN, speed="60 rpm", eccentricity=("1 um", -2e-6), progress=print)
    _, kwargs = called.pop()
    assert kwargs["speed"] == pytest.approx(2 * math.pi, rel=1e-15)
    assert kwargs["eccentricity"] == (1e-6, -2e-6)
    assert kwargs["progress"] is print
    petalfoil.solve(PLAIN, eccentricity="0 um, -5 um")
    assert called.pop()[1]["eccentricity"] == (0.0, -5e-6)


def test_curve(called: list[Any]) -> None:
    assert petalfoil.curve(PLAIN, "0 um : 10 um : 3", speed=100) == (["record"], "curve")
    args, kwargs = called.pop()
    assert args == (PLAIN, [0.0, 5e-6, 1e-5])
    assert kwargs == {"direction": -math.pi / 2, "speed": 100.0, "progress": None}
    petalfoil.curve(PLAIN, [0, "1 um"], direction="45 deg")
    args, kwargs = called.pop()
    assert args == (PLAIN, [0.0, 1e-6])
    assert kwargs["direction"] == math.pi / 4


def test_static(called: list[Any]) -> None:
    assert petalfoil.static(PLAIN) == (["record"], "static")
    assert called.pop() == ((PLAIN, [0.0]), {"direction": -math.pi / 2, "loop": False, "progress": None})


def test_check(called: list[Any]) -> None:
    assert petalfoil.check(PLAIN) == ["record"]
    assert called.pop() == ((PLAIN,), {})


def test_converge(called: list[Any]) -> None:
    assert petalfoil.converge(PLAIN) == (["record"], "estimates of record")
    args, kwargs = called.pop()
    assert args == (PLAIN,)
    assert kwargs == {"speed": None, "eccentricity": None, "levels": 3, "coarsest": None, "progress": None}
    petalfoil.converge(PLAIN, speed=5, eccentricity=("1 um", 0), levels=2, coarsest=24)
    _, kwargs = called.pop()
    assert (kwargs["speed"], kwargs["eccentricity"], kwargs["levels"], kwargs["coarsest"]) == (5.0, (1e-6, 0.0), 2, 24)


def test_solve_with_error_bars(called: list[Any]) -> None:
    assert petalfoil.solve(PLAIN, error=True) == (["record"], {"bearing_force": 0.5})


@pytest.mark.parametrize(
    ("verb", "args", "kwargs", "error", "reason"),
    [
        ("solve", (str(EXAMPLES / "rig.toml"),), {}, UsageError, "Case.load"),
        ("check", (None,), {}, UsageError, "is not a Case"),
        ("solve", (PLAIN,), {"speed": "60 Hz"}, UnitError, "rpm"),
        ("solve", (PLAIN,), {"speed": True}, UnitError, "angular speed"),
        ("solve", (PLAIN,), {"eccentricity": (1e-6,)}, UsageError, "not a pair"),
        ("solve", (PLAIN,), {"eccentricity": 1e-6}, UsageError, "not a pair"),
        ("curve", (PLAIN, []), {}, UsageError, "at least one"),
        ("curve", (PLAIN, 1e-6), {}, UsageError, "not a list"),
        ("curve", (PLAIN, "0 um : 1 um"), {}, UsageError, "start : stop : count"),
        ("static", (PLAIN,), {"direction": "1 m"}, UnitError, "an angle"),
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
