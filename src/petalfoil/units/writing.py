"""Floats in SI units → texts for a reader: 2.5e-05 m becomes ``"25 µm"``."""

from __future__ import annotations

import math

_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# SI unit → (factor, shown unit, powers of ten its prefixes may take)
_SHOWN_AS: dict[str, tuple[float, str, tuple[int, ...]]] = {
    "1": (1.0, "", ()),
    "N": (1.0, "N", (-3, 0, 3)),
    "N*m": (1.0, "N m", (-6, -3, 0)),
    "Pa": (1.0, "Pa", (0, 3, 6, 9)),
    "Pa*s": (1.0, "Pa s", (-6, -3, 0)),
    "W": (1.0, "W", (-3, 0, 3)),
    "kg/s": (1e3, "g/s", (-6, -3, 0, 3)),
    "m": (1.0, "m", (-9, -6, -3, 0)),
    "rad": (180.0 / math.pi, "°", ()),
    "rad/s": (30.0 / math.pi, "rpm", ()),
    "s": (1.0, "s", (-6, -3, 0)),
}


def format_quantity(value: float, unit: str, *, digits: int = 4) -> str:
    """Write a number for a reader, such as ``"25 µm"``; angles in degrees, speeds in rpm.

    Parameters
    ----------
    value : float
        The quantity [`unit`].
    unit : str
        Its SI unit; one without a row in the table is written as it is.
    digits : int
        Significant digits.

    Examples
    --------
    >>> format_quantity(2.5e-05, "m")
    '25 µm'
    """
    factor, symbol, powers = _SHOWN_AS.get(unit, (1.0, unit.replace("*", " "), ()))
    scaled = float(value) * factor
    prefix = ""
    if powers and math.isfinite(scaled) and scaled != 0.0:
        rounded = abs(float(f"{scaled:.{digits}g}"))  # so that 999.99 µm becomes 1 mm
        power = max((p for p in powers if rounded >= 10.0**p), default=powers[0])
        prefix = _PREFIXES[power]
        scaled /= 10.0**power
    number = _plain(scaled, digits)
    return number + symbol if symbol == "°" else f"{number} {prefix}{symbol}".rstrip()


def format_percent(fraction: float, *, digits: int = 2) -> str:
    """Write a fraction for a reader as per cent, without an exponent below a million.

    Examples
    --------
    >>> format_percent(1.304)
    '130 %'
    """
    return f"{_plain(100.0 * float(fraction), digits)} %"


def _plain(value: float, digits: int) -> str:
    """Shortest text of `digits` significant digits, without an exponent where a reader needs none."""
    text = f"{value:.{digits}g}"
    if "e" in text and 1.0 <= abs(value) < 1e6:
        return f"{float(text):.0f}"
    return text
