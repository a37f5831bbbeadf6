"""A grid study: records along the dimension ``grid``, with limits and error bars beside them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from petalfoil.results.estimate import Estimate
from petalfoil.results.layout import Json, Layout
from petalfoil.results.record import Record
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import as_json

if TYPE_CHECKING:
    import xarray as xr

ERROR_BAR = "grid_error"
"""Attribute of a result of a point: its error bar from a grid study, in the result's unit."""

_GRID = {"long_name": "number of the grid, coarsest first", "units": "1"}
_PARTS = {
    "limit": "grid-converged value of the ",
    "error": "error bar of the limit of the ",
    "order": "observed order of convergence of the ",
    "trusted": "the observed order is credible: ",
}


@dataclass(frozen=True, kw_only=True)
class GridStudy(Layout):
    """The same question on finer and finer grids, coarsest first, and what the answers tend to.

    Its JSON object has two keys: ``grids``, the objects of `solve` with ``cells_per_pitch`` and, in a 3-D model,
    ``axial_cells``; and ``quantities``, for each result its ``values`` on the grids, the observed ``order``, the
    ``limit``, its ``error`` bar and whether it can be ``trusted``.

    Attributes
    ----------
    conclude : callable
        What the records tell together.
    """

    dimension: ClassVar[str] = "grid"

    conclude: Callable[[Sequence[Record]], Sequence[Estimate]]

    def to_json(self, records: Sequence[Record]) -> dict[str, Json]:
        """The records of the grids."""
        return {"grids": [as_json(record) for record in records]}

    def to_dataset(self, records: Sequence[Record], verb: str) -> xr.Dataset:
        """Results along ``grid``; fields live on different grids and are left out."""
        from petalfoil.results.dataset import curve_dataset

        bare = [replace(record, fields={}, coords={}) for record in records]
        ds = curve_dataset(bare, verb).rename(point="grid")
        return ds.assign_coords(grid=("grid", np.arange(len(records)), _GRID))

    def points(self, ds: xr.Dataset) -> list[xr.Dataset]:
        """The grids."""
        return [ds.isel(grid=index) for index in range(ds.sizes["grid"])]

    def estimates(self, records: Sequence[Record]) -> tuple[Estimate, ...]:
        """What the grids tell about every result."""
        return tuple(self.conclude(records))

    def stored_estimates(self, ds: xr.Dataset) -> tuple[Estimate, ...]:
        """The same, read back from a dataset."""
        return estimates_of(ds)

    def place(self, number: int, record: Record) -> str:
        """The grid."""
        return f"the grid of {grid_text(record)} cells"


def grid_text(record: Record) -> str:
    """Cells per pitch and, in a 3-D model, along the axis."""
    grid = (record.scalars[name] for name in ("cells_per_pitch", "axial_cells") if name in record.scalars)
    return " x ".join(map(str, grid))


def with_estimates(ds: xr.Dataset, estimates: Sequence[Estimate]) -> xr.Dataset:
    """Add ``f_limit``, ``f_error``, ``f_order`` and ``f_trusted`` for each estimated result ``f``."""
    return ds.assign({name: variable for estimate in estimates for name, variable in _variables(estimate).items()})


def estimates_of(ds: xr.Dataset) -> tuple[Estimate, ...]:
    """Read back the estimates of a study."""
    return tuple(
        Estimate(
            name=name,
            values=tuple(float(value) for value in ds[name].values),
            limit=float(ds[f"{name}_limit"]),
            order=float(ds[f"{name}_order"]),
            error=float(ds[f"{name}_error"]),
            trusted=bool(ds[f"{name}_trusted"]),
        )
        for name in SCALARS
        if f"{name}_limit" in ds
    )


def with_error_bars(ds: xr.Dataset, errors: Mapping[str, float]) -> xr.Dataset:
    """Note the error bars of a point's results as attributes."""
    ds = ds.copy()
    for name, error in errors.items():
        ds[name].attrs[ERROR_BAR] = error
    return ds


def with_errors_of_points(ds: xr.Dataset, records: Sequence[Record]) -> xr.Dataset:
    """Add ``f_error`` along ``point`` for each result ``f`` that has an error bar, NaN where a point has none."""
    bars = [record.errors or {} for record in records]
    names = [name for name in SCALARS if any(name in errors for errors in bars)]
    return ds.assign({f"{name}_error": _error_along_points(name, bars) for name in names})


def _error_along_points(name: str, bars: Sequence[Mapping[str, float]]) -> tuple[Any, ...]:
    declared = SCALARS[name]
    attributes = {"long_name": f"error bar of the {declared.long_name}", "units": declared.units}
    return "point", np.array([errors.get(name, np.nan) for errors in bars]), attributes


def errors_of_point(point: xr.Dataset) -> dict[str, float]:
    """Read back the error bars of a point of a series."""
    read = {name: float(point[f"{name}_error"]) for name in SCALARS if f"{name}_error" in point}
    return {name: error for name, error in read.items() if np.isfinite(error)}


def error_bars_of(ds: xr.Dataset) -> dict[str, float]:
    """Read back the error bars of a point's results."""
    return {name: float(ds[name].attrs[ERROR_BAR]) for name in SCALARS if name in ds and ERROR_BAR in ds[name].attrs}


def _variables(estimate: Estimate) -> dict[str, tuple[Any, ...]]:
    declared = SCALARS[estimate.name]
    units = {"limit": declared.units, "error": declared.units, "order": "1", "trusted": "1"}
    return {
        f"{estimate.name}_{part}": (
            (),
            np.asarray(getattr(estimate, part)),
            {"long_name": text + declared.long_name, "units": units[part]},
        )
        for part, text in _PARTS.items()
    }
