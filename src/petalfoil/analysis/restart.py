"""The end of a motion in its result, and a motion that goes on from there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.release import Kept
from petalfoil.analysis.release_at_nodes import released
from petalfoil.analysis.release_at_points import equations_at, released_at_points
from petalfoil.analysis.release_on_lines import released_on_lines
from petalfoil.analysis.restart_on_lines import HeldState, lines_of, numbers_of
from petalfoil.case import Case
from petalfoil.dynamics.speed_schedule import Schedule
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.dynamics.travelling_stage import petals_balanced
from petalfoil.errors import UsageError
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.friction import against_slip
from petalfoil.system.point_equations import PointState
from petalfoil.system.temperatures import Temperatures
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

NEEDED = ("last_state", "last_reactions", "last_position", "last_velocity", "time", "shaft_speed", "shaft_angle")
"""What a motion goes on from."""

RECORDED = ("x", "y", "velocity_x", "velocity_y", "min_film_thickness", "peak_pressure", "force_x", "force_y")
"""Figures of the last state that the motion recorded too."""

BALANCED, BALANCED_SLIDING = RESIDUAL_TOLERANCE, 0.02
"""Residual of the wall's rows up to which a state is one. Stages leave 2e-12; with friction, whose limits follow the
reactions a correction late, 2e-3."""

PULL = 1e-5
"""Reaction below zero up to which a contact on a line is one, in ambient pressure on a node: a stage leaves a tenth."""

SAME = 1e-6
"""Relative difference that speed and angle of the shaft may have where one motion goes on from another."""


OF_POINTS = ("petal_unknown", "point_number")
"""Dimensions of the state of contact points."""


def end_state(last: Instant, system: RotorBearing) -> dict[str, Array]:
    """The state at the end, from which a motion can go on."""
    length, rate = system.problem.layout.scales.length, system.rotor.clock.rate
    return {
        "last_state": last.x,
        "last_reactions": last.lam,
        "last_position": last.moving.e * length,
        "last_velocity": last.moving.v * length * rate,
        "last_friction": np.zeros(0) if last.friction is None else last.friction.force,
        **end_points(last),
        **({} if last.lines is None else {"last_lines": numbers_of(last.lines)}),
    }


def end_points(last: Instant) -> dict[str, Array]:
    """The same of petals with continuous slopes and their contact points; nothing of contacts at nodes."""
    if last.points is None:
        return {}
    points = last.points.points
    counts = np.array([len(points.curve)]), points.curve
    return {
        "last_petals": last.points.w,
        "last_points": np.concatenate([*counts, points.position, points.inner, points.reaction], dtype=np.float64),
    }


def end_coordinates(last: Instant) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the state at the end."""
    slides = 0 if last.friction is None else len(last.friction.force)
    sizes = {"unknown": len(last.x), "gap": len(last.lam), "axis": len(last.e), "slide": slides}
    sizes |= {dim: len(values) for dim, values in zip(OF_POINTS, end_points(last).values(), strict=False)}
    if last.lines is not None:
        sizes["line_number"] = len(numbers_of(last.lines))
    return {name: np.arange(size) for name, size in sizes.items()}


