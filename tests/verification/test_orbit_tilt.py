"""A rotor in two bearings that tilts: its limits, its gyroscopic motion, its bearings as one wall."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from petalfoil.analysis.orbit_motion import Orbit, follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.case import Case
from petalfoil.errors import DefinitionError
from petalfoil.results.record import Record
from tests.cases import case

Array = NDArray[np.float64]


def plain(rotor: dict[str, float], **changes: object) -> Case:
    grid = {"model.cells_per_pitch": 32, "model.axial_cells": 8}
    return case("plain_journal", rotor=rotor, **grid, **changes)


def path(record: Record, *names: str) -> Array:
    return np.column_stack([np.asarray(record.fields[name]) for name in names])


COURSE = OrbitRequest(revolutions=2.0, tolerance=1e-4, longest=0.1)
OFF = {"operation.eccentricity": (0.0, -5e-6)}


def at(record: Record, name: str, time: Array) -> Array:
    return np.interp(time, np.asarray(record.coords["time"]), np.asarray(record.fields[name]))


@pytest.mark.slow
def test_parallel_motion_is_that_of_one_bearing() -> None:
    """Twice the mass in two bearings moves as one mass in one, and does not tilt."""
    one = follow(plain({"mass": 0.2, "unbalance": 1e-6}, **OFF, **{"model.symmetry": False}), COURSE)
    two = follow(
        plain({"mass": 0.4, "unbalance": 1e-6, "span": 0.5, "transverse_inertia": 1e-3, "polar_inertia": 1e-4}, **OFF),
        COURSE,
    )
    time = np.asarray(one.coords["time"])
    for name in ("x", "y"):
        assert np.max(np.abs(at(two, name, time) - at(one, name, time))) < 2e-3 * 25e-6
    assert np.max(np.abs(path(two, "slope_x", "slope_y"))) < 1e-12


@pytest.mark.slow
def test_conical_motion_is_that_of_one_bearing_too() -> None:
    """Far apart, bearings feel no tilt: the slope moves as a mass `I_t / (2 l^2)` in one bearing."""
    span, mass = 50.0, 0.2
    lever = 0.5 * span
    conical = plain(
        {"mass": 1e3, "span": span, "transverse_inertia": 2.0 * mass * lever**2},
        **{"operation.eccentricity": (0.0, 0.0)},
    )
    conical = conical.replace(**{"operation.load": (0.0, 0.0)})
    single = plain({"mass": mass}, **{"operation.load": (0.0, 0.0), "model.symmetry": False}, **OFF)
    one = follow(single, COURSE)
    two = follow(conical, OrbitRequest(**{**COURSE.__dict__, "slope": (0.0, -5e-6 / lever)}))
    time = np.asarray(one.coords["time"])
    for name, slope in (("x", "slope_x"), ("y", "slope_y")):
        assert np.max(np.abs(lever * at(two, slope, time) - at(one, name, time))) < 2e-3 * 25e-6


@pytest.mark.slow
def test_nutation_of_a_rotor_that_hardly_feels_its_film() -> None:
    """A skew principal axis drives a precession at `I_p / I_t` of the speed (O5), in closed form."""
    inertia, polar, skew = 1e4, 0.3e4, 1e-8
    rotor = {"mass": 1e6, "span": 0.5, "transverse_inertia": inertia, "polar_inertia": polar, "skew": skew}
    bearing = plain(rotor, **{"operation.load": (0.0, 0.0), "operation.eccentricity": (0.0, 0.0)})
    record = follow(bearing, OrbitRequest(revolutions=6.0, tolerance=1e-7, longest=0.02))
    turned = np.asarray(record.fields["shaft_angle"])
    slope = path(record, "slope_x", "slope_y") @ np.array([1.0, 1j])
    ratio = polar / inertia
    # from rest: a = -chi (e^{i t} - 1) + chi / ratio (e^{i ratio t} - 1), t in radians of the shaft
    exact = -skew * (np.exp(1j * turned) - 1.0) + skew / ratio * (np.exp(1j * ratio * turned) - 1.0)
    assert np.max(np.abs(slope - exact)) < 2e-3 * np.max(np.abs(exact))


@pytest.mark.slow
def test_petal_bearings_carry_a_tilting_rotor_through_contact() -> None:
    """Film, petals and contacts of both bearings with a rotor out of balance both ways; no step fails."""
    rotor = {
        "mass": 4.0,
        "unbalance": 5e-6,
        "span": 0.3,
        "transverse_inertia": 0.05,
        "polar_inertia": 0.01,
        "skew": 1e-4,
    }
    bearing = case("paper_n8", **{"model.cells_per_pitch": 16}).replace(rotor=rotor)
    record = follow(bearing, OrbitRequest(revolutions=3.0, initial="balance"))
    assert record.scalars["failed_steps"] == 0
    assert np.max(np.abs(path(record, "slope_x", "slope_y"))) > 1e-6
    assert float(record.scalars["energy_balance_error"]) < 5e-3
    assert np.asarray(record.fields["frame_radius"]).shape[1] == 8


def test_what_cannot_be_is_refused() -> None:
    for rotor, reason in (
        ({"mass": 1.0, "span": 0.5, "polar_inertia": 1e-3}, "transverse_inertia"),
        ({"mass": 1.0, "polar_inertia": 1e-3}, "span"),
        ({"mass": 1.0, "span": 0.5, "transverse_inertia": 1e-3, "polar_inertia": 1.0}, "body"),
    ):
        with pytest.raises(DefinitionError, match=reason):
            plain(rotor)
    assert plain({"mass": 2.0, "span": 0.5, "transverse_inertia": 1.0}).bearings == 2
    assert Orbit.begin(plain({"mass": 1.0}, **OFF), COURSE).start.e.shape == (2,)
