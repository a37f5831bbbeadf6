"""Contact points and stretches from runs of active nodes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import TravellingContact, packed
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

SHORT_STRETCH = 0.25
"""Runs of active nodes up to this long are one point, in elements."""

SPACING = 1.0
"""Spacing of the points of a stretch, in elements: as many as the elements have values."""


def from_active_nodes(whole: PointLayout, lam: Array, active: Mask) -> ContactPoints:
    """Contact points from the reactions (m,) of active nodes (m,)."""
    contacts: list[TravellingContact] = []
    for curve, number, place in nodes_of_curves(whole):
        for run in runs(active[number]):
            contacts += of_run(curve, place[run], lam[number[run]], place[-1])
    return packed(contacts)


def nodes_of_curves(whole: PointLayout) -> Iterator[tuple[int, Index, Array]]:
    """Curve by curve: its number, numbers of the gaps at its nodes (k,), and their places in elements (k,)."""
    phi, n = whole.pack.elements.phi, whole.pack.mesh.count
    for kind, nodes in enumerate(whole.pack.nodes.values()):
        lines = whole.layout.wall.contacts.lines[kind]
        place = np.interp(lines.phi, phi, np.arange(len(phi), dtype=np.float64)) - nodes.start
        for line in range(n):
            yield kind * n + line, lines.number[line], place


def at_nearest_points(whole: PointLayout, points: ContactPoints, forces: Array) -> Array:
    """Forces (m,) at the nodes on the contact points nearest to them on their curves, (j,)."""
    out = np.zeros(len(points.reaction))
    for curve, number, place in nodes_of_curves(whole):
        at, pulls = np.flatnonzero(points.every_curve == curve), np.flatnonzero(forces[number])
        if len(at) and len(pulls):
            apart = np.abs(place[pulls, None] - points.every_position[at])
            np.add.at(out, at[np.argmin(apart, axis=1)], forces[number[pulls]])
    return out


def runs(active: Mask) -> list[Index]:
    """Runs of neighbouring active nodes."""
    at = np.flatnonzero(active)
    return np.split(at, np.flatnonzero(np.diff(at) > 1) + 1) if len(at) else []


def of_run(curve: int, place: Array, lam: Array, end: float) -> list[TravellingContact]:
    """A point where a run of active nodes is short, else a stretch with a point at each end."""
    total = float(lam.sum())
    if len(place) <= 2 or place[-1] - place[0] <= SHORT_STRETCH:
        at = float(place @ lam / total) if total > 0.0 else float(place.mean())
        at_end = place[-1] == end and lam[-1] >= 0.5 * total
        return [TravellingContact(curve, end if at_end else at, total, [])]
    first, last = centroid(place[:2], lam[:2]), end if place[-1] == end else centroid(place[-2:], lam[-2:])
    count = divisions(last - first)
    spread = float(lam[2:-2].sum()) / max(count, 1)
    return [
        TravellingContact(curve, first, float(lam[:2].sum()), [spread] * count),
        TravellingContact(curve, last, float(lam[-2:].sum()), []),
    ]


def divisions(length: float) -> int:
    """Points that divide a stretch of a `length` in elements evenly."""
    return max(round(length / SPACING) - 1, 0)


def centroid(place: Array, lam: Array) -> float:
    """Centroid of two reactions."""
    total = float(lam.sum())
    return float(place @ lam / total) if total > 0.0 else float(place.mean())
