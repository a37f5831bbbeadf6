"""A series that goes on from the points it wrote before it was stopped: what was asked, and what is done of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from petalfoil.case import Case, warnings_of
from petalfoil.errors import UsageError
from petalfoil.results.answer import ASKED
from petalfoil.results.layout import Layout
from petalfoil.results.record import Record

if TYPE_CHECKING:
    import xarray as xr

SAME = 1e-6
"""Relative difference up to which a solution found again is the one that was stored: both are solved to 1e-8."""


def asked_for(case: Case, values: Mapping[str, Any]) -> str:
    """What a series is asked for, as JSON: a digest of the case, and the arguments in SI units, defaults included."""
    digest = hashlib.sha256(case.to_toml().encode()).hexdigest()
    return json.dumps({"case": digest, "arguments": dict(values)}, sort_keys=True)


def points_done(ds: xr.Dataset, layout: Layout, verb: str, asked: str) -> tuple[Record, ...]:
    """The points of a stored series, to go on after.

    Parameters
    ----------
    ds : xarray.Dataset
        What the series wrote.
    layout : Layout
        Its layout.
    verb : str
        Analysis that is to go on.
    asked : str
        What it is asked for now, by `asked_for`.

    Raises
    ------
    UsageError
        The result is that of another analysis, of another case or of other arguments.
    """
    if ds.attrs.get("analysis") != verb or ASKED not in ds.attrs or layout.dimension not in ds.dims:
        raise UsageError(f"the result to go on from is no series of {verb}: give a file that {verb} wrote")
    before, now = json.loads(ds.attrs[ASKED]), json.loads(asked)
    if before["case"] != now["case"]:
        raise UsageError("the result to go on from is that of another case: give the case that it was computed for")
    names = {*before["arguments"], *now["arguments"]}
    other = [name for name in sorted(names) if before["arguments"].get(name) != now["arguments"].get(name)]
    if other:
        raise UsageError(
            f"the result to go on from was asked for with other arguments: {', '.join(other)}; give those of the first "
            "run, in full"
        )
    case = Case.from_toml(str(ds.attrs["case"]))
    records = layout.whole_records(ds)
    return tuple(replace(record, warnings=tuple(warnings_of(case, record.scalars))) for record in records)


def is_same(record: Record, found: Mapping[str, float]) -> bool:
    """Whether a solution that was found again is that of a stored record.

    Parameters
    ----------
    record : Record
        The stored point.
    found : mapping
        Results of the solution by name, SI; components of a vector are compared with its size.
    """
    stored = np.array([float(record.scalars[name]) for name in found])
    return bool(np.linalg.norm(stored - np.array(list(found.values()))) <= SAME * np.linalg.norm(stored))
