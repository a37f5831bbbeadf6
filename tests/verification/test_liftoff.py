"""Lift-off, touch-down and run-up: brackets, load, hysteresis, both legs through contact."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis import known_verbs
from petalfoil.analysis.balance import balance
from petalfoil.analysis.crossings import CONTACT_FRACTION, PRECISION, crossings
from petalfoil.analysis.friction_told import RELAXED
from petalfoil.analysis.liftoff import in_words, liftoff
from petalfoil.analysis.runup import runup
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import UsageError
from petalfoil.results.record import Record
from petalfoil.results.tables import tables_of
from tests.cases import case

BEARING = case("paper_n8", **{"model.cells_per_pitch": 32, "operation.speed": 1000.0})


def number(record: Record, name: str) -> float:
    return float(record.scalars[name])


def share(speed: float, load: float) -> float:
    """Share of the contacts of a cold balance."""
    return float(balance.record(BEARING, (0.0, -load), speed=speed).scalars["contact_fraction"])


LOAD = 40.0  # N


@pytest.fixture(scope="module")
def lifted() -> Record:
    (record,) = liftoff.records(BEARING, [LOAD])
    return record


@pytest.mark.slow
def test_the_share_is_crossed_within_a_hundred_thousandth_of_the_speed(lifted: Record) -> None:
    for name in ("liftoff_speed", "touchdown_speed"):
        speed = number(lifted, name)
        half = 1e-5  # interpolated in a bracket a hundred times as wide
        assert share(speed * (1.0 - half), LOAD) > CONTACT_FRACTION >= share(speed * (1.0 + half), LOAD)


@pytest.mark.slow
def test_a_heavier_load_lifts_off_later(lifted: Record) -> None:
    """Where load rules and not preload: above 10 N on the paper's eight petals."""
    near = BEARING.replace(**{"operation.speed": number(lifted, "liftoff_speed")})
    lines = (SpeedLine(near, (0.0, -load)) for load in (0.8 * LOAD, 1.25 * LOAD))
    lighter, heavier = (crossings(line, CONTACT_FRACTION)[0] for line in lines)
    assert lighter < number(lifted, "liftoff_speed") < heavier


@pytest.mark.slow
def test_from_below_and_from_above_the_same_crossings_are_found(lifted: Record) -> None:
    """The case touches at its own speed, so that `lifted` ascended first; a faster one descends first."""
    faster = BEARING.replace(**{"operation.speed": 1.3 * number(lifted, "liftoff_speed")})
    assert share(BEARING.operation.speed, LOAD) > CONTACT_FRACTION >= share(faster.operation.speed, LOAD)
    found = crossings(SpeedLine(faster, (0.0, -LOAD)), CONTACT_FRACTION)
    wanted = [number(lifted, name) for name in ("liftoff_speed", "touchdown_speed")]
    assert_allclose(found, wanted, rtol=1e-5, atol=0.0)


