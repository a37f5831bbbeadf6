"""Speeds at which the contact fraction of a loaded journal crosses a limit: bracket, then narrow, on one branch."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain

from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError

PRECISION = 1e-3
"""Relative width of the bracket of a speed. Within it the speed is interpolated: rounding that moves the bracket moves
the speed by some 1e-6 of it."""

CONTACT_FRACTION = 0.01
"""Contact fraction below which the journal has lifted off, unless another is asked for."""

FACTOR = 1.25
"""Factor between speeds while a bracket is looked for."""

SLOWEST = 1.0
"""Speed below which no touchdown is looked for [rad/s]."""

FASTEST_SURFACE = 500.0
"""Surface speed of the journal above which no lift-off is looked for [m/s]: that of a shaft near bursting."""

PARTS_UP = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Parts of the speed of operation at which a pack that keeps the friction of its path is looked at on its way up."""

SENSITIVITY = 0.1
"""Relative change of the contact film thickness whose effect is reported; the limit is halved."""


@dataclass(frozen=True)
class LiftoffSpeeds:
    """Speeds of lift-off and touchdown [rad/s], and logarithmic derivatives of the first [1]."""

    liftoff_speed: float
    touchdown_speed: float
    liftoff_by_contact_film_thickness: float
    liftoff_by_contact_fraction: float


def fastest(case: Case) -> float:
    """Speed above which no lift-off is looked for [rad/s]."""
    return FASTEST_SURFACE / case.bearing.journal_radius


@dataclass(frozen=True)
class Bracket:
    """Two speeds [rad/s] on either side of the limit, the contact fractions there, and the balance at the first."""

    near: float
    far: float
    at_near: float
    at_far: float
    known: Solution


def crossings(line: SpeedLine, limit: float) -> tuple[float, float]:
    """Lift-off speed and touchdown speed [rad/s] along a line; infinite where it never lifts off, zero where it has.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    start = min(max(line.case.operation.speed, 10.0 * SLOWEST), fastest(line.case))
    if line.path is not None:
        return along_path(line, start, limit)
    touching = line.contact_fraction(start) > limit
    found = crossing(line, walk(line.case, start, upward=touching), limit, upward=touching)
    if found is None:
        return (math.inf, math.inf) if touching else (0.0, 0.0)
    beyond = found * FACTOR**2 if touching else found / FACTOR**2
    other = crossing(line, walk(line.case, beyond, upward=not touching), limit, upward=not touching)
    if touching:
        return found, 0.0 if other is None else other
    return math.inf if other is None else other, found


def along_path(line: SpeedLine, start: float, limit: float) -> tuple[float, float]:
    """The same of a pack that keeps the friction of its path: run up from rest, on to `start` at least, and down again.

    It lifts off once on that path, whatever its speed of operation `start` [rad/s] is.
    """
    slow = touching_from(line, PARTS_UP[0] * start, limit)
    if slow is None:
        return 0.0, 0.0
    rising_speeds = chain((slow,), (part * start for part in PARTS_UP[1:]), walk(line.case, FACTOR * start))
    up = crossing(line, rising_speeds, limit, upward=True)
    if up is None:
        return math.inf, math.inf
    down = crossing(line, walk(line.case, max(up * FACTOR**2, start), upward=False), limit, upward=False)
    return up, 0.0 if down is None else down


def walk(case: Case, start: float, *, upward: bool = True) -> Iterator[float]:
    """Speeds from `start` up to the fastest or down to the slowest, each by `FACTOR` from the one before [rad/s]."""
    factor, speed = FACTOR if upward else 1.0 / FACTOR, start
    yield speed
    while SLOWEST <= speed * factor <= fastest(case) * FACTOR:
        speed *= factor
        yield speed


def touching_from(line: SpeedLine, start: float, limit: float) -> float | None:
    """The first speed from `start` down at which the journal touches, where `line` then stands [rad/s]; None if none.

    A pack that keeps the friction of its path is run up to each from rest.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    for speed in walk(line.case, start, upward=False):
        if line.path is not None:
            line.known = None
        if line.contact_fraction(speed) > limit:
            return speed
    return None


