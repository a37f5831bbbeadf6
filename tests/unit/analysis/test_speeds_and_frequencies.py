"""Arguments of an analysis: what a user may write for them."""

from __future__ import annotations

import math
import typing

import pytest

import petalfoil
from petalfoil.analysis.arguments import NumbersWithUnit, Speed
from petalfoil.errors import UnitError, UsageError
from tests.cases import case

WHIRL = NumbersWithUnit(unit="rad/s", whirl=True, at_least=0.0, help="Whirl frequencies.")


@pytest.mark.parametrize("given", ["100 Hz", "0.1 kHz", ["100 Hz"], "6000 rpm", 200.0 * math.pi])
def test_whirl_frequencies_are_read_in_hertz(given: object) -> None:
    assert WHIRL.read(given) == pytest.approx([200.0 * math.pi], rel=1e-14)


def test_speeds_in_hertz_are_told_both_readings() -> None:
    with pytest.raises(UnitError, match="for turns write '6000 rpm', for radians '100 rad/s'"):
        NumbersWithUnit(unit="rad/s", help="Speeds.").read("100 Hz")


@pytest.mark.parametrize("given", ["-100 rpm", "-100 Hz"])
def test_what_is_outside_its_range_is_shown_as_typed(given: str) -> None:
    with pytest.raises(UsageError, match=f"'{given}' is outside its range; allowed: at least 0 rad/s"):
        WHIRL.read(given)


def test_a_negative_speed_is_shown_as_typed() -> None:
    with pytest.raises(UsageError, match="'-100 rpm' is outside its range"):
        typing.get_args(Speed)[1].read("-100 rpm")


def test_an_argument_has_the_name_of_its_option_too() -> None:
    plain = case("plain_journal", **{"model.cells_per_pitch": 8, "model.axial_cells": 2})
    one, other = (petalfoil.coefficients(plain, **{name: "300 Hz"}) for name in ("frequencies", "frequency"))
    assert float(one["stiffness"][0, 0, 0]) == float(other["stiffness"][0, 0, 0])


def test_an_argument_that_there_is_not_is_answered_with_the_nearest() -> None:
    with pytest.raises(TypeError, match=r"coefficients\(\) has no argument 'frequncy'\. Did you mean 'frequencies'"):
        petalfoil.coefficients(case("plain_journal"), frequncy="300 Hz")
    with pytest.raises(TypeError, match=r"solve\(\) has no argument 'bogus'\. Known: "):
        petalfoil.solve(case("plain_journal"), bogus=1)