@pytest.mark.slow
def test_the_width_of_the_bracket_matters_to_no_result(lifted: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    """What rounding may do, too: another bracket about the same crossing."""
    monkeypatch.setattr("petalfoil.analysis.crossings.PRECISION", 0.7 * PRECISION)
    (other,) = liftoff.records(BEARING, [LOAD])
    for name in ("liftoff_speed", "touchdown_speed"):
        assert number(other, name) == pytest.approx(number(lifted, name), rel=1e-6)
    for name in ("liftoff_by_contact_film_thickness", "liftoff_by_contact_fraction"):
        assert number(other, name) == pytest.approx(number(lifted, name), rel=1e-4)


@pytest.mark.slow
def test_sensitivity_is_that_of_another_floor_and_share(lifted: Record) -> None:
    up, factor = number(lifted, "liftoff_speed"), 0.9
    near = BEARING.replace(
        **{"operation.speed": up, "surface.contact_film_thickness": factor * BEARING.surface.contact_film_thickness}
    )
    by_floor = math.log(crossings(SpeedLine(near, (0.0, -LOAD)), CONTACT_FRACTION)[0] / up) / math.log(factor)
    assert_allclose(number(lifted, "liftoff_by_contact_film_thickness"), by_floor, rtol=0.0, atol=0.05)
    assert -0.2 < number(lifted, "liftoff_by_contact_fraction") < 0.0  # a smaller share is reached later, if little


@pytest.mark.slow
def test_an_overload_never_floats() -> None:
    (record,) = liftoff.records(BEARING, [400.0])
    assert record.converged
    assert number(record, "liftoff_speed") == number(record, "touchdown_speed") == math.inf
    assert "does not lift off" in str(record.scalars["status"])
    assert math.isnan(number(record, "liftoff_by_contact_film_thickness"))


@pytest.mark.parametrize(
    ("loads", "least", "reason"),
    [([-1.0], 0.01, "greater than 0 N"), ([], 0.01, "at least one"), ([1.0], 1.0, "less than 1")],
)
def test_what_cannot_be_asked(loads: list[float], least: float, reason: str) -> None:
    with pytest.raises(UsageError, match=reason):
        liftoff.records(BEARING, loads, contact_fraction=least)


def test_a_plain_bearing_has_no_pack_to_lift_off_from() -> None:
    for asked in (
        lambda: liftoff.records(case("plain_journal"), [1.0]),
        lambda: runup.records(case("plain_journal"), (0.0, -1.0), to=100.0),
    ):
        with pytest.raises(UsageError, match=r"\[petals\]"):
            asked()


@pytest.mark.slow
@pytest.mark.parametrize("name", [pytest.param("paper_n6", marks=pytest.mark.long), "paper_n8", "paper_n10"])
def test_continuous_edges_lift_off_too(name: str) -> None:
    """Balances there may be unstable in the time of the gas: the march with a damped wall finds them."""
    (record,) = liftoff.records(case(name, **{"model.cells_per_pitch": 24, "model.edges": "continuous"}), [15.0])
    assert record.scalars["status"] == "converged"
    assert 0.0 < number(record, "touchdown_speed") < math.inf


# ---------------------------------------------------------------------------------------------- run-up


@pytest.fixture(scope="module")
def legs() -> dict[str, list[Record]]:
    found: dict[str, list[Record]] = {"up": [], "down": []}
    for record in runup.records(BEARING, (0.0, -20.0), to=9000.0, points=9):
        found[str(record.scalars["leg"])].append(record)
    return found


@pytest.mark.slow
def test_both_legs_are_followed_through_contact(legs: dict[str, list[Record]]) -> None:
    assert [len(legs[leg]) for leg in ("up", "down")] == [9, 8]
    every = [*legs["up"], *legs["down"]]
    assert all(record.converged for record in every)
    assert all(number(record, "force_residual") <= 1e-8 for record in every)
    for leg, sign in (("up", -1.0), ("down", 1.0)):
        shares = [number(record, "contact_fraction") for record in legs[leg]]
        assert np.all(sign * np.diff(shares) >= 0.0)
    assert number(legs["up"][0], "contact_fraction") == 1.0
    assert number(legs["up"][-1], "contact_fraction") == 0.0


def test_a_run_up_begins_with_dry_friction_and_passes_a_least_torque(legs: dict[str, list[Record]]) -> None:
    rest = legs["up"][0]
    dry = BEARING.surface.friction_coefficient * BEARING.bearing.journal_radius * number(rest, "contact_normal_force")
    assert_allclose(number(rest, "friction_torque"), dry, rtol=1e-9, atol=0.0)
    torques = [number(record, "friction_torque") for record in legs["up"]]
    assert 0 < int(np.argmin(torques)) < len(torques) - 1


def test_the_way_down_returns_where_nothing_snaps(legs: dict[str, list[Record]]) -> None:
    """On the paper's bearing both legs meet at every speed."""
    for up, down in zip(legs["up"][:-1], reversed(legs["down"]), strict=True):
        assert up.scalars["speed"] == down.scalars["speed"]
        assert_allclose(number(up, "eccentricity_y"), number(down, "eccentricity_y"), rtol=1e-6, atol=0.0)


@pytest.mark.slow
def test_a_line_of_speeds_is_warm() -> None:
    run = current_run()
    line = SpeedLine(BEARING, (0.0, -20.0))
    line.at(3000.0)
    counts = []
    for speed in np.linspace(2950.0, 2500.0, 10):
        before = run.film.factorizations
        line.at(float(speed))
        counts.append(run.film.factorizations - before)
    assert np.median(counts) <= 6


@pytest.mark.slow
def test_where_a_pack_with_friction_lifts_off_does_not_hang_on_the_speed_of_the_case() -> None:
    """It is assembled, loaded at rest and run up whether the case's speed is below or above that of lift-off."""
    changes = {"model.cells_per_pitch": 12, "surface.petal_friction": 0.1, "surface.friction_history": "assembled"}
    for_speeds = (case("paper_n8", **changes, **{"operation.speed": speed}) for speed in (1000.0, 8000.0))
    found = [crossings(SpeedLine(kept, (0.0, -5.0)), CONTACT_FRACTION) for kept in for_speeds]
    assert_allclose(found[1][0], found[0][0], rtol=2e-4)  # a path is of first order in its steps
    assert all(down < (1.0 - 2e-3) * up for up, down in found)


@pytest.mark.slow
def test_a_relaxed_pack_lifts_off_and_touches_down_at_one_speed_and_says_why() -> None:
    relaxed = case("paper_n8", **{"model.cells_per_pitch": 12, "surface.petal_friction": 0.1})
    verb = known_verbs.find("liftoff")
    assert verb is not None
    run = verb.start(relaxed, {"loads": [5.0]})
    for _ in verb.advance(run):
        pass
    *_, told = tables_of(verb.answer(run))
    assert dict((line[0], line[1]) for line in told.lines) == {
        "petal friction": RELAXED,
        "touchdown": "at the speed of lift-off: downward the same equilibria are met as upward",
    }


class Line:
    """Contact fractions over speed, as a line of balances gives them."""

    path = None

    def __init__(self, fraction: Callable[[float], float]) -> None:
        self.case, self.known, self.fraction = BEARING, None, fraction

    def contact_fraction(self, speed: float) -> float:
        """That at `speed` [rad/s]."""
        self.known = speed
        return self.fraction(speed)


@pytest.mark.parametrize(
    ("fraction", "up", "down"),
    [
        (lambda speed: 12.0 / speed, 1200.0, 1200.0),
        (lambda speed: 8.0 / speed, 800.0, 800.0),
        (lambda speed: 1.0, math.inf, math.inf),
        (lambda speed: 0.0, 0.0, 0.0),
    ],
)
def test_crossings_of_given_fractions(fraction: Callable[[float], float], up: float, down: float) -> None:
    assert_allclose(crossings(cast("SpeedLine", Line(fraction)), 0.01), (up, down), rtol=1e-3)


def test_a_journal_that_stays_off_has_no_touchdown_speed() -> None:
    """Off on another branch: this is not said to be the speed of lift-off."""
    seen = [0.0]

    def fraction(speed: float) -> float:
        seen.append(speed)
        return 0.0 if max(seen) > 1500.0 else 12.0 / speed

    up, down = crossings(cast("SpeedLine", Line(fraction)), 0.01)
    assert up == pytest.approx(1200.0, rel=1e-3)
    assert down == 0.0
    assert in_words(BEARING, up, down) == "does not touch down above 10 rpm"