def instant_of(result: xr.Dataset, system: RotorBearing, tau: float) -> Instant:
    """The end of a motion, to go on from.

    Raises
    ------
    UsageError
        The state there is damaged: it has other sizes, is not finite, pulls where contacts can only push, or does not
        satisfy the equations of the wall.
    """
    scales, layout = system.problem.layout.scales, system.problem.layout
    sizes = (layout.unknowns.n, len(system.problem.weight), len(system.problem.displacement))
    x, lam, e = (
        _state(result, f"last_{name}", size)
        for name, size in zip(("state", "reactions", "position"), sizes, strict=True)
    )
    v = _state(result, "last_velocity", len(e)) / (scales.length * system.rotor.clock.rate)
    on_lines = system.lines and "last_lines" in result  # the weights of (K15) are negative at some nodes
    if not on_lines and np.any(lam < 0.0):
        raise _damaged("contact reactions are negative")
    if not np.all(x[layout.unknowns[PRESSURE]] > 0.0):
        raise _damaged("absolute pressures are not positive")
    if system.points is not None and "last_points" in result:
        return at_points_of(result, system, tau, (x, e / scales.length, v))
    if on_lines:
        return on_lines_of(result, system, tau, (x, e / scales.length, v))
    start = released(system, tau, (x, lam, lam > 0.0), (e / scales.length, v))
    if start.friction is not None:
        force = _state(result, "last_friction", len(start.friction.force))
        start = replace(start, friction=replace(start.friction, force=force))
    imbalance, allowed = wall_imbalance(start, system), BALANCED if system.friction is None else BALANCED_SLIDING
    if not imbalance <= allowed:
        raise _damaged(f"petals and loads are out of balance by {imbalance:.2g} of ambient pressure, over {allowed:g}")
    return start


def at_points_of(result: xr.Dataset, system: RotorBearing, tau: float, at: tuple[Array, Array, Array]) -> Instant:
    """The same with contact points; `at` are unknowns, displacement and velocity.

    Raises
    ------
    UsageError
        The state is damaged.
    """
    (x, e, v), whole = at, system.points
    if whole is None:
        raise ValueError("contacts of this motion are at nodes")
    w, numbers = _state(result, "last_petals", whole.n_wall), result["last_points"].to_numpy()
    points = points_of(numbers, len(whole.curves.elements)) if np.all(np.isfinite(numbers)) else None
    if points is None:
        raise _damaged("last_points are no contact points")
    state = PointState(w, x[whole.layout.unknowns[PRESSURE]], points)
    pulls = None if system.friction is None else _state(result, "last_friction", len(points.reaction))
    equations = equations_at(system, tau, state, e, pulls)
    if np.min(equations.film_thickness) <= 0.0 or not petals_balanced(equations):
        raise _damaged("petals, loads and contacts are out of balance")
    start = released_at_points(system, tau, state, (e, v), pulls)
    if not np.allclose(start.x, x, rtol=0.0, atol=SAME * float(np.max(np.abs(x)))):
        raise _damaged("petals and loads are out of balance: deflections at nodes are not those between them")
    return start


def on_lines_of(result: xr.Dataset, system: RotorBearing, tau: float, at: tuple[Array, Array, Array]) -> Instant:
    """The same with contact lines.

    Raises
    ------
    UsageError
        The state is damaged.
    """
    (x, e, v), problem = at, system.problem.at(displacement=at[1], bearing_number=system.rotor.bearing_number(tau))
    if not isinstance(problem, StepProblem):
        raise TypeError("contacts of a shaft in two bearings are at nodes")
    lines = lines_of(result["last_lines"].to_numpy(), HeldState(problem, x))
    if lines is None:
        raise _damaged("last_lines are no contact lines")
    least = min(lines.reaction.min(initial=0.0), lines.held_reaction.min(initial=0.0))
    if not problem.admits(x) or not petals_balanced(lines) or least < -PULL:
        raise _damaged("petals, loads and contacts are out of balance")
    return released_on_lines(system, tau, lines, (e, v))


def points_of(numbers: Array, curves: int) -> ContactPoints | None:
    """Contact points from their number, curves, positions, points in stretches and reactions; None if they are none."""
    k = int(numbers[0]) if len(numbers) else -1
    if k < 0 or len(numbers) < 1 + 3 * k:
        return None
    curve, position, inner, reaction = np.split(numbers[1:], [k, 2 * k, 3 * k])
    whole = np.all((curve == np.floor(curve)) & (curve < curves) & (curve >= 0.0))
    if not whole or np.any(inner < 0.0) or len(reaction) != k + inner.sum():
        return None
    return ContactPoints(curve.astype(np.intp), position, inner.astype(np.intp), reaction)


