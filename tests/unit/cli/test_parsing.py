"""Text of the options to SI numbers."""

from __future__ import annotations

import math

import pytest
from numpy.testing import assert_allclose

from petalfoil.cli import parsing
from petalfoil.errors import UsageError


def test_values_come_out_in_si() -> None:
    assert parsing.speed("8000 rad/s") == 8000.0
    assert_allclose(parsing.speed("60000 rpm"), 2000.0 * math.pi, rtol=1e-14, atol=0.0)
    assert parsing.position("0 um, -100 um") == (0.0, -1e-4)
    assert parsing.displacements("0 um : 280 um : 3") == [0.0, 1.4e-4, 2.8e-4]
    assert parsing.displacements("100 um") == [1e-4]
    assert_allclose(parsing.direction("-90 deg"), -0.5 * math.pi, rtol=1e-14, atol=0.0)


def test_absent_options_leave_the_case_to_decide() -> None:
    assert parsing.speed(None) is None
    assert parsing.position(None) is None


@pytest.mark.parametrize(
    ("option", "call"),
    [
        ("--speed", lambda: parsing.speed("8000 mm")),
        ("--eccentricity", lambda: parsing.position("100 um")),
        ("--eccentricity", lambda: parsing.position("0 um : 280 um : 15")),
        ("--eccentricity", lambda: parsing.displacements("0 um : 280 um")),
        ("--eccentricity", lambda: parsing.displacements("0 um : 280 um : many")),
        ("--direction", lambda: parsing.direction("down")),
    ],
)
def test_a_refusal_names_the_option(option: str, call) -> None:
    with pytest.raises(UsageError, match=f"^{option}: "):
        call()
