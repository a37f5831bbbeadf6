"""A grid study as labelled data: its records along the dimension ``grid``, limits and error bars beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from petalfoil.results.dataset import curve_dataset
from petalfoil.results.estimate import Estimate
from petalfoil.results.record import Record
from petalfoil.results.schema import SCALARS

ERROR_BAR = "grid_error"
"""Attribute of a figure of a point: its error bar from a grid study, in the figure's unit."""

_GRID = {"long_name": "number of the grid, coarsest first", "units": "1"}
_PARTS = {
    "limit": "limit for vanishing cells of the ",
    "error": "error bar of the limit of the ",
    "order": "observed order of convergence of the ",
    "trusted": "the observed order is credible: ",
}


def study_dataset(records: Sequence[Record], estimates: Sequence[Estimate]) -> xr.Dataset:
    """Line up the records of a grid study along ``grid``; fields live on different grids and are left out.

    Parameters
    ----------
    records : sequence of Record
        One for each grid, coarsest first.
    estimates : sequence of Estimate
        What they tell.

    Returns
    -------
    xarray.Dataset
        Figures along ``grid``; for each estimated figure ``f`` also ``f_limit``, ``f_error``, ``f_order``,
        ``f_trusted``. The case is that of the coarsest grid.
    """
    bare = [replace(record, fields={}, coords={}) for record in records]
    ds = curve_dataset(bare, "converge").rename(point="grid")
    ds = ds.assign_coords(grid=("grid", np.arange(len(records)), _GRID))
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
    """Note the error bars of a point's figures as attributes."""
    ds = ds.copy()
    for name, error in errors.items():
        ds[name].attrs[ERROR_BAR] = error
    return ds


def error_bars_of(ds: xr.Dataset) -> dict[str, float]:
    """Read back the error bars of a point's figures."""
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
