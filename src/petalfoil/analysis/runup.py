"""`runup`: torque, contact, film and position over speed under a load (the paper's Figures 10 and 11)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from petalfoil.analysis.arguments import Load, Quantity, Whole
from petalfoil.analysis.balance import balance_record
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.operating_point import applied_load, at
from petalfoil.analysis.records import effort, failed_record
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case, warnings_of
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError
from petalfoil.results.layout import Series, at_speed
from petalfoil.results.parts import AppliedLoad, Branch
from petalfoil.results.record import Record
from petalfoil.walls import Capability, required

Top = Annotated[
    float, Quantity(unit="rad/s", help='Speed to run up to, and back from: "30000 rpm".', option="to", above=0.0)
]
Count = Annotated[int, Whole(metavar="COUNT", help="Speeds on the way up, rest included.", at_least=3)]

COLUMNS = {
    "leg": "leg",
    "speed": "speed",
    "eccentricity_x": "e_x",
    "eccentricity_y": "e_y",
    "contact_fraction": "contact\nfraction",
    "min_film_thickness": "min. film",
    "peak_pressure": "peak\npressure",
    "friction_torque": "torque",
}


@dataclass(frozen=True)
class Leg:
    """Part of the way: up or down."""

    leg: str


@analysis(Series(columns=COLUMNS, legs=("up", "down"), at=at_speed))
def runup(case: Case, load: Load = None, *, to: Top, points: Count = 25, progress: Progress | None = None) -> Points:
    """Follow torque, contact, film and position from rest to a speed, and back.

    Each point is followed from the one before. With --out the file is
    rewritten as points finish; Ctrl-C keeps what is finished, and --resume
    goes on from it.

    Example: petalfoil runup case.toml --load "46.4 N" --to "30000 rpm"

    Raises
    ------
    UsageError
        The wall does not rest on the journal at zero speed, or there is no load.
    """
    required(case, Capability.LIFT_OFF, "a run-up")
    speeds = to * np.linspace(0.0, 1.0, points) ** 2  # close together where the film takes over from contact
    way = [("up", float(v)) for v in speeds] + [("down", float(v)) for v in speeds[-2::-1]]
    return Points(partial(_points, case, applied_load(case, load), way, progress), len(way))


def _points(
    case: Case,
    load: tuple[float, float],
    way: list[tuple[str, float]],
    progress: Progress | None,
    done: Sequence[Record] = (),
) -> Iterator[Record]:
    line = SpeedLine(at(case, way[0][1], (0.0, 0.0)), load)
    if done:
        line.regain([speed for _, speed in way[: len(done)]], done[-1])
    for number, (leg, speed) in enumerate(way[len(done) :], len(done)):
        here = at(case, speed, (0.0, 0.0))
        asked = (AppliedLoad.of(load, case.operation.moment), Leg(leg))
        with running(part(progress, number, len(way)), f"runup {leg}") as run:
            try:
                found = line.at(speed)
                own = (*asked, Branch(solution_path=found.solution_path), effort(run.seconds))
                record = balance_record("runup", here, found, *own)
            except ConvergenceError as failure:
                line.known = None
                record = failed_record("runup", here, failure, *asked)
        # Contact on the way up is what a run-up is about; at the case's own speed it is told.
        yield replace(record, warnings=tuple(warnings_of(case, record.scalars)))
