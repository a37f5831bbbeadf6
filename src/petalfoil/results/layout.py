"""What an analysis returns: one point or a series of points, as JSON, as labelled data, and read back from a file.

An analysis declares its layouts; `grid.py` and `study.py` hold two more. A dataset tells its layout by its dimensions.
"""

from __future__ import annotations

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from petalfoil.results.estimate import Estimate
from petalfoil.results.record import NO_COUNT, Record, Scalar
from petalfoil.results.rounding import without_rounding
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import TableRow, as_json
from petalfoil.results.variable import DataType

if TYPE_CHECKING:
    import xarray as xr

Json: TypeAlias = Any
Cell: TypeAlias = float | str
_PLAIN = {DataType.FLOAT: float, DataType.INT: int, DataType.BOOL: bool, DataType.STR: str}


@dataclass(frozen=True)
class ArrayTable:
    """A printed table of a record's arrays: a line for each entry along one dimension.

    Attributes
    ----------
    dim : str
        The dimension.
    columns : dict
        Heading, and the value of a record at an index.
    there : callable or None
        Whether a record has a line at an index; by default it has.
    title : str
        What stands above it where an answer has several.
    keys : int
        Columns at the left that tell what a line is of.
    """

    dim: str
    columns: Mapping[str, Callable[[Record, int], Cell]]
    there: Callable[[Record, int], bool] | None = None
    title: str = ""
    keys: int = 1

    def lines(self, record: Record) -> Iterator[list[Cell]]:
        """The values line by line; none where the record has no such dimension."""
        for index in range(len(record.coords.get(self.dim, ()))):
            if self.there is None or self.there(record, index):
                yield [value(record, index) for value in self.columns.values()]


def at_position(record: Record) -> str:
    """The position of the journal in words."""
    shown = without_rounding(record)
    x, y = (1e6 * float(shown[f"eccentricity_{axis}"]) for axis in "xy")
    return f"at ({x:.4g}, {y:.4g}) um"


def at_speed(record: Record) -> str:
    """The speed in words."""
    leg = str(record.scalars.get("leg", ""))
    return f"{leg} at {float(record.scalars['speed']) * 30.0 / math.pi:.0f} rpm".lstrip()


def of_load(record: Record) -> str:
    """The load in words."""
    return f"of {load_of(record):g} N"


def load_of(record: Record) -> float:
    """Size of the load of a record [N]."""
    return math.hypot(*(float(record.scalars[f"load_{axis}"]) for axis in "xy"))


@dataclass(frozen=True, kw_only=True)
class Layout(ABC):
    """How the records of an analysis are given out.

    Attributes
    ----------
    lists : tuple of str
        Arrays that the JSON object holds as lists, null where a record has none.
    histories : tuple of str
        Arrays that it holds where they are there.
    array_tables : tuple of ArrayTable
        Tables of these arrays; those that no record fills are left out.
    """

    dimension: ClassVar[str] = ""
    """Dimension by which a dataset of this layout is known; of one point there is none."""
    takes_error_bars: ClassVar[bool] = True
    """Whether its records may have error bars."""

    lists: tuple[str, ...] = ()
    histories: tuple[str, ...] = ()
    array_tables: tuple[ArrayTable, ...] = ()

    @abstractmethod
    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """The object that ``--json`` prints."""

    @abstractmethod
    def to_dataset(self, records: Sequence[Record], verb: str) -> xr.Dataset:
        """Labelled data."""

    @abstractmethod
    def points(self, ds: xr.Dataset) -> list[xr.Dataset]:
        """The single points of a dataset."""

    @abstractmethod
    def place(self, number: int, record: Record) -> str:
        """Where the record number `number` stands, in words."""

    def records(self, ds: xr.Dataset) -> tuple[Record, ...]:
        """The records of a dataset, as far as JSON and tables need them."""
        return tuple(self._record(point, ds) for point in self.points(ds))

    def whole_records(self, ds: xr.Dataset) -> tuple[Record, ...]:
        """The records of a dataset with all their arrays and their history, to add points to."""
        from petalfoil.results.dataset import whole_record

        history = json.loads(ds.attrs["history"])
        pairs = zip(self.points(ds), history, strict=True)
        return tuple(whole_record(point, scalars_of_point(point), steps) for point, steps in pairs)

    def estimates(self, records: Sequence[Record]) -> tuple[Estimate, ...]:
        """What the records together tell about their limit; nothing but for a grid study."""
        return ()

    def stored_estimates(self, ds: xr.Dataset) -> tuple[Estimate, ...]:
        """The same, read back from a dataset."""
        return ()

    def object_of(self, record: Record) -> dict[str, Json]:
        """One record as a JSON object."""
        arrays = {**record.coords, **record.fields}
        plain: dict[str, Json] = {**as_json(record)}
        plain |= {name: arrays[name].tolist() if name in arrays else None for name in self.lists}
        plain |= {name: arrays[name].tolist() for name in self.histories if name in arrays}
        return plain if record.errors is None else plain | {"error": dict(record.errors)}

    def _record(self, point: xr.Dataset, ds: xr.Dataset) -> Record:
        scalars = scalars_of_point(point)
        wanted = (*self.lists, *self.histories) if scalars.get("converged", True) else ()
        arrays = {name: point[name] for name in wanted if name in point and point[name].dims}
        coords = {str(dim): point[dim].values for array in arrays.values() for dim in array.dims}
        return Record(
            analysis=str(ds.attrs["analysis"]),
            title=str(ds.attrs.get("title", "")),
            scalars=scalars,
            fields={name: array.values for name, array in arrays.items() if name not in coords},
            coords=coords,
        )


