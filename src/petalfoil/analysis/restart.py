"""The end of a motion in its result, and a motion that goes on from there."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.release import released
from petalfoil.case import Case
from petalfoil.dynamics.speed_schedule import Schedule
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

SAME = 1e-6
"""Relative difference that speed and angle of the shaft may have where one motion goes on from another."""


def end_state(last: Instant, system: RotorBearing) -> dict[str, Array]:
    """The state at the end, from which a motion can go on."""
    length, rate = system.problem.layout.scales.length, system.rotor.clock.rate
    return {
        "last_state": last.x,
        "last_reactions": last.lam,
        "last_position": last.moving.e * length,
        "last_velocity": last.moving.v * length * rate,
        "last_friction": np.zeros(0) if last.friction is None else last.friction.force,
    }


def end_coordinates(last: Instant) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the state at the end."""
    slides = 0 if last.friction is None else len(last.friction.force)
    sizes = {"unknown": len(last.x), "gap": len(last.lam), "axis": len(last.e), "slide": slides}
    return {name: np.arange(size) for name, size in sizes.items()}


def instant_of(result: xr.Dataset, system: RotorBearing, tau: float) -> Instant:
    """The end of a motion, to go on from."""
    length, rate = system.problem.layout.scales.length, system.rotor.clock.rate
    x, lam = result["last_state"].to_numpy(), result["last_reactions"].to_numpy()
    e, v = result["last_position"].to_numpy() / length, result["last_velocity"].to_numpy() / (length * rate)
    start = released(system, tau, (x, lam, lam > 0.0), (e, v))
    if start.friction is None:
        return start
    return replace(start, friction=replace(start.friction, force=result["last_friction"].to_numpy()))


def continued(case: Case, schedule: Schedule, result: xr.Dataset) -> float:
    """Time at which the motion of `result` ended [s].

    Raises
    ------
    UsageError
        The result is not that of a motion, or it is the motion of another bearing or of another shaft's speed.
    """
    if "last_position" not in result:
        raise UsageError("this result holds no motion to go on from: give a file that orbit wrote")
    before = Case.from_toml(result.attrs["case"])
    walls = [wall.section for wall in (*before.walls, *case.walls)]
    for section in ("bearing", *walls, "gas", "surface", "model"):
        if getattr(before, section, None) != getattr(case, section, None):
            raise UsageError(
                f"the motion to go on from is that of another bearing: its [{section}] differs from the case's"
            )
    end, speed, angle = (float(result[name].to_numpy()[-1]) for name in ("time", "shaft_speed", "shaft_angle"))
    if abs(schedule.speed(end) - speed) > SAME * speed or abs(schedule.angle(end) - angle) > SAME * max(angle, 1.0):
        turns = 2.0 * np.pi
        raise UsageError(
            f"the motion to go on from ended at {speed:.6g} rad/s after {angle / turns:.6g} turns, but these speeds "
            f"are at {schedule.speed(end):.6g} rad/s after {schedule.angle(end) / turns:.6g} turns then: give the "
            "speeds from its start on, and what follows"
        )
    return end
