"""The search for a threshold speed ends with a speed, whatever the margin does between its ends."""

import pytest

from petalfoil.analysis.threshold import PRECISION, neutral_speed

KNOWN, AHEAD = (100.0, 0.4), (130.0, -0.5)


def test_a_margin_that_crosses_zero() -> None:
    speed, remark = neutral_speed(lambda speed: 0.03 * (113.0 - speed), KNOWN, AHEAD)
    assert speed == pytest.approx(113.0, rel=PRECISION)
    assert remark == ""


def test_a_margin_that_differs_where_it_is_followed_from_the_other_side() -> None:
    """At both ends it is negative when followed downward: the sign found first stands."""
    speed, remark = neutral_speed(lambda _: -0.5, KNOWN, AHEAD)
    assert speed == pytest.approx(100.0, rel=PRECISION)
    assert "jumps" in remark


def test_a_critical_mass_that_jumps() -> None:
    speed, remark = neutral_speed(lambda speed: 50.0 if speed < 120.0 else -0.5, KNOWN, AHEAD)
    assert speed == pytest.approx(120.0, rel=PRECISION)
    assert "jumps" in remark
