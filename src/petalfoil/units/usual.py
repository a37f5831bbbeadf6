"""Units of most cases with their exact factors: reading them takes no time, loading pint takes a second.

A factor is that of pint, a fraction; the tests compare both for every unit. Any other text goes to pint.
"""

from __future__ import annotations

from fractions import Fraction

PI = Fraction("3.1415926535897932384626433832795028841971693993751")
"""The digits that pint has; more than a float."""

FREEZING = Fraction("273.15")
"""0 degC [K]."""

LENGTHS = {
    "mm": Fraction(1, 10**3),
    "um": Fraction(1, 10**6),
    "µm": Fraction(1, 10**6),  # the micro sign
    "μm": Fraction(1, 10**6),  # the Greek letter
    "nm": Fraction(1, 10**9),
}
PRESSURES = {
    "kPa": Fraction(10**3),
    "MPa": Fraction(10**6),
    "GPa": Fraction(10**9),
    "bar": Fraction(10**5),
    "mbar": Fraction(10**2),
}
FACTORS = {
    "1": {"%": Fraction(1, 100)},
    "N": {"kN": Fraction(10**3), "mN": Fraction(1, 10**3)},
    "Pa": PRESSURES,
    "Pa*s": {"uPa*s": Fraction(1, 10**6), "uPa s": Fraction(1, 10**6), "mPa*s": Fraction(1, 10**3)},
    "kg": {"g": Fraction(1, 10**3)},
    "m": LENGTHS,
    "rad": {"deg": PI / 180},
    "rad/s": {"rpm": PI / 30, "krpm": PI / 30 * 10**3},
    "s": {"ms": Fraction(1, 10**3)},
}
"""Factor of each text of a unit, by the SI unit that is asked for."""


def converted(number: Fraction, text: str, unit: str) -> float | None:
    """Convert `number` times the unit written in `text` to the SI unit `unit`; None where it is none of these.

    Raises
    ------
    OverflowError
        The result is larger than a float can be.
    """
    if text == unit != "1":
        return float(number)
    if unit == "K" and text == "degC":
        return float(number + FREEZING)
    factor = FACTORS.get(unit, {}).get(text)
    return None if factor is None else float(number * factor)
