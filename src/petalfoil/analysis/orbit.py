"""The journal through time: weight, loads and unbalance, film and petals moving with it (65)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.balance import settled
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.equilibrium import Named, chosen, positioned
from petalfoil.analysis.figures import effort, given
from petalfoil.analysis.session import Clock, Progress, one_thread
from petalfoil.analysis.trace import Trace
from petalfoil.case import Case
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.rotor import RotorMotion, constant_load
from petalfoil.dynamics.speed_schedule import Schedule
from petalfoil.dynamics.time_state import Instant, TimeState
from petalfoil.dynamics.tr_bdf2 import System
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.loaded import journal_force
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import UsageError
from petalfoil.results.motion import figures_of
from petalfoil.results.record import Record
from petalfoil.system.build import build_pair, build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.friction import FrictionState, friction_of
from petalfoil.system.loaded import FilmForce
from petalfoil.system.time_step import StepProblem

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]
Load = tuple[float, float]

TOLERANCE = 1e-3
"""Local error of a step in reference films and ambient pressures."""


@dataclass(frozen=True)
class OrbitRequest:
    """What a motion is asked for.

    Attributes
    ----------
    revolutions : float or None
        Turns of the shaft; by default what `duration` or the schedule lasts, else 20.
    duration : float or None
        Time [s], instead of turns.
    initial : (2,), "balance" or None
        Displacement that the journal is released from [m], or where the constant load balances; by default the case's.
    speeds : list of (time, speed) or None
        Speed of the shaft [s, rad/s]; by default the case's.
    load : (2,) or None
        Constant load [N]; by default the case's, without one the weight.
    slope : (2,)
        Slopes that a shaft in two bearings is released with [rad].
    tolerance : float
        Local error of a step in reference films and ambient pressures.
    longest : float
        Longest step, as an angle of the shaft at its highest speed [rad].
    """

    revolutions: float | None = None
    duration: float | None = None
    initial: Load | Literal["balance"] | None = None
    speeds: tuple[tuple[float, float], ...] | None = None
    load: Load | None = None
    tolerance: float = TOLERANCE
    longest: float = MarchOptions.longest
    slope: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Refuse what has no meaning.

        Raises
        ------
        UsageError
            Turns, time, tolerance or step are not above zero, or both turns and time are given.
        """
        named = {"revolutions": self.revolutions, "duration": self.duration}
        for name, value in {**named, "tolerance": self.tolerance, "longest step": self.longest}.items():
            if value is not None and not (value > 0.0 and np.isfinite(value)):
                raise UsageError(f"{name} must be above zero, got {value:g}")
        if self.revolutions is not None and self.duration is not None:
            raise UsageError("give either revolutions or a duration, not both")

    def schedule(self, case: Case) -> Schedule:
        """Speed over time."""
        return Schedule.through(list(self.speeds or ((0.0, case.operation.speed),)))

    def lasts(self, schedule: Schedule, start: float) -> float:
        """Time from `start` to the end [s].

        Raises
        ------
        UsageError
            The shaft never turns that often.
        """
        if self.duration is not None:
            return self.duration
        if self.revolutions is None and len(schedule.times) > 1 and schedule.times[-1] > start:
            return float(schedule.times[-1]) - start
        turns = self.revolutions or 20.0
        end = schedule.instant(schedule.angle(start) + 2.0 * np.pi * turns)
        if not np.isfinite(end):
            raise UsageError(f"the shaft never turns {turns:g} times at these speeds: give a duration instead")
        return end - start


