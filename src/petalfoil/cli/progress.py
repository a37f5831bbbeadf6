"""The progress bar: on standard error, only at a terminal, only for work over a second."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import TypeAlias

Report: TypeAlias = Callable[[float, str], None]

DELAY = 1.0  # [s] shorter work flashes no bar


@contextmanager
def bar(title: str) -> Iterator[Report]:
    """Show how far the work of the block has come.

    Parameters
    ----------
    title : str
        What is being done, until the work says more.

    Yields
    ------
    callable
        To be called with the share done, 0 to 1, and a short text; does nothing where there is no terminal.
    """
    if not sys.stderr.isatty():
        yield _silent
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    description = TextColumn("{task.description}", markup=False)
    columns = (description, BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    display = Progress(*columns, console=Console(stderr=True), transient=True)
    task = display.add_task(title, total=1.0)

    def report(done: float, text: str) -> None:
        display.update(task, completed=done, description=text or title)

    # A timer, not a look at the clock in `report`: the bar must appear also while the first long step is still running.
    starter = Timer(DELAY, display.start)
    starter.daemon = True
    starter.start()
    try:
        yield report
    finally:
        starter.cancel()
        starter.join()  # had it just begun to start the display, let it finish, then stop it
        if display.live.is_started:
            display.stop()


def _silent(done: float, text: str) -> None:
    """Report to nobody."""
