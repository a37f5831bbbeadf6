"""The progress bar: at a terminal on standard error, in a notebook a line of its own; only for work over a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Timer
from typing import Any, TypeAlias

Report: TypeAlias = Callable[[float, str], None]

REWRITE = 0.5  # [s] a browser that is told more often falls behind
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
        To be called with the share done, 0 to 1, and a short text; does nothing where nobody looks on.
    """
    if in_notebook():
        with _line(title) as tell:
            yield tell
        return
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


def in_notebook() -> bool:
    """Whether the program runs in the kernel of a notebook."""
    interactive = sys.modules.get("IPython")
    shell = interactive.get_ipython() if interactive is not None else None
    return hasattr(shell, "kernel")


@contextmanager
def _line(title: str) -> Iterator[Report]:
    """A line below the cell, which is rewritten as the work proceeds and empty at its end."""
    from IPython.display import display

    started = shown = time.monotonic()
    handle: Any = None

    def report(done: float, text: str) -> None:
        nonlocal shown, handle
        now = time.monotonic()
        if now - started < DELAY or (handle is not None and now - shown < REWRITE):
            return
        shown, line = now, {"text/plain": f"{text or title}: {done:.0%}"}
        if handle is None:
            handle = display(line, raw=True, display_id=True)
        else:
            handle.update(line, raw=True)

    try:
        yield report
    finally:
        if handle is not None:
            handle.update({"text/plain": ""}, raw=True)


def _silent(done: float, text: str) -> None:
    """Report to nobody."""
