"""What is meant by the text of a unit that is not known, or that measures something else.

``"80 F"`` is 80 farad and ``"80 C"`` 80 coulomb to whoever reads SI, and nobody who is asked for a temperature means
that. They are refused with the unit that is meant, never taken for it.
"""

from __future__ import annotations

import difflib
import re

_COMMON = {
    "m": ("m", "mm", "um", "nm", "in", "thou", "microinch"),
    "rad": ("deg", "rad"),
    "s": ("s", "ms", "us", "min", "h"),
    "rad/s": ("rpm", "krpm", "rps", "rad/s", "Hz", "kHz"),
    "Pa": ("Pa", "kPa", "MPa", "GPa", "bar", "mbar", "atm", "psi", "ksi", "Msi"),
    "N": ("N", "kN", "lbf", "kgf"),
    "kg": ("kg", "g", "lb"),
    "K": ("K", "degC", "degF", "degR"),
    "Pa*s": ("cP", "Pa s", "mPa s", "uPa s"),
    "J": ("J",),
    "W": ("W",),
}
"""Units that a mistyped one is compared with, by what they measure. Of two that are alike the first is meant."""

_TYPED = {
    "m": {"u": "um", "n": "nm", "mu": "um", "mic": "um", '"': "in", "''": "in"},
    "rad": {"d": "deg", "r": "rad"},
    "s": {"m": "min"},
    "rad/s": {"rad": "rad/s", "r/min": "rpm", "U/min": "rpm", "r/s": "rps", "U/s": "rps"},
    "Pa": {"B": "bar", "b": "bar", "P": "Pa", "k": "kPa", "M": "MPa", "G": "GPa", "kg/cm^2": "kgf/cm^2"},
    "N": {"g": "gf", "kg": "kgf", "lb": "lbf", "lbs": "lbf"},
    "kg": {"k": "kg", "K": "kg", "kgs": "kg", "kilo": "kg", "T": "t"},
    "K": {"Celsius": "degC", "Fahrenheit": "degF", "Kelvin": "K", "℃": "degC", "℉": "degF"},
    "J/(kg*K)": {
        "J/kgK": "J/(kg K)",
        "J/kg K": "J/(kg K)",
        "J/kg/C": "J/kg/K",
        "kJ/kgK": "kJ/(kg K)",
        "kJ/kg K": "kJ/(kg K)",
    },
    "W/K": {"W/C": "W/K", "W/°": "W/K"},
    "1/K": {"1/C": "1/K"},
    "Pa*s": {"p": "P", "Pas": "Pa s", "mPas": "mPa s", "uPas": "uPa s", "µPas": "uPa s", "μPas": "uPa s"},
}
"""Texts that people write for a unit and that are none, or another one, by what is asked for."""

_SCALE = re.compile(r"(?:°|º|o|deg(?:rees?)?\b)?\s*([CFR])", re.IGNORECASE)
"""A scale of temperatures with or without its degrees, apart from ``"degC"`` and its like."""

_DEGREES = re.compile(r"°|º|deg(rees?)?", re.IGNORECASE)


def meant(text: str, unit: str) -> str:
    """The unit that is most likely meant by a whole `text` where the SI unit `unit` is asked for, or nothing."""
    plain, candidates = text.strip(), _COMMON.get(unit, ())
    if unit == "K" and (scale := _SCALE.fullmatch(plain)):
        return f"deg{scale.group(1).upper()}"
    if unit == "K" and _DEGREES.fullmatch(plain):
        return "degC"
    if plain in _TYPED.get(unit, {}):
        return _TYPED[unit][plain]
    alike = [common for common in candidates if common.lower() == plain.lower()]
    return alike[0] if alike else ""


def nearest(name: str, unit: str) -> str:
    """The common unit closest to an unknown `name`, capitals and small letters alike, or nothing.

    One of those that measure `unit`, if any does and the name may be all that was written.
    """
    candidates = _COMMON.get(unit) or tuple(common for group in _COMMON.values() for common in group)
    lower = {common.lower(): common for common in reversed(candidates)}
    matches = difflib.get_close_matches(name.lower(), lower, n=1)
    return lower[matches[0]] if matches else ""
