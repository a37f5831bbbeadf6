"""What every run needs around it: one BLAS thread, and its part of the progress."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController

from petalfoil.equilibrium.run_context import Progress


@contextmanager
def one_thread() -> Iterator[None]:
    """One BLAS thread: two make small blocks many times slower, and runs go parallel over cases."""
    with thread_pools(len(sys.modules)).limit(limits=1, user_api="blas"):
        yield


@lru_cache(maxsize=1)
def thread_pools(loaded: int) -> ThreadpoolController:
    """The libraries with threads, looked for anew when other modules are `loaded`: that takes as long as 20 solves."""
    return ThreadpoolController()


def part(progress: Progress | None, number: int, count: int) -> Progress | None:
    """Progress of point `number` of `count` as a part of the whole."""
    if progress is None:
        return None

    def tell(share: float, text: str) -> None:
        progress((number + share) / count, text)

    return tell
