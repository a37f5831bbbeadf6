"""Speeds at which the contact fraction of a loaded journal crosses a limit: bracket, then narrow, on one branch."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
    touching = line.contact_fraction(start) > limit
    found = crossing(line, start, limit, upward=touching)
    if found is None:
        return (math.inf, math.inf) if touching else (0.0, 0.0)
    beyond = found * FACTOR**2 if touching else found / FACTOR**2
    other = crossing(line, beyond, limit, upward=not touching) or found
    return (found, other) if touching else (other, found)


def crossing(line: SpeedLine, start: float, limit: float, *, upward: bool) -> float | None:
    """The first speed from `start`, where `line` stands, at which the limit is crossed; None if it never is.

    Raises
    ------
    ConvergenceError
        A balance on the way was not found.
    """
    bracket = search(line, start, limit, upward=upward)
    return None if bracket is None else narrowed(line, bracket, limit)


def search(line: SpeedLine, start: float, limit: float, *, upward: bool) -> Bracket | None:
    """Walk from `start` until the journal has lifted off (upward) or touches (downward); None past the last speed."""
    factor = FACTOR if upward else 1.0 / FACTOR
    speed, here = start, line.contact_fraction(start)
    while SLOWEST <= speed * factor <= fastest(line.case) * FACTOR:
        before, ahead = line.known, speed * factor
        there = line.contact_fraction(ahead)
        if (there <= limit) == upward and before is not None:
            return Bracket(speed, ahead, here, there, before)
        speed, here = ahead, there
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
    start = near / FACTOR
    try:
        while line.contact_fraction(start) <= limit and start > SLOWEST:
            start /= FACTOR
        return crossing(line, start, limit, upward=True)
    except ConvergenceError as failure:
        current_run().note("sensitivity", outcome=str(failure))
        return None
