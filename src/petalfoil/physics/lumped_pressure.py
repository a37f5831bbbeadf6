"""Two points in place of the contact pressure of an element, where friction acts (K18).

With the reaction `N` of an element, its centroid `m`, the variance `v` of its place and its third moment, `2 a` over
`v^1.5`, the two points

    t = m -+ c sqrt(v) (sqrt(1 + a^2) -+ a) ,   N / 2 (1 +- a / sqrt(1 + a^2))                            (K18)

have all its moments up to the third where `c = 1`: they are Gauss's for this pressure. Where the pressure is narrow or
hardly carries, `c` falls to zero, smoothly, and the element has one point. Two points that coincide rub as one does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

SPREAD = 3e-5
"""Reaction times variance of its place in the element, over all reactions, up to which an element has one point. Stiff
packs have a sum of 0.02 to 0.05: with this 1.2 to 1.6 times as many points as elements, and slopes as with twice."""


def two_points(place: Array, reaction: Array) -> tuple[Index, Array, Array]:
    """Points in place of reactions (L, S) at `place` (S,) of elements: element, place and reaction of each (K18)."""
    total = reaction.sum(axis=1)
    centroid = (reaction @ place) / total
    apart = place - centroid[:, None]
    variance = np.einsum("es,es->e", reaction, apart**2) / total
    ramp = np.clip(total * variance / (SPREAD * float(total.sum())) - 1.0, 0.0, 1.0) if len(total) else total
    one, two = np.flatnonzero(ramp == 0.0), np.flatnonzero(ramp)
    width = np.sqrt(variance[two])
    skew = 0.5 * np.einsum("es,es->e", reaction[two], apart[two] ** 3) / (total[two] * width**3)
    root, width = np.sqrt(1.0 + skew**2), (ramp**2 * (3.0 - 2.0 * ramp))[two] * width
    before = 0.5 * (1.0 + skew / root)
    return (
        np.concatenate([one, two, two]),
        np.concatenate([centroid[one], centroid[two] - width * (root - skew), centroid[two] + width * (root + skew)]),
        np.concatenate([total[one], total[two] * before, total[two] * (1.0 - before)]),
    )
