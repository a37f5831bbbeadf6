"""Stiffness and damping for other programs, as a table with units in its header; `ross.py` writes for ROSS."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.atomic import replacing

if TYPE_CHECKING:
    import xarray as xr

AXIS = "xy"
ENTRIES = [(row, column) for row in (0, 1) for column in (0, 1)]


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
    for point in converged_points(ds):
        where = [float(point[name]) for name in ("speed", "eccentricity_x", "eccentricity_y")]
        for f, frequency in enumerate(point["whirl_frequency"].values.tolist()):
            parts = [point[name].values[f][i, j] for name in ("stiffness", "damping") for i, j in ENTRIES]
            numbers = [where[0], frequency, *where[1:], *parts]
            lines.append(",".join(repr(float(number)) for number in numbers))
    write_text("\n".join(lines) + "\n", path)


def write_xltrc(ds: xr.Dataset, path: str | Path) -> None:
    """Write synchronous coefficients over speed as XLTRC2 takes them into a table of user coefficients.

    One line for each speed, separated by tabs: speed [rpm], stiffness [N/m], damping [N s/m]. They tell the response to
    unbalance. They do not tell stability: a rotor in a gas film becomes unstable in a whirl at about half speed.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients``; every speed must be among the whirl frequencies.
    path : str or Path
        Where to.

    Raises
    ------
    UsageError
        A speed is not among the whirl frequencies.
    StoreError
        The file cannot be written.
    """
    units = (("K", "N/m"), ("C", "N-s/m"))
    heads = [f"{letter}{AXIS[i]}{AXIS[j]} ({unit})" for letter, unit in units for i, j in ENTRIES]
    lines = ["\t".join(["Speed (rpm)", *heads])]
    for point in sorted(converged_points(ds), key=lambda one: float(one["speed"])):
        speed, frequencies = float(point["speed"]), point["whirl_frequency"].values.tolist()
        if speed not in frequencies:
            raise UsageError(f"{speed:g} rad/s is not among the whirl frequencies: leave them to their default")
        own = frequencies.index(speed)
        parts = [float(point[name].values[own][i, j]) for name in ("stiffness", "damping") for i, j in ENTRIES]
        lines.append("\t".join(repr(number) for number in (speed * 30.0 / math.pi, *parts)))
    write_text("\n".join(lines) + "\n", path)


def converged_points(ds: xr.Dataset) -> list[xr.Dataset]:
    """The points of a dataset that have coefficients."""
    points = [ds.isel(point=number) for number in range(ds.sizes["point"])] if "point" in ds.dims else [ds]
    return [point for point in points if bool(point["converged"])]


def write_text(text: str, path: str | Path) -> None:
    """Write a text file whole, or leave a former one alone.

    Raises
    ------
    StoreError
        It cannot be written.
    """
    try:
        with replacing(Path(path)) as temporary:
            temporary.write_text(text, encoding="utf-8")
    except OSError as error:
        raise StoreError(f"cannot write {path}: {error.strerror}") from error
