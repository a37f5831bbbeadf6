"""What every run needs around it: one BLAS thread, a clock, someone to tell."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from threadpoolctl import threadpool_limits

from petalfoil.equilibrium.run_log import RunLog

Progress = Callable[[float, str], None]

TYPICAL_STEPS = 30.0
"""Steps of a typical cold start: what the progress of a single solve is measured by."""


@contextmanager
def one_thread() -> Iterator[None]:
    """One BLAS thread: two make small blocks many times slower, and runs go parallel over cases."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield


@dataclass
class Clock:
    """Wall time since it was made."""

    start: float = field(default_factory=time.perf_counter)

    @property
    def seconds(self) -> float:
        """Time passed [s]."""
        return time.perf_counter() - self.start


def part(progress: Progress | None, number: int, count: int) -> Progress | None:
    """Progress of point `number` of `count` as a part of the whole."""
    if progress is None:
        return None

    def tell(share: float, text: str) -> None:
        progress((number + share) / count, text)

    return tell


def telling_work(progress: Progress | None, text: str, typical: float = TYPICAL_STEPS) -> RunLog:
    """RunLog that tells `progress` of its steps; the share approaches 1 as they exceed the `typical` number."""
    work = RunLog()
    if progress is None:
        return work

    def tell(phase: str) -> None:
        share = 1.0 - math.exp(-len(work.history) / typical)
        progress(share, f"{text}: {phase}")

    work.tell = tell
    return work
