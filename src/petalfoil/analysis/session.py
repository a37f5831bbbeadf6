"""What every run needs around it: one BLAS thread, and its part of the progress."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits

from petalfoil.equilibrium.run_context import Progress


@contextmanager
def one_thread() -> Iterator[None]:
    """One BLAS thread: two make small blocks many times slower, and runs go parallel over cases."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield


def part(progress: Progress | None, number: int, count: int) -> Progress | None:
    """Progress of point `number` of `count` as a part of the whole."""
    if progress is None:
        return None

    def tell(share: float, text: str) -> None:
        progress((number + share) / count, text)

    return tell
