"""What figures take from a study: its parameters and results in readable units, and which cases have no answer."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from petalfoil.errors import UsageError
from petalfoil.plot.labels import QUANTITIES, RPM, PlottedQuantity, quantity
from petalfoil.results.rounding import values_without_rounding
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.text import for_figure

Floats = NDArray[np.float64]

_LENGTHS = ((1e-3, "µm", 1e6), (1.0, "mm", 1e3))
_PRESSURES = ((1e4, "Pa", 1.0), (1e6, "kPa", 1e-3), (1e9, "MPa", 1e-6), (np.inf, "GPa", 1e-9))
_FEW = 4
"""Results that a figure shows unless it is told which."""
_SAME = 1e-3
"""Difference of two results over their scatter below which they are drawn as one: it would not be seen."""
_DERIVATIVES = ("liftoff_by_contact_film_thickness", "liftoff_by_contact_fraction")
"""Results that a figure shows when it is told to."""


def parameters(ds: xr.Dataset) -> list[str]:
    """Names of what varies; of one case, of all that could."""
    names = [str(name) for name in ds.coords if "path" in ds[name].attrs]
    return [name for name in names if ds[name].size > 1] or names


def parameter(ds: xr.Dataset, name: str) -> PlottedQuantity:
    """How a parameter is shown: its meaning, and a unit in which its values are readable."""
    attributes = ds[name].attrs
    meaning, units = for_figure(str(attributes.get("long_name", name))), str(attributes.get("units", ""))
    if of_one := re.search(r"\[(\d+)\]$", str(attributes.get("path", ""))):
        meaning += f", petal {of_one[1]}"
    largest = float(np.max(np.abs(ds[name].values))) if ds[name].size else 0.0
    if units == "rad s-1":
        return PlottedQuantity(meaning, "rpm", RPM)
    if units == "rad":
        return PlottedQuantity(meaning, "deg", 180.0 / np.pi)
    for unit, ladder in (("m", _LENGTHS), ("Pa", _PRESSURES)):
        if units == unit:
            return next(
                (PlottedQuantity(meaning, u, factor) for top, u, factor in ladder if largest < top),
                PlottedQuantity(meaning, unit),
            )
    return PlottedQuantity(meaning, "" if units == "1" else for_figure(units))


def result(ds: xr.Dataset, name: str) -> PlottedQuantity:
    """How a result is shown; a long name without its symbol."""
    return replace(quantity(ds, name), symbol="")


def shown_results(ds: xr.Dataset, names: Sequence[str] = ()) -> list[str]:
    """Results that a figure shows: those of `names`, else the first few that vary.

    Raises
    ------
    UsageError
        No result varies, or there is none of a name.
    """
    for name in names:
        if name not in ds.data_vars:
            raise UsageError(f"the study has no result {name!r}; it has {', '.join(_varying(ds)) or 'none'}")
    found = list(names) or _told_once(ds, sorted(_varying(ds), key=_rank))[:_FEW]
    if not found:
        raise UsageError("no case of this study has a result that varies: there is nothing to draw")
    return found


def _told_once(ds: xr.Dataset, names: Sequence[str]) -> list[str]:
    """Results but for derivatives and those that repeat one before, such as a touchdown at the lift-off speed."""
    found: list[str] = []
    for name in names:
        values = ds[name].values
        least = _SAME * float(np.ptp(values[np.isfinite(values)]))
        copies = (np.allclose(values, ds[other].values, rtol=0.0, atol=least, equal_nan=True) for other in found)
        if name not in _DERIVATIVES and not any(copies):
            found.append(name)
    return found or list(names)


def of_cases(ds: xr.Dataset) -> xr.Dataset:
    """The study with one value a case: of a series of points the last. Parameters of one level are no dimension."""
    last = ds.isel(point=-1) if "point" in ds.dims else ds
    single = [dim for dim in last["converged"].dims if last.sizes[dim] == 1]
    return last.squeeze(single) if len(single) < last["converged"].ndim else last


def in_unit(ds: xr.Dataset, name: str, shown: PlottedQuantity) -> Floats:
    """Values of a parameter or a result in the unit of the figure; infinite ones are left out."""
    values = values_without_rounding(ds, name) * shown.factor
    return np.where(np.isfinite(values), values, np.nan)


def count_fact(ds: xr.Dataset) -> str:
    """How many cases there are, and how many have no answer."""
    total, without = ds["converged"].size, int((~ds["converged"].values).sum())
    return f"{total} cases" + (f", {without} without an answer" if without else "")


def _varying(ds: xr.Dataset) -> list[str]:
    found = []
    for name in ds.data_vars:
        variable = SCALARS.get(str(name))
        if variable is None or variable.kind is not DataType.FLOAT or variable.role is not Role.ANSWER:
            continue
        values = values_without_rounding(ds, str(name)) if ds[name].dims else np.empty(0)
        finite = values[np.isfinite(values)]
        if finite.size and float(np.ptp(finite)) > 1e-9 * float(np.abs(finite).max()):
            found.append(str(name))
    return found


def _rank(name: str) -> tuple[int, str]:
    order = [
        "liftoff_speed",
        "threshold_speed",
        "min_film_thickness",
        "bearing_force",
        "contact_fraction",
        "friction_torque",
        "max_bending_stress",
        *QUANTITIES,
    ]
    return (order.index(name) if name in order else len(order)), name
