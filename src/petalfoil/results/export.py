"""Stiffness and damping for other programs, as a table with units in its header; `ross.py` writes for ROSS."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.errors import StoreError
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
