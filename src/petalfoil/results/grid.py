"""Points over load and speed: a row for each load, a column for each speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from petalfoil.results.layout import Json, Layout, at_speed, load_of, of_load
from petalfoil.results.record import NO_COUNT, Record, Scalar
from petalfoil.results.schema import COORDINATES, SCALARS
from petalfoil.results.summary import as_json
from petalfoil.results.variable import Variable

if TYPE_CHECKING:
    import xarray as xr

DIMS = ("load", "speed")


@dataclass(frozen=True, kw_only=True)
class LoadSpeedGrid(Layout):
    """Results over load and speed, in JSON as ``[load][speed]``; null where nothing was computed.

    Attributes
    ----------
    names : tuple of str
        Results in the JSON object.
    tables : dict
        Results that have a printed table, with its heading.
    """

    dimension: ClassVar[str] = "load"
    takes_error_bars: ClassVar[bool] = False

    names: tuple[str, ...]
    tables: Mapping[str, str]

    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """Loads, speeds, and a table for each result."""
        return {
            "loads": self.loads(records),
            "speeds": self.speeds(records),
            **{name: self.over(records, name) for name in self.names},
        }

    @staticmethod
    def loads(records: Sequence[Record]) -> list[float]:
        """Sizes of the loads [N], a row of the table each."""
        return list(dict.fromkeys(load_of(record) for record in records))

    @staticmethod
    def speeds(records: Sequence[Record]) -> list[float]:
        """Speeds [rad/s], a column of the table each."""
        return list(dict.fromkeys(float(record.scalars["speed"]) for record in records))

    def over(self, records: Sequence[Record], name: str) -> list[list[Scalar | None]]:
        """One result over load and speed."""
        at = {(load_of(record), float(record.scalars["speed"])): as_json(record).get(name) for record in records}
        return [[at.get((load, speed)) for speed in self.speeds(records)] for load in self.loads(records)]

    def to_dataset(self, records: Sequence[Record], verb: str) -> xr.Dataset:
        """Labelled data over load and speed."""
        return grid_dataset(records, verb)

    def points(self, ds: xr.Dataset) -> list[xr.Dataset]:
        """The points that were computed."""
        places = [(row, column) for row in range(ds.sizes["load"]) for column in range(ds.sizes["speed"])]
        points = [ds.isel(load=row, speed=column) for row, column in places]
        return [point for point in points if str(point["status"].item())]

    def place(self, number: int, record: Record) -> str:
        """The point, its load and its speed."""
        return f"point {number} {of_load(record)} {at_speed(record)}"


def grid_dataset(records: Sequence[Record], verb: str) -> xr.Dataset:
    """Lay out records over load and speed.

    Parameters
    ----------
    records : sequence of Record
        Points with `load_x`, `load_y` and `speed`, in any number; what is missing of the table is NaN (false, empty).
    verb : str
        Analysis that gave them.

    Returns
    -------
    xarray.Dataset
        Results along ``load`` (size of the load) and ``speed``, in the order in which they were first met.
    """
    import xarray as xr

    from petalfoil.results.dataset import curve_dataset

    points = curve_dataset(records, verb)
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
    missing: dict[str, float | int | bool | str] = {"f": np.nan, "i": NO_COUNT, "b": False, "U": ""}
    return missing[dtype.kind]
