"""Texts of a speed that changes."""

from __future__ import annotations

import math

import pytest
from numpy.testing import assert_allclose

from petalfoil.errors import PetalfoilError, UnitError, UsageError
from petalfoil.units import parse_ramp

RPM = math.pi / 30.0


def test_a_ramp_begins_at_time_zero() -> None:
    assert_allclose(parse_ramp("0 rpm : 60000 rpm : 2 s"), [(0.0, 0.0), (2.0, 60000.0 * RPM)], rtol=1e-14, atol=0.0)


def test_segments_follow_each_other() -> None:
    up_hold_down = parse_ramp("0 : 6000 rpm : 500 ms, 100 rps : 6000 rpm : 1 s")
    assert_allclose(up_hold_down, [(0.0, 0.0), (0.5, 200.0 * math.pi), (1.5, 200.0 * math.pi)], rtol=1e-12, atol=0.0)


@pytest.mark.parametrize(
    ("text", "error", "reason"),
    [
        ("0 rpm : 60 rpm : -1 s", UsageError, "'0 rpm : 60 rpm : -1 s' goes back in time"),
        ("0 rpm : 60 rpm : 0 s", UsageError, "lasts no time"),
        ("0 : 10 : 1 s, 11 : 0 : 1 s", UsageError, "'11 : 0 : 1 s' does not join on: it begins at 11 rad/s"),
        ("0 rpm : 60 rpm", UsageError, "from : to : duration"),
        ("", UsageError, "from : to : duration"),
        ("0 : 10 : 1 s,", UsageError, "from : to : duration"),
        ("-10 : 10 : 1 s", UsageError, "negative speed"),
        ("0 rpm : 60 rpm : 1 m", UnitError, "a time, such as '10 ms'"),
        ("0 rpm : 60 N : 1 s", UnitError, "an angular speed"),
    ],
)
def test_a_ramp_that_cannot_be_is_refused(text: str, error: type[PetalfoilError], reason: str) -> None:
    with pytest.raises(error, match=reason):
        parse_ramp(text)
