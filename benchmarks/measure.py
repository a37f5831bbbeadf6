"""Ratios of times of one run. The compared calls run in turn, so that other load on the machine slows all of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field

Value = float | int | str | bool | None


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes
    ----------
    name : str
        Key in the JSON file.
    description : str
        What is divided by what.
    ratio : float or None
        The ratio; None where it could not be measured.
    target : str
        The limit of the ratio as text; empty without a limit.
    met : bool or None
        Whether the ratio keeps the limit; None without a limit or a measurement.
    remark : str
        How it was measured, or why it was not.
    details : dict
        The measured quantities behind the ratio.
    """

    name: str
    description: str
    ratio: float | None
    target: str = ""
    met: bool | None = None
    remark: str = ""
    details: dict[str, Value] = field(default_factory=dict)

    def plain(self) -> dict[str, object]:
        """The row as a dictionary for JSON."""
        return asdict(self)


def at_most(name: str, description: str, ratio: float, limit: float, **more: object) -> Row:
    """A row with an upper limit of its ratio."""
    return Row(name, description, ratio, f"≤ {limit:g}", ratio <= limit, **more)  # type: ignore[arg-type]


def at_least(name: str, description: str, ratio: float, limit: float, **more: object) -> Row:
    """A row with a lower limit of its ratio."""
    return Row(name, description, ratio, f"≥ {limit:g}", ratio >= limit, **more)  # type: ignore[arg-type]


def seconds(call: Callable[[], object]) -> float:
    """Processor time of one call [s]. It does not contain the time of other processes."""
    start = time.process_time()
    call()
    return time.process_time() - start


def in_turn(calls: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """Smallest processor time of each call [s]. All calls run in turn, `repeats` times."""
    best = dict.fromkeys(calls, float("inf"))
    for _ in range(repeats):
        for name, call in calls.items():
            best[name] = min(best[name], seconds(call))
    return best
