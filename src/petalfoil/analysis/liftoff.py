"""Lift-off: the speed above which the journal no longer touches, for a given load (model, question 4).

The journal floats where contacts carry less than a share of what pushes on it (J3). Lift-off is that crossing met
upward, from a speed at which it touches; touch-down is the crossing met downward, from one at which it floats. Where
equilibria are not unique the two need not be the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.equilibrium import Named
from petalfoil.analysis.figures import effort, given
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.loaded import Balance
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.walls import Capability, required

SHARE = 0.01
"""Share of the contacts below which the journal floats."""

PRECISION = 1e-3
"""Relative width of the bracket of a speed."""

FACTOR = 1.25
"""Factor between speeds while a bracket is looked for."""

SLOWEST = 1.0
"""Speed below which no touch-down is looked for [rad/s]."""

FASTEST_SURFACE = 500.0
"""Surface speed of the journal above which no lift-off is looked for [m/s]: that of a shaft near bursting."""

SENSITIVITY = 0.1
"""Relative change of the film floor whose effect is reported; the share is halved."""


def iterate(
    case: Case,
    loads: Sequence[float],
    *,
    share: float = SHARE,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield lift-off and touch-down speed for each load [N], along -y.

    Raises
    ------
    UsageError
        A wall that does not rest on the journal at zero speed, a load or share out of range.
    """
    newton_only(case)
    required(case, Capability.LIFT_OFF, "lift-off")
    if not 0.0 < share < 1.0:
        raise UsageError("the contact share must lie between 0 and 1")
    if not loads or any(not load > 0.0 for load in loads):
        raise UsageError("loads must be positive; they act along -y")
    return _records(case, list(loads), share, progress)


def _records(case: Case, loads: list[float], share: float, progress: Progress | None) -> Iterator[Record]:
    for number, load in enumerate(loads):
        clock, work = Clock(), telling_work(part(progress, number, len(loads)), f"liftoff {load:g} N")
        try:
            with one_thread():
                up, down = crossings(case, load, share, work)
                effects = sensitivity(case, load, (share, up), work)
            own: Named = {"liftoff_speed": up, "touchdown_speed": down, **effects, "converged": True}
            status = in_words(case, up)
        except ConvergenceError as failure:
            own, status = {"converged": False}, f"not converged: {failure}"
        scalars: Named = {**given(case), "load_x": 0.0, "load_y": -load, "share": share, **own}
        scalars.update({**effort(work), "status": status, "wall_time": clock.seconds})
        del scalars["speed"], scalars["eccentricity_x"], scalars["eccentricity_y"]
        yield Record(analysis="liftoff", scalars=scalars, case_toml=case.to_toml(), title=case.title)


def in_words(case: Case, up: float) -> str:
    """How the search ended."""
    if math.isinf(up):
        return f"does not lift off below {fastest(case) * 30.0 / math.pi:.0f} rpm"
    return "converged" if up > 0.0 else "floats at any speed"


def fastest(case: Case) -> float:
    """Speed above which no lift-off is looked for [rad/s]."""
    return FASTEST_SURFACE / case.bearing.journal_radius


@dataclass(frozen=True)
class Bracket:
    """Two speeds [rad/s] on either side of the share, the shares there, and the balance at the first."""

    near: float
    far: float
    at_near: float
    at_far: float
    known: Balance


def crossings(case: Case, load: float, share: float, work: RunLog) -> tuple[float, float]:
    """Lift-off speed and touch-down speed [rad/s]; infinite where the journal never floats, zero where it always does.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    start = min(max(case.operation.speed, 10.0 * SLOWEST), fastest(case))
    line = SpeedLine(case, (0.0, -load), work)
    touching = line.share(start) > share
    found = crossing(line, start, share, upward=touching)
    if found is None:
        return (math.inf, math.inf) if touching else (0.0, 0.0)
    beyond = found * FACTOR**2 if touching else found / FACTOR**2
    other = crossing(line, beyond, share, upward=not touching) or found
    return (found, other) if touching else (other, found)


def crossing(line: SpeedLine, start: float, share: float, *, upward: bool) -> float | None:
    """The first speed from `start`, where `line` stands, at which the share is crossed; None if it never is.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    bracket = search(line, start, share, upward=upward)
    return None if bracket is None else narrowed(line, bracket, share)


