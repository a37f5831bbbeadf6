"""A result read from a file as the answer it was."""

from __future__ import annotations

import xarray as xr

from petalfoil.cli.answer import Answer
from petalfoil.results import Record, Scalar
from petalfoil.results.schema import SCALARS, Kind

_PLAIN = {Kind.FLOAT: float, Kind.INT: int, Kind.BOOL: bool, Kind.STR: str}


def answer_of(dataset: xr.Dataset) -> Answer:
    """Take the scalars of a result; its fields stay in the dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        Result as ``results.store.load`` gives it.

    Returns
    -------
    Answer
        One record, or one a point. Variables that this version does not know are left out.
    """
    is_curve = "point" in dataset.dims
    points = [dataset.isel(point=index) for index in range(dataset.sizes["point"])] if is_curve else [dataset]
    verb = str(dataset.attrs["analysis"])
    title = str(dataset.attrs.get("title", ""))
    records = tuple(Record(analysis=verb, scalars=_scalars(point), title=title) for point in points)
    return Answer(verb=verb, records=records, is_curve=is_curve)


def _scalars(point: xr.Dataset) -> dict[str, Scalar]:
    known = {name: _PLAIN[variable.kind](point[name].item()) for name, variable in SCALARS.items() if name in point}
    if known.get("converged", True):
        return known
    # A count that a failed point does not have is -1 in the file, for whole numbers know no NaN.
    return {name: value for name, value in known.items() if SCALARS[name].kind is not Kind.INT or value != -1}
