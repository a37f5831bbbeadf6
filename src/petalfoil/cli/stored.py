"""A result read from a file as the answer it was."""

from __future__ import annotations

import xarray as xr

from petalfoil.cli.answer import Answer
from petalfoil.cli.study import StudyAnswer
from petalfoil.results import Record, Scalar
from petalfoil.results.schema import SCALARS, Kind
from petalfoil.results.study import error_bars_of, estimates_of

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
    if "grid" in dataset.dims:
        return _study(dataset)
    is_curve = "point" in dataset.dims
    points = [dataset.isel(point=index) for index in range(dataset.sizes["point"])] if is_curve else [dataset]
    verb = str(dataset.attrs["analysis"])
    title = str(dataset.attrs.get("title", ""))
    records = tuple(Record(analysis=verb, scalars=_scalars(point), title=title) for point in points)
    errors = None if is_curve else error_bars_of(dataset) or None
    return Answer(verb=verb, records=records, is_curve=is_curve, errors=errors)


def _study(dataset: xr.Dataset) -> StudyAnswer:
    verb, title = str(dataset.attrs["analysis"]), str(dataset.attrs.get("title", ""))
    grids = [dataset.isel(grid=index) for index in range(dataset.sizes["grid"])]
    records = tuple(Record(analysis=verb, scalars=_scalars(grid), title=title) for grid in grids)
    return StudyAnswer(verb=verb, records=records, estimates=estimates_of(dataset))


def _scalars(point: xr.Dataset) -> dict[str, Scalar]:
    known = {name: _PLAIN[variable.kind](point[name].item()) for name, variable in SCALARS.items() if name in point}
    if known.get("converged", True):
        return known
    # A count that a failed point does not have is -1 in the file, for whole numbers know no NaN.
    return {name: value for name, value in known.items() if SCALARS[name].kind is not Kind.INT or value != -1}
