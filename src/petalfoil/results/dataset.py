"""Records to labelled data: one point, or a curve of points along the leading dimension ``point``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import xarray as xr

from petalfoil.results import view  # noqa: F401 - gives datasets `petalfoil`, the tables of the result
from petalfoil.results.record import NO_COUNT, Array, Record, Scalar, blank
from petalfoil.results.schema import COORDINATES, FIELDS, SCALARS
from petalfoil.results.variable import DataType, Role, Variable

CONVENTIONS = "CF-1.11"
_DTYPES: dict[DataType, type] = {
    DataType.FLOAT: np.float64,
    DataType.INT: np.int64,
    DataType.BOOL: np.bool_,
    DataType.STR: np.str_,
}
RAGGED = ("contact",)
"""Dimensions whose length differs from point to point of a curve: shorter ones end in NaN."""
_POINT = {"long_name": "number of the point along the curve", "units": "1"}


ALWAYS_KEPT = (Role.GEOMETRY, Role.BOOKKEEPING)
"""Fields of these roles are kept of a state that did not converge too."""


def to_dataset(record: Record) -> xr.Dataset:
    """Label one record.

    Parameters
    ----------
    record : Record
        One answer; of a state that did not converge only the inputs and the bookkeeping are kept.

    Returns
    -------
    xarray.Dataset
        Scalars and fields with their units, names and symbols; the case and the history as attributes.
    """
    variables = {name: _labelled(SCALARS[name], value) for name, value in record.reported().items()}
    for name, values in record.fields.items():
        if record.converged or FIELDS[name].role in ALWAYS_KEPT:
            variables[name] = _labelled(FIELDS[name], values)
    attributes = _attributes(record, record.analysis, _plain_history(record))
    return xr.Dataset(variables, coords=_coordinates(record.coords), attrs=attributes)


def curve_dataset(records: Sequence[Record], analysis: str = "curve") -> xr.Dataset:
    """Line up the records of a curve along ``point``.

    Geometry is stored once; a figure or field that a point lacks, or that did not converge, is NaN there.

    Parameters
    ----------
    records : sequence of Record
        The points in order, of one case on one grid.
    analysis : str
        Verb the curve answers.

    Returns
    -------
    xarray.Dataset
        As ``to_dataset``, with the leading dimension ``point``.

    Raises
    ------
    ValueError
        No record; or the records differ in geometry or grid, or converged ones in their flags.
    """
    if not records:
        raise ValueError("a curve needs at least one record")
    coords = _common_coordinates(records)
    variables = _curve_scalars(records) | _curve_fields(records, coords)
    labelled = _coordinates(coords) | {"point": ("point", np.arange(len(records)), _POINT)}
    attributes = _attributes(records[0], analysis, [_plain_history(record) for record in records])
    return xr.Dataset(variables, coords=labelled, attrs=attributes)


def whole_record(point: xr.Dataset, scalars: dict[str, Scalar], history: list[dict[str, Any]]) -> Record:
    """The record that a point of a dataset was made from.

    Parameters
    ----------
    point : xarray.Dataset
        The point, without the dimension of its series.
    scalars : dict
        Its scalars.
    history : list of dict
        Its history.

    Returns
    -------
    Record
        The record; without fields, and without what is not there, where the point did not converge.
    """
    converged = bool(scalars.get("converged", True))
    fields = {name: point[name] for name in FIELDS if name in point and point[name].dims} if converged else {}
    coords = {name: point[name].values for name in COORDINATES if fields and name in point.coords and point[name].dims}
    absent = set() if converged else {name for name, value in scalars.items() if value != value}
    return Record(
        analysis=str(point.attrs["analysis"]),
        title=str(point.attrs["title"]),
        scalars={name: value for name, value in scalars.items() if name not in absent},
        fields={name: array.values for name, array in fields.items()},
        coords=coords,
        case_toml=str(point.attrs["case"]),
        history=history,
    )


def _curve_scalars(records: Sequence[Record]) -> dict[str, tuple[Any, ...]]:
    reported = [record.reported() for record in records]
    variables: dict[str, tuple[Any, ...]] = {}
    for name in _in_order(SCALARS, *reported):
        variable = SCALARS[name]
        if variable.role is Role.GEOMETRY:
            variables[name] = _labelled(variable, _shared(name, reported))
        else:
            values = [_value(name, point, record) for point, record in zip(reported, records, strict=True)]
            variables[name] = _labelled(variable, values, ("point",))
    return variables


def _curve_fields(records: Sequence[Record], coords: Mapping[str, Array]) -> dict[str, tuple[Any, ...]]:
    variables: dict[str, tuple[Any, ...]] = {}
    for name in _in_order(FIELDS, *(record.fields for record in records)):
        variable = FIELDS[name]
        if variable.role is Role.GEOMETRY:
            holder = next(record for record in records if name in record.fields)
            variables[name] = _labelled(variable, holder.fields[name])
            continue
        nothing = np.full([len(coords[dim]) for dim in variable.dims], np.nan)
        kept = variable.role in ALWAYS_KEPT
        values = [record.fields.get(name, nothing) if record.converged or kept else nothing for record in records]
        if variable.dims[0] in RAGGED:
            values = [np.concatenate([value, nothing[len(value) :]]) for value in values]
        variables[name] = _labelled(variable, np.stack(values), ("point", *variable.dims))
    return variables


def _value(name: str, point: Mapping[str, Scalar], record: Record) -> Scalar:
    if name in point:
        return point[name]
    if record.converged and SCALARS[name].kind is DataType.BOOL:
        raise ValueError(f"a converged point of the curve lacks {name!r}, which others have")
    return blank(SCALARS[name])


def _shared(name: str, reported: Sequence[Mapping[str, Scalar]]) -> Scalar:
    values = [point[name] for point in reported if name in point]
    if any(not _same(value, values[0]) for value in values):
        raise ValueError(f"the points of a curve must share {name!r}, got {sorted(set(values), key=str)}")
    return values[0]


def _same(a: Scalar, b: Scalar) -> bool:
    both_nan = isinstance(a, float) and isinstance(b, float) and math.isnan(a) and math.isnan(b)
    return both_nan or a == b


def _common_coordinates(records: Sequence[Record]) -> dict[str, Array]:
    coords: dict[str, Array] = {}
    for record in records:
        for name, values in record.coords.items():
            if name in RAGGED:
                coords[name] = max(coords.get(name, values), values, key=len)
                continue
            if not np.array_equal(coords.setdefault(name, values), values):
                raise ValueError(f"the points of a curve must share the coordinate {name!r}")
    return coords


def _in_order(declared: Mapping[str, Variable], *given: Mapping[str, object]) -> list[str]:
    return [name for name in declared if any(name in mapping for mapping in given)]


def _coordinates(coords: Mapping[str, Array]) -> dict[str, tuple[Any, ...]]:
    return {name: _labelled(COORDINATES[name], coords[name]) for name in _in_order(COORDINATES, coords)}


def _labelled(variable: Variable, values: object, dims: tuple[str, ...] | None = None) -> tuple[Any, ...]:
    attributes: dict[str, object] = {"long_name": variable.long_name, "symbol": variable.symbol}
    if variable.units:
        attributes["units"] = variable.units
    if variable.kind is DataType.BOOL:
        attributes |= {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "false true"}
    if variable.kind is DataType.INT and dims == ("point",):
        attributes["comment"] = f"{NO_COUNT} where a point has none"
    return variable.dims if dims is None else dims, np.array(values, dtype=_DTYPES[variable.kind]), attributes


def _attributes(record: Record, analysis: str, history: list[Any]) -> dict[str, str]:
    return {
        "Conventions": CONVENTIONS,
        "title": record.title,
        "petalfoil_version": _version(),
        "analysis": analysis,
        "case": record.case_toml,
        "history": json.dumps(history, allow_nan=False),
    }


def _plain_history(record: Record) -> list[dict[str, float | int | str | None]]:
    return [{key: _json_value(value) for key, value in entry.items()} for entry in record.history]


def _json_value(value: float | int | str) -> float | int | str | None:
    plain = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(plain, float) and not math.isfinite(plain) else plain


def _version() -> str:
    try:
        return version("petalfoil")
    except PackageNotFoundError:  # the source tree on the path, not installed
        return "0+uninstalled"