@dataclass(frozen=True, kw_only=True)
class SinglePoint(Layout):
    """One record.

    Attributes
    ----------
    rows : callable or None
        Lines of the table; by default the scalars that tables show.
    """

    rows: Callable[[Record], Iterable[TableRow]] | None = None

    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """The record as one object."""
        return self.object_of(records[-1])

    def to_dataset(self, records: Sequence[Record], verb: str) -> xr.Dataset:
        """The record as labelled data."""
        from petalfoil.results.dataset import to_dataset
        from petalfoil.results.study import with_error_bars

        record = records[-1]
        return to_dataset(record) if record.errors is None else with_error_bars(to_dataset(record), record.errors)

    def points(self, ds: xr.Dataset) -> list[xr.Dataset]:
        """The dataset itself."""
        return [ds]

    def records(self, ds: xr.Dataset) -> tuple[Record, ...]:
        """The record, with its error bars."""
        from petalfoil.results.study import error_bars_of

        (record,) = super().records(ds)
        return (replace(record, errors=error_bars_of(ds) or None),)

    def place(self, number: int, record: Record) -> str:
        """The run at the journal's position."""
        return f"the run {at_position(record)}"


@dataclass(frozen=True, kw_only=True)
class Series(Layout):
    """Points in order, along the dimension ``point``.

    Attributes
    ----------
    columns : dict
        Columns of the table with their headings; those that no point has are left out.
    head : callable or None
        What the JSON object tells beside its points.
    legs : tuple of str
        Values of ``leg``, each of which has a list of its own in the JSON object; by default one list, ``points``.
    at : callable
        Where a point stands, in words.
    told : callable or None
        Lines below the table: what is to be said of all points together.
    """

    dimension: ClassVar[str] = "point"

    columns: Mapping[str, str] | None = None
    head: Callable[[list[dict[str, Json]]], dict[str, Json]] | None = None
    legs: tuple[str, ...] = ()
    at: Callable[[Record], str] = at_position
    told: Callable[[Sequence[Record]], Iterable[TableRow]] | None = None

    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """A list of objects, or one for each leg."""
        points = [self.object_of(record) for record in records]
        if self.legs:
            return {leg: [point for point in points if point["leg"] == leg] for leg in self.legs}
        return {**(self.head(points) if self.head else {}), "points": points}

    def to_dataset(self, records: Sequence[Record], verb: str) -> xr.Dataset:
        """The points along ``point``, with the error bar ``f_error`` of each result ``f`` that has one."""
        from petalfoil.results.dataset import curve_dataset
        from petalfoil.results.study import with_errors_of_points

        return with_errors_of_points(curve_dataset(records, verb), records)

    def points(self, ds: xr.Dataset) -> list[xr.Dataset]:
        """The points along ``point``."""
        return [ds.isel(point=number) for number in range(ds.sizes["point"])]

    def records(self, ds: xr.Dataset) -> tuple[Record, ...]:
        """The records, with their error bars."""
        from petalfoil.results.study import errors_of_point

        points = zip(super().records(ds), self.points(ds), strict=True)
        return tuple(replace(record, errors=errors_of_point(point) or None) for record, point in points)

    def place(self, number: int, record: Record) -> str:
        """The point and where it stands."""
        return f"point {number} {self.at(record)}"


@dataclass(frozen=True, kw_only=True)
class ColumnarSeries(Series):
    """Points whose JSON object has a list for each result, in the order of the points.

    Attributes
    ----------
    heads : dict
        Lists that are computed from a record.
    names : tuple of str
        Results that have a list.
    """

    heads: Mapping[str, Callable[[Record], Json]]
    names: tuple[str, ...]

    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """A list for each result."""
        points = [as_json(record) for record in records]
        heads = {name: [value(record) for record in records] for name, value in self.heads.items()}
        return {**heads, **{name: [point.get(name) for point in points] for name in self.names}}


def scalars_of_point(point: xr.Dataset) -> dict[str, Scalar]:
    """The scalars of one point that the schema knows."""
    here = {name: variable for name, variable in SCALARS.items() if name in point and not point[name].dims}
    known = {name: _PLAIN[variable.kind](point[name].item()) for name, variable in here.items()}
    return {name: value for name, value in known.items() if SCALARS[name].kind is not DataType.INT or value != NO_COUNT}
