"""`capacity`: the largest load carried within stated limits, over speed and over its direction to the petals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from petalfoil.analysis.arguments import NumberWithUnit, Speed, Speeds, Whole
from petalfoil.analysis.balance import carrier
from petalfoil.analysis.capacity_search import CapacityRequest, CapacitySearch
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.crossings import CONTACT_FRACTION
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.fields import all_fields
from petalfoil.analysis.friction_told import refuse_path
from petalfoil.analysis.heat_results import heat_results
from petalfoil.analysis.load_limit import NONE_KEPT, Capacity
from petalfoil.analysis.load_ray import Limits
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.other_bearing import rotor_parts
from petalfoil.analysis.records import asked_position, effort, geometry, position, record_of
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress, current_run, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.layout import ArrayTable, Cell, Series, SinglePoint, at_speed
from petalfoil.results.parts import Branch, RunOutcome
from petalfoil.results.record import Array, Record
from petalfoil.results.summary import ABSENT, barred
from petalfoil.results.variable import DataType, Role, TableLabel, Variable
from petalfoil.units.writing import format_percent
from petalfoil.walls import wall_kind

DOWN = -math.pi / 2.0
"""Direction of a weight, along -y [rad]."""
FOLLOWED_ON = "followed from the capacity at the speed or in the direction before, on its branch"
"""Solution path of a load to which the branch of the capacity before leads."""
SOUGHT_ANEW = "sought anew: not followed from the speed before, where the load or its contacts jump"
"""Solution path of a load that no path of equilibria joins to that of the speed before."""
LBF, INCH, KRPM = 4.4482216152605, 0.0254, 1e3 * math.pi / 30.0
"""Pound-force [N], inch [m] and a thousand revolutions per minute [rad/s]."""

MinFilm = Annotated[
    float | None,
    NumberWithUnit(
        unit="m",
        option="min-film",
        help='Minimum film thickness to keep: "5 um"; above the contact film thickness.',
        above=0.0,
    ),
]
Fraction = Annotated[
    float | None,
    NumberWithUnit(unit="1", metavar="FRACTION", help="Contact fraction that is allowed.", above=0.0, below=1.0),
]
Stress = Annotated[
    float | None,
    NumberWithUnit(unit="Pa", help='Maximum bending stress of the petals that is allowed: "800 MPa".', above=0.0),
]
LoadDirection = Annotated[
    float, NumberWithUnit(unit="rad", metavar="ANGLE", help="Direction of the load, from x toward y.")
]
Orientations = Annotated[
    int,
    Whole(metavar="COUNT", help="Directions of the load over one pitch, from --direction on.", at_least=1),
]

RESULTS = {
    "load_capacity": Variable((), "N", "largest load within the limits", "W_c", shown=TableLabel("load capacity", "N")),
    "load_direction": Variable(
        (), "rad", "direction of the load, from x toward y", "psi", role=Role.GIVEN,
        shown=TableLabel("load direction", "deg", 180.0 / math.pi),
    ),
    "load_coefficient": Variable(
        (), "N s m-3", "load capacity over L D^2 omega", "C_W", shown=TableLabel("load coefficient", "N s/m³")
    ),
    "load_coefficient_imperial": Variable(
        (), "lbf in-3 krpm-1", "load capacity over L D^2 omega, in the unit of the literature", "D_W",
        shown=TableLabel("load coefficient", "lbf/(in³ krpm)"),
    ),
    "limited_by": Variable(
        (), "", "result that reaches its limit at the load capacity", "q_lim", DataType.STR,
        shown=TableLabel("limited by"),
    ),
    "min_film_limit": Variable((), "m", "least minimum film thickness allowed", "h_lim", role=Role.GIVEN),
    "contact_fraction_allowed": Variable((), "1", "largest contact fraction allowed", "s_lim", role=Role.GIVEN),
    "stress_limit": Variable((), "Pa", "largest maximum bending stress allowed", "sigma_lim", role=Role.GIVEN),
    "least_load_capacity": Variable(
        (), "N", "least load capacity of all directions looked at", "min W_c",
        shown=TableLabel("least load capacity", "N"),
    ),
    "least_capacity_direction": Variable(
        (), "rad", "direction of the least load capacity", "psi_min",
        shown=TableLabel("  in direction", "deg", 180.0 / math.pi),
    ),
    "capacity_over_direction": Variable(
        ("load_orientation",), "N", "load capacity in each direction; nan where none was found", "W_c"
    ),
    "film_under_smallest_load": Variable(
        ("load_orientation",), "m",
        "minimum film thickness under the smallest load in each direction that has no load capacity; else nan", "h_0",
        role=Role.BOOKKEEPING,
    ),
    "capacity_over_direction_error": Variable(
        ("load_orientation",), "N", "error bar of the load capacity in each direction", "dW_c"
    ),
}  # fmt: skip
COLUMNS = {
    "speed": "speed",
    "load_capacity": "load\ncapacity",
    "limited_by": "limited\nby",
    "load_coefficient_imperial": "load\ncoefficient",
    "min_film_thickness": "min. film",
    "contact_fraction": "contact\nfraction",
    "least_load_capacity": "least",
    "least_capacity_direction": "in\ndirection",
}


def of_direction(record: Record, name: str, k: int, factor: float = 1.0) -> float | str:
    """An array over the direction at an index, times a factor; absent where there is none."""
    value = float(record.fields[name][k]) if name in record.fields else math.nan
    return ABSENT if math.isnan(value) else factor * value


def capacity_in(record: Record, k: int) -> Cell:
    """The load capacity in a direction, and its error bar where it has one."""
    value, bar = (of_direction(record, f"capacity_over_direction{part}", k) for part in ("", "_error"))
    return barred(value, bar) if isinstance(value, float) and isinstance(bar, float) else value


TABLE = ArrayTable(
    dim="load_orientation",
    columns={
        "direction\ndeg": lambda record, k: math.degrees(float(record.coords["load_orientation"][k])),
        "load capacity\nN": capacity_in,
        "film under the\nsmallest load µm": lambda record, k: of_direction(record, "film_under_smallest_load", k, 1e6),
    },
)
OVER = ("load_orientation", "capacity_over_direction", "film_under_smallest_load")
BARS = ("capacity_over_direction_error",)


@dataclass(frozen=True, kw_only=True)
class Given:
    """What was asked: direction of the load and limits."""

    load_direction: float
    min_film_limit: float | None
    contact_fraction_allowed: float | None
    stress_limit: float | None

    @classmethod
    def of(cls, asked: CapacityRequest) -> Given:
        """Limits and the first direction."""
        limits = asked.limits
        return cls(
            load_direction=float(asked.directions[0]),
            min_film_limit=limits.min_film_thickness,
            contact_fraction_allowed=limits.contact_fraction,
            stress_limit=limits.max_stress,
        )


@dataclass(frozen=True, kw_only=True)
class Carried:
    """The largest load, its coefficient, and what limits it."""

    load_capacity: float
    load_coefficient: float
    load_coefficient_imperial: float
    limited_by: str


@dataclass(frozen=True, kw_only=True)
class Least:
    """The direction of least capacity."""

    least_load_capacity: float
    least_capacity_direction: float


@analysis(
    SinglePoint(lists=OVER, histories=BARS, array_tables=(TABLE,)),
    Series(columns=COLUMNS, lists=OVER, histories=BARS, at=at_speed),
    excludes={"speed": ("speeds",)},
    results=RESULTS,
    error_bars=True,
)
def capacity(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    min_film_thickness: MinFilm = None,
    contact_fraction: Fraction = None,
    max_stress: Stress = None,
    direction: LoadDirection = DOWN,
    orientations: Orientations = 1,
    speed: Speed = None,
    speeds: Speeds = None,
    progress: Progress | None = None,
) -> Record | Points:
    """Find the largest load that is carried within limits, over speed and direction.

    The load grows until the film is as thin as --min-film, or solid contact
    carries --contact-fraction, or the petals are bent by --max-stress: the
    first limit that is reached counts. The load coefficient is the load over
    L D^2 times speed, the rule of thumb of the literature. --orientations
    turns the load over one pitch and names the direction of least capacity.

    Example: petalfoil capacity case.toml --min-film "5 um" --speeds "20000 rpm : 60000 rpm : 5"

    Raises
    ------
    UsageError
        No limit is given, or one that says nothing of this bearing; the shaft does not turn; petals keep
        friction forces.
    """
    newton_only(case)
    refuse_path(case, "the largest load is that")
    limits = Limits(min_film_thickness=min_film_thickness, contact_fraction=contact_fraction, max_stress=max_stress)
    check_limits(case, limits)
    turn = list(speeds) if speeds is not None else [at(case, speed).operation.speed]
    if not all(omega > 0.0 for omega in turn):
        raise UsageError("a load capacity needs a turning shaft: give speeds above zero")
    search = CapacitySearch(case, CapacityRequest(limits, directions_of(case, direction, orientations)))
    if speeds is None:
        with running(progress, "capacity") as run:
            record = point(search, turn[0])
            if not record.converged and len(search.asked.directions) == 1:
                raise ConvergenceError(str(record.scalars["status"]), history=run.history, advice=ADVICE)
            return record
    return Points(partial(_points, search, turn, progress), len(turn))


ADVICE = "allow a thinner film or more contact, or raise the speed; `balance` tells the state under a small load"


def check_limits(case: Case, limits: Limits) -> None:
    """Refuse limits that say nothing.

    Raises
    ------
    UsageError
        There is none; the film cannot be thinner than the one asked for; nothing is bent.
    """
    if limits == Limits():
        raise UsageError("a load capacity needs a limit: give --min-film, --contact-fraction or --max-stress")
    floor = case.surface.contact_film_thickness
    if limits.min_film_thickness is not None and limits.min_film_thickness <= floor:
        raise UsageError(
            f"a film of {1e6 * limits.min_film_thickness:g} um is no limit: surfaces touch at "
            f"surface.contact_film_thickness, {1e6 * floor:g} um; give a thicker one, or --contact-fraction"
        )
    if limits.max_stress is not None and not wall_kind(case).has_stress:
        raise UsageError(f"a stress is no limit here: the {wall_kind(case).name} wall of this case reports none")


def directions_of(case: Case, first: float, count: int) -> Array:
    """Directions of the load over one pitch, (count,) [rad].

    Raises
    ------
    UsageError
        The wall is the same all round.
    """
    pitch = wall_kind(case).pitch(case)
    if pitch is None and count > 1:
        raise UsageError(
            f"the {wall_kind(case).name} wall of this case is the same in all directions: leave --orientations out"
        )
    return np.asarray(first + (pitch or 0.0) * np.arange(count) / count)


def _points(
    search: CapacitySearch, speeds: list[float], progress: Progress | None, done: Sequence[Record] = ()
) -> Iterator[Record]:
    for place, speed in enumerate(speeds[len(done) :], len(done)):
        with running(part(progress, place, len(speeds)), f"capacity at {speed:.6g} rad/s"):
            record = point(search, speed)
        yield record


def point(search: CapacitySearch, speed: float) -> Record:
    """The record of one speed."""
    asked, found = search.asked, search.at(speed)
    here, first = at(search.case, speed, (0.0, 0.0)), found[0]
    over = np.array([math.nan if one.at is None else one.at.size for one in found])
    parts: tuple[object, ...] = (*geometry(here), Given.of(asked), effort(current_run().seconds))
    if len(found) > 1 and not np.all(np.isnan(over)):
        least = int(np.nanargmin(over))
        parts += (
            Least(least_load_capacity=float(over[least]), least_capacity_direction=float(asked.directions[least])),
        )
    if first.at is None:
        ended = RunOutcome(
            converged=False, status=f"not converged: {why_none(search, speed, first)}", residual=math.nan
        )
        parts += (asked_position(here), ended)
    else:
        parts += (
            *carried(here, first),
            RunOutcome(status=first.status, residual=first.at.found.answer.reported_residual),
        )
    return record_of(
        "capacity",
        here,
        *parts,
        fields={"capacity_over_direction": over, "film_under_smallest_load": np.array([thin(one) for one in found])},
        coords={"load_orientation": asked.directions},
    )


def solution_path(capacity: Capacity, of_state: str) -> str:
    """How a load was reached: from the capacity before, else as its state tells."""
    if capacity.sought_anew:
        return SOUGHT_ANEW
    return FOLLOWED_ON if capacity.followed_on else of_state


def thin(found: Capacity) -> float:
    """Minimum film thickness under the smallest load [m]; nan where a load keeps to the limits, or without balance."""
    return math.nan if found.smallest is None else found.smallest.found.film().min_film_thickness


def why_none(search: CapacitySearch, speed: float, found: Capacity) -> str:
    """Why no load is carried, with the result that is beyond its limit under the smallest one."""
    if (smallest := found.smallest) is None:
        return found.status
    limits, fraction = search.asked.limits, smallest.found.contact_fraction
    beyond = {
        "min_film_thickness": (thin(found), "<", limits.min_film_thickness, "m"),
        "contact_fraction": (fraction, ">", limits.contact_fraction, "1"),
    }
    told = f"{smallest.limit} is beyond its limit at the smallest load"
    if smallest.limit in beyond:
        value, sign, limit, unit = beyond[smallest.limit]
        told = f"{smallest.limit} at the smallest load: {in_unit(value, unit)} {sign} {in_unit(limit, unit)}"
    aground = f"; not lifted off at {speed * 30.0 / math.pi:.0f} rpm" if fraction > CONTACT_FRACTION else ""
    return f"{NONE_KEPT}: {told}{aground}"


def in_unit(value: float | None, unit: str) -> str:
    """A fraction in per cent, or a film thickness in micrometres."""
    return format_percent(value or 0.0) if unit == "1" else f"{1e6 * (value or 0.0):.3g} µm"


def carried(case: Case, capacity: Capacity) -> tuple[object, ...]:
    """The largest load and the state under it."""
    loaded = capacity.at
    assert loaded is not None
    bearing, found = case.bearing, loaded.found
    coefficient = loaded.size / (case.bearings * bearing.length * (2.0 * bearing.journal_radius) ** 2)
    coefficient /= case.operation.speed
    warm = heat_results(found.case, found.answer)
    return (
        *(() if warm is None else (warm,)),
        position(found.case, found.answer),
        found.forces(),
        found.film(),
        wall_kind(found.case).scalars(all_fields(found)),
        *rotor_parts(case, found.answer),
        carrier(found.contact_fraction),
        Branch(
            solution_path=solution_path(capacity, found.answer.solution_path),
            jump=capacity.sought_anew,
        ),
        Carried(
            load_capacity=loaded.size,
            load_coefficient=coefficient,
            load_coefficient_imperial=coefficient * INCH**3 * KRPM / LBF,
            limited_by=loaded.limit if capacity.status == "converged" else "",
        ),
    )
