"""What tables and figures show as 0: components of forces and displacements that are nothing but rounding."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.results.record import Record, Scalar

if TYPE_CHECKING:
    import xarray as xr

ROUNDING = 1e-10
"""Part of a vector, of ambient pressure on the bearing for a force, of the journal's radius for a displacement, below
which a component is rounding: thousands of pressures are added, of equations that are solved to 1e-8."""
_VECTORS = (
    (("force_x", "force_y"), "N"),
    (("film_force_x", "film_force_y"), "N"),
    (("contact_force_x", "contact_force_y"), "N"),
    (("load_x", "load_y"), "N"),
    (("bearing_force",), "N"),
    (("eccentricity_x", "eccentricity_y"), "m"),
)
"""Components of vectors that tables show, with their unit."""


def without_rounding(record: Record) -> dict[str, Scalar]:
    """Reported scalars as tables show them: 0 for what is nothing but rounding.

    Parameters
    ----------
    record : Record
        One answer.

    Returns
    -------
    dict
        Scalars by name, SI.
    """
    reported = record.reported()
    sizes = [float(reported.get(name, 0.0)) for name in ("ambient_pressure", "journal_radius", "length")]
    pressed = math.prod(sizes)  # ambient pressure on the bearing [N]
    scales = {"N": pressed, "m": sizes[1]}
    for names, scale in ((names, scales[kind]) for names, kind in _VECTORS):
        here = [float(reported[name]) for name in names if name in reported]
        least = ROUNDING * max(scale, math.hypot(*here))
        reported |= {name: 0.0 for name in names if name in reported and abs(float(reported[name])) < least}
    if float(reported.get("max_membrane_stress", math.inf)) < ROUNDING * float(reported.get("max_bending_stress", 0.0)):
        reported["max_membrane_stress"] = 0.0
    return reported


def values_without_rounding(ds: xr.Dataset, name: str) -> NDArray[np.float64]:
    """Values of one result of many cases as tables and figures show them: 0 for what is nothing but rounding.

    Parameters
    ----------
    ds : xarray.Dataset
        Results of many cases.
    name : str
        One of them.

    Returns
    -------
    (...) array
        Its values [SI].
    """
    values = np.asarray(ds[name].values, dtype=np.float64)
    kinds = [kind for names, kind in _VECTORS if name in names]
    if not kinds:
        return values
    sizes = [_largest(ds, size) for size in ("ambient_pressure", "journal_radius", "length")]
    scale = math.prod(sizes) if kinds[0] == "N" else sizes[1]
    return np.where(np.abs(values) < ROUNDING * scale, 0.0, values)


def _largest(ds: xr.Dataset, name: str) -> float:
    """Largest value of a size over all cases; 0 where the dataset does not hold it."""
    if name not in ds:
        return 0.0
    values = np.asarray(ds[name].values, dtype=np.float64)
    return float(np.max(values[np.isfinite(values)], initial=0.0))
