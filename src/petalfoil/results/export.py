"""Stiffness and damping for other programs: a table with units, and a bearing element of ROSS.

ROSS (https://github.com/petrobras/ross), from its version 3.0 on, keeps coefficients over rotor speed and whirl
frequency: ``BearingElement.load`` reads the file written here. Its axes are x and y of the bushing, and the rotor turns
from x to y.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.atomic import replacing

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

AXIS = "xy"
ENTRIES = [(row, column) for row in (0, 1) for column in (0, 1)]
LEAST_POINTS = 5
"""Points of an axis below which ROSS warns that its interpolation is poor."""

TAG = "petalfoil"
"""Name of the element in a file for ROSS."""


def write_csv(ds: xr.Dataset, path: str | Path) -> None:
    """Write coefficients as comma-separated values, one line for each speed and whirl frequency, units in the header.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients``, at one speed or several; speeds that did not converge are left out.
    path : str or Path
        Where to.

    Raises
    ------
    StoreError
        The file cannot be written.
    """
    places = ["speed [rad/s]", "whirl_frequency [rad/s]", "eccentricity_x [m]", "eccentricity_y [m]"]
    heads = [
        f"{letter}_{AXIS[i]}{AXIS[j]} [{unit}]" for letter, unit in (("K", "N/m"), ("C", "N s/m")) for i, j in ENTRIES
    ]
    lines = [",".join(places + heads)]
    for point in _converged(ds):
        where = [float(point[name]) for name in ("speed", "eccentricity_x", "eccentricity_y")]
        for f, frequency in enumerate(point["whirl_frequency"].values.tolist()):
            parts = [point[name].values[f][i, j] for name in ("stiffness", "damping") for i, j in ENTRIES]
            numbers = [where[0], frequency, *where[1:], *parts]
            lines.append(",".join(repr(float(number)) for number in numbers))
    _write("\n".join(lines) + "\n", path)


def write_ross(ds: xr.Dataset, path: str | Path) -> None:
    """Write coefficients over speed and whirl frequency as a bearing element of ROSS.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients`` at several speeds; both axes need `LEAST_POINTS` points.
    path : str or Path
        Where to: ``.toml`` or ``.json``.

    Raises
    ------
    UsageError
        An axis is too short, or has a value twice.
    StoreError
        A speed has no coefficients, or the file cannot be written.
    """
    points = sorted(_converged(ds), key=lambda point: float(point["speed"]))
    if len(points) < ds.sizes.get("point", 1):
        raise StoreError(f"{path} is not written: ROSS needs coefficients at every speed, and some have none")
    speeds = [float(point["speed"]) for point in points]
    order = np.argsort(ds["whirl_frequency"].values, kind="stable")
    frequencies = ds["whirl_frequency"].values[order].tolist()
    check_axes(speeds, frequencies)
    element: dict[str, object] = {"n": 0, "tag": TAG, "speed": speeds, "frequency": frequencies}
    for name, letter in (("stiffness", "k"), ("damping", "c")):
        table = np.stack([point[name].values for point in points])[:, order]
        element |= {f"{letter}{AXIS[i]}{AXIS[j]}": table[:, :, i, j].tolist() for i, j in ENTRIES}
    section = f"BearingElement_{TAG}"
    _write(json.dumps({section: element}) if Path(path).suffix == ".json" else _toml(section, element), path)


def check_axes(speeds: list[float], frequencies: list[float]) -> None:
    """Refuse axes that ROSS cannot use; a verb asks before it computes.

    Raises
    ------
    UsageError
        An axis is too short, or has a value twice.
    """
    for name, axis in (("speeds", speeds), ("whirl frequencies", frequencies)):
        if len(set(axis)) < max(len(axis), LEAST_POINTS):
            raise UsageError(f"a table for ROSS needs {LEAST_POINTS} different {name} or more, got {len(set(axis))}")


def _converged(ds: xr.Dataset) -> list[xr.Dataset]:
    points = [ds.isel(point=number) for number in range(ds.sizes["point"])] if "point" in ds.dims else [ds]
    return [point for point in points if bool(point["converged"])]


def _toml(section: str, element: dict[str, object]) -> str:
    """One key a line: a list of numbers, or of lists of them, is written alike in TOML and in JSON."""
    return f"[{section}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in element.items())


def _write(text: str, path: str | Path) -> None:
    try:
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror}") from error