class Orbit:
    """A motion that can be followed step by step, and recorded at any of them.

    Parameters
    ----------
    case : Case
        A bearing with its rotor.
    course : OrbitRequest
        How it moves.
    restart : xarray.Dataset or None
        Result of a motion of the same bearing, to go on from its end.

    Raises
    ------
    UsageError
        The case has no rotor, or the result is that of another bearing.
    ConvergenceError
        No equilibrium was found to start from.
    """

    def __init__(self, case: Case, course: OrbitRequest, restart: xr.Dataset | None = None) -> None:
        newton_only(case)
        self.clock, self.work, self.course = Clock(), RunLog(), course
        self.case = positioned(case, None, first_position(case, course, self.work)) if restart is None else case
        schedule = course.schedule(case)
        begin = 0.0 if restart is None else continued(case, schedule, restart)
        with one_thread():
            self.system = system_of(self.case, schedule, course.load)
            tau = begin * self.system.rotor.clock.rate
            if restart is None:
                self.start = at_rest(self.case, self.system, course, self.work)
            else:
                self.start = instant_of(restart, self.system, tau)
        self.end = begin + course.lasts(schedule, begin)
        self.trace = Trace(self.case, self.system)
        self.trace.add(self.start)
        self.counts = {"steps": 0, "residual": 0.0}

    def steps(self, progress: Progress | None = None) -> Iterator[float]:
        """Take the steps; yield the share of the motion that is done.

        Raises
        ------
        ConvergenceError
            No step, however short, leads on.
        """
        rate = self.system.rotor.clock.rate
        options = MarchOptions(tolerance=self.course.tolerance, longest=self.course.longest)
        begin, end = self.start.tau, self.end * rate
        with one_thread():
            for stepped in march(self.system, self.start, end, self.work, options):
                self.trace.add(stepped.end)
                self.counts["steps"] += 1
                self.counts["residual"] = max(self.counts["residual"], stepped.residual)
                share = (stepped.end.tau - begin) / (end - begin)
                if progress is not None:
                    progress(share, f"orbit: {self.trace.rows[-1]['shaft_angle'] / (2.0 * np.pi):.1f} turns")
                yield share

    def record(self, status: str = "converged") -> Record:
        """Everything up to here as a record."""
        time, over = self.trace.histories()
        coords, pictures = self.trace.pictures()
        last = self.trace.last or self.start
        refused = [row.get("outcome") for row in self.work.history if row["phase"] == "motion"]
        scalars: Named = {
            **{key: value for key, value in given(self.case).items() if key not in HERE},
            **self.trace.audits(over),
            **figures_of(time, over),
            "revolutions": float(over["shaft_angle"][-1] - over["shaft_angle"][0]) / (2.0 * np.pi),
            "tolerance": self.course.tolerance,
            "rotor_mass": 0.0 if self.case.rotor is None else self.case.rotor.mass,
            "steps": int(self.counts["steps"]),
            "rejected_steps": refused.count("error"),
            "failed_steps": refused.count("no answer"),
            "residual": float(self.counts["residual"]),
            **effort(self.work),
            "reference_film_thickness": self.system.problem.layout.scales.length,
            "wall_time": self.clock.seconds,
            "converged": True,
            "status": status,
        }
        return Record(
            analysis="orbit",
            scalars=scalars,
            fields={**over, **pictures, **end_state(last, self.system)},
            coords={"time": time, **coords, **end_coordinates(last)},
            case_toml=self.case.to_toml(),
            title=self.case.title,
            history=[],
        )


SAME = 1e-6
"""Share by which speed and angle of the shaft may differ where one motion goes on from another."""
HERE = ("eccentricity_x", "eccentricity_y")
"""Figures of a point that a motion has over time."""


def run(
    case: Case, course: OrbitRequest, restart: xr.Dataset | None = None, progress: Progress | None = None
) -> Record:
    """The whole motion.

    Raises
    ------
    UsageError
        The case has no rotor, the course is impossible, or the result to go on from is that of another bearing.
    ConvergenceError
        No equilibrium to start from, or no step that leads on.
    """
    orbit = Orbit(case, course, restart)
    for _ in orbit.steps(progress):
        pass
    return orbit.record()


def first_position(case: Case, course: OrbitRequest, work: RunLog) -> Load | None:
    """Where the journal is released [m]; None where the case says so.

    Raises
    ------
    ConvergenceError
        No position balances the load.
    """
    if course.initial != "balance":
        return course.initial
    load = constant_load(case, course.load)
    if case.rotor is not None and case.rotor.span:
        load = (0.5 * load[0], 0.5 * load[1])  # the bearings share it
    there = positioned(case, course.schedule(case).speed(0.0), (0.0, 0.0))
    with one_thread():
        found, _ = settled(there, load, work)
    x, y = found.answer.problem.displacement * found.answer.problem.layout.scales.length
    return float(x) - (0.0 if case.rotor is None else case.rotor.unbalance), float(y)


