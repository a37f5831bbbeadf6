"""Numbers and texts at the border → floats in SI units."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from itertools import pairwise
from numbers import Real

from petalfoil.errors import UnitError, UsageError
from petalfoil.units.grammar import UnitTextError, convert
from petalfoil.units.writing import format_quantity

MAX_TEXT = 120  # longer texts are no quantities; the bound keeps the reader's work and depth small
MAX_POINTS = 10_000  # more points than this in one range is a typing mistake

# At most three digits of exponent: a number is also read as an exact fraction, whose length grows with the exponent.
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3}(?![0-9]))?")

_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]+,[0-9]")
_THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+(?![0-9])")

# What each SI unit measures, with an example to follow.
_MEASURES = {
    "1": ("a plain number", "0.3"),
    "J/(kg*K)": ("a specific gas constant", "287.05 J/(kg*K)"),
    "K": ("a temperature", "20 degC"),
    "N": ("a force", "50 N"),
    "Pa": ("a pressure or an elastic modulus", "1 bar"),
    "Pa*s": ("a dynamic viscosity", "18.5 uPa*s"),
    "kg": ("a mass", "2 kg"),
    "kg*m^2": ("a moment of inertia", "0.01 kg m^2"),
    "m": ("a length", "25 um"),
    "rad": ("an angle", "45 deg"),
    "rad/s": ("an angular speed", "60000 rpm"),
    "s": ("a time", "10 ms"),
}


def parse_quantity(value: object, unit: str, *, whirl: bool = False) -> float:
    """Read a number or a text as a float in an SI unit.

    Parameters
    ----------
    value : float, int or str
        A bare number (or a text of a number alone) is already in `unit`; a text may carry any unit of the same kind.
    unit : str
        SI unit to return, such as ``"m"`` or ``"rad/s"``; ``"1"`` for a plain number.
    whirl : bool
        The quantity is a whirl frequency [rad/s], whose usual unit is Hz: one orbit a second, 2 pi rad/s. For a speed
        Hz is refused, since it may mean turns or radians a second.

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
        number = _read(value, unit, whirl)
    except UnitTextError as error:
        raise _unit_error(value, unit, str(error)) from None
    except OverflowError:
        raise _unit_error(value, unit, "is too large") from None
    if not math.isfinite(number):
        raise _unit_error(value, unit, "is not finite")
    return number


def is_bare(value: object) -> bool:
    """Whether `value` is a number without a unit, which is read as SI."""
    return not isinstance(value, str) or _NUMBER.fullmatch(_plain(value)) is not None


def note_on_bare(text: str, unit: str, *, whirl: bool = False) -> str:
    """How numbers without a unit in a text were read, and what to write; empty where each has one.

    Parameters
    ----------
    text : str
        A quantity, a list or a range of them.
    unit : str
        SI unit that bare numbers are read in.
    whirl : bool
        They are whirl frequencies.

    Examples
    --------
    >>> note_on_bare("60000", "rad/s")
    "'60000' has no unit and is read in rad/s (572960 rpm); write the unit, such as '60000 rpm'"
    """
    parts = text.split(":")[:2] if ":" in text else text.split(",")
    bare = [float(_plain(part)) for part in parts if is_bare(part) and float(_plain(part)) != 0.0]
    if unit == "1" or not bare:
        return ""
    example = "600 Hz" if whirl else _measure(unit)[1]
    familiar = f"{bare[0] / (2.0 * math.pi):.5g} Hz" if whirl else format_quantity(bare[0], unit, digits=5)
    also = "" if familiar == f"{bare[0]:g} {unit}" else f" ({familiar})"
    return f"{shown(text)} has no unit and is read in {unit}{also}; write the unit, such as '{example}'"


def parse_pair(text: str, unit: str) -> tuple[float, float]:
    """Read two quantities separated by a comma, such as ``"0 um, -100 um"``, as floats [`unit`]."""
    parts = _split(text, unit)
    if len(parts) != 2:
        _, example = _measure(unit)
        raise UsageError(f"{shown(text)} is not a pair of quantities; write two, such as '{example}, {example}'")
    _refuse_mixed(text, parts, unit)
    return parse_quantity(parts[0], unit), parse_quantity(parts[1], unit)