def crossing(line: SpeedLine, speeds: Iterable[float], limit: float, *, upward: bool) -> float | None:
    """The first crossing of the limit on the way through `speeds` [rad/s]; None if there is none.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    bracket = search(line, speeds, limit, upward=upward)
    return None if bracket is None else narrowed(line, bracket, limit)


def search(line: SpeedLine, speeds: Iterable[float], limit: float, *, upward: bool) -> Bracket | None:
    """Walk through `speeds` until a journal that touched has lifted off (upward), or the reverse; None if none does."""
    last: tuple[float, float, Solution] | None = None
    for speed in speeds:
        here = line.contact_fraction(speed)
        is_there = (here <= limit) == upward
        if is_there and last is not None:
            near, at_near, known = last
            return Bracket(near, speed, at_near, here, known)
        last = None if is_there or line.known is None else (speed, here, line.known)
    return None


def narrowed(line: SpeedLine, bracket: Bracket, limit: float) -> float:
    """The speed at which the limit is crossed, each look from the side that it came from.

    Roots of the contact fractions over the logarithm of speed are nearly straight. Where the next look there does not
    halve the bracket, its middle is next.
    """
    near, far, known = (math.log(bracket.near), bracket.at_near), (math.log(bracket.far), bracket.at_far), bracket.known
    upward, halved = far[0] > near[0], True
    while (width := abs(far[0] - near[0])) > math.log1p(PRECISION):
        look = aim(near, far, limit) if halved else 0.5 * (near[0] + far[0])
        line.known = known
        found = (look, line.contact_fraction(math.exp(look)))
        if (found[1] <= limit) == upward:
            far = found
        else:
            near, known = found, line.known or known
        halved = abs(far[0] - near[0]) <= 0.5 * width
    return math.exp(near[0] + crossed(near, far, limit) * (far[0] - near[0]))


def crossed(near: tuple[float, float], far: tuple[float, float], limit: float) -> float:
    """Part of the way from `near` to `far` at which a straight line of the fraction's root crosses the limit."""
    a, b = (math.sqrt(value) - math.sqrt(limit) for _, value in (near, far))
    return a / (a - b) if a != b else 0.5


def aim(near: tuple[float, float], far: tuple[float, float], limit: float) -> float:
    """Logarithm of the speed at which the limit would be crossed on a straight line of its root, inside the bracket.

    A look at an end would close nothing: it keeps a little less than the precision from both.
    """
    part = crossed(near, far, limit)
    least = min(0.4 * PRECISION / abs(far[0] - near[0]), 0.5)
    return near[0] + min(max(part, least), 1.0 - least) * (far[0] - near[0])


def sensitivity(line: SpeedLine, limit: float, up: float) -> tuple[float, float]:
    """Logarithmic derivatives of the lift-off speed by contact film thickness and limit [1]; nan where not found.

    Those by the limit are along the `line` that found it, which goes on; where its way or its temperatures count, along
    another from nothing.
    """
    case, load = line.case, line.load
    thick = case.replace(
        **{"surface.contact_film_thickness": case.surface.contact_film_thickness * (1.0 + SENSITIVITY)}
    )
    by_film = slope(up, rising(SpeedLine(thick, load), limit, up), 1.0 + SENSITIVITY)
    goes_on = line.path is None and line.rotor is None and case.heat is None
    same = line if goes_on else SpeedLine(case, load)
    return by_film, slope(up, rising(same, 0.5 * limit, up), 0.5)


def slope(before: float, after: float | None, factor: float) -> float:
    """Logarithmic derivative of a speed by what was changed by `factor` [1]; nan where it was not found."""
    if after is None or not 0.0 < before < math.inf:
        return math.nan
    return math.log(after / before) / math.log(factor)


def rising(line: SpeedLine, limit: float, near: float) -> float | None:
    """Lift-off speed of a bearing like the one that lifts off at `near` [rad/s]; None if it is not found."""
    if not 0.0 < near < math.inf:
        return None
    try:
        start = touching_from(line, near / FACTOR, limit)
        return None if start is None else crossing(line, walk(line.case, start), limit, upward=True)
    except ConvergenceError as failure:
        current_run().note("sensitivity", outcome=str(failure))
        return None
