"""Signals that ask a run to stop: what is finished is kept, as after Ctrl-C.

Batch systems send SIGTERM before they kill, a terminal that is closed sends SIGHUP.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

STOPPING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that stop a run, where the system has them."""

ENDED_BY_SIGNAL = 128
"""Exit code of a process that a signal ended, less the number of the signal, as shells have it."""


class StopRequested(KeyboardInterrupt):
    """A signal other than that of Ctrl-C asks the run to stop."""

    def __init__(self, number: int) -> None:
        super().__init__(signal.Signals(number).name)
        self.number = number


def exit_code_of(interrupt: KeyboardInterrupt) -> int:
    """Exit code after an interrupt."""
    number = interrupt.number if isinstance(interrupt, StopRequested) else signal.SIGINT
    return ENDED_BY_SIGNAL + number


@contextmanager
def stopping_in_order() -> Iterator[None]:
    """Raise `StopRequested` in the block where a signal asks to stop.

    A signal that the caller has ignored (``nohup``) stays ignored. Only the main thread may set handlers; elsewhere
    nothing changes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in STOPPING}
    ours = [number for number, handler in before.items() if handler == signal.SIG_DFL]
    for number in ours:
        signal.signal(number, _stop)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, before[number])


def _stop(number: int, frame: FrameType | None) -> None:
    raise StopRequested(number)
