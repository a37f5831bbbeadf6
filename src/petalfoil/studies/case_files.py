"""Cases of a study as case files, which can be opened again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from petalfoil.case import Case, with_values
from petalfoil.errors import UsageError
from petalfoil.results.atomic import replacing
from petalfoil.studies.study_definition import Study


def case_of(study: Study, ds: xr.Dataset, number: int) -> Case:
    """A case of a study.

    Parameters
    ----------
    study : Study
        The study.
    ds : xarray.Dataset
        Its labelled data.
    number : int
        Number of the case, counted from 0 in the order of the table.

    Raises
    ------
    UsageError
        There is no such case.
    """
    shape = ds["converged"].shape
    if not 0 <= number < int(np.prod(shape)):
        raise UsageError(f"there is no case {number}; allowed: 0 to {int(np.prod(shape)) - 1}")
    place = dict(zip(ds["converged"].dims, np.unravel_index(number, shape), strict=True))
    values = {}
    for name in ds.coords:
        if "path" in ds[name].attrs:
            at = {dim: place[dim] for dim in ds[name].dims}
            values[str(ds[name].attrs["path"])] = ds[name].isel(at).values.item()
    return with_values(study.case, values)


def write_case(study: Study, ds: xr.Dataset, number: int, path: Path) -> None:
    """Write a case of a study as a case file."""
    text = case_of(study, ds, number).to_toml()
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
