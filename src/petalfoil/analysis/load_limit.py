"""The largest load in one direction under which a bearing keeps to stated limits.

The load grows from where all limits are kept until one of them is reached. Each balance is followed from the one
before: its last tangent foretells how the limits change with the load, so that Newton's method on the logarithm of the
load needs a few balances, and most of them no factorisation. Near the limit, and from one speed or direction to the
next, bearings with contact points take the load as one more unknown instead (C13).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from petalfoil.analysis.load_ray import BOTTOMED_OUT, LEAST, MOST, NO_BALANCE, Loaded, LoadRay
from petalfoil.equilibrium.at_limit import REACHED

NEAR = 0.7
"""Distance from a limit (a film half as thick) from which the load is an unknown: followed from farther, petals come to
lie on each other on the way, and steps are lost."""
NEARER = 0.25
"""Distance from the limit over that of the last such attempt at which the next one is made."""
NARROW = 1e-6
"""Relative width of a bracket of loads in which a limit is crossed in a jump."""
NARROW_WITHOUT = 1e-3
"""The same where no balance is found on the far side, or the pack is bottomed out: each look there is expensive."""
GROWTH, FALL = 2.0, 8.0
"""Largest factor between one load and the next larger or smaller one: less load costs less."""
RISES = 4
"""Larger loads that are looked at where more load leads nearer to the limit."""
BALANCES = 60
"""Most balances of one search."""
IN_A_JUMP = "passes its limit there in a jump"
"""How a result is beyond its limit, where none is met exactly."""
ENDS_IN_A_SNAP = "converged; the balance ends there, and the bearing snaps to another state"
"""What bounds the load where the branch that leads to the limit has a largest load before it."""
BRANCHES = 4
"""Most attempts of one search to follow a branch to the limit."""
CLOSE = 1.1
"""Ratio of a load beyond the limit to one that keeps to it, from which another attempt is worth its tangents."""
NONE_KEPT = "no load keeps to the limits"
NONE_FOUND = "undecided: no balance was found under hardly any load, and none that keeps to the limits under more"
UNLOADED = ("passes its limit there in a jump", "is beyond its limit under hardly any load")
"""What is said where no load was found."""


@dataclass(frozen=True)
class Capacity:
    """The largest load that keeps to the limits.

    Attributes
    ----------
    at : Loaded or None
        The balance there; None where not even the least load keeps to them.
    status : str
        ``"converged"``, or what bounds the load instead of a limit.
    sought_anew : bool
        Whether it could not be followed from the speed before.
    followed_on : bool
        Whether it was, or from the direction before.
    smallest : Loaded or None
        The balance under the smallest load, which does not keep to the limits; None where one keeps to them.
    """

    at: Loaded | None
    status: str = "converged"
    sought_anew: bool = False
    followed_on: bool = False
    smallest: Loaded | None = None


def largest_load(ray: LoadRay, guess: float) -> Capacity:
    """The largest load of a ray that keeps to its limits, from a `guess` [N]."""
    if found := ray.along_branch():
        return replace(of_branch(found), followed_on=True)
    capacity = searched(ray, guess)
    while capacity.at is not None and capacity.status == ENDS_IN_A_SNAP:
        past = ray.past(capacity.at)
        if not isinstance(past, Loaded) or past.margin <= 0.0:
            break
        farther = searched(ray, past.size)
        if farther.at is None or farther.at.size <= capacity.at.size:
            break
        capacity = farther
    return capacity


def of_branch(found: Loaded) -> Capacity:
    """The largest load of the branch that was followed: at the limit, or where the branch turns back."""
    return Capacity(found) if abs(found.margin) <= 2.0 * REACHED else Capacity(found, ENDS_IN_A_SNAP)


def searched(ray: LoadRay, guess: float) -> Capacity:
    """The largest load of a branch that keeps to the limits, by looking at one load after the other."""
    size = min(max(guess, LEAST * ray.unit), MOST * ray.unit)
    kept: Loaded | None = None
    last: Loaded | None = None
    beyond, reason, nearest, rises, branches = math.inf, "", math.inf, RISES, BRANCHES
    for _ in range(BALANCES):
        here = ray.at(size, cold=kept is None, by_nodes=kept is None)
        if found := limit_beside(ray, here, nearest):
            return Capacity(found)
        if isinstance(here, Loaded) and 0.0 < -here.margin < NEARER * nearest:
            nearest = -here.margin
        if isinstance(here, Loaded) and here.margin > 0.0:
            kept = here
        elif rises and kept is None and math.isinf(beyond) and isinstance(here, Loaded) and ray.slope(here) > 0.0:
            size, rises = min(GROWTH * size, MOST * ray.unit), rises - 1
            continue
        else:
            beyond = size
            reason = here if isinstance(here, str) else f"{here.limit} {IN_A_JUMP}"
        if kept is not None and branches and (near(kept, here) or reason == NO_BALANCE or beyond <= CLOSE * kept.size):
            branches, ray.known = branches - 1, kept.found.answer
            if found := ray.along_branch():
                return of_branch(found)
        if ended := bounded(ray, kept, (beyond, reason)):
            return replace(ended, smallest=here) if ended.at is None and isinstance(here, Loaded) else ended
        size = following(ray, (last, here), kept, beyond)
        last = here if isinstance(here, Loaded) else last
        if kept is not None:  # beyond the limit, another branch may go on below it
            ray.known = kept.found.answer
    return Capacity(kept, "bounded from below: the search for the limit ran out of balances")


def near(kept: Loaded, here: Loaded | str) -> bool:
    """Whether the load that was looked at last is kept, and near a limit."""
    return kept is here and kept.margin < NEAR


def limit_beside(ray: LoadRay, here: Loaded | str, nearest: float) -> Loaded | None:
    """The balance at the limit, if that is the one `here` or is found from there; from kept loads the branch leads on.

    `nearest` is the distance of the last attempt.
    """
    if isinstance(here, str):
        return None
    if abs(here.margin) <= REACHED:
        return here
    return ray.to_limit() if 0.0 < -here.margin < min(NEAR, NEARER * nearest) else None


def bounded(ray: LoadRay, kept: Loaded | None, over: tuple[float, str]) -> Capacity | None:
    """What bounds the load where no limit is met exactly; None while the search goes on.

    Parameters
    ----------
    ray : LoadRay
        The loads.
    kept : Loaded or None
        The largest load that keeps to the limits.
    over : (float, str)
        The least load that does not [N], and why.
    """
    beyond, reason = over
    if kept is None:
        if beyond > LEAST * ray.unit:
            return None
        return Capacity(None, NONE_FOUND if reason == NO_BALANCE else f"{NONE_KEPT}: {reason.replace(*UNLOADED)}")
    if kept.size >= MOST * ray.unit:
        return Capacity(kept, f"no limit is reached up to {kept.size:.3g} N")
    narrow = NARROW_WITHOUT if reason in (NO_BALANCE, BOTTOMED_OUT) else NARROW
    return Capacity(kept, f"converged; {reason}") if beyond / kept.size - 1.0 <= narrow else None


def following(ray: LoadRay, looked_at: tuple[Loaded | None, Loaded | str], kept: Loaded | None, beyond: float) -> float:
    """The next load to look at: Newton's, inside what is known, else by a factor or in the middle [N].

    `looked_at` are the last two loads. The slope of bearings without a tangent is that of the line through both.
    """
    low, high = (0.0 if kept is None else kept.size), beyond
    last, here = looked_at
    if isinstance(here, Loaded) and (slope := slope_at(ray, last, here)) < 0.0:
        step = min(max(-here.margin / slope, -math.log(FALL)), math.log(GROWTH))
        if low < (ahead := here.size * math.exp(step)) < high:
            return min(max(ahead, LEAST * ray.unit), MOST * ray.unit)
    if math.isinf(high):
        return min(GROWTH * low, MOST * ray.unit)
    return math.sqrt(low * high) if low else max(high / FALL, LEAST * ray.unit)


def slope_at(ray: LoadRay, last: Loaded | None, here: Loaded) -> float:
    """Derivative of the margin by the logarithm of the load, by the tangent or from the `last` load; nan of neither."""
    slope = ray.slope(here)
    if not math.isnan(slope) or last is None or last.limit != here.limit or last.size == here.size:
        return slope
    return (here.margin - last.margin) / math.log(here.size / last.size)
