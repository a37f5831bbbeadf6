"""The journal through time, step by step: weight, loads and unbalance, film and petals moving with it (65)."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.friction_told import RELEASED, RELEASED_LOADED, FrictionTold
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.records import effort, geometry, record_of
from petalfoil.analysis.release import (
    Kept,
    OrbitRequest,
    at_kept,
    at_rest,
    at_rest_on_path,
    balance_on_path,
    begins_on_path,
    first_position,
    system_of,
    temperatures_of,
)
from petalfoil.analysis.restart import (
    check_figures,
    continued,
    end_coordinates,
    end_state,
    instant_of,
    kept_temperatures,
)
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.steps_ahead import steps_ahead
from petalfoil.analysis.trace import Trace
from petalfoil.case import Case, warnings_of
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.equilibrium.run_context import RunContext, new_run
from petalfoil.equilibrium.small_motion import AT_POINTS, HELD_AT_NODES, ON_LINES
from petalfoil.results.motion import figures_of, tilt_figures
from petalfoil.results.parts import RunOutcome
from petalfoil.results.record import Record
from petalfoil.system.time_step import StepProblem
from petalfoil.units import format_percent

if TYPE_CHECKING:
    import xarray as xr

Array = NDArray[np.float64]

LOG = logging.getLogger(__name__)

TURN = 2.0 * np.pi

AT_SPEED = 1e-9
"""Part by which a speed that is reached may lie below the one given: a ramp ends there but for rounding."""


@dataclass(frozen=True, kw_only=True)
class MotionSummary:
    """What is told of the motion as a whole."""

    speed: float
    amplitude: float
    dominant_whirl_ratio: float
    revolutions: float
    rotor_mass: float
    reference_film_thickness: float


@dataclass(frozen=True, kw_only=True)
class Tilt:
    """What is told of the tilt of a shaft in two bearings."""

    tilt_amplitude: float
    tilt_whirl_ratio: float
    span: float
    rotor_centre: float


@dataclass(frozen=True, kw_only=True)
class Warmth:
    """Temperatures that a motion keeps [K], and how much shaft and bushing have grown where it begins [m]."""

    film_temperature: float
    shaft_temperature: float
    pack_temperature: float
    bushing_temperature: float
    shaft_growth: float
    bushing_growth: float


@dataclass(frozen=True, kw_only=True)
class OtherWarmth:
    """Temperatures that a motion keeps in the second bearing [K]."""

    other_film_temperature: float
    other_shaft_temperature: float
    other_pack_temperature: float
    other_bushing_temperature: float


@dataclass(frozen=True, kw_only=True)
class Stepping:
    """The steps in time."""

    tolerance: float
    steps: int
    rejected_steps: int
    failed_steps: int


@dataclass(frozen=True, kw_only=True)
class ContactsInTime:
    """Where contacts are in a motion; None where the wall has none."""

    contact_model: str | None
    point_share: float | None

    @classmethod
    def of(cls, system: RotorBearing, steps: int, at_points: int) -> ContactsInTime:
        """Those of a motion with as many `steps`, of which `at_points` have contact points."""
        problem = system.problem
        if not (problem.layout if isinstance(problem, StepProblem) else problem.parts[0].layout).n_wall:
            return cls(contact_model=None, point_share=None)
        share, kind = at_points / steps if steps else 0.0, ON_LINES if system.lines else AT_POINTS
        between = f"{kind} in {format_percent(share)} of the steps, contacts at nodes in the others"
        model = kind if share == 1.0 else between if at_points else HELD_AT_NODES
        return cls(contact_model=model, point_share=share)


@dataclass
class Orbit:
    """A motion that is followed step by step, and recorded at any of them.

    Attributes
    ----------
    case : Case
        A bearing with its rotor; with a heat network as it is at the temperatures that the motion keeps.
    request : OrbitRequest
        How it moves.
    system : RotorBearing
        Both in the units of the problem.
    start : Instant
        Where it begins.
    end : float
        Where it ends [s].
    run : RunContext
        Counts of the start and of all steps.
    asked : Case
        The case that was asked for, with its heat network if it has one.
    warm : tuple of Temperatures or None
        Temperatures that the motion keeps in each bearing: it is shorter than any warm-up.
    foretold : tuple of str
        Warnings of what it costs.
    """

    case: Case
    request: OrbitRequest
    system: RotorBearing
    start: Instant
    end: float
    run: RunContext
    asked: Case
    warm: Kept = (None,)
    trace: Trace = field(init=False)
    foretold: tuple[str, ...] = ()
    taken: int = 0
    at_points: int = 0
    residual: float = 0.0
    is_series: bool = False

    def __post_init__(self) -> None:
        """Keep the start."""
        self.trace = Trace(self.case, self.system)
        self.trace.add(self.start)

    @classmethod
    def begin(cls, case: Case, request: OrbitRequest, restart: xr.Dataset | None = None) -> Orbit:
        """Find the start: an equilibrium, or the end of an earlier motion of the same bearing.

        Raises
        ------
        UsageError
            The case has no rotor, or the result is that of another bearing.
        ConvergenceError
            No equilibrium was found to start from.
        """
        newton_only(case)
        run, schedule = new_run(), request.schedule(case)
        if restart is None:
            with run.active():
                warm = temperatures_of(case, request)
                warmed, supports = at_kept(case, warm)
                known = balance_on_path(warmed, request)
                first = first_position(warmed if case.shares_evenly else case, request, known)
                request, place = replace(request, slope=first.slope), first.place
                placed = at(warmed, eccentricity=place)
                system, time = system_of(placed, supports, schedule, request.load), 0.0
                start = at_rest(placed, system, request, first) if known is None else at_rest_on_path(system, known)
        else:
            time, warm, place = continued(case, schedule, restart), kept_temperatures(case, restart), None
            placed, supports = at_kept(case, warm)
            system = system_of(placed, supports, schedule, request.load)
            start = instant_of(restart, system, time * system.rotor.clock.rate)
        end, asked = time + request.lasts(schedule, time), at(case, eccentricity=place)
        orbit = cls(placed, request, system, start, end, run, asked, warm)
        if restart is not None:
            check_figures(restart, orbit.trace.rows[0])
        return orbit

    def advance(self) -> Iterator[tuple[float, str]]:
        """Take the steps; give the part of the motion that is done.

        Raises
        ------
        ConvergenceError
            No step, however short, leads on.
        """
        with self.run.active():
            self.foretold = tuple(steps_ahead(self.system, self.start))
        for warning in self.foretold:
            LOG.warning("Warning: %s", warning)
        options = MarchOptions(tolerance=self.request.tolerance, longest=self.request.longest)
        begin, end = self.start.tau, self.end * self.system.rotor.clock.rate
        for stepped in self.run.during(march(self.system, self.start, end, options)):
            self.trace.add(stepped.end)
            self.taken += 1
            self.at_points += stepped.end.between_nodes
            self.residual = max(self.residual, stepped.residual)
            yield (stepped.end.tau - begin) / (end - begin), f"{self.trace.turned / TURN:.1f} turns"

    def records(self, ended: str = "") -> tuple[Record, ...]:
        """The motion so far."""
        return (self.record(f"{ended} after {self._turns:.4g} turns" if ended else "converged"),)

    def finished(self) -> str:
        """How many turns are done."""
        return f"{self._turns:.4g} turns are finished" if self.taken else ""

    @property
    def _turns(self) -> float:
        """Revolutions of the shaft so far."""
        return float(self.trace.rows[-1]["shaft_angle"] - self.trace.rows[0]["shaft_angle"]) / TURN

    def record(self, status: str = "converged") -> Record:
        """Everything so far as a record."""
        time, over = self.trace.histories()
        coords, pictures = self.trace.pictures()
        last = self.trace.last or self.start
        record = record_of(
            "orbit",
            self.asked,
            *geometry(self.asked),
            self._summary(time, over),
            *self._tilt(time, over),
            *self._warmth(),
            FrictionTold(self._path),
            ContactsInTime.of(self.system, self.taken, self.at_points),
            self.trace.audits(over),
            self._stepping(),
            effort(self.run.seconds, self.run),
            RunOutcome(status=status, residual=float(self.residual)),
            history=[],
            fields={**over, **pictures, **end_state(last, self.system)},
            coords={"time": time, **coords, **end_coordinates(last)},
        )
        judged = {**record.scalars, **worst_of(over, self.case.operation.speed)}
        return replace(record, warnings=(*self.foretold, *warnings_of(self.asked, judged)))

    def _summary(self, time: Array, over: dict[str, Array]) -> MotionSummary:
        return MotionSummary(
            speed=self.case.operation.speed,
            **figures_of(time, over, (0.0,) if self.case.rotor is None else self.case.rotor.places),
            revolutions=float(over["shaft_angle"][-1] - over["shaft_angle"][0]) / TURN,
            rotor_mass=0.0 if self.case.rotor is None else self.case.rotor.mass,
            reference_film_thickness=self.system.problem.layout.scales.length,
        )

    def _tilt(self, time: Array, over: dict[str, Array]) -> tuple[Tilt, ...]:
        """What is told of a shaft that tilts; nothing of another."""
        if self.case.rotor is None or self.case.rotor.span is None:
            return ()
        rotor = self.case.rotor
        return (Tilt(**tilt_figures(time, over), span=rotor.span or 0.0, rotor_centre=rotor.centre),)

    def _warmth(self) -> tuple[object, ...]:
        """What is told of a motion with a heat network; nothing of another."""
        first, other = self.warm[0], self.warm[-1]
        told: list[object] = []
        if first is not None:
            growth = self.case.growth
            told.append(
                Warmth(
                    **{f"{node}_temperature": T for node, T in first._asdict().items()},
                    shaft_growth=growth.journal(float(self.trace.rows[0]["shaft_speed"])),
                    bushing_growth=growth.bushing,
                )
            )
        if other is not None and not self.asked.shares_evenly:
            told.append(OtherWarmth(**{f"other_{node}_temperature": T for node, T in other._asdict().items()}))
        return tuple(told)

    @property
    def _path(self) -> str | None:
        """Where the friction forces between petals come from."""
        if self.system.friction is None:
            return None
        return RELEASED_LOADED if begins_on_path(self.case, self.request) else RELEASED

    def _stepping(self) -> Stepping:
        refused = [row.get("outcome") for row in self.run.history if row["phase"] == "motion"]
        return Stepping(
            tolerance=self.request.tolerance,
            steps=self.taken,
            rejected_steps=refused.count("error"),
            failed_steps=refused.count("no answer") + refused.count("no points"),
        )


def worst_of(over: dict[str, Array], speed: float) -> dict[str, float]:
    """What warnings judge of a motion: its extremes while the shaft turns at the speed of the case or faster."""
    turning = over["shaft_speed"] >= (1.0 - AT_SPEED) * speed
    if not turning.any():
        return {}
    return {
        "min_film_thickness": float(over["min_film_thickness"][turning].min()),
        "contact_fraction": float(over["contact_fraction"][turning].max()),
        "peak_pressure": float(over["peak_pressure"][turning].max()),
    }


def follow(case: Case, request: OrbitRequest, restart: xr.Dataset | None = None) -> Record:
    """The record of a whole motion."""
    with one_thread():
        orbit = Orbit.begin(case, request, restart)
        for _ in orbit.advance():
            pass
        return orbit.record()
