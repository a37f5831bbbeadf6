"""Texts of a speed that changes: ``"0 rpm : 60000 rpm : 2 s"`` → instants and speeds."""

from __future__ import annotations

from petalfoil.errors import UnitError, UsageError
from petalfoil.units.reading import parse_quantity, shown

SAME = 1e-9
"""Share by which the speed at a joint may differ: two texts of one speed are rounded differently."""


def parse_ramp(text: str) -> list[tuple[float, float]]:
    """Read a speed over time.

    Parameters
    ----------
    text : str
        ``"from : to : duration"``, or several such segments separated by commas, each beginning at the speed at which
        the one before ended: ``"0 rpm : 60000 rpm : 2 s, 60000 rpm : 0 rpm : 5 s"``.

    Returns
    -------
    list of (float, float)
        Instants from zero on [s] and the speeds there [rad/s], straight lines between them.

    Raises
    ------
    UsageError
        A segment has another form, lasts no time or goes back in time, or does not join on.
    UnitError
        One of the quantities cannot be read.
    """
    points: list[tuple[float, float]] = []
    for segment in text.split(","):
        begin, end, duration = _segment(segment.strip())
        if not points:
            points.append((0.0, begin))
        time, speed = points[-1]
        if abs(begin - speed) > SAME * max(abs(begin), abs(speed)):
            raise UsageError(
                f"the segment {shown(segment.strip())} does not join on: it begins at {begin:.6g} rad/s, and the one "
                f"before ended at {speed:.6g} rad/s"
            )
        points.append((time + duration, end))
    return points


def _segment(text: str) -> tuple[float, float, float]:
    """Speeds [rad/s] and duration [s] of one segment."""
    parts = text.split(":")
    if len(parts) != 3:
        raise UsageError(
            f"{shown(text)} is no segment of a ramp; write from : to : duration, such as '0 rpm : 60000 rpm : 2 s'"
        )
    try:
        begin, end = parse_quantity(parts[0], "rad/s"), parse_quantity(parts[1], "rad/s")
        duration = parse_quantity(parts[2], "s")
    except UnitError as error:
        raise UnitError(f"in the segment {shown(text)}: {error}", given=error.given, allowed=error.allowed) from error
    for speed in (begin, end):
        if speed < 0.0:
            raise UsageError(f"the segment {shown(text)} has a negative speed; allowed: 0 or more")
    if duration <= 0.0:
        how = "lasts no time" if duration == 0.0 else "goes back in time"
        raise UsageError(f"the segment {shown(text)} {how}: its duration must be above zero")
    return begin, end, duration
