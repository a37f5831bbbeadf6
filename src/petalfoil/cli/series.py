"""Runs through the points of a curve and keeps what is finished, whatever happens."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from petalfoil.cli.answer import Answer
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.progress import Report
from petalfoil.cli.streams import say

if TYPE_CHECKING:
    from petalfoil.results import Record


def collect(
    points: Iterable[Record], count: int, autosave: Autosave, report: Report, kind: type[Answer] = Answer
) -> Answer:
    """Run all points.

    Parameters
    ----------
    points : iterable of Record
        Computes a point whenever the next is asked for.
    count : int
        How many there will be.
    autosave : Autosave
        Keeps the file of finished points.
    report : callable
        Shows how far it has come.
    kind : type
        DataType of the answer.

    Returns
    -------
    Answer
        All points; or, when the user interrupted, those that were finished.

    Raises
    ------
    KeyboardInterrupt
        Interrupted before the first point was finished.
    """
    records: list[Record] = []
    try:
        for record in points:
            records.append(record)
            report(len(records) / count, f"{autosave.verb}: {len(records)} of {count} points")
            autosave.offer(records)
    except KeyboardInterrupt:
        if not records:
            raise
        say(f"interrupted: {len(records)} of {count} points are finished and kept")
        return kind(verb=autosave.verb, records=tuple(records), is_curve=True, interrupted=True)
    except Exception:
        autosave.flush(records)  # the run is lost, its finished points need not be
        raise
    return kind(verb=autosave.verb, records=tuple(records), is_curve=True)
