"""A result read from a file as the answer it was."""

from __future__ import annotations

import xarray as xr

from petalfoil.cli.answer import Answer
from petalfoil.cli.kinds import KINDS, MODES, OVER_TIME, ChartAnswer
from petalfoil.cli.study import StudyAnswer
from petalfoil.results import Record, Scalar
from petalfoil.results.schema import SCALARS, DataType
from petalfoil.results.study import error_bars_of, estimates_of

_PLAIN = {DataType.FLOAT: float, DataType.INT: int, DataType.BOOL: bool, DataType.STR: str}


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
    if "load" in dataset.dims:
        return _chart(dataset)
    is_curve = "point" in dataset.dims
    points = [dataset.isel(point=index) for index in range(dataset.sizes["point"])] if is_curve else [dataset]
    verb = str(dataset.attrs["analysis"])
    title = str(dataset.attrs.get("title", ""))
    records = tuple(_record(point, verb, title) for point in points)
    errors = None if is_curve else error_bars_of(dataset) or None
    return KINDS.get(verb, Answer)(verb=verb, records=records, is_curve=is_curve, errors=errors)


def _record(point: xr.Dataset, verb: str, title: str) -> Record:
    """The scalars of a point, and the fields that are printed: stiffness and damping, modes, a motion's histories."""
    scalars = _scalars(point)
    if not scalars.get("converged", True):
        return Record(analysis=verb, scalars=scalars, title=title)
    printed = ("stiffness", "damping", *MODES, *OVER_TIME)
    fields = {name: point[name].values for name in printed if name in point and point[name].dims}
    axes = ("whirl_frequency", "row", "column", "mode", "time")
    coords = {dim: point[dim].values for dim in axes if dim in point.dims}
    return Record(analysis=verb, scalars=scalars, title=title, fields=fields, coords=coords)


def _chart(dataset: xr.Dataset) -> ChartAnswer:
    """The points that were computed of a table over load and speed."""
    verb, title = str(dataset.attrs["analysis"]), str(dataset.attrs.get("title", ""))
    places = [(row, column) for row in range(dataset.sizes["load"]) for column in range(dataset.sizes["speed"])]
    points = [dataset.isel(load=row, speed=column) for row, column in places]
    computed = [point for point in points if str(point["status"].item())]
    records = tuple(_record(point, verb, title) for point in computed)
    return ChartAnswer(verb=verb, records=records)


def _study(dataset: xr.Dataset) -> StudyAnswer:
    verb, title = str(dataset.attrs["analysis"]), str(dataset.attrs.get("title", ""))
    grids = [dataset.isel(grid=index) for index in range(dataset.sizes["grid"])]
    records = tuple(Record(analysis=verb, scalars=_scalars(grid), title=title) for grid in grids)
    return StudyAnswer(verb=verb, records=records, estimates=estimates_of(dataset))


def _scalars(point: xr.Dataset) -> dict[str, Scalar]:
    here = {name: variable for name, variable in SCALARS.items() if name in point and not point[name].dims}
    known = {name: _PLAIN[variable.kind](point[name].item()) for name, variable in here.items()}
    if known.get("converged", True):
        return known
    # A count that a failed point does not have is -1 in the file, for whole numbers know no NaN.
    return {name: value for name, value in known.items() if SCALARS[name].kind is not DataType.INT or value != -1}
