"""Ratios measured in one run: what is compared runs in turn, so that a busy machine slows both alike."""

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
    says : str
        What is divided by what, for people.
    ratio : float or None
        The ratio; None where it could not be measured.
    wanted : str
        What it should be, as the table prints it; empty where nothing is asked.
    met : bool or None
        Whether it is so; None where nothing is asked or nothing was measured.
    remark : str
        What else a reader must know: how it was measured, why it was not.
    details : dict
        What the ratio was made of.
    """

    name: str
    says: str
    ratio: float | None
    wanted: str = ""
    met: bool | None = None
    remark: str = ""
    details: dict[str, Value] = field(default_factory=dict)

    def plain(self) -> dict[str, object]:
        """As JSON has it."""
        return asdict(self)


def at_most(name: str, says: str, ratio: float, limit: float, **more: object) -> Row:
    """A row whose ratio should not exceed `limit`."""
    return Row(name, says, ratio, f"≤ {limit:g}", ratio <= limit, **more)  # type: ignore[arg-type]


def at_least(name: str, says: str, ratio: float, limit: float, **more: object) -> Row:
    """A row whose ratio should reach `limit`."""
    return Row(name, says, ratio, f"≥ {limit:g}", ratio >= limit, **more)  # type: ignore[arg-type]


def seconds(call: Callable[[], object]) -> float:
    """Processor time of one call [s]: what other programs take of the machine does not count."""
    start = time.process_time()
    call()
    return time.process_time() - start


def in_turn(calls: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """Least processor time of each call [s]; they run one after the other, `repeats` times over."""
    best = dict.fromkeys(calls, float("inf"))
    for _ in range(repeats):
        for name, call in calls.items():
            best[name] = min(best[name], seconds(call))
    return best
