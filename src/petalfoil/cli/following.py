"""Follows a motion and keeps what is done, whatever happens."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.cli.autosave import Autosave
from petalfoil.cli.kinds import OrbitAnswer
from petalfoil.cli.progress import Report
from petalfoil.cli.streams import say
from petalfoil.errors import StoreError

if TYPE_CHECKING:
    import xarray as xr

    from petalfoil.analysis.orbit import Orbit
    from petalfoil.results import Record

VERB, TURN = "orbit", 2.0 * math.pi


def follow(orbit: Orbit, out: Path | None, report: Report) -> OrbitAnswer:
    """Take all steps.

    Parameters
    ----------
    orbit : Orbit
        The motion, at its start.
    out : Path or None
        File that is rewritten as the motion grows.
    report : callable
        Shows how far it has come.

    Returns
    -------
    OrbitAnswer
        The whole motion; or, when the user interrupted, what of it was done.

    Raises
    ------
    KeyboardInterrupt
        Interrupted before the first step was done.
    ConvergenceError
        No step leads on; what was done is in the file.
    """
    autosave, taken = Autosave(out, VERB, layout=_layout), 0

    def so_far(how: str) -> Record:
        first, last = (orbit.trace.rows[place]["shaft_angle"] for place in (0, -1))
        return orbit.record(f"{how} after {(last - first) / TURN:.4g} turns")

    try:
        for _ in orbit.steps(report):
            taken += 1
            autosave.offer(lambda: [so_far("not finished")])
    except KeyboardInterrupt:
        if not taken:
            raise
        record = so_far("interrupted")
        say(f"{record.scalars['status']}: what is done is kept")
        return OrbitAnswer(verb=VERB, records=(record,), interrupted=True)
    except Exception:  # the run is lost, what was done need not be
        if taken:
            _keep(autosave, so_far("stopped"))
        raise
    return OrbitAnswer(verb=VERB, records=(orbit.record(),))


def _keep(autosave: Autosave, record: Record) -> None:
    """Write what was done; a refusal is said, for the reason why the motion stopped is to be told."""
    try:
        autosave.flush([record])
    except StoreError as error:
        say(f"Warning: {error}")
    else:
        if autosave.path is not None:
            say(f"{record.scalars['status']}: what is done is kept in {autosave.path}")


def _layout(records: Sequence[Record], _verb: str) -> xr.Dataset:
    from petalfoil.results.dataset import to_dataset

    return to_dataset(records[-1])
