"""Which contact points and stretches there are: corrected by the signs of reactions and gaps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.gap_curves import ContactPoints, Facing, sampled
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.point_equations import PointEquations

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

MEETING = 0.03
"""Travelling points this near to each other become one, in elements."""

SPLIT = 2.0
"""Gaps below zero up to this far on both sides of a point, in elements, split it."""

BRIDGED = 1.6
"""Travelling points up to this far apart, in elements, are the ends of a stretch if the gap between them is below
zero."""

SAMPLES = 8
"""Gaps looked at per element."""

BESIDE = 1.0
"""Distance from a contact, in elements, within which its travel opens and closes the gap."""

OVERLAP = 2e-4
"""A gap this far below zero gains a contact, in units of the reference film (2 nm)."""

SAG = 1.0 / 96.0
"""A gap within a stretch may be below zero by this part of the compliance times the nearest reaction: that reaction is
spread over the stretch, and a clamped beam sags by 1/384 of it under an even load, by 1/192 under a single one."""

PULL = 2e-5
"""A reaction that pulls is zero if without it the gap would open by less than this between contacts an element away, in
units of the reference film (0.2 nm): what is smaller decides nothing."""

CLOSELY = 0.025
"""Part of `OVERLAP` and `PULL` from which on signs count for points that are followed: they keep what they were, and so
does all that gaps 2 nm deep let be. It is 3 nm of the position of the rig at rest, 26 nm of that of eight petals."""

SPANS = 1.0 / 24.0
"""Deflection of a clamped beam of two elements under a load in its middle, over the compliance of one."""


@dataclass
class TravellingContact:
    """A travelling point, and the points of the stretch that begins there.

    Attributes
    ----------
    curve, position, reaction
        Of the travelling point.
    inner : list of float
        Reactions of the points up to the next travelling point; none where no stretch begins.
    """

    curve: int
    position: float
    reaction: float
    inner: list[float]


def listed(points: ContactPoints) -> list[TravellingContact]:
    """The contacts one by one, in their order."""
    parts = np.split(points.reaction, points.ends[1:]) if len(points.curve) else []
    return [
        TravellingContact(int(curve), float(position), float(part[0]), part[1:].tolist())
        for curve, position, part in zip(points.curve, points.position, parts, strict=True)
    ]


def packed(contacts: Iterable[TravellingContact]) -> ContactPoints:
    """The same in arrays, in their order along the curves."""
    rows = sorted(contacts, key=lambda contact: (contact.curve, contact.position))
    reactions = [[contact.reaction, *contact.inner] for contact in rows]
    return ContactPoints(
        np.array([contact.curve for contact in rows], dtype=np.intp),
        np.array([contact.position for contact in rows], dtype=np.float64),
        np.array([len(contact.inner) for contact in rows], dtype=np.intp),
        np.array([value for part in reactions for value in part], dtype=np.float64),
    )


def merged(points: ContactPoints) -> ContactPoints:
    """Travelling points that meet become one, at the centroid of their reactions."""
    curve, position = points.curve, points.position
    if not np.any((curve[1:] == curve[:-1]) & (position[1:] - position[:-1] < MEETING)):
        return points
    kept: list[TravellingContact] = []
    for contact in listed(points):
        last = kept[-1] if kept else None
        if last is None or last.curve != contact.curve or contact.position - last.position >= MEETING:
            kept.append(contact)
            continue
        both = last.reaction + sum(last.inner) + contact.reaction
        share = float(np.clip(contact.reaction / both, 0.0, 1.0)) if both > 0.0 else 0.5
        last.position += share * (contact.position - last.position)
        last.reaction, last.inner = both, contact.inner
    return packed(kept)


# ------------------------------------------------------------------------------------------ corrected by signs


def revised(
    equations: PointEquations,
    error: float = 0.0,
    *,
    one_by_one: bool = False,
    splitting: bool = True,
    closely: bool = False,
) -> ContactPoints | None:
    """Other contacts, where the signs ask for them; None where they are right.

    Parameters
    ----------
    equations : PointEquations
        The equations at a state.
    error : float
        Gaps and slopes up to this may still close or open by themselves; so may what a pull opens.
    one_by_one : bool
        Only the lowest gap of each curve gains a contact: it often opens the others.
    splitting : bool
        Points with gaps below zero beside them split; else these gaps gain contacts of their own.
    closely : bool
        Gaps and pulls count from a part `CLOSELY` of the usual on.
    """
    points, part = equations.state.points, CLOSELY if closely else 1.0
    inward = np.where(points.position > 0.0, 1.0, -1.0) * equations.end_slopes
    leaving = inward > max(RESIDUAL_TOLERANCE, error)
    released = (equations.travels == 0.0) & leaving & (equations.idle[points.ends] == 0.0)
    fresh = overlapping(equations, max(part * OVERLAP, error), one_by_one=one_by_one)
    pulling = points.reaction < -least_pull(equations, max(part * PULL, error))
    if not released.any() and not fresh and not pulling.any():
        return None
    contacts = marked(points, pulling)
    for k in np.flatnonzero(released):
        contacts[k].position += 2.0 * MEETING if contacts[k].position == 0.0 else -2.0 * MEETING
    return packed(without_pulling(with_fresh(contacts, fresh, splitting=splitting)))


def marked(points: ContactPoints, pulling: Mask) -> list[TravellingContact]:
    """The contacts one by one, of which those `pulling` (j,) alone have reactions below zero."""
    return listed(replace(points, reaction=np.where(pulling, points.reaction, np.maximum(points.reaction, 0.0))))


def without_loose(equations: PointEquations) -> ContactPoints | None:
    """The contacts without those that pull while Newton's method does not settle; None if none does.

    A contact by itself that pulls wanders along its gap, however little it pulls. In stretches reactions of this size
    may have either sign.
    """
    points = equations.state.points
    alone = np.ones(len(points.reaction), dtype=bool)
    stretches = np.flatnonzero(points.inner)
    for first, last in zip(points.ends[stretches], points.ends[stretches + 1], strict=True):
        alone[first : last + 1] = False
    loose = points.reaction < np.where(alone, 0.0, -least_pull(equations, PULL))
    return packed(without_pulling(marked(points, loose))) if loose.any() else None


def least_pull(equations: PointEquations, opening: float) -> Array:
    """Pull of each point without which the gap would open by `opening` [1], (j,)."""
    points, curves = equations.state.points, equations.whole.curves
    element, _ = curves.locate(points.every_curve, points.every_position)
    return np.asarray(opening / (SPANS * curves.softness[element]))


def without_pulling(contacts: list[TravellingContact]) -> list[TravellingContact]:
    """Without reactions that pull: a stretch ends before them, and begins again behind them."""
    left: list[TravellingContact] = []
    for k, contact in enumerate(contacts):
        ahead = contacts[k + 1].position if contact.inner else contact.position
        values = [contact.reaction, *contact.inner]
        places = np.linspace(contact.position, ahead, len(values) + 1)[:-1] if contact.inner else [contact.position]
        # the stretch that this one continues, if the point before still bears
        begin: TravellingContact | None = None
        for place, value in zip(places, values, strict=True):
            if value < 0.0:
                begin = None
            elif begin is None:
                begin = TravellingContact(contact.curve, float(place), value, [])
                left.append(begin)
            else:
                begin.inner.append(value)
        if begin is not None and begin.inner and not reaches(contacts, k):
            closed(left, begin, float(places[-1]))
    return [settled(left, k) for k in range(len(left))]


def reaches(contacts: list[TravellingContact], k: int) -> bool:
    """Whether the stretch that begins at contact `k` still has an end."""
    return k + 1 < len(contacts) and contacts[k + 1].reaction >= 0.0


def closed(left: list[TravellingContact], begin: TravellingContact, place: float) -> None:
    """End the stretch of `begin` at its last point."""
    left.append(TravellingContact(begin.curve, place, begin.inner.pop(), []))


def settled(left: list[TravellingContact], k: int) -> TravellingContact:
    """A contact whose stretch has lost its end has none."""
    here, ahead = left[k], left[k + 1] if k + 1 < len(left) else None
    if here.inner and (ahead is None or ahead.curve != here.curve):
        return TravellingContact(here.curve, here.position, here.reaction, [])
    return here


def with_fresh(
    contacts: list[TravellingContact], fresh: list[tuple[int, float, int]], *, splitting: bool = True
) -> list[TravellingContact]:
    """With contacts at further places: a point split in two, one more in a stretch, a stretch between two, a point."""
    new: list[TravellingContact] = []
    if splitting:
        contacts, fresh = split(contacts, fresh)
    for curve, place, before in fresh:
        if before >= 0 and bridges(contacts, before):
            contacts[before].inner.append(0.0)
        else:
            new.append(TravellingContact(curve, place, 0.0, []))
    return [*contacts, *new] if not new else sorted([*contacts, *new], key=lambda one: (one.curve, one.position))


def split(
    contacts: list[TravellingContact], fresh: list[tuple[int, float, int]]
) -> tuple[list[TravellingContact], list[tuple[int, float, int]]]:
    """The contacts with points that have gaps below zero beside them split in two, and the other gaps.

    Petals that flatten against each other touch at two points in place of one. Those are about halfway to the lowest
    gaps, and share the reaction so that its centroid stays. Without a gap on one side, the point there moves half as
    far as the other one.
    """
    left: list[TravellingContact] = []
    numbers, used = [-1], set()
    for k, one in enumerate(contacts):
        near = [f for f in fresh if f[0] == one.curve and abs(f[1] - one.position) <= SPLIT]
        beside = [f for f in near if f[2] in (k - 1, k, -1)]
        before = max((f for f in beside if f[1] < one.position and f not in used), key=lambda f: f[1], default=None)
        behind = min((f for f in beside if f[1] > one.position and f[2] == k), key=lambda f: f[1], default=None)
        if one.inner or (k and contacts[k - 1].inner) or (before is None and behind is None):
            left.append(one)
        else:
            used |= {gap for gap in (before, behind) if gap is not None}
            left += halves(one, before, behind)
        numbers.append(len(left) - 1)
    return left, [(curve, at, numbers[last + 1]) for curve, at, last in fresh if (curve, at, last) not in used]


def halves(
    one: TravellingContact, before: tuple[int, float, int] | None, behind: tuple[int, float, int] | None
) -> tuple[TravellingContact, TravellingContact]:
    """The two points that take the place of one, from the lowest gaps before and behind it."""
    down = 0.0 if before is None else 0.5 * (one.position - before[1])
    up = 0.0 if behind is None else 0.5 * (behind[1] - one.position)
    down, up = down or 0.5 * up, up or 0.5 * down
    share = up / (down + up)
    first = TravellingContact(one.curve, max(one.position - down, 0.0), share * one.reaction, [])
    return first, TravellingContact(one.curve, one.position + up, (1.0 - share) * one.reaction, [])


def bridges(contacts: list[TravellingContact], k: int) -> bool:
    """Whether a point between contact `k` and the next makes a stretch of them, or belongs to the one there is."""
    if k + 1 >= len(contacts) or contacts[k + 1].curve != contacts[k].curve:
        return False
    return bool(contacts[k].inner) or contacts[k + 1].position - contacts[k].position <= 2.0 * BRIDGED


def overlapping(
    equations: PointEquations, depth: float = OVERLAP, *, one_by_one: bool = False
) -> list[tuple[int, float, int]]:
    """Lowest places where gaps are below zero by `depth`: curve, position, number of the travelling point before or -1.

    One between two travelling points, or where `one_by_one` the lowest of each curve.
    """
    points, curves = equations.state.points, equations.whole.curves
    if not equations.may_overlap(depth, SAMPLES):
        return []
    curve, position, gap = sampled(curves, points, equations.nodal_gaps, SAMPLES)
    if points.inner.any():
        gap = gap + sagging(equations, curve, position)
    low = gap < -depth
    if not low.any():
        return []
    bushing = np.array([facing is Facing.BUSHING for facing in curves.facing])
    low &= ~(bushing[curve] & (position < 0.5))
    before = np.concatenate([[np.inf], np.where(np.diff(curve) == 0, gap[:-1], np.inf)])
    after = np.concatenate([np.where(np.diff(curve) == 0, gap[1:], np.inf), [np.inf]])
    found: dict[tuple[int, int], tuple[int, float, int]] = {}
    lowest = np.flatnonzero(low & (gap <= before) & (gap <= after))
    for k in lowest[np.argsort(gap[lowest], kind="stable")] if one_by_one else lowest:
        on, at = int(curve[k]), float(position[k])
        near = np.abs(points.every_position[points.every_curve == on] - at)
        if len(near) and near.min() < 0.5 / SAMPLES:
            continue
        mine = np.flatnonzero((points.curve == on) & (points.position < at))
        last = int(mine[-1]) if len(mine) else -1
        between = last if last >= 0 else -1 - int(k)
        found.setdefault((0 if one_by_one else between, on), (on, at, last))
    return list(found.values())


def beside_contacts(points: ContactPoints, curve: Index, position: Array) -> Mask:
    """Whether places on curves lie within an element of a contact, or in a stretch; (sample,).

    Gaps there open and close as contacts travel.
    """
    last = points.position.copy()
    stretches = np.flatnonzero(points.inner)
    last[stretches] = points.position[stretches + 1]
    near = (position[:, None] > points.position - BESIDE) & (position[:, None] < last + BESIDE)
    return np.asarray(np.any(near & (curve[:, None] == points.curve), axis=1))


def sagging(equations: PointEquations, curve: Index, position: Array) -> Array:
    """How far gaps may be below zero because reactions of a stretch are spread between its points; (sample,)."""
    points, curves = equations.state.points, equations.whole.curves
    out = np.zeros(len(curve))
    element, _ = curves.locate(curve, position)
    for k in np.flatnonzero(points.inner):
        inside = (curve == points.curve[k]) & (position > points.position[k]) & (position < points.position[k + 1])
        own = points.reaction[points.ends[k] : points.ends[k + 1] + 1]
        out[inside] = SAG * curves.softness[element[inside]] * float(np.max(own[1:-1], initial=0.0))
    return out
