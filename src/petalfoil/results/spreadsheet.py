"""Any result as a table for other programs: CSV, or an Excel workbook with fields and units. SI numbers, all digits."""

from __future__ import annotations

import csv
import io
import json
import math
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.atomic import replacing
from petalfoil.results.schema import SCALARS, VARIABLES
from petalfoil.results.study import ERROR_BAR

if TYPE_CHECKING:
    import xarray as xr

Cell: TypeAlias = float | int | bool | str | None
Rows: TypeAlias = list[list[Cell]]

MAX_ROWS = 1_048_576
"""Rows of a sheet of Excel."""

FORMULA = ("=", "+", "-", "@", "\t")
"""First letters of a text that a spreadsheet would take for a formula."""


def write_table(ds: xr.Dataset, path: str | Path) -> None:
    """Write a result for other programs.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of any analysis.
    path : str or Path
        ``.csv``: a row for each point, a column for each quantity with its unit. ``.xlsx``: the same, the meaning of
        each name, fields over their coordinates, and the case, on sheets of their own.

    Raises
    ------
    UsageError
        The suffix is none of these, or openpyxl, which writes workbooks, is missing.
    StoreError
        The file cannot be written.
    """
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in (".csv", ".xlsx"):
        raise UsageError(f"a table is written as .csv or .xlsx; {target.name!r} has the suffix {target.suffix!r}")
    if suffix == ".xlsx":
        need_excel(target)
    try:
        with replacing(target) as temporary:
            if suffix == ".csv":
                temporary.write_text(_csv(points(ds)), encoding="utf-8")
            else:
                _workbook(ds, temporary)
    except OSError as error:
        raise StoreError(f"cannot write {target}: {error.strerror}") from error


def need_excel(path: Path) -> None:
    """Refuse a workbook where what writes it is missing.

    Raises
    ------
    UsageError
        openpyxl is not installed.
    """
    if find_spec("openpyxl") is None:
        raise UsageError(f"{path} needs openpyxl: pip install 'petalfoil[excel]', or write a .csv")


def points(ds: xr.Dataset) -> Rows:
    """A heading and a row for each point: every scalar, and its error bar behind it where it has one."""
    names = [name for name in SCALARS if name in ds]
    columns: dict[str, list[Cell]] = {}
    frame = ds[names].to_dataframe() if any(ds[name].dims for name in names) else None
    for name in names:
        values = [ds[name].item()] if frame is None else frame[name].tolist()
        columns[_headed(name, SCALARS[name].units)] = [_cell(value) for value in values]
        for bar in _bars(ds, name, len(values)):
            columns[_headed(f"{name}_error", SCALARS[name].units)] = bar
    return [list(columns), *map(list, zip(*columns.values(), strict=True))]


def _bars(ds: xr.Dataset, name: str, count: int) -> Iterator[list[Cell]]:
    """Error bars of a scalar, as an attribute of a point or as a variable of a series."""
    if ERROR_BAR in ds[name].attrs:
        yield [_cell(ds[name].attrs[ERROR_BAR])] * count
    elif f"{name}_error" in ds:
        yield [_cell(value) for value in ds[f"{name}_error"].values.ravel().tolist()]


def _csv(rows: Rows) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()


def _workbook(ds: xr.Dataset, path: Path) -> None:
    from openpyxl import Workbook

    book = Workbook(write_only=True)
    for title, rows in _sheets(ds):
        if len(rows) > MAX_ROWS:
            warnings.warn(f"the sheet {title!r} is left out: {len(rows)} rows, {MAX_ROWS} fit", stacklevel=3)
            continue
        sheet = book.create_sheet(title)
        for row in rows:
            sheet.append(row)
    with path.open("wb") as file:  # by itself it would judge the temporary name
        book.save(file)


def _sheets(ds: xr.Dataset) -> Iterator[tuple[str, Rows]]:
    yield "results", points(ds)
    for dims, names in _fields(ds).items():
        frame = ds[names].to_dataframe(dim_order=list(dims)).reset_index()[[*dims, *names]]
        head: list[Cell] = [_headed(name, _units(ds, name)) for name in frame.columns]
        yield "_".join(dims)[:31], [head, *([_cell(value) for value in row] for row in frame.itertuples(index=False))]
    known = [str(name) for name in ds.variables]
    yield "names", [["name", "unit", "meaning"], *([n, _units(ds, n), ds[n].attrs.get("long_name", "")] for n in known)]
    about = ("petalfoil_version", "analysis", "title", "warnings")
    lines = [f"{name}: {ds.attrs[name]}" for name in about if name in ds.attrs]
    yield "case", [[_cell(line)] for line in (*lines, "", *str(ds.attrs.get("case", "")).splitlines())]


def _fields(ds: xr.Dataset) -> dict[tuple[str, ...], list[str]]:
    """Fields by their dimensions: those that are no scalars of points."""
    found: dict[tuple[str, ...], list[str]] = {}
    for key in ds.data_vars:
        name = str(key)
        if name not in SCALARS and name.removesuffix("_error") not in SCALARS and ds[name].dims:
            found.setdefault(tuple(map(str, ds[name].dims)), []).append(name)
    return found


def _units(ds: xr.Dataset, name: str) -> str:
    return str(ds[name].attrs.get("units", VARIABLES[name].units if name in VARIABLES else ""))


def _headed(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _cell(value: Any) -> Cell:
    """A value as a program reads it: nothing for NaN, no text that looks like a formula."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else json.dumps(value)
    if isinstance(value, str) and value.startswith(FORMULA):
        return f"'{value}"
    return value if isinstance(value, float | int | bool | str) else str(value)
