"""Whirl of a rigid rotor on the bearing: smallest mass that whirls, whirl ratio, threshold speed."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from petalfoil.analysis.balance import given_load, loaded
from petalfoil.analysis.coefficients import operating_point
from petalfoil.analysis.equilibrium import Named, positioned
from petalfoil.analysis.figures import effort, forces, given
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.analysis.whirl import Whirl, neutral_whirl
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.work import Work
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record

GRAVITY = 9.80665
"""Standard gravity [m/s^2]: a load without a mass is taken for a weight."""

RANGE, FACTOR = 16.0, 1.3
"""Speeds between which the threshold is looked for, over the case's, and the factor between looks."""

PRECISION = 1e-3
"""Relative precision of the threshold speed."""


def run(
    case: Case,
    *,
    load: tuple[float, float] | None = None,
    mass: float | None = None,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Smallest mass that whirls at the operating point, and the speed at which `mass` [kg] begins to.

    Without a mass the load over gravity stands for it; without a load there is no threshold speed (nan).

    Raises
    ------
    UsageError
        A shaft at rest, or a mass that is not positive.
    ConvergenceError
        The operating point was not found.
    """
    clock, work = Clock(), telling_work(progress, "stability")
    case = positioned(case, speed, None)
    if not case.operation.speed > 0.0:
        raise UsageError("stability needs a turning shaft: give a speed above zero")
    if mass is not None and not mass > 0.0:
        raise UsageError("the mass of the rotor must be positive")
    with one_thread():
        answer, about = operating_point(case, load, work)
        whirl = neutral_whirl(answer, case.operation.speed, work)
        rotor = rotor_mass(case, load, mass)
        threshold = math.nan if math.isnan(rotor) else threshold_speed(case, load, (rotor, whirl), work)
    return record(case, answer, whirl, {**about, "rotor_mass": rotor, "threshold_speed": threshold}, (work, clock))


def rotor_mass(case: Case, load: tuple[float, float] | None, mass: float | None) -> float:
    """The mass on this bearing [kg]; nan where nothing tells it."""
    if mass is not None:
        return mass
    if load is None and case.operation.load is None:
        return math.nan
    return float(np.hypot(*loaded(case, load))) / GRAVITY


def margin(case: Case, load: tuple[float, float] | None, mass: float, work: Work) -> float:
    """Logarithm of the smallest whirling mass over `mass`: positive where the rotor is stable."""
    answer, _ = operating_point(case, load, work)
    whirl = neutral_whirl(answer, case.operation.speed, work)
    return math.log(whirl.mass / mass) if math.isfinite(whirl.mass) else NEVER


NEVER = 50.0
"""Margin of a bearing on which no mass whirls."""


def threshold_speed(case: Case, load: tuple[float, float] | None, start: tuple[float, Whirl], work: Work) -> float:
    """Speed at which the mass begins to whirl [rad/s]; nan where none within the range does.

    Upward from a stable bearing, downward from an unstable one. A speed without an equilibrium ends the search.
    """
    mass, whirl = start
    omega = case.operation.speed
    here = math.log(whirl.mass / mass) if math.isfinite(whirl.mass) else NEVER
    factor = FACTOR if here > 0.0 else 1.0 / FACTOR

    def at(speed: float) -> float:
        return margin(case.replace(**{"operation.speed": speed}), load, mass, work)

    known = omega
    while 1.0 / RANGE < known * factor / omega < RANGE:
        ahead = known * factor
        try:
            there = at(ahead)
        except ConvergenceError as failure:
            work.note("threshold", outcome=str(failure))
            return math.nan
        if (there > 0.0) != (here > 0.0):
            return float(brentq(at, min(known, ahead), max(known, ahead), rtol=PRECISION))
        known, here = ahead, there
    return math.nan


def record(case: Case, answer: Answer, whirl: Whirl, extra: Named, run_of: tuple[Work, Clock]) -> Record:
    """The record of a stability analysis."""
    work, clock = run_of
    e = answer.problem.displacement * answer.problem.layout.scales.length
    own: Named = {
        "critical_mass": whirl.mass,
        "whirl_ratio": whirl.ratio,
        "eccentricity_x": float(e[0]),
        "eccentricity_y": float(e[1]),
        "contact_share": forces(case, answer)["contact_share"],
        "residual": answer.residual,
        "converged": True,
        "status": "converged",
        "wall_time": clock.seconds,
    }
    scalars: Named = {**given(case), **extra, **effort(work), **own}
    if case.operation.load is not None and "load_x" not in scalars:
        scalars.update(given_load(case.operation.load))
    return Record(
        analysis="stability", scalars=scalars, case_toml=case.to_toml(), title=case.title, history=list(work.history)
    )
