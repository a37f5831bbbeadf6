"""A motion of a hot bearing: it keeps the temperatures of the balance where it begins."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

from petalfoil import Case, balance, load, orbit, save
from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.errors import UsageError
from tests.cases import FAULTS, case

RPM = math.pi / 30.0
STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0, "expansion": 11.5e-6}
HOT = case(
    "plain_journal",
    shaft=STEEL,
    bushing={"expansion": 11.5e-6},
    heat={"pack_to_bushing": 20.0, "bushing_to_ambient": 2.0, "shaft_to_ambient": 0.5},
    rotor={"mass": 2.0, "unbalance": 1e-6},
    **{"model.kind": "2d", "model.cells_per_pitch": 16, "operation.eccentricity": (0.0, -5e-6)},
)
NODES = ("film", "shaft", "pack", "bushing")


@cache
def moved() -> xr.Dataset:
    return orbit(HOT, revolutions=0.05)


def test_a_motion_keeps_the_temperatures_of_the_balance() -> None:
    """And is that of the isothermal bearing whose gas, shaft and bushing have them."""
    steady = balance.record(HOT, (0.0, -2.0 * 9.80665)).scalars
    for node in NODES:
        assert_allclose(float(moved()[f"{node}_temperature"]), steady[f"{node}_temperature"], rtol=1e-12)
    still = HOT.replace(
        heat=None,
        **{
            "gas.viscosity": HOT.gas.viscosity * (float(steady["film_temperature"]) / 293.15) ** 0.7,
            "shaft.temperature": steady["shaft_temperature"],
            "bushing.temperature": steady["bushing_temperature"],
        },
    )
    alone = orbit(still, revolutions=0.05)
    for name in ("x", "y", "min_film_thickness", "friction_torque"):
        assert_allclose(moved()[name], alone[name], rtol=1e-8)
    cold = orbit(still.replace(**{"shaft.temperature": 293.15}), revolutions=0.05)
    assert abs(float(moved()["y"][-1] - cold["y"][-1])) > 1e-9


@pytest.mark.slow
def test_a_motion_that_goes_on_keeps_them_too(tmp_path: Path) -> None:
    save(moved(), tmp_path / "motion.nc")
    further = orbit(HOT, revolutions=0.05, restart=load(tmp_path / "motion.nc"))
    for node in NODES:
        assert float(further[f"{node}_temperature"]) == float(moved()[f"{node}_temperature"])
    assert_allclose(further["x"][0], moved()["x"][-1], rtol=1e-9)
    save(orbit(HOT.replace(heat=None), revolutions=0.05), tmp_path / "cold.nc")
    with pytest.raises(UsageError, match="has no heat network"):
        orbit(HOT, revolutions=0.05, restart=load(tmp_path / "cold.nc"))


UNEVEN = HOT.replace(
    rotor={"mass": 4.0, "span": 0.2, "centre": 0.03, "second": {"surface": {"contact_film_thickness": 2e-6}}}
)
"""In two bearings that carry unequal loads, and have unequal temperatures."""


@pytest.mark.slow
def test_both_bearings_of_a_motion_keep_temperatures_of_their_own(tmp_path: Path) -> None:
    """Those of the balance, where the rotor rests as it begins and as it goes on."""
    steady, still = balance.record(UNEVEN, (0.0, -4.0 * 9.80665)).scalars, UNEVEN
    ds = orbit(still, revolutions=0.05, initial="balance")
    for node in NODES:
        assert_allclose(float(ds[f"{node}_temperature"]), steady[f"{node}_temperature"], rtol=1e-9)
    for node in ("shaft", "pack"):
        assert_allclose(float(ds[f"other_{node}_temperature"]), steady[f"other_{node}_temperature"], rtol=1e-9)
    assert abs(float(ds["shaft_temperature"] - ds["other_shaft_temperature"])) > 0.01
    assert float(np.ptp(ds["x"].values)) < 1e-12
    assert float(np.ptp(ds["slope_y"].values)) < 1e-11
    save(ds, tmp_path / "motion.nc")
    further = orbit(still, revolutions=0.02, restart=load(tmp_path / "motion.nc"))
    for node in NODES:
        assert float(further[f"other_{node}_temperature"]) == float(ds[f"other_{node}_temperature"])
    assert_allclose(further["y"], ds["y"].values[-1], rtol=1e-9)


def test_a_start_from_rest_has_the_temperatures_before_it() -> None:
    """Those of the surroundings, but for a shaft that is still warm."""
    warm = HOT.replace(**{"heat.shaft_start_temperature": 303.15})
    begun = Orbit.begin(warm, OrbitRequest(duration=1e-4, speeds=((0.0, 0.0), (1e-2, 2000.0)), initial=(0.0, -5e-6)))
    assert begun.warm[0] is not None
    assert_allclose(begun.warm[0].nodes, [293.15, 303.15, 293.15, 293.15], rtol=1e-12)
    assert begun.case.growth.journal(0.0) > 1e-6


# ---------------------------------------------------------------------------------------------- cost, told beforehand


def foretold(bearing: Case, request: OrbitRequest, caplog: pytest.LogCaptureFixture) -> str:
    """What is said before the first step."""
    begun = Orbit.begin(bearing, request)
    next(begun.advance())
    assert "\n".join(begun.foretold) in caplog.text
    assert begun.record().warnings[: len(begun.foretold)] == begun.foretold
    return caplog.text


def test_a_heavy_rotor_that_falls_at_low_speed_is_told_to_take_many_steps(caplog: pytest.LogCaptureFixture) -> None:
    """The rotor of 2 kg is released 5 µm off centre at 60 rpm: it bounces on solid contact 500 times per turn."""
    slow = HOT.replace(heat=None, **{"operation.speed": 60.0 * RPM})
    told = foretold(slow, OrbitRequest(duration=1e-6), caplog)
    hertz = math.sqrt(9.80665 / HOT.surface.contact_film_thickness) / (2.0 * math.pi)
    assert_allclose(float(told.split("may take ")[1].split(" steps")[0]), 16.0 * hertz, rtol=1e-3)
    assert "use a shorter duration" in told


def test_a_usual_motion_is_not(caplog: pytest.LogCaptureFixture) -> None:
    assert foretold(HOT.replace(heat=None), OrbitRequest(duration=1e-6), caplog) == ""


@pytest.mark.slow
def test_a_random_bearing_whose_motion_hardly_ends_is_told(caplog: pytest.LogCaptureFixture) -> None:
    """52 kg in two bearings at 123 rpm: some 8000 steps per turn were counted."""
    bearing = Case.load(FAULTS / "verbs_5001.toml").replace(**{"model.edges": "ambient"})
    weight, span = math.hypot(*bearing.operation.load or (0.0, 0.0)), 2.0 * bearing.bearing.length
    rotor = {"mass": weight / 9.81, "span": span, "transverse_inertia": 0.5 * weight / 9.81 * span**2}
    told = foretold(bearing.replace(rotor=rotor), OrbitRequest(revolutions=1.0, initial="balance"), caplog)
    steps = float(told.split("may take ")[1].split(" steps")[0])
    assert 2000.0 < steps < 12000.0
    assert np.isfinite(steps)
