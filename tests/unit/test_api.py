"""The verbs as functions hand their arguments on in SI units; what the analyses answer is tested with them."""

import inspect
import math
from typing import Any
from unittest.mock import ANY

import pytest

import petalfoil
from petalfoil.analysis.known_verbs import find
from petalfoil.analysis.runs import Points
from petalfoil.errors import ConvergenceError, UnitError, UsageError
from petalfoil.results import Record
from petalfoil.results.layout import Series
from tests.cases import EXAMPLES, case
from tests.unit.cli.conftest import play

PLAIN = case("plain_journal")


Called = list[dict[str, Any]]


@pytest.fixture
def called(monkeypatch: pytest.MonkeyPatch) -> Called:
    """Arguments that reached an analysis, by name, defaults filled in."""
    calls: Called = []

    def answer(**given: Any) -> Points:
        calls.append(given)
        return Points(iter([Record(analysis="test", scalars={"speed": 1.0})]), 1)

    for verb in ("solve", "curve", "static", "check", "converge"):
        play(verb, answer, monkeypatch)
        monkeypatch.setattr(find(verb), "layouts", (Series(),))
    return calls


def test_solve(called: Called) -> None:
    petalfoil.solve(PLAIN)
    assert called.pop() == {"case": PLAIN, "speed": None, "eccentricity": None, "progress": ANY}
    petalfoil.solve(PLAIN, speed="60 rpm", eccentricity=("1 um", -2e-6), progress=print)
    given = called.pop()
    assert given["speed"] == pytest.approx(2 * math.pi, rel=1e-15)
    assert (given["eccentricity"], given["progress"]) == ((1e-6, -2e-6), print)
    petalfoil.solve(PLAIN, eccentricity="0 um, -5 um")
    assert called.pop()["eccentricity"] == (0.0, -5e-6)


def test_curve(called: Called) -> None:
    petalfoil.curve(PLAIN, "0 um : 10 um : 3", speed=100)
    given = called.pop()
    assert given == {
        "case": PLAIN,
        "eccentricities": [0.0, 5e-6, 1e-5],
        "direction": -math.pi / 2,
        "speed": 100.0,
        "progress": ANY,
    }
    petalfoil.curve(PLAIN, [0, "1 um"], direction="45 deg")
    given = called.pop()
    assert (given["eccentricities"], given["direction"]) == ([0.0, 1e-6], math.pi / 4)


def test_static(called: Called) -> None:
    petalfoil.static(PLAIN)
    given = called.pop()
    assert (list(given["eccentricities"]), given["direction"], given["loop"]) == ([0.0], -math.pi / 2, False)


def test_check(called: Called) -> None:
    petalfoil.check(PLAIN)
    assert called.pop() == {"case": PLAIN}


def test_converge(called: Called) -> None:
    petalfoil.converge(PLAIN)
    given = called.pop()
    assert (given["speed"], given["eccentricity"], given["levels"], given["coarsest"]) == (None, None, 3, None)
    petalfoil.converge(PLAIN, speed=5, eccentricity=("1 um", 0), levels="2", coarsest=24)
    given = called.pop()
    assert (given["speed"], given["eccentricity"], given["levels"], given["coarsest"]) == (5.0, (1e-6, 0.0), 2, 24)


def test_an_analysis_looks_like_its_function() -> None:
    assert list(inspect.signature(petalfoil.curve).parameters)[:3] == ["case", "eccentricities", "direction"]
    assert petalfoil.curve.__name__ == "curve"
    assert "Example: petalfoil curve" in str(petalfoil.curve.__doc__)
    assert "direction : NumberWithUnit, optional" in str(petalfoil.curve.__doc__)


def test_a_point_without_error_bars_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def one_grid(*_: object) -> None:
        raise ConvergenceError("one grid")

    play("solve", lambda **_: Record(analysis="solve", scalars={"speed": 1.0}), monkeypatch)
    monkeypatch.setattr("petalfoil.analysis.error_bars.error_bars", one_grid)
    with pytest.warns(UserWarning, match="no error bars: one grid"):
        petalfoil.solve(PLAIN, error=True)


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
        ("curve", (PLAIN, 1e-6, 1e-6), {}, TypeError, "positional"),
        ("curve", (PLAIN, "all"), {}, UnitError, "eccentricities: 'all' does not begin with a number"),
        ("converge", (PLAIN,), {"levels": 2.5}, UsageError, "levels: 2.5 is not a whole number"),
        ("converge", (PLAIN,), {"levels": True}, UsageError, "not a whole number"),
        ("solve", (PLAIN,), {"error": "yes"}, UsageError, "error: 'yes' is neither True nor False"),
        ("solve", (PLAIN,), {"speed": "-5 rpm"}, UsageError, "speed: '-5 rpm' is outside its range"),
        ("curve", (PLAIN, "0 um : 1 um"), {}, UsageError, "start : stop : count"),
        ("static", (PLAIN,), {"direction": "1 m"}, UnitError, "an angle"),
    ],
)
def test_bad_arguments_reach_no_analysis(
    called: Called,
    verb: str,
    args: tuple[Any, ...],
    kwargs: dict[str, Any],
    error: type[Exception],
    reason: str,
) -> None:
    with pytest.raises(error, match=reason):
        getattr(petalfoil, verb)(*args, **kwargs)
    assert called == []
