"""Units that are read without pint: they are what pint makes of them, to the last digit."""

from __future__ import annotations

import subprocess
import sys
from fractions import Fraction

import pytest

from petalfoil.units.grammar import UnitTextError, convert, convert_any
from petalfoil.units.usual import FACTORS, converted
from tests.cases import EXAMPLES

TEXTS = [(text, unit) for unit, factors in FACTORS.items() for text in factors]
SI = [
    "N",
    "N*m",
    "Pa",
    "Pa*s",
    "J/(kg*K)",
    "J/K",
    "K",
    "W/K",
    "1/K",
    "kg",
    "kg*m^2",
    "kg/m^3",
    "kg/s",
    "m",
    "rad",
    "rad/s",
    "s",
]
NUMBERS = [
    "25",
    "0.176",
    "-100",
    "1e-3",
    "18.5",
    "60000",
    "287.05",
    "0",
    "1e290",
    "1e-320",
    "123456.789012345678901234567",
]


@pytest.mark.parametrize(("text", "unit"), [*TEXTS, ("degC", "K"), *((unit, unit) for unit in SI)])
@pytest.mark.parametrize("whirl", [False, True])
def test_a_usual_unit_is_what_pint_makes_of_it(text: str, unit: str, whirl: bool) -> None:
    for number in map(Fraction, NUMBERS):
        assert converted(number, text, unit) == convert_any(number, text, unit, whirl)


@pytest.mark.parametrize(
    ("text", "unit"), [("um", "Pa"), ("degC", "m"), ("%", "m"), ("1", "1"), ("Hz", "rad/s"), ("in", "m")]
)
def test_any_other_text_is_left_to_pint(text: str, unit: str) -> None:
    assert converted(Fraction(1), text, unit) is None


def test_a_number_that_no_float_holds_is_refused() -> None:
    for text in ("m", "km"):
        with pytest.raises(UnitTextError, match="cannot be converted"):
            convert(Fraction("1e400"), text, "m")


def test_a_case_in_usual_units_loads_no_pint() -> None:
    code = "import sys; from petalfoil import Case; Case.load(sys.argv[1]); sys.exit('pint' in sys.modules)"
    subprocess.run([sys.executable, "-c", code, str(EXAMPLES / "paper_n8.toml")], check=True)
