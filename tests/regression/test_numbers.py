"""Numbers of every verb that must not move: `numbers.json` beside this file, of the runs below.

A refactoring leaves every number within `RTOL`, and a number that is small beside the natural size of its quantity
(`SIZES`) within `RTOL` of that size. Counts of work (`COUNTS`) may fall, not grow. Texts must be the same.

What follows an `@` in a name is what the table holds of a variable: `@mean` mean and largest magnitude of an array,
`@last` the last value of a history, `@grid_error` the attribute of that name, an error bar.

Where numbers are meant to move, write the table anew, all of it or the runs named, and tell why in the commit::

    python -m tests.regression.test_numbers --write [run ...]
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from tests.cases import case

RTOL = 1e-9
TABLE = Path(__file__).with_name("numbers.json")

COUNTS = frozenset({"factorizations", "iterations"})
"""Work that may fall."""

SIZES = {
    "force_x": 1.0,
    "force_y": 1.0,
    "contact_force_x": 1.0,
    "contact_force_y": 1.0,
    "contact_normal_force": 1.0,
    "bearing_force": 1.0,
    "attitude_angle": 1.0,
    "contact_fraction": 1.0,
    "eccentricity_x": 1e-5,
    "eccentricity_y": 1e-5,
    "x": 1e-5,
    "y": 1e-5,
    "velocity_x": 1e-2,
    "velocity_y": 1e-2,
    "slope_x": 1e-5,
    "slope_y": 1e-5,
    "last_position": 1e-5,
    "last_velocity": 1e-2,
    "stiffness": 1e4,
    "damping": 1.0,
    "natural_frequency": 1e2,
    "mode_growth_rate": 1e2,
    "damping_ratio": 1.0,
    "whirl_direction": 1.0,
    "participation": 1.0,
    "growth_rate": 1e3,
    "petal_friction_work": 1e-4,
    "elastic_energy": 1e-4,
    "load_work": 1e-4,
    "film_work": 1e-4,
    "kinetic_energy": 1e-5,
}
"""Natural sizes in SI units of what may be small beside it; zero for the rest, which is compared relatively."""

CROSSINGS = {"liftoff_speed": 1e-6, "touchdown_speed": 1e-6, "liftoff_by_contact_film_thickness": 1e-5}
"""Relative tolerances of what is found from many solutions, each to a residual of 1e-8: from one processor to another
the touchdown speed differs by 6e-8, and a derivative of two of them by 2e-6."""

FLAT = case("paper_n8", **{"model.cells_per_pitch": 16})
RUBBING = FLAT.replace(**{"surface.petal_friction": 0.2})
COARSE = RUBBING.replace(**{"model.cells_per_pitch": 8})
WIDE = RUBBING.replace(**{"surface.friction_width": 1e-7})  # at 1 nm rounding decides which places slide first
SPATIAL = case("paper_n8_spatial", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 24, "model.axial_cells": 6})
PLAIN_FLAT = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 32})
RIG = case("rig", **{"model.cells_per_pitch": 16})
THIN_AIR = {"model.slip": True, "gas.ambient_pressure": 0.3e5}

ROTOR = {"mass": 3.0, "unbalance": 2e-6}
TILTING = {
    "mass": 4.0, "unbalance": 5e-6, "span": 0.3, "transverse_inertia": 0.05, "polar_inertia": 0.01, "skew": 1e-4,
}  # fmt: skip
LIGHT = {"mass": 0.4, "unbalance": 1e-6, "span": 0.5, "transverse_inertia": 1e-3, "polar_inertia": 1e-4, "skew": 1e-5}


@dataclass(frozen=True)
class Run:
    """One call of the Python API and the numbers kept of its answer."""

    name: str
    call: Callable[[], xr.Dataset]
    kept: tuple[str, ...]
    marks: tuple[str, ...] = ()


POINT = ("bearing_force", "force_x", "min_film_thickness", "peak_pressure", "friction_torque", "growth_rate")
PETALS = (*POINT, "max_bending_stress", "pressure@mean", "film_thickness@mean", "deflection@mean", "radius@mean")
WORK = ("factorizations", "iterations")
TOUCHING = ("contact_force_y", "contact_normal_force", "contact_fraction")
BALANCED = ("eccentricity_x", "eccentricity_y")
MOTION = ("last_position", "last_velocity", "min_film_thickness@mean", "peak_pressure@mean", "friction_torque@last",
          "kinetic_energy@mean", "load_work@last", "film_work@last", "shaft_work@last", "amplitude", "steps",
          "factorizations")  # fmt: skip
ELASTIC = ("elastic_energy@last", "frame_radius@mean", "frame_film_thickness@mean", "x@mean", "y@mean")

RUNS = (
    Run("solve 2-D", partial(petalfoil.solve, FLAT), (*PETALS, *WORK, "status")),
    Run("solve 2-D displaced", partial(petalfoil.solve, FLAT, eccentricity=(3e-5, -3e-4)), (*PETALS, *WORK)),
    Run("solve 2-D slow", partial(petalfoil.solve, FLAT, speed=600.0), (*PETALS, *TOUCHING, *WORK)),
    Run("solve 2-D slip", partial(petalfoil.solve, FLAT.replace(**THIN_AIR)), (*PETALS, *WORK)),
    Run("solve 2-D continuous", partial(petalfoil.solve, FLAT.replace(**{"model.edges": "continuous"})), PETALS),
    Run("solve 2-D rig", partial(petalfoil.solve, RIG),
        ("bearing_force", "min_film_thickness", "friction_torque", *WORK)),
    Run("solve 3-D", partial(petalfoil.solve, SPATIAL, eccentricity=(2e-5, -1.5e-4)),
        (*PETALS, *TOUCHING, "side_leakage", *WORK)),
    Run("solve 3-D stretching", partial(petalfoil.solve, SPATIAL.replace(**{"petals.theory": "shell"})),
        (*PETALS, *TOUCHING, "side_leakage", "max_membrane_stress", *WORK)),
    Run("solve 3-D slip", partial(petalfoil.solve, SPATIAL.replace(**THIN_AIR)), (*PETALS, "side_leakage", *WORK)),
    Run("solve plain", partial(petalfoil.solve, PLAIN), (*POINT, "attitude_angle", "side_leakage", "pressure@mean")),
    Run("solve plain slip", partial(petalfoil.solve, PLAIN.replace(**{"model.slip": True})), (*POINT, *WORK)),
    Run("solve plain 2-D", partial(petalfoil.solve, PLAIN_FLAT), (*POINT, "attitude_angle", *WORK)),
    Run("solve with error 2-D", partial(petalfoil.solve, FLAT.replace(**{"model.cells_per_pitch": 64}), error=True),
        ("bearing_force", "bearing_force@grid_error", "min_film_thickness@grid_error", "friction_torque@grid_error"),
        marks=("slow",)),
    Run("solve with error plain",
        partial(petalfoil.solve, PLAIN.replace(**{"model.cells_per_pitch": 64, "model.axial_cells": 16}), error=True),
        ("bearing_force", "side_leakage", "bearing_force@grid_error", "side_leakage@grid_error")),
    Run("solve classic", partial(petalfoil.solve, FLAT.replace(**{"model.method": "classic"})),
        (*POINT, "max_bending_stress", "iterations"), marks=("slow", "compiled")),
    Run("converge 2-D", partial(petalfoil.converge, FLAT, coarsest=16),
        ("bearing_force", "min_film_thickness", "bearing_force_limit", "bearing_force_error", "force_x_order",
         "friction_torque_limit", "factorizations")),
    Run("converge plain", partial(petalfoil.converge, PLAIN, levels=2, coarsest=16), ("bearing_force", "side_leakage")),
    Run("curve 2-D", partial(petalfoil.curve, FLAT, "0 um : 280 um : 4"), (*POINT, "max_bending_stress", *WORK)),
    Run("curve 3-D", partial(petalfoil.curve, SPATIAL, "50 um : 200 um : 3", direction="-80 deg"),
        ("bearing_force", "force_x", "peak_pressure", "friction_torque", "max_bending_stress", *TOUCHING, *WORK)),
    Run("curve plain", partial(petalfoil.curve, PLAIN, "2 um : 20 um : 3"), (*POINT, "side_leakage", *WORK)),
    Run("static 2-D", partial(petalfoil.static, FLAT, "0 um : 280 um : 4"),
        ("bearing_force", "force_x", "contact_normal_force", "starting_torque", "max_bending_stress",
         "deflection@mean", *WORK)),
    Run("static 3-D", partial(petalfoil.static, SPATIAL, "0 um : 200 um : 3"),
        ("bearing_force", "force_x", "contact_normal_force", "starting_torque", "max_bending_stress",
         "deflection@mean", *WORK)),
    Run("static loop", partial(petalfoil.static, COARSE, "0 um : 100 um : 3", loop=True),
        ("bearing_force", "force_y", "contact_normal_force", "petal_friction_work", "starting_torque", "leg")),
    Run("static loop wide", partial(petalfoil.static, WIDE, "0 um : 100 um : 3", loop=True),
        ("bearing_force", "force_y", "contact_normal_force", "petal_friction_work", "starting_torque",
         *WORK), marks=("slow",)),
    Run("balance 2-D", partial(petalfoil.balance, FLAT, 20.0), (*BALANCED, *PETALS, *WORK, "carried_by")),
    Run("balance 3-D", partial(petalfoil.balance, SPATIAL, (2.0, -20.0)),
        (*BALANCED, *PETALS, *TOUCHING, *WORK, "carried_by")),
    Run("balance plain", partial(petalfoil.balance, PLAIN, 30.0), (*BALANCED, *POINT, "attitude_angle", *WORK)),
    Run("liftoff 2-D", partial(petalfoil.liftoff, FLAT, [15.0]),
        ("liftoff_speed", "touchdown_speed", "liftoff_by_contact_film_thickness", "liftoff_by_contact_fraction")),
    Run("runup 2-D", partial(petalfoil.runup, FLAT, 15.0, to=4000.0, points=4),
        (*BALANCED, "contact_normal_force", "contact_fraction", "min_film_thickness", "friction_torque", "leg", *WORK)),
    Run("coefficients 2-D", partial(petalfoil.coefficients, FLAT, [0.0, 500.0, 8000.0], load=20.0),
        ("stiffness", "damping", *WORK)),
    Run("coefficients 3-D", partial(petalfoil.coefficients, SPATIAL, [500.0]), ("stiffness", "damping")),
    Run("coefficients plain", partial(petalfoil.coefficients, PLAIN, [1000.0], speeds=[1000.0, 2000.0], load=30.0),
        ("stiffness", "damping", *BALANCED, *WORK)),
    Run("coefficients stuck", partial(petalfoil.coefficients, RUBBING, [500.0], load=20.0), ("stiffness", "damping")),
    Run("coefficients rubbing", partial(petalfoil.coefficients, RUBBING, [500.0], load=20.0, amplitude=2e-6),
        ("stiffness", "damping", *WORK)),
    Run("stability plain", partial(petalfoil.stability, PLAIN, load=30.0, mass=1.0),
        ("critical_mass", "whirl_ratio", "threshold_speed", "natural_frequency", "mode_growth_rate", "damping_ratio",
         "participation", "whirl_direction", *WORK)),
    Run("stability rubbing", partial(petalfoil.stability, COARSE, load=20.0, mass=3.0),
        ("natural_frequency", "mode_growth_rate", "participation", *WORK), marks=("slow",)),
    Run("stability table plain", partial(petalfoil.stability, PLAIN, speeds=[1000.0, 2000.0], loads=[20.0, 40.0]),
        ("critical_mass", "whirl_ratio", *BALANCED, *WORK)),
    Run("stability table 2-D", partial(petalfoil.stability, FLAT, speeds=[500.0, 1000.0], loads=[5.0, 10.0]),
        ("critical_mass", "contact_fraction", "growth_rate", *BALANCED, *WORK, "status")),
    Run("orbit plain", partial(petalfoil.orbit, PLAIN.replace(rotor=ROTOR), revolutions=2.0), MOTION),
    Run("orbit 2-D", partial(petalfoil.orbit, FLAT.replace(rotor=ROTOR), revolutions=1.0, initial="balance"),
        (*MOTION, *ELASTIC)),
    Run("orbit 3-D", partial(petalfoil.orbit, SPATIAL.replace(rotor=ROTOR), revolutions=0.5), (*MOTION, *ELASTIC)),
    Run("orbit slip", partial(petalfoil.orbit, PLAIN.replace(rotor=ROTOR, **THIN_AIR), revolutions=1.0), MOTION),
    Run("orbit rubbing", partial(petalfoil.orbit, RUBBING.replace(rotor=ROTOR), revolutions=0.5, initial="balance"),
        (*MOTION, *ELASTIC, "petal_friction_work@last")),
    Run("orbit tilting plain", partial(petalfoil.orbit, PLAIN.replace(rotor=LIGHT), revolutions=1.0),
        (*MOTION, "slope_x@last", "slope_y@mean")),
    Run("orbit tilting 2-D", partial(petalfoil.orbit, FLAT.replace(rotor=TILTING), revolutions=0.5, initial="balance"),
        (*MOTION, *ELASTIC, "slope_x@last", "slope_y@mean")),
    Run("orbit ramp", partial(petalfoil.orbit, FLAT.replace(rotor=ROTOR), speeds="0 rpm : 20000 rpm : 2 ms"),
        (*MOTION, *ELASTIC, "contact_fraction@mean", "rubbing_work@last", "revolutions")),
    Run("check 2-D", partial(petalfoil.check, FLAT),
        ("radial_clearance", "pack_clearance", "compressibility_number", "overlap", "layers", "petal_angle",
         "covered_angle", "metric_radius", "bending_stiffness", "root_tilt", "first_contact_angle",
         "free_petal_height", "radius@mean")),
    Run("check plain", partial(petalfoil.check, PLAIN),
        ("pack_clearance", "compressibility_number", "mean_free_path", "clearance_knudsen_number")),
)  # fmt: skip


SLOW = {
    "converge 2-D", "curve 2-D", "curve 3-D", "static 3-D", "static loop", "liftoff 2-D", "runup 2-D",
    "coefficients 3-D", "stability table 2-D", "orbit 2-D", "orbit 3-D", "orbit rubbing", "orbit ramp",
}  # fmt: skip
"""Runs of more than half a second whose verb has a faster one, or whose verb is slow on petals."""


def value(ds: xr.Dataset, name: str) -> Any:
    """Value of the answer under a name of the table, as JSON holds it."""
    variable, _, reduction = name.partition("@")
    array = ds[variable]
    if reduction == "mean":
        return [float(array.mean()), float(np.abs(array).max())]
    if reduction == "last":
        return float(array[-1])
    if reduction:
        return float(array.attrs[reduction])
    return array.values.tolist()


def answer(run: Run) -> dict[str, Any]:
    """All that is kept of a run, computed anew."""
    ds = run.call()
    return {name: value(ds, name) for name in run.kept}


def table() -> dict[str, dict[str, Any]]:
    """The numbers stored."""
    stored: dict[str, dict[str, Any]] = json.loads(TABLE.read_text(encoding="utf-8")) if TABLE.exists() else {}
    return stored


def compare(name: str, found: Any, stored: Any) -> None:
    """Assert that a value is the one stored; work may be less."""
    if np.asarray(stored).dtype.kind == "U":
        assert found == stored, name
    elif name in COUNTS:
        assert np.shape(found) == np.shape(stored), name
        assert np.all(np.asarray(found) <= np.asarray(stored)), f"{name}: {found}, stored {stored}"
    else:
        atol = RTOL * SIZES.get(name.partition("@")[0], 0.0)
        assert_allclose(np.asarray(found, dtype=float), stored, rtol=CROSSINGS.get(name, RTOL), atol=atol, err_msg=name)


def marks(run: Run) -> list[pytest.MarkDecorator]:
    """Its own marks, and `slow` where it takes more than half a second."""
    return [getattr(pytest.mark, mark) for mark in (*run.marks, *(("slow",) if run.name in SLOW else ()))]


@pytest.mark.parametrize("run", [pytest.param(run, id=run.name, marks=marks(run)) for run in RUNS])
def test_numbers(run: Run) -> None:
    stored, found = table()[run.name], answer(run)
    assert found.keys() == stored.keys()
    moved = []
    for name in run.kept:
        try:
            compare(name, found[name], stored[name])
        except AssertionError as error:
            moved.append(str(error))
    assert not moved, "\n".join(moved)


def test_the_table_is_of_these_runs() -> None:
    assert list(table()) == [run.name for run in RUNS]
    assert sum(math.prod(np.shape(entry)) for run in table().values() for entry in run.values()) >= 80


def write(names: list[str]) -> None:
    """Compute the runs named, or all, and store them with what else is stored."""
    kept = table()
    new = {run.name: answer(run) if not names or run.name in names else kept[run.name] for run in RUNS}
    lines = []
    for name, entries in new.items():
        rows = ",\n".join(f"    {json.dumps(key)}: {json.dumps(entry)}" for key, entry in entries.items())
        lines.append(f"  {json.dumps(name)}: {{\n{rows}\n  }}")
    TABLE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:2] != ["--write"]:
        sys.exit(__doc__)
    write(sys.argv[2:])