def wall_imbalance(instant: Instant, system: RotorBearing) -> float:
    """Largest residual of the wall's rows (C1) at an instant, over their scale; 0 of a rigid wall [1].

    What a wall that loses energy is out of balance by is the rate of its loss: nothing is left over.
    """
    # of the speed the wall only knows whether the journal turns
    turning = system.rotor.bearing_number(instant.tau)
    problem = system.problem.at(bearing_number=turning, displacement=instant.e)
    if any(part.layout.loss is not None for part, _, _ in problem.each(instant.x, instant.lam)):
        return 0.0
    linearized, wall = problem.linearize(instant.x), problem.layout.unknowns[DEFLECTION]
    residual = linearized.residual - problem.acting.T @ instant.lam
    if system.friction is not None and instant.friction is not None:
        residual = residual + against_slip(system.friction, instant.friction.force, len(instant.x))
    return float(np.max(np.abs(residual[wall]) / linearized.row_scale[wall], initial=0.0))


def check_figures(result: xr.Dataset, figures: Mapping[str, float]) -> None:
    """Refuse a state whose results differ from those that the motion recorded at its end.

    Parameters
    ----------
    result : xarray.Dataset
        The motion.
    figures : mapping
        The same figures computed from its last state, SI.

    Raises
    ------
    UsageError
        One of them differs.
    """
    for name in RECORDED:
        told, found = float(result[name].to_numpy()[-1]), figures[name]
        size = float(np.abs(result[name].to_numpy()).max())
        if not abs(told - found) <= SAME * size:
            raise _damaged(f"its {name} is {found:.6g}, but the motion ended with {told:.6g}")


def kept_temperatures(case: Case, result: xr.Dataset) -> Kept:
    """Temperatures that a motion kept in each bearing, and keeps where it goes on; None without a heat network.

    Raises
    ------
    UsageError
        The case has a heat network, and the motion none.
    """
    marks = ("", "") if case.shares_evenly else ("", "other_")
    return tuple(_kept(one, result, mark) for one, mark in zip(case.supports, marks, strict=False))


def _kept(bearing: Case, result: xr.Dataset, mark: str) -> Temperatures | None:
    if bearing.heat is None:
        return None
    names = [f"{mark}{node}_temperature" for node in Temperatures._fields]
    if not {*names} <= {*map(str, result.variables)}:
        raise UsageError("the motion to go on from has no heat network: leave [heat] out, or run it again")
    return Temperatures(*(float(result[name]) for name in names))


def _state(result: xr.Dataset, name: str, size: int) -> Array:
    """A part of the last state.

    Raises
    ------
    UsageError
        It is not there, has another size or is not finite.
    """
    values = result[name].to_numpy() if name in result else np.zeros(0)
    if values.shape != (size,):
        raise _damaged(f"{name} has the shape {values.shape} where this bearing needs {(size,)}")
    if values.dtype.kind != "f" or not np.all(np.isfinite(values)):
        raise _damaged(f"{name} has values that are not finite numbers")
    return values


def _damaged(reason: str) -> UsageError:
    return UsageError(f"the motion to go on from ends in an invalid state: {reason}; run it again")


def continued(case: Case, schedule: Schedule, result: xr.Dataset) -> float:
    """Time at which the motion of `result` ended [s].

    Raises
    ------
    UsageError
        The result is not that of a motion, or it is the motion of another bearing or of another shaft's speed.
    """
    if not {*NEEDED, *RECORDED} <= {*map(str, result.variables)} or "case" not in result.attrs:
        raise UsageError("this result holds no motion to go on from: give a file that orbit wrote")
    before = Case.from_toml(result.attrs["case"])
    walls = [wall.section for wall in (*before.walls, *case.walls)]
    for section in ("bearing", *walls, "gas", "surface", "model"):
        if getattr(before, section, None) != getattr(case, section, None):
            raise UsageError(
                f"the motion to go on from is that of another bearing: its [{section}] differs from the case's"
            )
    seconds = [None if of.rotor is None else of.rotor.second for of in (before, case)]
    if seconds[0] != seconds[1]:
        raise UsageError(
            "the motion to go on from is that of another rotor: its [rotor.second] differs from the case's"
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
