"""Where a motion begins: the request, the system, and the journal released from an equilibrium."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.friction_told import follows_path
from petalfoil.analysis.heat_results import at_temperatures
from petalfoil.analysis.operating_point import Vector, at, at_position, under_load
from petalfoil.analysis.release_at_nodes import released
from petalfoil.analysis.release_at_points import points_in_time, released_at_points
from petalfoil.analysis.release_on_lines import lines_beside, lines_in_time, released_on_lines
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.case import Case
from petalfoil.dynamics.adaptive_steps import MarchOptions
from petalfoil.dynamics.rotor_motion import RotorMotion, constant_load
from petalfoil.dynamics.speed_schedule import Schedule
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.element_contacts import near_nodes, with_elements
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_sets import with_lines
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import UsageError
from petalfoil.system.build import build_pair, build_problem, on_the_same_wall
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of
from petalfoil.system.heat_network import HeatNetwork
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.point_friction import RubbingEquations
from petalfoil.system.shaft_layout import friction_on_shaft, joined
from petalfoil.system.temperatures import Temperatures
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

Kept = tuple[Temperatures | None, ...]
"""Temperatures that a motion keeps in each bearing; None of one without a heat network."""

LYING = 0.999
"""Part of the way to the wall where a journal is released that lies on it: between nodes it may lie deeper than the
wall by up to the sagitta of a cell."""

TOLERANCE = 1e-3
"""Local error of a step in reference films and ambient pressures."""


@dataclass(frozen=True)
class OrbitRequest:
    """What a motion is asked for.

    Attributes
    ----------
    revolutions : float or None
        Revolutions of the shaft; by default what `duration` or the schedule lasts, else 20.
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
    initial: Vector | Literal["balance"] | None = None
    speeds: tuple[tuple[float, float], ...] | None = None
    load: Vector | None = None
    tolerance: float = TOLERANCE
    longest: float = MarchOptions.longest
    slope: tuple[float, float] = (0.0, 0.0)

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


def temperatures_of(case: Case, request: OrbitRequest) -> Kept:
    """Temperatures that a motion keeps in each bearing: those of the balance where it begins; None without [heat].

    A start from rest has those before it.

    Raises
    ------
    ConvergenceError
        No position balances the load, or there is no steady temperature.
    """
    networks, speed = [HeatNetwork.of(one) for one in case.supports], request.schedule(case).speed(0.0)
    if not any(networks) or speed == 0.0:
        return tuple(None if network is None else network.start for network in networks)
    if not case.shares_evenly:
        rotor, found = on_shaft(case, request)
        return tuple(one.problem.temperatures for one in rotor.in_order(found))
    found, _ = under_load(at(case, speed, (0.0, 0.0)), constant_load(case, request.load))
    return tuple(found.problem.temperatures for _ in networks)


def at_kept(case: Case, warm: Kept) -> tuple[Case, tuple[Case, ...]]:
    """The case with the temperatures of its first bearing, and both bearings by themselves with their own."""
    each = zip(case.supports, warm, strict=True)
    supports = tuple(one if kept is None else at_temperatures(one, kept) for one, kept in each)
    first = warm[0]
    if first is None:
        return case, supports
    alone = {} if case.rotor is None else {"rotor.second": None}  # its tables were for the case as it was
    return at_temperatures(case.replace(**alone), first), supports


def begins_on_path(case: Case, request: OrbitRequest) -> bool:
    """Whether a motion begins with the friction forces of the path to its balance: of a rotor in one bearing."""
    return request.initial == "balance" and case.bearings == 1 and follows_path(case)


def balance_on_path(case: Case, request: OrbitRequest) -> Solution | None:
    """The balance where a motion begins, if it keeps the friction of its path; else None.

    In 3-D it has contacts at nodes, as motions with friction have.

    Raises
    ------
    ConvergenceError
        The path was lost.
    """
    if not begins_on_path(case, request):
        return None
    speed = request.schedule(case).speed(0.0)
    held = case.replace(**{"model.contacts": "nodes"}) if case.has_contact_lines else case
    return under_load(at(held, speed, (0.0, 0.0)), constant_load(case, request.load))[0]


