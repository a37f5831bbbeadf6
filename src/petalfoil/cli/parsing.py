"""Text of the options to SI numbers; a refusal names the option."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, TypeVar

from petalfoil import units
from petalfoil.errors import UnitError, UsageError

T = TypeVar("T")


def speed(text: str | None) -> float | None:
    """Angular velocity [rad/s] of ``--speed``; None where the case decides."""
    return None if text is None else _named("--speed", units.parse_quantity, text, "rad/s")


def position(text: str | None) -> tuple[float, float] | None:
    """Displacement (x, y) [m] of ``--eccentricity``; None where the case decides."""
    return None if text is None else _named("--eccentricity", units.parse_pair, text, "m")


def displacements(text: str) -> list[float]:
    """Displacements [m] of ``--eccentricity`` along the direction."""
    return _named("--eccentricity", units.parse_range, text, "m")


def direction(text: str) -> float:
    """Angle [rad] of ``--direction``."""
    return _named("--direction", units.parse_quantity, text, "rad")


def load(text: str | None) -> tuple[float, float] | None:
    """Load (x, y) [N] of ``--load``; a single value acts along -y; None where the case decides."""
    if text is None:
        return None
    if "," in text:
        return _named("--load", units.parse_pair, text, "N")
    return 0.0, -_named("--load", units.parse_quantity, text, "N")


def loads(option: str, text: str) -> list[float]:
    """Loads along -y [N]."""
    return _named(option, units.parse_range, text, "N")


def speeds(option: str, text: str | None) -> list[float] | None:
    """Speeds or whirl frequencies [rad/s]; None where none are given."""
    return None if text is None else _named(option, units.parse_range, text, "rad/s")


def top(text: str) -> float:
    """Angular velocity [rad/s] of ``--to``."""
    return _named("--to", units.parse_quantity, text, "rad/s")


def mass(text: str | None) -> float | None:
    """Mass [kg] of ``--mass``; None where none is given."""
    return None if text is None else _named("--mass", units.parse_quantity, text, "kg")


def amplitude(text: str | None) -> float | None:
    """Amplitude [m] of ``--amplitude``; None where none is given."""
    return None if text is None else _named("--amplitude", units.parse_quantity, text, "m")


def initial(text: str | None) -> tuple[float, float] | Literal["balance"] | None:
    """Displacement (x, y) [m] of ``--initial``, or "balance"; None where the case decides."""
    if text is not None and text.strip() == "balance":
        return "balance"
    return None if text is None else _named("--initial", units.parse_pair, text, "m")


def duration(text: str | None) -> float | None:
    """Time [s] of ``--duration``; None where turns are counted."""
    return None if text is None else _named("--duration", units.parse_quantity, text, "s")


def ramp(text: str | None) -> tuple[tuple[float, float], ...] | None:
    """Instants [s] and speeds [rad/s] of ``--ramp``; None where the speed stays."""
    return None if text is None else tuple(_named("--ramp", lambda ramp, _: units.parse_ramp(ramp), text, ""))


def tolerance(text: str) -> float:
    """Local error of a step [1] of ``--tolerance``."""
    return _named("--tolerance", units.parse_quantity, text, "1")


def share(text: str) -> float:
    """Contact share [1] of ``--share``."""
    return _named("--share", units.parse_quantity, text, "1")


def _named(option: str, parse: Callable[[str, str], T], text: str, unit: str) -> T:
    try:
        return parse(text, unit)
    except (UnitError, UsageError) as error:
        raise UsageError(f"{option}: {error}") from error
