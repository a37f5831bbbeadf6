"""When a search for contact points is given up: what has never led to any of them in two hundred random packs."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import PULL, least_pull
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.point_equations import PointEquations, PointState

Array = NDArray[np.float64]

FARTHEST_STATE = 1e4
"""Film pressure over ambient pressure, and deflection over the reference film (0.1 m), past which Newton's method
diverges."""

PULLS = 20
"""Most reactions of a set of contacts that pull at once. Dropped together they tear stretches apart, and Newton's
method does not settle any more: 13 of 71 random packs without contact points had more, those with points at most 18."""

TURNED, LOOKED_AT = 12, 10
"""Most travelling points with gaps that bend the other way (`p'' < 0`), and steps after which they are counted.
Newton's method seeks the highest place of a gap there. Of these packs 22 had 10 to 50, those
with points at most 8, and one balance under a load 11."""

SAME = 1e-6
"""Places of contacts that differ by less are the same, in elements."""


def diverged(state: PointState) -> bool:
    """Whether a state is that of no bearing."""
    far = max(float(np.max(np.abs(state.w), initial=0.0)), float(np.max(state.P, initial=0.0)))
    return not far <= FARTHEST_STATE


def check_prospects(equations: PointEquations, steps: int) -> None:
    """Whether Newton's method may still lead to contact points after a number of steps.

    Raises
    ------
    NoPointsError
        It diverges, or too many points are at gaps that bend the other way.
    """
    if diverged(equations.state):
        raise NoPointsError("Newton's method diverges")
    if steps >= LOOKED_AT and (turned := turned_points(equations)) > TURNED:
        raise NoPointsError(f"{turned} contact points are where gaps bend the other way")


def turned_points(equations: PointEquations) -> int:
    """Number of travelling points at which the gap has a negative curvature."""
    points = equations.state.points
    of_ends = equations.gaps.slope_by_place.from_rows(points.ends, len(points.reaction))
    rows, cols, values = points.by_travel(of_ends)
    own = rows == cols
    curvature = np.bincount(rows[own], weights=values[own], minlength=len(points.position))
    return int(np.count_nonzero((curvature < 0.0) & (equations.travels > 0.0)))


@dataclass
class SearchedSets:
    """Sets of contacts that Newton's method has started from.

    Attributes
    ----------
    sets : list of ContactPoints
        These sets, in their order.
    """

    sets: list[ContactPoints] = field(default_factory=list)

    def check(self, equations: PointEquations, points: ContactPoints | None) -> None:
        """Note the set that is to follow that of `equations`; None where there is none.

        Raises
        ------
        NoPointsError
            It was there before, or too many reactions pull.
        """
        if points is None:
            return
        pulls = int(np.count_nonzero(equations.state.points.reaction < -least_pull(equations, PULL)))
        if pulls > PULLS:
            raise NoPointsError(f"{pulls} reactions pull")
        if any(are_same(points, other) for other in self.sets):
            raise NoPointsError("sets of contacts recur")
        self.sets.append(points)


def are_same(one: ContactPoints, other: ContactPoints) -> bool:
    """Whether two sets of contacts are the same."""
    if not (np.array_equal(one.curve, other.curve) and np.array_equal(one.inner, other.inner)):
        return False
    return bool(np.max(np.abs(one.position - other.position), initial=0.0) <= SAME)