class FirstPosition(NamedTuple):
    """Where a journal is released.

    Attributes
    ----------
    place : (2,) or None
        Its displacement [m]; None where the case says so.
    slope : (2,)
        Slopes of a shaft in two bearings [rad].
    at_points : bool
        Whether it may begin with contact points or lines: not from a balance that has none.
    lines : LineContacts or None
        Contact lines of the balance that it is released near.
    """

    place: Vector | None
    slope: Vector
    at_points: bool = True
    lines: LineContacts | None = None


def first_position(case: Case, request: OrbitRequest, known: Solution | None = None) -> FirstPosition:
    """Where the journal is released.

    A `known` balance that keeps the friction of its path is where it is.

    Raises
    ------
    ConvergenceError
        No position balances the load.
    """
    if request.initial != "balance":
        return FirstPosition(request.initial, request.slope)
    if known is not None:
        x, y = map(float, known.position[:2] * known.problem.layout.scales.length)
        return FirstPosition((x, y), request.slope)
    if not case.shares_evenly:
        return FirstPosition(*on_both(case, request))
    load, speed = constant_load(case, request.load), request.schedule(case).speed(0.0)
    (x, y), at_points, lines = case.operation.eccentricity, True, None
    if np.any(load) or speed > 0.0:  # every place balances a shaft at rest without a load
        found, _ = under_load(at(case, speed, (0.0, 0.0)), load)
        place, at_points, lines = place_of_balance(case, found)
        x, y = map(float, place * found.problem.layout.scales.length)
    if case.rotor is not None and request.schedule(case).speed(0.0) > 0.0:
        x -= case.rotor.unbalance  # a shaft that does not turn feels none
    beyond = np.hypot(x, y) >= case.pack_clearance
    short = LYING * case.pack_clearance / np.hypot(x, y) if beyond else 1.0
    return FirstPosition((float(short * x), float(short * y)), request.slope, at_points, lines)


def place_of_balance(case: Case, found: Solution) -> tuple[Array, bool, LineContacts | None]:
    """Displacement over the reference length at which a motion has the load of a balance, (n_position,) [1].

    It is that of contact points or lines where the balance has them; whether it has, and the lines.
    """
    layout = found.problem.layout
    friction = friction_of(case, layout)
    if lines_in_time(case, layout, friction):
        lines = with_lines(found).lines
        if not isinstance(lines, LineContacts):
            return found.problem.displacement, False, None
        return lines.problem.displacement, True, lines
    if case.bearings > 1 or points_in_time(layout, friction) is None:
        return found.problem.displacement, False, None
    between = with_elements(found)
    at_points = isinstance(between.elements, PointContacts)
    return between.position if at_points else found.problem.displacement, at_points, None


def on_both(case: Case, request: OrbitRequest) -> tuple[Vector, Vector]:
    """Position and slopes at which a rotor rests whose bearings do not share the load evenly.

    Where the shaft turns, its axis is off the mass centre, which rests, by the unbalance.

    Raises
    ------
    ConvergenceError
        No position balances the load.
    """
    rotor, found = on_shaft(case, request)
    x, y, slope_x, slope_y = map(float, rotor.position_at_nodes(found))
    turns = request.schedule(case).speed(0.0) > 0.0
    unbalance = 0.0 if case.rotor is None or not turns else case.rotor.unbalance
    return (x - unbalance, y), (slope_x, slope_y)


def on_shaft(case: Case, request: OrbitRequest) -> tuple[RotorInBearings, Solution]:
    """A rotor whose bearings do not share the load evenly, and its balance where the motion begins."""
    weighs = request.load is None and case.operation.load is None  # a weight acts at the mass centre
    held = case.replace(**{"rotor.load_place": None}) if weighs else case
    rotor = RotorInBearings.of(held, constant_load(case, request.load))
    return rotor, rotor.at(request.schedule(case).speed(0.0))


