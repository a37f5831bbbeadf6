"""`liftoff`: the speed above which the journal no longer touches, for a given load (model, question 4).

The journal has lifted off where the contact fraction is below a limit (J3). The lift-off speed is that crossing met
upward, from a speed at which it touches; the touchdown speed is the crossing met downward, from one at which it has
lifted off. Where equilibria are not unique the two need not be the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

from petalfoil.analysis.arguments import NumbersWithUnit, NumberWithUnit
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.crossings import (
    CONTACT_FRACTION,
    PRECISION,
    SLOWEST,
    LiftoffSpeeds,
    crossings,
    fastest,
    sensitivity,
)
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.friction_told import FrictionTold
from petalfoil.analysis.operating_point import at, beyond_capacity
from petalfoil.analysis.records import effort, geometry, record_of
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.layout import ColumnarSeries, load_of, of_load
from petalfoil.results.parts import AppliedLoad, RunOutcome
from petalfoil.results.record import Record
from petalfoil.results.summary import TableRow
from petalfoil.system.build import build_problem
from petalfoil.walls import Capability, required

LoadList = Annotated[
    Sequence[float] | None,
    NumbersWithUnit(
        unit="N",
        option="load",
        also="loads",
        metavar="LOADS",
        help='Loads along -y: "46.4 N, 55.6 N", or "10 N : 100 N : 10"; by default the case\'s.',
        above=0.0,
    ),
]
Limit = Annotated[
    float,
    NumberWithUnit(
        unit="1",
        metavar="FRACTION",
        help="Contact fraction below which the journal has lifted off.",
        above=0.0,
        below=1.0,
    ),
]

SPEEDS = ("liftoff_speed", "touchdown_speed", "liftoff_by_contact_film_thickness", "liftoff_by_contact_fraction")
TABLE = {
    "load_y": "load y",
    "liftoff_speed": "lift-off",
    "touchdown_speed": "touchdown",
    "liftoff_by_contact_film_thickness": "d ln lift-off\n/ d ln contact film",
    "liftoff_by_contact_fraction": "d ln lift-off\n/ d ln limit",
}


@dataclass(frozen=True)
class FractionLimit:
    """Contact fraction below which the journal has lifted off."""

    contact_fraction_limit: float


def equal_speeds(records: Sequence[Record]) -> Iterator[TableRow]:
    """Of which loads lift-off and touchdown are one speed, and why; nothing where none are."""
    places = [str(place) for place, record in enumerate(records, start=1) if is_one_speed(record)]
    if places:
        of = f" (points {', '.join(places)})" if len(places) < len(records) else ""
        yield TableRow("touchdown", f"at the speed of lift-off: downward the same equilibria are met as upward{of}", "")


def is_one_speed(record: Record) -> bool:
    """Whether a journal lifts off and touches down at one speed, as closely as speeds are bracketed."""
    up, down = (float(record.scalars.get(name, math.nan)) for name in SPEEDS[:2])
    return 0.0 < down < math.inf and abs(up - down) <= PRECISION * down


LAYOUT = ColumnarSeries(
    columns=TABLE,
    heads={"loads": load_of},
    names=(*SPEEDS, "contact_fraction_limit", "friction_path", "converged", "status", "factorizations", "wall_time"),
    at=of_load,
    told=equal_speeds,
)


@analysis(LAYOUT, error_bars=True)
def liftoff(
    case: Case,
    loads: LoadList = None,
    *,
    contact_fraction: Limit = CONTACT_FRACTION,
    progress: Progress | None = None,
) -> Points:
    """Find the speeds of lift-off and touchdown for each load along -y.

    The journal has lifted off where the contact fraction is below the limit.
    Each speed is bracketed to 0.1 % and interpolated there. "d ln lift-off /
    d ln limit" and "... contact film" tell how it changes with the limit and
    with the contact film thickness: 0.5 is 0.5 % of speed for 1 % of these.
    Lift-off and touchdown are one speed where upward and downward the same
    equilibria are met: without friction between petals, or on a relaxed
    pack, mostly so. With surface.friction_history = "assembled" the pack is
    assembled, loaded at rest and run up to the case's speed, at least to 1.6
    times the lift-off speed, and down again.

    Example: petalfoil liftoff case.toml --load "46.4 N, 55.6 N" --plot liftoff.png

    Raises
    ------
    UsageError
        The wall does not rest on the journal at zero speed; or neither loads nor a case's load along -y are given.
    """
    newton_only(case)
    required(case, Capability.LIFT_OFF, "lift-off")
    asked = [own_load(case)] if loads is None else list(loads)
    return Points(partial(_points, case, asked, contact_fraction, progress), len(asked))


def own_load(case: Case) -> float:
    """The case's load along -y [N].

    Raises
    ------
    UsageError
        It has none, or one that acts along another line.
    """
    if case.operation.load is None:
        raise UsageError("no load to lift off under: give loads, or set operation.load in the case")
    x, y = case.operation.load
    if x != 0.0 or not y < 0.0:
        raise UsageError(
            f"operation.load ({x:g} N, {y:g} N) does not act along -y, as loads of a lift-off do: give loads, or turn "
            "the bearing"
        )
    return -y


def _points(
    case: Case, loads: list[float], limit: float, progress: Progress | None, done: Sequence[Record] = ()
) -> Iterator[Record]:
    for number, load in enumerate(loads[len(done) :], len(done)):
        with running(part(progress, number, len(loads)), f"liftoff {load:g} N") as run:
            try:
                line = SpeedLine(case, (0.0, -load))
                up, down = crossings(line, limit)
                found: tuple[object, ...] = (LiftoffSpeeds(up, down, *sensitivity(line, limit, up)),)
                ended = RunOutcome(status=in_words(case, up, down))
            except ConvergenceError as failure:
                found, ended = (), RunOutcome(converged=False, status=f"not converged: {why_none(case, load, failure)}")
            told = FractionLimit(limit), FrictionTold.under_load(case)
            asked = (*geometry(case), AppliedLoad.of((0.0, -load)), *told)
            record = record_of("liftoff", case, *asked, *found, effort(run.seconds), ended)
        yield record


def why_none(case: Case, load: float, failure: ConvergenceError) -> ConvergenceError:
    """The error of a load [N] whose crossings were not found: that it is beyond the capacity, where it is."""
    if not case.shares_evenly:
        return failure
    return beyond_capacity(build_problem(at(case, None, (0.0, 0.0))), (0.0, -load), failure)


def in_words(case: Case, up: float, down: float) -> str:
    """How the search for both speeds [rad/s] ended."""
    if math.isinf(up):
        return f"does not lift off below {fastest(case) * 30.0 / math.pi:.0f} rpm"
    if not up > 0.0:
        return "lifted off at any speed"
    return "converged" if down > 0.0 else f"does not touch down above {SLOWEST * 30.0 / math.pi:.0f} rpm"
