"""Text of the options to SI numbers; a refusal names the option."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

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


def _named(option: str, parse: Callable[[str, str], T], text: str, unit: str) -> T:
    try:
        return parse(text, unit)
    except (UnitError, UsageError) as error:
        raise UsageError(f"{option}: {error}") from error