def search(line: SpeedLine, start: float, share: float, *, upward: bool) -> Bracket | None:
    """Walk from `start` until the journal floats (upward) or touches (downward); None past the last speed."""
    factor = FACTOR if upward else 1.0 / FACTOR
    speed, here = start, line.share(start)
    while SLOWEST <= speed * factor <= fastest(line.case) * FACTOR:
        before, ahead = line.known, speed * factor
        there = line.share(ahead)
        if (there <= share) == upward and before is not None:
            return Bracket(speed, ahead, here, there, before)
        speed, here = ahead, there
    return None


def narrowed(line: SpeedLine, bracket: Bracket, share: float) -> float:
    """The speed at which the share is crossed, each look from the side that it came from.

    Roots of the shares over the logarithm of speed are nearly straight; where looking there does not halve the bracket,
    its middle is next.
    """
    near, far, known = (math.log(bracket.near), bracket.at_near), (math.log(bracket.far), bracket.at_far), bracket.known
    upward, halved = far[0] > near[0], True
    while (width := abs(far[0] - near[0])) > math.log1p(PRECISION):
        look = aim(near, far, share) if halved else 0.5 * (near[0] + far[0])
        line.known = known
        found = (look, line.share(math.exp(look)))
        if (found[1] <= share) == upward:
            far = found
        else:
            near, known = found, line.known or known
        halved = abs(far[0] - near[0]) <= 0.5 * width
    return math.exp(0.5 * (near[0] + far[0]))


def aim(near: tuple[float, float], far: tuple[float, float], share: float) -> float:
    """Logarithm of the speed at which the share would be crossed on a straight line of its root, inside the bracket.

    A look at an end would close nothing: it keeps a little less than the precision from both.
    """
    a, b = (math.sqrt(value) - math.sqrt(share) for _, value in (near, far))
    part = a / (a - b) if a != b else 0.5
    least = min(0.4 * PRECISION / abs(far[0] - near[0]), 0.5)
    return near[0] + min(max(part, least), 1.0 - least) * (far[0] - near[0])


def sensitivity(case: Case, load: float, at: tuple[float, float], work: RunLog) -> Named:
    """Change of the lift-off speed with film floor and share: logarithmic derivatives [1]; nan where not found."""
    share, up = at
    h_min = case.surface.contact_film_thickness
    thick = case.replace(**{"surface.contact_film_thickness": h_min * (1.0 + SENSITIVITY)})
    return {
        "liftoff_by_contact_film_thickness": slope(up, rising(thick, load, share, up, work), 1.0 + SENSITIVITY),
        "liftoff_by_contact_fraction": slope(up, rising(case, load, 0.5 * share, up, work), 0.5),
    }


def slope(before: float, after: float | None, factor: float) -> float:
    """Logarithmic derivative of a speed by what was changed by `factor` [1]; nan where it was not found."""
    if after is None or not 0.0 < before < math.inf:
        return math.nan
    return math.log(after / before) / math.log(factor)


def rising(case: Case, load: float, share: float, near: float, work: RunLog) -> float | None:
    """Lift-off speed of a bearing like the one that lifts off at `near` [rad/s]; None if it is not found."""
    if not 0.0 < near < math.inf:
        return None
    line, start = SpeedLine(case, (0.0, -load), work), near / FACTOR
    try:
        while line.share(start) <= share and start > SLOWEST:
            start /= FACTOR
        return crossing(line, start, share, upward=True)
    except ConvergenceError as failure:
        work.note("sensitivity", outcome=str(failure))
        return None
