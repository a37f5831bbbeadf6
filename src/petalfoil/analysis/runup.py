"""`runup`: torque, contact, film and position over speed under a load (the paper's Figures 10 and 11)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated

import numpy as np

from petalfoil.analysis.arguments import Load, NumberWithUnit, Whole
from petalfoil.analysis.balance import balance_record
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.heat_results import network_in_time, stored_temperatures
from petalfoil.analysis.operating_point import applied_load, at
from petalfoil.analysis.records import effort, failed_record
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case, warnings_of
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.layout import Series, at_speed
from petalfoil.results.parts import AppliedLoad, Branch, Leg
from petalfoil.results.record import Record
from petalfoil.walls import Capability, required

Top = Annotated[
    float, NumberWithUnit(unit="rad/s", help='Speed to run up to, and back from: "30000 rpm".', option="to", above=0.0)
]
PointCount = Annotated[int, Whole(metavar="COUNT", help="Speeds on the way up, rest included.", at_least=3)]

WarmUp = Annotated[
    float | None,
    NumberWithUnit(
        unit="s",
        metavar="TIME",
        help='Time from rest to the speed, and back: "20 s"; temperatures begin cold and follow by heat capacities.',
        above=0.0,
    ),
]
SpeedsInTime = tuple[list[tuple[str, float]], float | None]
"""Legs and speeds [rad/s], and in a warm-up the acceleration [rad/s^2]."""

FIRST_STEP = 1e-6
"""Time step of the first point of a warm-up, which is cold [s]."""

COLUMNS = {
    "leg": "leg",
    "speed": "speed",
    "eccentricity_x": "e_x",
    "eccentricity_y": "e_y",
    "contact_fraction": "contact\nfraction",
    "min_film_thickness": "min. film",
    "peak_pressure": "peak\npressure",
    "friction_torque": "torque",
    "shaft_temperature": "shaft\ntemp.",
    "pack_temperature": "pack\ntemp.",
    "shaft_growth": "shaft\ngrowth",
}


@analysis(Series(columns=COLUMNS, legs=("up", "down"), at=at_speed), error_bars=True)
def runup(
    case: Case,
    load: Load = None,
    *,
    to: Top,
    points: PointCount = 25,
    warm_up: WarmUp = None,
    progress: Progress | None = None,
) -> Points:
    """Follow torque, contact, film and position from rest to a speed, and back.

    Each point is followed from the one before. With --out the file is
    rewritten as points finish; Ctrl-C keeps what is finished, and --resume
    goes on from it. With friction between petals that slide along themselves
    the pack is assembled, loaded at rest and run up, and each point keeps
    the friction forces of that path; with surface.friction_history =
    "relaxed" none does. With a heat network (table heat) every point is at
    its steady temperature; with --warm-up the bearing starts cold.

    Example: petalfoil runup case.toml --load "46.4 N" --to "30000 rpm"

    Raises
    ------
    UsageError
        The wall does not rest on the journal at zero speed, or there is no load.
    """
    required(case, Capability.LIFT_OFF, "a run-up")
    speeds = to * np.linspace(0.0, 1.0, points) ** 2  # close together where the film takes over from contact
    way = [("up", float(v)) for v in speeds] + [("down", float(v)) for v in speeds[-2::-1]]
    if warm_up is not None:
        network_in_time(case)
    rate = None if warm_up is None else to / warm_up
    return Points(partial(_points, case, applied_load(case, load), (way, rate), progress), len(way))


def _points(
    case: Case,
    load: tuple[float, float],
    in_time: SpeedsInTime,
    progress: Progress | None,
    done: Sequence[Record] = (),
) -> Iterator[Record]:
    way, rate = in_time
    line, before = SpeedLine(at(case, way[0][1], (0.0, 0.0)), load, from_rest=rate is None), 0.0
    if done:
        if rate is not None and line.rotor is not None:
            raise UsageError("a warm-up of a rotor on unequal bearings does not go on: run it again from the start")
        line.regain([speed for _, speed in way[: len(done)]], done[-1])
        line.temperatures, before = stored_temperatures(done[-1]), way[len(done) - 1][1]
    for number, (leg, speed) in enumerate(way[len(done) :], len(done)):
        here = at(case, speed, (0.0, 0.0))
        asked = (AppliedLoad.of(load, case.operation.moment), Leg(leg))
        with running(part(progress, number, len(way)), f"runup {leg}") as run:
            try:
                found = line.at(speed, None if rate is None else max(abs(speed - before) / rate, FIRST_STEP))
                own = (*asked, Branch(solution_path=found.solution_path), effort(run.seconds))
                record = balance_record("runup", here, found, *own)
            except ConvergenceError as failure:
                line.known = None
                record = failed_record("runup", here, failure, *asked)
        before = speed
        # Contact on the way up is what a run-up is about; at the case's own speed it is told.
        yield replace(record, warnings=tuple(warnings_of(case, record.scalars)))
