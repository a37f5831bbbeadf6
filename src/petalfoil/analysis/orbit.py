"""`orbit`: a rigid rotor through time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal

import numpy as np

from petalfoil.analysis.arguments import Load, NumberWithUnit, Pair, Place, Ramp, StoredResult
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.file_exports import Export
from petalfoil.analysis.operating_point import Vector
from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import TOLERANCE, OrbitRequest
from petalfoil.case import Case
from petalfoil.results.layout import SinglePoint
from petalfoil.results.motion import Path
from petalfoil.results.record import Record
from petalfoil.results.schema import HISTORIES
from petalfoil.results.summary import ABSENT, TableRow, cell, number

Revolutions = Annotated[
    float | None,
    NumberWithUnit(
        unit="1",
        metavar="TURNS",
        help="Revolutions of the shaft to follow; by default to the end of the ramp, else 20.",
        above=0.0,
    ),
]
Duration = Annotated[
    float | None, NumberWithUnit(unit="s", help='Time to follow, instead of turns: "10 ms".', above=0.0)
]
Initial = Annotated[
    Place,
    Pair(
        unit="m",
        word="balance",
        metavar="X,Y",
        help='Where the journal is released: "10 um, 0 um", or balance for where the constant load is balanced; by '
        "default at the case's eccentricity, with a ramp from the centre at the balance.",
    ),
]
SpeedOverTime = Annotated[
    Sequence[tuple[float, float]] | None,
    Ramp(
        option="ramp",
        metavar="FROM:TO:DURATION",
        help='Speed that changes: "0 rpm : 60000 rpm : 2 s"; several segments with commas between, one joining the '
        "other. Time counts from the start of the motion, also in a restart.",
    ),
]
Restart = Annotated[
    Any, StoredResult(metavar="FILE.nc", help="Go on from the end of a motion that --out wrote, of the same bearing.")
]
Tolerance = Annotated[
    float,
    NumberWithUnit(
        unit="1",
        metavar="NUMBER",
        help="Local error of a step in reference films and ambient pressures.",
        above=0.0,
    ),
]
OVER_TIME = ("time", *(name for name, variable in HISTORIES.items() if variable.dims == ("time",)))

WARMTH = ("shaft_temperature", "pack_temperature", "shaft_growth")
"""Lines of the table of a motion with a heat network."""


def summary(record: Record) -> Iterator[TableRow]:
    """Lines of the table: how far, how large, how close, and how far it can be trusted."""
    scalars, time = record.scalars, record.coords["time"].astype(float)
    over = {name: values.astype(float) for name, values in record.fields.items() if name in OVER_TIME}
    yield TableRow("status", str(scalars["status"]), "")
    yield TableRow("speed", _speeds(over["shaft_speed"].tolist()), "rpm")
    yield TableRow("turns", number(float(scalars["revolutions"])), "")
    yield TableRow("time", number(1e3 * float(time[-1] - time[0])), "ms")
    for name, label in (("steps", "steps"), ("factorizations", "factorisations"), ("failed_steps", "failed steps")):
        yield TableRow(label, str(scalars[name]), "")
    if "contact_model" in scalars:
        yield TableRow("contacts", str(scalars["contact_model"]), "")
    if "friction_path" in scalars:
        yield cell("friction_path", scalars["friction_path"])
    paths = Path.journals(time, over, places_of(record))
    yield TableRow("largest displacement", number(1e6 * max(float(np.hypot(p.x, p.y).max()) for p in paths)), "µm")
    yield TableRow("amplitude, last turns", with_bar(record, "amplitude", 1e6), "µm")
    if "tilt_amplitude" in scalars:
        yield TableRow("tilt, last turns", with_bar(record, "tilt_amplitude", 1e6), "µrad")
        yield TableRow("whirl ratio of the tilt", _ratio(float(scalars["tilt_whirl_ratio"])), "")
    yield cell("min_film_thickness", float(over["min_film_thickness"].min()))
    yield cell("contact_fraction", float(over["contact_fraction"].max()))._replace(label="largest contact fraction")
    yield from (cell(name, float(scalars[name])) for name in WARMTH if name in scalars)
    yield TableRow("dominant whirl ratio", _ratio(float(scalars["dominant_whirl_ratio"])), "")
    for name in ("mass_balance_error", "energy_balance_error"):
        yield TableRow(name.replace("_balance_", "-balance "), number(float(scalars[name])), "")
    if "contact_model_energy" in scalars:
        yield TableRow("energy of steps between points and nodes", number(float(scalars["contact_model_energy"])), "")
    yield TableRow("time spent", number(float(scalars["wall_time"])), "s")


def places_of(record: Record) -> tuple[float, ...]:
    """Where the bearings of the rotor are, from its mass centre [m]."""
    span, centre = (float(record.scalars.get(name, 0.0)) for name in ("span", "rotor_centre"))
    return (-0.5 * span - centre, 0.5 * span - centre) if span else (0.0,)


def with_bar(record: Record, name: str, factor: float) -> str:
    """A scalar times `factor`, and its error bar where it has one."""
    value, error = float(record.scalars[name]), (record.errors or {}).get(name)
    return number(factor * value) + ("" if error is None else f" ± {number(factor * error)}")


def _ratio(ratio: float) -> str:
    """A whirl ratio to the digits that a spectrum of some turns gives."""
    return ABSENT if math.isnan(ratio) else f"{ratio:.3f}"


def _speeds(speed: list[float]) -> str:
    first, last = (cell("speed", value).value for value in (speed[0], speed[-1]))
    return first if max(speed) - min(speed) <= 1e-9 * max(speed) else f"{first} to {last}"


ANIMATION = Export(
    option="animate",
    metavar="FILE.html",
    help="Animate the last turns: a page of its own (.html) or a picture (.gif).",
    suffixes=(".html", ".gif"),
    writer="petalfoil.plot:animate",
)


@analysis(
    SinglePoint(histories=OVER_TIME, rows=summary),
    exports=(ANIMATION,),
    excludes={"initial": ("restart",), "revolutions": ("duration",)},
    error_bars=True,
)
def orbit(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    revolutions: Revolutions = None,
    duration: Duration = None,
    initial: Initial = None,
    speeds: SpeedOverTime = None,
    load: Load = None,
    restart: Restart = None,
    tolerance: Tolerance = TOLERANCE,
) -> Orbit:
    """Follow a rigid rotor through time: film, petals, contacts and journal move together.

    Mass and unbalance stand in the case's section rotor. With --out the file
    is rewritten as the motion grows; Ctrl-C keeps what is done, and --restart
    goes on from it. Friction between petals (surface.petal_friction) has no
    force at the start; where petals.theory is inextensible it counts the
    turning of their faces only, about a sixtieth of the slip in the paper's
    bearing. With a heat network
    (table heat) temperatures do not change in a motion, which is much shorter
    than a warm-up: they are those of the balance where it begins, and of a
    run-up from rest those of the cold bearing.

    Example: petalfoil orbit case.toml --revolutions 60 --plot orbit.png

    Raises
    ------
    UsageError
        The case has no rotor, the request is impossible, or the motion to go on from is that of another bearing.
    ConvergenceError
        No equilibrium to start from, or no step that leads on.
    """
    request = OrbitRequest(
        revolutions=revolutions,
        duration=duration,
        initial=place_of_release(case, initial, ramp=speeds is not None),
        speeds=None if speeds is None else tuple(speeds),
        load=load,
        tolerance=tolerance,
    )
    return Orbit.begin(case, request, restart)


def place_of_release(
    case: Case, initial: Vector | Literal["balance"] | None, *, ramp: bool
) -> Vector | Literal["balance"] | None:
    """Where the journal is released.

    A rotor that is sped up rests on its bearing first: released from the centre it would drop onto it, and bounce at
    every speed. Elsewhere the case's own place is meant.
    """
    if initial is not None or not ramp or any(case.operation.eccentricity):
        return initial
    return "balance"
