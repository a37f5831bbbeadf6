"""Tables over load and speed: laid out, with holes, stored and read back."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import xarray as xr

from petalfoil.results import Record
from petalfoil.results.grid import grid_dataset
from petalfoil.results.store import load, save


def point(size: float, speed: float, mass: float) -> Record:
    scalars = {"load_x": 0.0, "load_y": -size, "speed": speed, "critical_mass": mass, "iterations": 3, "length": 0.05}
    ended = {"converged": True, "status": "converged", "stable": True}
    return Record(analysis="stability", scalars={**scalars, **ended}, title="Table", case_toml="x = 1")


POINTS = [point(10.0, 100.0, 1.0), point(10.0, 200.0, math.inf), point(20.0, 100.0, 4.0)]


def test_rows_are_loads_and_columns_are_speeds() -> None:
    ds = grid_dataset(POINTS, "stability")
    assert ds["critical_mass"].dims == ("load", "speed")
    np.testing.assert_array_equal(ds["critical_mass"], [[1.0, math.inf], [4.0, math.nan]])
    np.testing.assert_array_equal(ds["load"], [10.0, 20.0])
    np.testing.assert_array_equal(ds["speed"], [100.0, 200.0])
    assert (ds["load"].attrs["units"], ds["speed"].attrs["units"]) == ("N", "rad s-1")
    assert ds["length"].dims == ()


def test_what_was_not_computed_stands_empty() -> None:
    hole = grid_dataset(POINTS, "stability").isel(load=1, speed=1)
    assert (bool(hole["converged"]), str(hole["status"].item()), int(hole["iterations"])) == (False, "", -1)
    assert math.isnan(float(hole["load_y"]))


def test_a_table_survives_its_file(tmp_path: Path) -> None:
    ds = grid_dataset(POINTS, "stability")
    save(ds, tmp_path / "chart.nc")
    xr.testing.assert_identical(load(tmp_path / "chart.nc"), ds)
