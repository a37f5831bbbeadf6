"""Datasets to NetCDF files and back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from petalfoil.errors import StoreError
from petalfoil.results import view  # noqa: F401 - gives datasets `petalfoil`, the tables of the result
from petalfoil.results.atomic import replacing
from petalfoil.results.seal import add_seal, digest_of_data, is_sealed

_MARKS = ("petalfoil_version", "analysis", "case")
DIGEST = "petalfoil_digest"
"""Attribute of a file that holds the checksum of its data; a dataset in memory does not have it."""
_UNREADABLE = (
    OSError,
    RuntimeError,
    ValueError,
)  # what netCDF4 and xarray raise on a file that is damaged or of another kind


def save(ds: xr.Dataset, path: str | Path) -> None:
    """Write a result to a NetCDF4 file; a former file is replaced whole, or left alone if the writing fails.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``to_dataset`` or ``curve_dataset``.
    path : str or Path
        Where to.

    Raises
    ------
    StoreError
        The file cannot be written.
    """
    target = Path(path)
    # No fill value: NaN stands for itself, and a reader gets the numbers that were computed.
    encoding = {
        str(name): {"_FillValue": None, "zlib": variable.ndim > 0, "complevel": 4}
        for name, variable in ds.variables.items()
        if np.issubdtype(variable.dtype, np.floating)
    }
    try:
        with replacing(target) as temporary:
            stored = ds.assign_attrs({DIGEST: digest_of_data(ds)})
            stored.to_netcdf(temporary, engine="netcdf4", format="NETCDF4", encoding=encoding)
            add_seal(temporary)
    except (OSError, RuntimeError) as error:
        raise StoreError(f"cannot write {target}: {error}") from error


def load(path: str | Path) -> xr.Dataset:
    """Read a result from a NetCDF4 file into memory; the file is closed afterwards.

    Parameters
    ----------
    path : str or Path
        File written by ``save``.

    Returns
    -------
    xarray.Dataset
        The result, equal to what was saved.

    Raises
    ------
    StoreError
        There is no such file, it cannot be read, petalfoil did not write it, or it was changed since.
    """
    source = Path(path)
    if not source.is_file():
        raise StoreError(
            f"{source} is a folder; expected a file" if source.is_dir() else f"{source}: there is no such file"
        )
    sealed = _seal_of(source)
    try:
        ds = xr.load_dataset(source, engine="netcdf4")
    except _UNREADABLE as error:
        raise StoreError(
            f"{source} is not a result of petalfoil, or is damaged: it cannot be read as NetCDF-4 ({error}); results "
            "are written by --out"
        ) from error
    missing = [mark for mark in _MARKS if mark not in ds.attrs]
    if missing:
        raise StoreError(f"{source} was not written by petalfoil: it has no attribute {missing[0]!r}")
    digest = ds.attrs.pop(DIGEST, None)
    if not sealed and digest != digest_of_data(ds):
        raise StoreError(
            f"{source} is not as petalfoil wrote it: its data do not match their checksum ({DIGEST}); "
            "run the analysis again, or restore the file from a copy"
        )
    return ds


def _seal_of(source: Path) -> bool | None:
    """Whether the file carries a seal that fits its bytes; None where it has none.

    Raises
    ------
    StoreError
        The file cannot be read, or its bytes are not those that were sealed.
    """
    try:
        sealed = is_sealed(source)
    except OSError as error:
        raise StoreError(f"cannot read {source}: {error.strerror}") from error
    if sealed is False:
        raise StoreError(
            f"{source} is damaged: its bytes do not match the checksum at its end; run the analysis again, or restore "
            "the file from a copy"
        )
    return sealed