def system_of(case: Case, schedule: Schedule, load: Load | None) -> System:
    """The bearing of `case` and its rotor in the units of the problem."""
    problem = build_pair(case) if case.rotor is not None and case.rotor.span else build_problem(case)
    if problem.layout.film_rows.content is not None and len(problem.displacement) > 2:
        raise UsageError(
            "two flat films without ends hold no gas of their own: take the spatial model or ambient edges"
        )
    rotor = RotorMotion.of(case, problem.layout.scales, schedule, load)
    still = StepProblem(problem.layout, 0.0, problem.displacement, rotor.clock.bearing_number)
    return System(still, rotor, FilmForce.of(problem), friction_of(case, problem.layout))


def at_rest(case: Case, system: System, course: OrbitRequest, work: RunLog) -> Instant:
    """The journal held where it is, film and petals in equilibrium, and let go at time zero.

    From a balance its mass centre rests, and the shaft turns about that: a start without a blow.
    """
    rotor, scales = case.rotor, system.problem.layout.scales
    speed, place = system.rotor.schedule.speed(0.0), system.problem.displacement
    off = np.zeros_like(place)  # of the axis from the mass centre, over the reference length
    if rotor is not None and course.initial == "balance":
        off[:2] = [-rotor.unbalance / scales.length, 0.0]
    if rotor is None or len(place) == 2:
        answer, _ = chosen(case.replace(**{"operation.speed": speed}), work)
    else:
        place = place + rotor.lever / scales.length * np.array([0.0, 0.0, *course.slope])
        both = system.problem.at(bearing_number=system.rotor.bearing_number(0.0), displacement=place)
        answer = solve_cold(CoupledProblem(both.layout, both.bearing_number, both.displacement), work)
    turning = np.zeros_like(place)
    turning[:2] = np.array([-off[1], off[0]]) * speed / system.rotor.clock.rate
    return released(system, 0.0, (answer.x, answer.lam, answer.in_contact), (place, turning))


def released(
    system: System, tau: float, state: tuple[Array, Array, NDArray[np.bool_]], moving: tuple[Array, Array]
) -> Instant:
    """An instant from unknowns, reactions and closed gaps, position and velocity: its rates by the equations."""
    (x, lam, closed), (e, v), rotor = state, moving, system.rotor
    problem = system.problem.at(displacement=e, bearing_number=rotor.bearing_number(tau))
    film = FilmState(problem.layout.film_rows, problem.pressure(x), problem.film(x), problem.bearing_number)
    outflow = film.residual.copy()
    if problem.layout.film_rows.content is not None:
        outflow[0] = 0.0  # the content stands in place of this balance
    force = journal_force(problem, x[problem.positive], lam) + rotor.outside(tau) - rotor.gyroscopic(tau) @ v
    speeding = np.asarray(np.linalg.solve(rotor.inertia, force), dtype=np.float64)
    change = TimeState(-outflow, v, speeding)
    rubbed = None if system.friction is None else FrictionState.fresh(system.friction, x, lam)
    return Instant(tau, x, lam, closed, TimeState(problem.stored(x), e, v), change, rubbed)


def end_state(last: Instant, system: System) -> dict[str, Array]:
    """The state at the end, from which a motion can go on."""
    length, rate = system.problem.layout.scales.length, system.rotor.clock.rate
    return {
        "last_state": last.x,
        "last_reactions": last.lam,
        "last_position": last.moving.e * length,
        "last_velocity": last.moving.v * length * rate,
        "last_friction": np.zeros(0) if last.rubbed is None else last.rubbed.force,
    }


def end_coordinates(last: Instant) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the state at the end."""
    slides = 0 if last.rubbed is None else len(last.rubbed.force)
    sizes = {"unknown": len(last.x), "gap": len(last.lam), "axis": len(last.e), "slide": slides}
    return {name: np.arange(size) for name, size in sizes.items()}


def instant_of(result: xr.Dataset, system: System, tau: float) -> Instant:
    """The end of a motion, to go on from."""
    length, rate = system.problem.layout.scales.length, system.rotor.clock.rate
    x, lam = result["last_state"].to_numpy(), result["last_reactions"].to_numpy()
    e, v = result["last_position"].to_numpy() / length, result["last_velocity"].to_numpy() / (length * rate)
    start = released(system, tau, (x, lam, lam > 0.0), (e, v))
    if start.rubbed is None:
        return start
    return replace(start, rubbed=replace(start.rubbed, force=result["last_friction"].to_numpy()))


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
