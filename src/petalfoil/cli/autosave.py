"""Rewrites the result file of a curve or a motion as it grows, so that little is lost when the run is."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from petalfoil.cli.streams import say
from petalfoil.errors import StoreError

if TYPE_CHECKING:
    import xarray as xr

    from petalfoil.results import Record

Finished: TypeAlias = "Sequence[Record] | Callable[[], Sequence[Record]]"
"""Records, or what makes them when they are needed."""
Layout: TypeAlias = "Callable[[Sequence[Record], str], xr.Dataset]"

PERIOD = 2.0  # [s] between rewrites: a fast curve is not slowed by its own file
MAX_SHARE = 0.1  # of the time goes into rewriting: the file grows with the curve, and is rewritten whole


class Autosave:
    """Keeps a NetCDF file up to date with the finished points of a curve.

    Parameters
    ----------
    path : Path or None
        The file; None keeps nothing.
    verb : str
        Verb the curve answers, stored in the file.
    clock : callable
        Gives the time [s].
    layout : callable, optional
        Makes labelled data of the points and the verb; by default a curve.
    """

    def __init__(
        self,
        path: Path | None,
        verb: str,
        clock: Callable[[], float] = time.monotonic,
        layout: Layout | None = None,
    ) -> None:
        self.path = path
        self.verb = verb
        self._layout = layout
        self._clock = clock
        self._due = clock() + PERIOD

    def offer(self, records: Finished) -> None:
        """Write the records if the last writing is long enough ago; a refusal is said, and does not end the run."""
        if self.path is None or self._clock() < self._due:
            return
        start = self._clock()
        try:
            self.flush(records)
        except StoreError as error:
            say(f"Warning: {error}; the run goes on and tries again")
        end = self._clock()
        self._due = end + max(PERIOD, (end - start) / MAX_SHARE)

    def flush(self, records: Finished) -> None:
        """Write the records now, if there are any."""
        if self.path is None:
            return
        finished = records() if callable(records) else records
        if not finished:
            return
        from petalfoil.results.dataset import curve_dataset
        from petalfoil.results.store import save

        save((self._layout or curve_dataset)(finished, self.verb), self.path)
