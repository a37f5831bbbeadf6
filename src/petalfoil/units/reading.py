"""Numbers and texts at the border → floats in SI units."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from numbers import Real

from petalfoil.errors import UnitError, UsageError
from petalfoil.units.grammar import UnitTextError, convert

MAX_TEXT = 120  # longer texts are no quantities; the bound keeps the reader's work and depth small
MAX_POINTS = 10_000  # more points than this in one range is a slip of the pen

# At most three digits of exponent: a number is also read as an exact fraction, whose length grows with the exponent.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3}(?![0-9]))?")

# What each SI unit measures, with an example to follow.
_MEASURES = {
    "1": ("a plain number", "0.3"),
    "J/(kg*K)": ("a specific gas constant", "287.05 J/(kg*K)"),
    "K": ("a temperature", "20 degC"),
    "N": ("a force", "50 N"),
    "Pa": ("a pressure or an elastic modulus", "1 bar"),
    "Pa*s": ("a dynamic viscosity", "18.5 uPa*s"),
    "kg": ("a mass", "2 kg"),
    "m": ("a length", "25 um"),
    "rad": ("an angle", "45 deg"),
    "rad/s": ("an angular speed", "60000 rpm"),
    "s": ("a time", "10 ms"),
}


def parse_quantity(value: object, unit: str) -> float:
    """Read a number or a text as a float in an SI unit.

    Parameters
    ----------
    value : float, int or str
        A bare number (or a text of a number alone) is already in `unit`; a text may carry any unit of the same kind.
    unit : str
        SI unit to return, such as ``"m"`` or ``"rad/s"``; ``"1"`` for a plain number.

    Returns
    -------
    float
        The quantity [`unit`], finite.

    Raises
    ------
    UnitError
        The value is no quantity, its unit is unknown, or it measures something else.

    Examples
    --------
    >>> parse_quantity("25 um", "m")
    2.5e-05
    """
    try:
        number = _read(value, unit)
    except UnitTextError as error:
        raise _unit_error(value, unit, str(error)) from None
    except OverflowError:
        raise _unit_error(value, unit, "is too large") from None
    if not math.isfinite(number):
        raise _unit_error(value, unit, "is not finite")
    return number


def parse_pair(text: str, unit: str) -> tuple[float, float]:
    """Read two quantities separated by a comma, such as ``"0 um, -100 um"``, as floats [`unit`]."""
    parts = text.split(",")
    if len(parts) != 2:
        _, example = _measure(unit)
        raise UsageError(f"{shown(text)} is not a pair of quantities; write two, such as '{example}, {example}'")
    return parse_quantity(parts[0], unit), parse_quantity(parts[1], unit)


def parse_range(text: str, unit: str) -> list[float]:
    """Read a range or a list of quantities as floats [`unit`].

    Parameters
    ----------
    text : str
        ``"0 um : 280 um : 15"`` (start, stop, count; both ends included), ``"0 um, 50 um"`` or a single quantity.
    unit : str
        SI unit to return.

    Raises
    ------
    UsageError
        The text has another form, or the count is no whole number from 2 to `MAX_POINTS`.
    UnitError
        One of the quantities cannot be read.
    """
    if ":" not in text:
        return [parse_quantity(part, unit) for part in text.split(",")]
    parts = text.split(":")
    if len(parts) != 3:
        raise UsageError(f"{shown(text)} is not a range; write start : stop : count, such as '0 um : 280 um : 15'")
    start, stop = parse_quantity(parts[0], unit), parse_quantity(parts[1], unit)
    count = _count(parts[2].strip(), text)
    return [start + (stop - start) * i / (count - 1) for i in range(count - 1)] + [stop]


def shown(value: object, limit: int = 60) -> str:
    """Return `value` as an error message shows it: quoted where it is a text, and cut where it is long."""
    try:
        text = repr(value[:limit] + "…" if isinstance(value, str) and len(value) > limit else value)
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, a list nested without end
        return f"a value of type {type(value).__name__}"
    return text if len(text) <= limit + 3 else text[:limit] + "…"


def _read(value: object, unit: str) -> float:
    if isinstance(value, bool) or not isinstance(value, str | Real):
        raise UnitTextError("is not a number, nor a text with a unit")
    return _read_text(value, unit) if isinstance(value, str) else float(value)


def _read_text(text: str, unit: str) -> float:
    plain = text.strip().replace("−", "-")  # the minus sign of typeset texts
    if len(plain) > MAX_TEXT:
        raise UnitTextError("is too long for a quantity")
    number = _NUMBER.match(plain)
    if number is None:
        raise UnitTextError("does not begin with a number")
    rest = plain[number.end() :].strip()
    return convert(Fraction(number.group()), rest, unit) if rest else float(number.group())


def _count(text: str, whole: str) -> int:
    if re.fullmatch(r"[0-9]{1,6}", text) and 2 <= int(text) <= MAX_POINTS:
        return int(text)
    raise UsageError(f"{shown(whole)} has the count {shown(text)}; allowed: a whole number from 2 to {MAX_POINTS}")


def _measure(unit: str) -> tuple[str, str]:
    return _MEASURES.get(unit, (f"a quantity in {unit}", f"1 {unit}"))


def _unit_error(value: object, unit: str, reason: str) -> UnitError:
    what, example = _measure(unit)
    allowed = f"{what}, such as '{example}'" + ("" if unit == "1" else f", or a bare number in {unit}")
    return UnitError(f"{shown(value)} {reason}; expected {allowed}", given=value, allowed=allowed)