def parse_range(text: str, unit: str, *, whirl: bool = False) -> list[float]:
    """Read a range or a list of quantities as floats [`unit`].

    Parameters
    ----------
    text : str
        ``"0 um : 280 um : 15"`` (start, stop, count; both ends included), ``"0 um, 50 um"`` or a single quantity.
    unit : str
        SI unit to return.
    whirl : bool
        The quantities are whirl frequencies: see `parse_quantity`.

    Raises
    ------
    UsageError
        The text has another form, some of its quantities have a unit and others none, or the count is no whole number
        from 2 to `MAX_POINTS`.
    UnitError
        One of the quantities cannot be read.
    """
    if ":" not in text:
        listed = _split(text, unit)
        _refuse_mixed(text, listed, unit)
        return [parse_quantity(part, unit, whirl=whirl) for part in listed]
    parts = text.split(":")
    if len(parts) != 3:
        raise UsageError(f"{shown(text)} is not a range; write start : stop : count, such as '0 um : 280 um : 15'")
    _refuse_mixed(text, parts[:2], unit)
    start, stop = (parse_quantity(part, unit, whirl=whirl) for part in parts[:2])
    count = _count(parts[2].strip(), text)
    return [start + (stop - start) * i / (count - 1) for i in range(count - 1)] + [stop]


def shown(value: object, limit: int = 60) -> str:
    """Return `value` as an error message shows it: quoted where it is a text, and cut where it is long."""
    try:
        text = repr(value[:limit] + "…" if isinstance(value, str) and len(value) > limit else value)
    except (ValueError, RecursionError):  # an integer of more than 4300 digits, a list nested without end
        return f"a value of type {type(value).__name__}"
    return text if len(text) <= limit + 3 else text[:limit] + "…"


def _read(value: object, unit: str, whirl: bool) -> float:
    if isinstance(value, bool) or not isinstance(value, str | Real):
        raise UnitTextError("is not a number, nor a text with a unit")
    return _read_text(value, unit, whirl) if isinstance(value, str) else float(value)


def _read_text(text: str, unit: str, whirl: bool) -> float:
    plain = _plain(text)
    if len(plain) > MAX_TEXT:
        raise UnitTextError("is too long for a quantity")
    if _DECIMAL_COMMA.match(plain):
        raise UnitTextError(_with_comma(plain))
    number = _NUMBER.match(plain)
    if number is None:
        raise UnitTextError("does not begin with a number")
    rest = plain[number.end() :].strip()
    return convert(Fraction(number.group()), rest, unit, whirl=whirl) if rest else float(number.group())


def _with_comma(plain: str) -> str:
    """What is wrong with a number that has a comma: it marks decimals or, before three digits, thousands."""
    point = plain.replace(",", ".", 1)
    if _THOUSANDS.match(plain):
        return f"has a comma: write '{plain.replace(',', '')}' if it marks thousands, '{point}' if it marks decimals"
    return f"has a decimal comma: write a decimal point, '{point}'"


def _plain(text: str) -> str:
    return text.strip().replace("−", "-")  # the minus sign of typeset texts


def _split(text: str, unit: str) -> list[str]:
    """Parts of a list at its commas; ``"0,1 mm"`` is refused: a list of 0 and 1 mm, or a decimal comma."""
    parts = text.split(",")
    for before, after in pairwise(parts):
        if _DECIMAL_COMMA.match(f"{before},{after}".strip()) and not is_bare(after):
            _, example = _measure(unit)
            raise UsageError(
                f"{shown(text)} {_with_comma(f'{before},{after}'.strip())}; "
                f"or in a list write a unit with each quantity, such as '{example}, {example}'"
            )
    return parts


def _refuse_mixed(text: str, parts: list[str], unit: str) -> None:
    """A unit after the last number alone may be meant for all: ``"20000, 30000 rpm"`` is not 20000 rad/s."""
    bare = [part.strip() for part in parts if is_bare(part) and float(_plain(part)) != 0.0]
    if bare and unit != "1" and not all(map(is_bare, parts)):
        _, example = _measure(unit)
        raise UsageError(
            f"{shown(text)} has a unit with some of its numbers and none with {shown(bare[0])}, which would be read in "
            f"{unit}; write a unit with each quantity, such as '{example}, {example}'"
        )


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
