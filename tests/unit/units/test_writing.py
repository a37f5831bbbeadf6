import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from petalfoil.units import format_percent, format_quantity, parse_quantity


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (2.5e-05, "m", "25 µm"),
        (-2.5e-05, "m", "-25 µm"),
        (0.0009999999, "m", "1 mm"),
        (0.0, "m", "0 m"),
        (12.5, "m", "12.5 m"),
        (1e-15, "m", "1e-06 nm"),
        (math.nan, "m", "nan m"),
        (-math.pi / 2, "rad", "-90°"),
        (8000.0 * math.pi / 30.0, "rad/s", "8000 rpm"),
        (123456.0 * math.pi / 30.0, "rad/s", "123500 rpm"),
        (1e5, "Pa", "100 kPa"),
        (2e11, "Pa", "200 GPa"),
        (1.85e-05, "Pa*s", "18.5 µPa s"),
        (1.2345e-06, "kg/s", "1.234 mg/s"),
        (0.0123, "N*m", "12.3 mN m"),
        (293.15, "K", "293.1 K"),
        (0.123456, "1", "0.1235"),
    ],
)
def test_a_reader_gets_a_handy_unit(value: float, unit: str, text: str) -> None:
    assert format_quantity(value, unit) == text


@pytest.mark.parametrize(
    ("fraction", "text"),
    [(1.0, "100 %"), (1.3, "130 %"), (0.999, "100 %"), (0.0314, "3.1 %"), (12.34, "1200 %"), (1e-7, "1e-05 %")],
)
def test_a_fraction_is_read_as_per_cent(fraction: float, text: str) -> None:
    assert format_percent(fraction) == text


@given(st.floats(1e-12, 1e6), st.sampled_from(["m", "Pa", "N", "rad", "rad/s", "Pa*s"]))
def test_what_is_written_reads_back(value: float, unit: str) -> None:
    assert parse_quantity(format_quantity(value, unit, digits=12), unit) == pytest.approx(value, rel=1e-11)
