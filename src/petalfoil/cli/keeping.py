"""Follows a run, rewrites its result file as it grows, and keeps what is finished when it is stopped."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.cli.signals import exit_code_of
from petalfoil.cli.streams import say
from petalfoil.errors import StoreError

if TYPE_CHECKING:
    from petalfoil.analysis.declaration import Analysis
    from petalfoil.analysis.progress_bar import Report
    from petalfoil.analysis.runs import Run
    from petalfoil.results.answer import Answer

PERIOD = 2.0  # [s] between rewrites: a fast series is not slowed by its own file
MAX_SHARE = 0.1  # of the time goes into rewriting: the file grows with the series, and is rewritten whole


def follow(analysis: Analysis, run: Run, autosave: Autosave, report: Report) -> tuple[Answer, int]:
    """Compute until the end.

    Parameters
    ----------
    analysis : Analysis
        What is asked.
    run : Run
        The analysis, begun.
    autosave : Autosave
        Keeps the file of what is finished.
    report : callable
        Shows how far it has come.

    Returns
    -------
    tuple of (Answer, int)
        The whole answer and 0; or, when the run was interrupted, what was finished and the exit code.

    Raises
    ------
    KeyboardInterrupt
        Interrupted before anything was finished.
    """
    try:
        for _ in analysis.advance(run, report):
            if run.finished():
                autosave.offer(lambda: analysis.answer(run, "not finished"))
    except KeyboardInterrupt as interrupt:
        finished = run.finished()
        if not finished:
            raise
        say(f"interrupted: {finished} and kept")
        return analysis.answer(run, "interrupted"), exit_code_of(interrupt)
    except Exception:  # the run is lost, what was finished need not be
        _keep(analysis, run, autosave)
        raise
    return analysis.answer(run), 0


def _keep(analysis: Analysis, run: Run, autosave: Autosave) -> None:
    """Write what was finished; a refusal is said, for the reason why the run stopped is to be told."""
    finished = run.finished()
    if autosave.path is None or not finished:
        return
    try:
        autosave.flush(analysis.answer(run, "stopped"))
    except StoreError as error:
        say(f"Warning: {error}")
    else:
        say(f"stopped: {finished} and kept in {autosave.path}")


@contextmanager
def earlier_set_aside(path: Path | None, read: Path | None) -> Iterator[None]:
    """Keep the file of an earlier run from being taken for that of this run, whatever ends it.

    Until this run has written its own file the earlier one is beside it under another name, and stays there if none is
    written. A file that the run goes on from stays where it is.

    Parameters
    ----------
    path : Path or None
        File that the run writes.
    read : Path or None
        File that the run goes on from.
    """
    if path is None or not path.is_file() or (read is not None and read.resolve() == path.resolve()):
        yield
        return
    target = path.resolve()  # a link stays a link
    aside = target.with_name(f"{target.stem}.earlier{target.suffix}")
    target.replace(aside)
    try:
        yield
    finally:
        if target.exists():
            aside.unlink(missing_ok=True)
        else:
            say(f"{path} was not written; that of an earlier run is now {aside.name}")


class Autosave:
    """Keeps a NetCDF file up to date with what is finished.

    Parameters
    ----------
    path : Path or None
        The file; None keeps nothing.
    clock : callable
        Gives the time [s].
    """

    def __init__(self, path: Path | None, clock: Callable[[], float] = time.monotonic) -> None:
        self.path = path
        self._clock = clock
        self._due = clock() + PERIOD

    def offer(self, answer: Callable[[], Answer]) -> None:
        """Write the answer if the last writing is long enough ago; a refusal is said, and does not end the run."""
        if self.path is None or self._clock() < self._due:
            return
        start = self._clock()
        try:
            self.flush(answer())
        except StoreError as error:
            say(f"Warning: {error}; the run goes on and tries again")
        end = self._clock()
        self._due = end + max(PERIOD, (end - start) / MAX_SHARE)

    def flush(self, answer: Answer) -> None:
        """Write the answer now."""
        if self.path is None:
            return
        from petalfoil.results.store import save

        save(answer.to_dataset(), self.path)
