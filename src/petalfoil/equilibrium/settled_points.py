"""Contact points that meet the conditions of contact along their whole curves, whichever way led to them.

Searches look at gaps eight times in an element, not near their points, and let those within a stretch sag. So they may
end with other sets of points, which all leave gaps below zero somewhere. At an equilibrium

    p >= 0 along all curves,   lam >= 0,   lam p = 0                                                   (K12b)

to `CLOSELY` of `OVERLAP`. For given loads of the film the energy of the petals is convex and has one minimum under
these conditions, so that sets which meet them have the same force. A point with lower gaps beside it splits in two or
gains a second one, a short stretch with gaps below zero becomes the points at its lowest gaps, and a point goes if
without it the gap there stays above.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.amended_factor import serving_factor
from petalfoil.equilibrium.contact_sets import (
    CLOSELY,
    OVERLAP,
    TravellingContact,
    halves,
    listed,
    packed,
    revised,
)
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError
from petalfoil.equilibrium.point_contacts import PointContacts, Search, newton
from petalfoil.equilibrium.point_prospects import SearchedSets
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.gap_curves import ContactPoints, sampled
from petalfoil.system.point_equations import PointEquations

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Gaps = tuple[Index, Array, Array]

DEPTH = CLOSELY * OVERLAP
"""Deepest gap below zero, in units of the reference film (0.05 nm)."""

FINE = 32
"""Gaps looked at per element."""

BESIDE = 0.25
"""Distance from a point, in elements, within which gaps are looked at that searches do not see. Lower ones on both
sides split it, one on one side gains a point."""

SHORT = 2
"""Most inner points of a stretch that becomes points. Longer ones seldom settle: along them gaps stay zero."""

SETTLING = Search(16, 4)
"""The search from one set to the next: two to seven factorisations serve, in the rig up to twelve."""

SMALL, NONE = 1e-2, 1e-12
"""Reactions below the first part of the largest are asked what the gap would be without them, a solve for each; those
below the second one are none. Where a gap is zero over some length a point without reaction has no place of its own."""


def settled_points(found: PointContacts, load: Array | None) -> PointContacts | None:
    """The equilibrium with contacts that meet (K12b), `found` itself where it does; None where they do not settle."""
    equations, tangent = found.equations, found.tangent
    points = corrected(equations, tangent)
    if points is None:
        return found
    seen, left, served = SearchedSets(), SETTLING.most, serving_factor(tangent, current_run().film_solver)
    try:
        while points is not None:
            seen.check(equations, points)
            equations = replace(equations, state=replace(equations.state, points=points))
            equations, steps, tangent = newton(equations, left, (load, served), SETTLING)
            left, points = left - steps, corrected(equations, tangent)
            points = revised(equations, closely=True) if points is None else points
    except NoPointsError as failure:
        current_run().note("contact points", outcome=f"kept with gaps below zero beside them: {failure}")
        return None
    residual = float(np.max(np.abs(equations.scaled)))
    current_run().note("contact points", residual=residual, points=len(equations.state.points.curve))
    return PointContacts(equations, residual, tangent)


def still_settled(found: PointContacts, near: PointContacts, load: Array | None) -> PointContacts:
    """`found`, to which a neighbour `near` led, with contacts that meet (K12b), if those of the neighbour did."""
    if corrected(found.equations, found.tangent) is None or corrected(near.equations, near.tangent) is not None:
        return found
    return settled_points(found, load) or found


def corrected(equations: PointEquations, tangent: ElementTangent | None) -> ContactPoints | None:
    """Other points where gaps along the curves ask for them, or None: stretches, then points, then needless ones."""
    gaps = below_zero(equations)
    if len(gaps[0]):
        for points in (without_short_stretches(equations, gaps), with_split_points(equations, gaps)):
            if points is not None:
                return points
    return without_needless(equations, tangent)


def below_zero(equations: PointEquations) -> Gaps:
    """Curves, places and gaps of the samples that lie deeper than `DEPTH`, (s,) each: none in most states."""
    curve, place, gap = sampled(equations.whole.curves, equations.state.points, equations.nodal_gaps, FINE)
    deep = gap < -DEPTH
    return curve[deep], place[deep], gap[deep]


def without_short_stretches(equations: PointEquations, gaps: Gaps) -> ContactPoints | None:
    """Short stretches with gaps below zero as the points at their lowest gaps; None where there is none."""
    contacts = listed(equations.state.points)
    left: list[TravellingContact] = []
    for k, one in enumerate(contacts):
        lowest: list[float] = []
        if 0 < len(one.inner) <= SHORT:
            places = np.linspace(one.position, contacts[k + 1].position, len(one.inner) + 2)
            found = (lowest_gap(gaps, one.curve, begin, end) for begin, end in pairwise(places.tolist()))
            lowest = [place for place in found if place is not None]
        if not lowest:
            left.append(one)
            continue
        share = sum(one.inner) / len(lowest)
        left.append(replace(one, inner=[]))
        left += [TravellingContact(one.curve, place, share, []) for place in lowest]
    return packed(left) if len(left) > len(contacts) else None


def with_split_points(equations: PointEquations, gaps: Gaps) -> ContactPoints | None:
    """Points with gaps below zero on both sides split in two, a lowest gap on one side gains one; None without."""
    points, travels = equations.state.points, equations.travels
    contacts, in_stretch = listed(points), in_stretches(points)
    left: list[TravellingContact] = []
    for k, one in enumerate(contacts):
        before = behind = None
        if travels[k] and not in_stretch[k]:
            first, last = between_neighbours(contacts, k)
            before = lowest_gap(gaps, one.curve, max(first, one.position - BESIDE), one.position)
            behind = lowest_gap(gaps, one.curve, one.position, min(last, one.position + BESIDE))
        if before is None and behind is None:
            left.append(one)
            continue
        if before is None or behind is None:
            place = behind if before is None else before
            left += [one, TravellingContact(one.curve, float(place or 0.0), 0.0, [])]
        else:
            left += halves(one, (one.curve, before, k - 1), (one.curve, behind, k))
    return packed(left) if len(left) > len(contacts) else None


def without_needless(equations: PointEquations, tangent: ElementTangent | None) -> ContactPoints | None:
    """Without points that leave the gap above `-DEPTH` without them, one on each curve at most; None if all are needed.

    A gap that opens by 1 takes a reaction more by `x`, one solve with the tangent: without its reaction `lam` a point
    has the gap `-lam / x`.
    """
    points = equations.state.points
    if tangent is None or tangent.n != equations.n:
        return None
    reaction, largest = points.reaction[points.ends], float(np.max(points.reaction, initial=0.0))
    may_go = ~in_stretches(points) & (equations.idle[points.ends] == 0.0)
    gone: dict[int, tuple[float, int]] = {}
    for k in np.flatnonzero(may_go & (reaction < SMALL * largest)).tolist():
        depth, curve = 0.0, int(points.curve[k])
        if abs(reaction[k]) > NONE * largest:
            depth = float(reaction[k]) / stiffness_at(equations, tangent, int(points.ends[k]))
        if abs(depth) <= DEPTH or (depth < 0.0 and reaction[k] < 0.0):
            gone[curve] = min(gone.get(curve, (depth, k)), (depth, k))
    if not gone:
        return None
    numbers = {k for _, k in gone.values()}
    return packed(one for k, one in enumerate(listed(points)) if k not in numbers)


def stiffness_at(equations: PointEquations, tangent: ElementTangent, number: int) -> float:
    """Reaction that a point (by its `number` among all) takes more where its gap opens by 1."""
    unit = np.zeros(equations.n)
    row = equations.whole.n_wall + equations.whole.n_film + number
    unit[row] = 1.0
    return float(tangent.factor.solve(unit)[row])


def lowest_gap(gaps: Gaps, curve: int, begin: float, end: float) -> float | None:
    """Where the lowest of the gaps below zero between two places on a curve is; None if none is there."""
    on, position, gap = gaps
    between = np.flatnonzero((on == curve) & (position > begin) & (position < end))
    return float(position[between[np.argmin(gap[between])]]) if len(between) else None


def between_neighbours(contacts: list[TravellingContact], k: int) -> tuple[float, float]:
    """Positions of the contacts before and behind contact `k` on its curve."""
    curve = contacts[k].curve
    first = contacts[k - 1].position if k and contacts[k - 1].curve == curve else -np.inf
    ahead = contacts[k + 1] if k + 1 < len(contacts) else None
    return first, ahead.position if ahead is not None and ahead.curve == curve else np.inf


def in_stretches(points: ContactPoints) -> NDArray[np.bool_]:
    """Travelling points that are ends of a stretch, (k,)."""
    begins = points.inner > 0
    return np.asarray(begins | np.concatenate([[False], begins[:-1]])[: len(begins)])
