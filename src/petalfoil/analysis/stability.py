"""Whirl of a rigid rotor on the bearing: smallest mass that whirls, threshold speed, damped natural frequencies."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from petalfoil.analysis.balance import given_load, loaded
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.coefficients import Load, at_position, elastic, operating_point
from petalfoil.analysis.equilibrium import Named, about, positioned
from petalfoil.analysis.figures import effort, failed_record, given
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.dynamics.critical_mass import Whirl, neutral_whirl, scan
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.dynamics.natural_modes import Mode, natural_modes
from petalfoil.dynamics.rotor import GRAVITY
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Array, Record

RANGE, FACTOR = 16.0, 1.3
"""Speeds between which the threshold is looked for, over the case's, and the factor between looks."""

PRECISION = 1e-3
"""Relative precision of the threshold speed."""

Threshold = tuple[float, str]
"""Threshold speed [rad/s], nan where there is none, and how the search ended."""


def run(
    case: Case,
    *,
    load: Load | None = None,
    mass: float | None = None,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Smallest mass that whirls at the operating point, the speed at which `mass` [kg] begins to, and its modes.

    Without `mass` that of the case's rotor is taken, without one the load over gravity; without a load there are no
    threshold speed (nan) and no modes.

    Raises
    ------
    UsageError
        A shaft at rest, or a mass that is not positive.
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    clock, work = Clock(), telling_work(progress, "stability")
    case = turning(positioned(case, speed, None))
    if mass is not None and not mass > 0.0:
        raise UsageError("the mass of the rotor must be positive")
    with one_thread():
        answer, known = operating_point(case, load, work)
        motion = elastic(case, answer, work)
        scanned = scan(motion, work)
        whirl = neutral_whirl(motion, case.operation.speed, work, scanned)
        rotor = rotor_mass(case, load, mass)
        inertia = rotor * case.operation.speed**2
        modes = None if math.isnan(rotor) else natural_modes(motion, inertia, scanned, work)
        threshold, ended = threshold_speed(case, load, (rotor, whirl), work)
    own: Named = {**known, "rotor_mass": rotor, "threshold_speed": threshold}
    whole = record(case, answer, whirl, own, (work, clock, ended))
    return whole if modes is None else with_modes(whole, modes, case.operation.speed)


def with_modes(record: Record, modes: list[Mode], speed: float) -> Record:
    """The record with fields that tell the modes."""
    fields = {
        "natural_frequency": [mode.s.imag * speed for mode in modes],
        "mode_growth_rate": [mode.s.real * speed for mode in modes],
        "damping_ratio": [mode.damping_ratio for mode in modes],
        "participation": [mode.participation for mode in modes],
        "whirl_direction": [mode.direction for mode in modes],
    }
    arrays: dict[str, Array] = {name: np.array(values, dtype=float) for name, values in fields.items()}
    return replace(record, fields=arrays, coords={"mode": np.arange(1, len(modes) + 1)})


def iterate(
    case: Case,
    speeds: Sequence[float] | None = None,
    loads: Sequence[float] | None = None,
    *,
    load: Load | None = None,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield the smallest mass that whirls for each load at each speed, load by load, speeds in order.

    Parameters
    ----------
    case : Case
        The bearing.
    speeds : sequence of float, optional
        Speeds instead of the case's [rad/s].
    loads : sequence of float, optional
        Loads along -y [N], instead of the one load.
    load : (x, y), optional
        The one load instead of the case's [N].
    progress : callable, optional
        Told how far it has come.

    Raises
    ------
    UsageError
        A speed is not positive, or there is no load, or one that is not positive.
    """
    if loads is not None and any(not size > 0.0 for size in loads):
        raise UsageError("loads must be positive; they act along -y")
    wanted = [loaded(case, load)] if loads is None else [(0.0, -size) for size in loads]
    turn = [case.operation.speed] if speeds is None else speeds
    return _records([turning(positioned(case, speed, (0.0, 0.0))) for speed in turn], wanted, progress)


def _records(cases: list[Case], loads: list[Load], progress: Progress | None) -> Iterator[Record]:
    for row, load in enumerate(loads):
        line: SpeedLine | None = None
        for column, case in enumerate(cases):
            here = part(progress, row * len(cases) + column, len(loads) * len(cases))
            clock, work = Clock(), telling_work(here, "stability")
            line = line or SpeedLine(case, load, work)
            line.work = work
            try:
                with one_thread():
                    answer = line.at(case.operation.speed).answer
                    whirl = neutral_whirl(elastic(case, answer, work), case.operation.speed, work)
                    known = about(leading_eigenvalue(answer, work), case, (1, answer.way))
            except ConvergenceError as failure:
                line.known = None
                yield failed_record("stability", case, f"not converged: {failure}", work, given_load(load))
                continue
            yield record(case, answer, whirl, {**known, **given_load(load)}, (work, clock, ""))


def turning(case: Case) -> Case:
    """The case, if its shaft turns."""
    newton_only(case)
    if not case.operation.speed > 0.0:
        raise UsageError("stability needs a turning shaft: give a speed above zero")
    return case


def rotor_mass(case: Case, load: Load | None, mass: float | None) -> float:
    """The mass on this bearing [kg]: as asked, else the case's, else the load's; nan where nothing tells it."""
    if mass is not None:
        return mass
    if case.rotor is not None:
        return case.rotor.mass_on_bearing
    if load is None and case.operation.load is None:
        return math.nan
    return float(np.hypot(*loaded(case, load))) / GRAVITY  # a load without a mass is taken for a weight


def margin(whirl: Whirl, mass: float) -> float:
    """Logarithm of the smallest whirling mass over `mass`: positive where the rotor is stable."""
    return math.log(whirl.mass / mass) if math.isfinite(whirl.mass) else NEVER


NEVER = 50.0
"""Margin of a bearing on which no mass whirls."""


def threshold_speed(case: Case, load: Load | None, start: tuple[float, Whirl], work: RunLog) -> Threshold:
    """Speed at which the mass begins to whirl, within the range.

    Upward from a stable bearing, downward from an unstable one. A speed without an equilibrium ends the search.
    """
    mass, whirl = start
    if math.isnan(mass):
        return math.nan, "no threshold speed: give a mass or a load"
    margin_at = margins(case, load, mass, work)
    known, here = case.operation.speed, margin(whirl, mass)
    factor = FACTOR if here > 0.0 else 1.0 / FACTOR
    first, last = sorted((known, known * RANGE if here > 0.0 else known / RANGE))
    try:
        while first <= known * factor <= last:
            ahead = known * factor
            there = margin_at(ahead)
            if (there > 0.0) != (here > 0.0):
                return float(brentq(margin_at, min(known, ahead), max(known, ahead), rtol=PRECISION)), ""
            known, here = ahead, there
    except ConvergenceError as failure:
        work.note("threshold", outcome=str(failure))
        return math.nan, f"no threshold speed: no operating point beyond {in_rpm(known)}"
    if here > 0.0:
        return math.nan, f"no threshold speed: the rotor is stable up to {in_rpm(known)}"
    return math.nan, f"no threshold speed: the rotor whirls down to {in_rpm(known)}"


def margins(case: Case, load: Load | None, mass: float, work: RunLog) -> Callable[[float], float]:
    """The margin over speed [rad/s], under the load or at the case's position."""
    if load is None and case.operation.load is None:

        def in_place(speed: float) -> float:
            answer, _ = operating_point(positioned(case, speed, None), None, work)
            return margin(neutral_whirl(elastic(case, answer, work), speed, work), mass)

        return in_place
    line = SpeedLine(case, loaded(case, load), work)

    def under_load(speed: float) -> float:
        answer = line.at(speed).answer
        return margin(neutral_whirl(elastic(case, answer, work), speed, work), mass)

    return under_load


def in_rpm(speed: float) -> str:
    """A speed as people read it."""
    return f"{speed * 30.0 / math.pi:.0f} rpm"


def record(case: Case, answer: Solution, whirl: Whirl, extra: Named, ran: tuple[RunLog, Clock, str]) -> Record:
    """The record of a stability analysis; what it has no number for is told by its status."""
    work, clock, ended = ran
    remarks = ["converged", "" if math.isfinite(whirl.mass) else "no mass whirls", ended]
    own: Named = {
        **at_position(case, answer),
        "critical_mass": whirl.mass,
        "whirl_ratio": whirl.ratio,
        "status": "; ".join(filter(None, remarks)),
        "wall_time": clock.seconds,
    }
    scalars: Named = {**given(case), **extra, **effort(work), **own}
    return Record(
        analysis="stability", scalars=scalars, case_toml=case.to_toml(), title=case.title, history=list(work.history)
    )
