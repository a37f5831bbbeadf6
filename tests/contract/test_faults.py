"""Small cases that were once refused or answered wrongly: read, and say what they say."""

from __future__ import annotations

import math

import pytest

from petalfoil.case import Case
from tests.cases import FAULTS

NAMES = sorted(path.stem for path in FAULTS.glob("*.toml"))


@pytest.mark.parametrize("name", NAMES)
def test_every_case_is_read(name: str) -> None:
    one = Case.load(FAULTS / f"{name}.toml")
    assert Case.from_toml(one.to_toml()) == one


def test_units_of_a_north_american_drawing() -> None:
    one = Case.load(FAULTS / "krpm.toml")
    assert one.operation.speed == pytest.approx(1000.0 * math.pi, rel=1e-14)
    assert one.surface.contact_film_thickness == pytest.approx(20e-6 * 0.0254, rel=1e-14)
    assert one.operation.load == pytest.approx((0.0, -6.0 * 0.45359237 * 9.80665), rel=1e-14)
