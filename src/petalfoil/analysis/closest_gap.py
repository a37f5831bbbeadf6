"""Where petals with continuous slopes are closest to the journal, which need not be at a node of the film.

The gap of a petal toward the journal is a cubic on each element (K10), zero at every contact and positive elsewhere but
for rounding: the minimum film thickness is the contact film thickness and the least value of the cubic, if that is
positive.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.gap_curves import Facing
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class ClosestGap:
    """The least gap toward the journal.

    Attributes
    ----------
    gap : float
        Its value, over the reference length [1].
    petal : int
        The petal.
    phi : float
        Angle from its root [rad].
    element, place : (1,) array
        Element of all curves, and place in it.
    """

    gap: float
    petal: int
    phi: float
    element: Index
    place: Array

    def weights(self, whole: PointLayout) -> Array:
        """Derivatives of the gap by the nodal gaps of all curves, (2 n_node,): its place is stationary, or an end."""
        return np.asarray(hermite.rows(self.element, self.place, whole.curves.angle).toarray()[0])


def closest_gap(nodal_gaps: Array, whole: PointLayout) -> ClosestGap:
    """The least gap of all petals toward the journal, from the nodal (value, slope) of all gap curves (2 n_node,)."""
    element = facing_journal(whole)
    gap, place = (one[0] for one in lowest_gaps(nodal_gaps[None], whole))
    least = int(gap.argmin())
    petal, within = divmod(least, int(whole.curves.elements[0]))
    start = whole.pack.elements.phi[whole.pack.nodes[Facing.JOURNAL]][within]
    phi = float(start + place[least] * whole.curves.angle[element[least]])
    return ClosestGap(float(gap[least]), petal, phi, element[[least]], place[[least]])


def facing_journal(whole: PointLayout) -> Index:
    """Elements of the gaps toward the journal, petal by petal."""
    curves = whole.curves
    return np.asarray((curves.first[: whole.pack.mesh.count, None] + np.arange(int(curves.elements[0]))).ravel())


def lowest_gaps(nodal_gaps: Array, whole: PointLayout) -> tuple[Array, Array]:
    """Least gap on every element toward the journal, and its place in it, (k, element) each.

    `nodal_gaps` (k, 2 n_node) are the nodal (value, slope) of all gap curves of `k` states.
    """
    element = facing_journal(whole)
    pairs = nodal_gaps[:, 2 * element[:, None] + np.arange(4)]
    pairs[..., 1::2] *= whole.curves.angle[element][:, None]
    shape, pairs = pairs.shape[:2], pairs.reshape(-1, 4)
    place = lowest_place(pairs @ hermite.COEFFICIENTS)
    gap = np.einsum("ki,ki->k", hermite.basis(place), pairs)
    return gap.reshape(shape), place.reshape(shape)


def lowest_place(cubic: Array) -> Array:
    """Places in [0, 1] of the least values of cubics with coefficients (k, 4) of rising powers, (k,)."""
    value, slope, bend, third = cubic.T
    root = np.sqrt(np.maximum(bend**2 - 3.0 * slope * third, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):  # a straight line has no lowest place inside
        inside = np.where(bend > 0.0, -slope / (bend + root), (root - bend) / (3.0 * third))
    inside = np.clip(np.nan_to_num(inside, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    places = np.stack([np.zeros_like(inside), inside, np.ones_like(inside)])
    values = ((third * places + bend) * places + slope) * places + value
    return np.asarray(np.take_along_axis(places, values.argmin(axis=0)[None], axis=0)[0])
