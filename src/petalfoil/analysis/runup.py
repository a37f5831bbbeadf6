"""Run-up and coast-down under a load: torque, contact, film and position over speed (the paper's Figures 10 and 11)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from petalfoil.analysis.balance import balance_record, given_load, loaded
from petalfoil.analysis.equilibrium import Named
from petalfoil.analysis.figures import effort, failed_record
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.walls import Capability, required

POINTS = 25
"""Speeds of a run-up, rest included."""


def iterate(
    case: Case,
    load: tuple[float, float] | None,
    top: float,
    *,
    points: int = POINTS,
    progress: Progress | None = None,
) -> Iterator[tuple[str, Record]]:
    """Yield ("up", record) from rest to `top` [rad/s], then ("down", record) back, each followed from the one before.

    The load [N] is by default the case's.

    Raises
    ------
    UsageError
        A wall that has no pack at zero speed, no load, or the top speed or the number of points is out of range.
    """
    required(case, Capability.PACK, "a run-up")
    if not top > 0.0:
        raise UsageError("the top speed of a run-up must be above zero")
    if points < 3:
        raise UsageError("a run-up needs at least 3 points")
    speeds = top * np.linspace(0.0, 1.0, points) ** 2  # close together where contacts give way to the film
    way = [("up", float(v)) for v in speeds] + [("down", float(v)) for v in speeds[-2::-1]]
    return _records(case, loaded(case, load), way, progress)


def _records(
    case: Case, load: tuple[float, float], way: list[tuple[str, float]], progress: Progress | None
) -> Iterator[tuple[str, Record]]:
    line: SpeedLine | None = None
    for number, (leg, speed) in enumerate(way):
        clock, work = Clock(), telling_work(part(progress, number, len(way)), f"runup {leg}")
        here = case.replace(**{"operation.speed": speed, "operation.eccentricity": (0.0, 0.0)})
        line = line or SpeedLine(here, load, work)
        line.work = work
        try:
            with one_thread():
                found = line.at(speed)
        except ConvergenceError as failure:
            line.known = None
            lost: Named = {**given_load(load), "leg": leg}
            yield leg, failed_record("runup", here, f"not converged: {failure}", work, lost)
            continue
        extra: Named = {**given_load(load), "leg": leg, **effort(work), "solution_path": found.answer.way}
        extra["wall_time"] = clock.seconds
        yield leg, balance_record("runup", here, found, extra, work)