def system_of(case: Case, supports: tuple[Case, ...], schedule: Schedule, load: Vector | None) -> RotorBearing:
    """The bearings of a case, `supports` by themselves, and its rotor in the units of the problem."""
    if case.operation.moment is not None and case.bearings == 1:
        raise UsageError(
            "a rotor in one bearing stays parallel to its axis and feels no operation.moment: give the slopes that it "
            "is held at, operation.tilt, or a rotor.span"
        )
    if case.bearings > 1:
        pair = build_pair(case, supports)
        rotor = RotorMotion.of(case, pair.layout.scales, schedule, load)
        still = replace(pair, bearing_number=0.0, time_number=rotor.clock.bearing_number)
        return RotorBearing(still, rotor, friction_on_shaft(pair.layout))
    problem = build_problem(case)
    rotor = RotorMotion.of(case, problem.layout.scales, schedule, load)
    alone = StepProblem(problem.layout, 0.0, problem.displacement, rotor.clock.bearing_number)
    friction = friction_of(case, problem.layout)
    points = points_in_time(problem.layout, friction)
    return RotorBearing(alone, rotor, friction, points, lines=lines_in_time(case, problem.layout, friction))


def at_rest(case: Case, system: RotorBearing, request: OrbitRequest, first: FirstPosition) -> Instant:
    """The journal held where it is, film and petals in equilibrium, and released at time zero.

    With contact points or lines where it may begin with them: the place of a balance at nodes is none of points.

    From a balance its mass centre rests, and the shaft turns about that: a start without a blow.
    """
    rotor, scales = case.rotor, system.problem.layout.scales
    speed, place = system.rotor.schedule.speed(0.0), system.problem.displacement
    turning = np.zeros_like(place)
    if rotor is not None and request.initial == "balance":  # the axis is off the mass centre by the unbalance
        turning[1] = -rotor.unbalance / scales.length * speed / system.rotor.clock.rate
    if not isinstance(system.problem, ShaftStep):
        return one_at_rest(at(case, speed), system, first, (place, turning))
    if rotor is not None:
        place = place + rotor.lever / scales.length * np.array([0.0, 0.0, *request.slope])
    state = held_on_shaft(system.problem.at(bearing_number=system.rotor.bearing_number(0.0), displacement=place))
    return released(system, 0.0, state, (place, turning))


def one_at_rest(case: Case, system: RotorBearing, first: FirstPosition, moving: tuple[Array, Array]) -> Instant:
    """The same of a rotor in one bearing, `case` at the speed of the start; `moving` are position and velocity."""
    if isinstance(system.problem, ShaftStep):
        raise TypeError("this rotor is in two bearings")
    problem = on_the_same_wall(system.problem, case)
    lines = None if first.lines is None else lines_beside(first.lines, problem)
    if lines is not None:
        return released_on_lines(system, 0.0, lines, moving)
    answer = at_position(case, problem).answer
    if system.points is not None and first.at_points:
        found = near_nodes(answer)
        if isinstance(found, PointContacts):
            return released_at_points(system, 0.0, found.equations.state, moving)
    if system.lines and first.at_points:
        near = with_lines(answer).lines
        if isinstance(near, LineContacts):
            return released_on_lines(system, 0.0, near, moving)
    return released(system, 0.0, (answer.x, answer.lam, answer.active), moving)


def held_on_shaft(problem: ShaftStep) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Unknowns, reactions and active contacts of both bearings under a shaft that is held where it is."""
    parts = [CoupledProblem(part.layout, part.bearing_number, part.displacement) for part in problem.parts]
    found, layout = [solve_cold(parts[0])], problem.layout
    same = parts[0].layout is parts[1].layout and np.array_equal(parts[0].displacement, parts[1].displacement)
    found.append(found[0] if same else solve_cold(parts[1]))
    lam, active = [one.lam for one in found], [one.active for one in found]
    x = joined(layout.numbers, [one.x for one in found])
    return x, joined(layout.gap_numbers, lam), joined(layout.gap_numbers, active)


def at_rest_on_path(system: RotorBearing, known: Solution) -> Instant:
    """The journal released at rest where it balances, with the friction forces that the path there has left."""
    place, found = system.problem.displacement, known.elements
    still = place, np.zeros_like(place)
    if system.points is not None and found is not None and isinstance(found.equations, RubbingEquations):
        return released_at_points(system, 0.0, found.equations.state, still, found.equations.friction_force)
    start = released(system, 0.0, (known.x, known.lam, known.active), still)
    return start if known.friction is None else replace(start, friction=known.friction.state)
