"""Points over load and speed as labelled data: a table with a row for each load and a column for each speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from petalfoil.results.dataset import curve_dataset
from petalfoil.results.record import Record
from petalfoil.results.schema import COORDINATES, SCALARS, Variable

DIMS = ("load", "speed")


def chart_dataset(records: Sequence[Record], analysis: str = "stability") -> xr.Dataset:
    """Lay out records over load and speed.

    Parameters
    ----------
    records : sequence of Record
        Points with `load_x`, `load_y` and `speed`, in any number; what is missing of the table is NaN (false, empty).
    analysis : str
        Verb the table answers.

    Returns
    -------
    xarray.Dataset
        Figures along ``load`` (size of the load) and ``speed``, in the order in which they were first met.
    """
    points = curve_dataset(records, analysis)
    loads = list(zip(points["load_x"].values.tolist(), points["load_y"].values.tolist(), strict=True))
    speeds = points["speed"].values.tolist()
    rows, columns = list(dict.fromkeys(loads)), list(dict.fromkeys(speeds))
    places = [rows.index(load) for load in loads], [columns.index(speed) for speed in speeds]
    shape = (len(rows), len(columns))
    variables: dict[str, tuple[Any, ...]] = {}
    for name, variable in points.data_vars.items():
        if name == "speed":
            continue
        if "point" not in variable.dims:
            variables[str(name)] = (variable.dims, variable.values, variable.attrs)
            continue
        table = np.full(shape, _missing(variable.dtype), dtype=variable.dtype)
        table[places] = variable.values
        variables[str(name)] = (DIMS, table, variable.attrs)
    coords = {
        "load": ("load", np.hypot(*np.array(rows).T), _attributes(COORDINATES["load"])),
        "speed": ("speed", np.array(columns), _attributes(SCALARS["speed"])),
    }
    return xr.Dataset(variables, coords=coords, attrs=points.attrs)


def _attributes(variable: Variable) -> dict[str, str]:
    return {"long_name": variable.long_name, "symbol": variable.symbol, "units": variable.units}


def _missing(dtype: np.dtype[Any]) -> float | int | bool | str:
    """What stands where no point was computed."""
    missing: dict[str, float | int | bool | str] = {"f": np.nan, "i": -1, "b": False, "U": ""}
    return missing[dtype.kind]
