"""The motion as a function: what it takes, refuses and returns; what it returns survives a file and goes on."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.errors import PetalfoilError, StoreError, UnitError, UsageError
from petalfoil.results import Record
from petalfoil.results.store import load, save
from tests.cases import case
from tests.unit.cli.conftest import play

ROTOR = {"rotor.mass": 3.0, "rotor.unbalance": 2e-6}
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 32, "model.axial_cells": 8}, **ROTOR)
PETALS = case("paper_n8", **{"model.cells_per_pitch": 16}, **ROTOR)
FAST = 0.5 * 20000.0 * math.pi / 30.0


@pytest.fixture(scope="module")
def four() -> xr.Dataset:
    return petalfoil.orbit(PLAIN, revolutions=4.0)


def test_a_motion_tells_where_the_journal_is(four: xr.Dataset) -> None:
    assert four.attrs["analysis"] == "orbit"
    assert four["x"].dims == four["min_film_thickness"].dims == four["contact_fraction"].dims == ("time",)
    assert four["time"].attrs["units"] == "s"
    assert_allclose([four["x"][0], four["y"][0]], [0.0, -1e-5], rtol=0.0, atol=1e-18)
    assert_allclose(float(four["revolutions"]), 4.0, rtol=1e-9)
    assert_allclose(float(four["time"][-1]), 4.0 * 60.0 / 20000.0, rtol=1e-9)
    assert bool(four["converged"])
    assert int(four["steps"]) == four.sizes["time"] - 1


@pytest.mark.parametrize("bearing", [PLAIN, PETALS], ids=["plain", "petals"])
def test_a_motion_survives_its_file(tmp_path: Path, bearing: petalfoil.Case) -> None:
    ds = petalfoil.orbit(bearing, duration="0.1 ms")
    save(ds, tmp_path / "orbit.nc")
    xr.testing.assert_identical(load(tmp_path / "orbit.nc"), ds)
    assert ("frame_radius" in ds) == (bearing.petals is not None)


@pytest.mark.slow
def test_two_turns_and_two_more_are_four(four: xr.Dataset, tmp_path: Path) -> None:
    save(petalfoil.orbit(PLAIN, revolutions=2.0), tmp_path / "two.nc")
    more = petalfoil.orbit(PLAIN, revolutions=2.0, restart=tmp_path / "two.nc")
    assert_allclose(more["time"][[0, -1]], [0.5 * float(four["time"][-1]), float(four["time"][-1])], rtol=1e-9)
    whole, halves = (
        np.array([float(ds[name][-1]) for name in ("x", "y", "velocity_x", "velocity_y")]) for ds in (four, more)
    )
    size = np.abs(whole[:2]).max(), np.abs(whole[2:]).max()
    assert_allclose(halves[:2], whole[:2], rtol=0.0, atol=1e-3 * size[0])
    assert_allclose(halves[2:], whole[2:], rtol=0.0, atol=1e-3 * size[1])


def test_a_motion_goes_on_from_one_at_hand(four: xr.Dataset) -> None:
    more = petalfoil.orbit(PLAIN, duration=1e-4, restart=four)
    for name in ("x", "y", "velocity_x", "velocity_y", "shaft_angle"):
        assert_allclose(float(more[name][0]), float(four[name][-1]), rtol=1e-12)


def test_a_ramp_goes_on_where_it_was_left() -> None:
    ramp = "2000 rad/s : 2200 rad/s : 0.2 ms"
    half = petalfoil.orbit(PLAIN, speeds=ramp, duration="0.1 ms")
    rest = petalfoil.orbit(PLAIN, speeds=ramp, restart=half)  # to the end of the ramp
    assert_allclose(rest["time"][[0, -1]], [1e-4, 2e-4], rtol=1e-9)
    assert_allclose(rest["shaft_speed"][[0, -1]], [2100.0, 2200.0], rtol=1e-9)


def test_what_is_given_reaches_the_analysis_in_si(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[dict[str, Any]] = []

    def answer(**given: Any) -> Record:
        asked.append(given)
        return Record(analysis="orbit", scalars={"speed": 1.0})

    play("orbit", answer, monkeypatch)
    petalfoil.orbit(
        PLAIN, duration="10 ms", initial="1 um, 2 um", speeds="0 rpm : 10000 rpm : 1 s", load="20 N", tolerance="1e-4"
    )
    given = asked.pop()
    assert (given["case"], given["restart"], given["revolutions"]) == (PLAIN, None, None)
    assert (given["duration"], given["initial"]) == (0.01, (1e-6, 2e-6))
    assert (given["load"], given["tolerance"]) == ((0.0, -20.0), 1e-4)
    assert_allclose(given["speeds"], [(0.0, 0.0), (1.0, FAST)], rtol=1e-12, atol=0.0)
    petalfoil.orbit(PLAIN, speeds=[(0, 0), ("1 s", "10000 rpm")], initial=(1e-6, "2 um"))
    assert_allclose(asked[0]["speeds"], [(0.0, 0.0), (1.0, FAST)], rtol=1e-12, atol=0.0)
    assert asked[0]["initial"] == (1e-6, 2e-6)


BARE = case("plain_journal")
OTHER = case("plain_journal", **{"bearing.length": 0.06}, **ROTOR)


@pytest.mark.parametrize(
    ("bearing", "given", "error", "reason"),
    [
        ("case.toml", {}, UsageError, "is not a Case"),
        (BARE, {"revolutions": 1.0}, UsageError, r"needs a case with \[rotor\]"),
        (PLAIN, {"revolutions": -1.0}, UsageError, "revolutions: .* greater than 0"),
        (PLAIN, {"revolutions": 1.0, "duration": 1.0}, UsageError, "revolutions says nothing beside duration"),
        (PLAIN, {"tolerance": 0.0}, UsageError, "tolerance: .* greater than 0"),
        (PLAIN, {"duration": "5 m"}, UnitError, "a time"),
        (PLAIN, {"initial": "1 um"}, UsageError, "not a pair"),
        (PLAIN, {"initial": (1.0, 2.0, 3.0)}, UsageError, "initial: .* is not a pair"),
        (PLAIN, {"speeds": "0 : 10 : -1 s"}, UsageError, "goes back in time"),
        (PLAIN, {"speeds": [(1.0, 10.0), (0.5, 20.0)]}, UsageError, "goes back in time"),
        (PLAIN, {"speeds": [(1.0, -10.0)]}, UsageError, "negative speed"),
        (PLAIN, {"speeds": [1.0, 2.0]}, UsageError, r"1.0 is not a pair \(time, speed\)"),
        (PLAIN, {"speeds": 5.0}, UsageError, r"5.0 is not a pair \(time, speed\)"),
        (PLAIN, {"speeds": [(0.0, 0.0)], "revolutions": 1.0}, UsageError, "never turns 1 times"),
        (PLAIN, {"restart": "no such file.nc"}, StoreError, "there is no such file"),
    ],
)
def test_what_cannot_be_is_refused(
    bearing: Any, given: dict[str, Any], error: type[PetalfoilError], reason: str
) -> None:
    with pytest.raises(error, match=reason):
        petalfoil.orbit(bearing, **given)


def test_a_motion_of_another_bearing_is_refused(four: xr.Dataset) -> None:
    with pytest.raises(UsageError, match=r"another bearing: its \[bearing\] differs"):
        petalfoil.orbit(OTHER, restart=four)
    with pytest.raises(UsageError, match=r"another bearing: its \[petals\] differs|its \[bearing\] differs"):
        petalfoil.orbit(PETALS, restart=four)
    with pytest.raises(UsageError, match=r"ended at 2094\.4 rad/s after 4 turns, but these speeds are at 3000 rad/s"):
        petalfoil.orbit(PLAIN.replace(**{"operation.speed": 3000.0}), restart=four)
    with pytest.raises(UsageError, match="holds no motion"):
        petalfoil.orbit(PLAIN, restart=four.drop_vars("last_position"))
    with pytest.raises(UsageError, match="initial says nothing beside restart"):
        petalfoil.orbit(PLAIN, restart=four, initial=(0.0, 0.0))


SLIDING = PETALS.replace(**{"surface.petal_friction": 0.2})


@pytest.fixture(scope="module", params=["plain", "petals", "petals with friction"])
def motion(request: pytest.FixtureRequest) -> tuple[petalfoil.Case, xr.Dataset]:
    bearing = {"plain": PLAIN, "petals": PETALS, "petals with friction": SLIDING}[request.param]
    return bearing, petalfoil.orbit(bearing, duration="0.05 ms")


def changed(ds: xr.Dataset, name: str, change: Callable[[np.ndarray], None]) -> xr.Dataset:
    """The motion with a variable changed in place."""
    copy = ds.copy(deep=True)
    change(copy[name].values)
    return copy


def test_a_motion_goes_on_only_from_a_state_that_is_one(motion: tuple[petalfoil.Case, xr.Dataset]) -> None:
    bearing, ds = motion
    petalfoil.orbit(bearing, duration=1e-6, restart=ds)
    damaged = {
        "reactions are negative": changed(ds, "last_reactions", lambda lam: lam.__setitem__(0, -1e-3)),
        "not finite": changed(ds, "last_state", lambda x: x.__setitem__(-1, np.nan)),
        "pressures are not positive": changed(ds, "last_state", lambda x: x.__setitem__(-1, -1.0)),
        "its (x|min_film_thickness|peak_pressure|force_[xy]) is": changed(
            ds, "last_position", lambda e: e.__setitem__(0, e[0] + 1e-6)
        ),
        "its velocity_y is": changed(ds, "last_velocity", lambda v: v.__setitem__(1, 2.0 * v[1] + 0.1)),
        "has the shape": ds.isel(unknown=slice(1, None)),
    }
    for reason, bad in damaged.items():
        with pytest.raises(UsageError, match=f"ends in an invalid state: .*{reason}"):
            petalfoil.orbit(bearing, duration=1e-6, restart=bad)


def test_petals_that_are_out_of_balance_are_no_state_to_go_on_from() -> None:
    ds = petalfoil.orbit(PETALS, duration="0.05 ms")
    bent = changed(ds, "last_state", lambda x: x.__setitem__(3, x[3] + 1e-3))
    with pytest.raises(UsageError, match="petals and loads are out of balance"):
        petalfoil.orbit(PETALS, duration=1e-6, restart=bent)


@pytest.mark.parametrize("given", [5.0, {"x": 1}, object()])
def test_what_is_no_result_is_no_motion_to_go_on_from(given: Any) -> None:
    with pytest.raises(UsageError, match=r"restart: .* is neither a result nor the file of one"):
        petalfoil.orbit(PLAIN, restart=given)


@pytest.mark.parametrize("bearing", [PLAIN, PETALS], ids=["plain", "petals"])
def test_a_ramp_starts_from_the_balance(bearing: petalfoil.Case) -> None:
    centred = bearing.replace(**{"operation.eccentricity": (0.0, 0.0)})
    ds = petalfoil.orbit(centred, speeds="3000 rad/s : 3100 rad/s : 0.2 ms", duration="0.02 ms")
    balanced = petalfoil.balance(centred, 3.0 * 9.80665, speed=3000.0)
    assert_allclose(float(ds["y"][0]), float(balanced["eccentricity_y"]), rtol=1e-6)
    left = float(np.hypot(ds["force_x"][0], ds["force_y"][0] - 3.0 * 9.80665))
    assert left < 3.0 * 2e-6 * 3000.0**2  # the axis stands off the balance by the unbalance, less than that turns it
    own = petalfoil.orbit(bearing, speeds="3000 rad/s : 3100 rad/s : 0.2 ms", duration="0.02 ms")
    assert_allclose([own["x"][0], own["y"][0]], bearing.operation.eccentricity, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize(("cells", "load"), [(32, (0.0, -29.0)), (18, (0.0, -29.0)), (50, (3.0, -9.0))])
def test_a_plain_bearing_is_run_up_from_where_the_rotor_lies(cells: int, load: tuple[float, float]) -> None:
    """At zero speed the journal lies on the contact film thickness, between nodes a little deeper."""
    lying = PLAIN.replace(**{"operation.eccentricity": (0.0, 0.0), "model.cells_per_pitch": cells})
    ds = petalfoil.orbit(lying, speeds="0 rpm : 1000 rpm : 1 ms", duration="0.01 ms", load=load)
    clearance = lying.bearing.clearance - lying.surface.contact_film_thickness
    assert_allclose(np.hypot(ds["x"][0], ds["y"][0]), clearance, rtol=2e-3)
    assert float(ds["y"][0]) < -0.9 * clearance


def test_progress_is_told() -> None:
    told: list[float] = []
    petalfoil.orbit(PLAIN, duration=1e-4, progress=lambda share, _: told.append(share))
    assert told == sorted(told)
    assert_allclose(told[-1], 1.0, rtol=1e-12)
