"""Stations along the shaft for petals that stretch: crowded at the sides of the petals, without a solution.

A shell bows within a few sqrt(R_m delta) of its free sides, whatever presses on it: 2 mm in a petal of 0.15 mm on
29 mm. There its film opens, and there it touches last. The density of the stations is

    rho(z) ~ 1 / (l + z) ,   l = 1.4 sqrt(R_m delta)                z from the nearer side

so that cells grow in proportion to their distance from the side.
"""

from __future__ import annotations

import numpy as np

from petalfoil.case import Case

LAYER = 1.4
"""Distance from the side at which the density is half of that there, over sqrt(R_m delta). On 64 × 24 cells the contact
fraction of the rig at 8800 rpm is 0.0244, 0.0241, 0.0241, 0.0238, 0.0216 with 0.7, 1, 1.4, 1.5, 2, on 128 × 48 it is
0.0240 (with 2). Minimum film of eight petals at 200 um: 5.745, 5.765, 5.779 um with 1, 1.4, 2,
for 5.805 um on 128 × 48 adapted stations."""

POINTS = 33
"""Values of a density from the side to the middle."""

SHORTEST = 0.005
"""Least length of the layer over half of the bearing's: densities then stay within what a case may hold."""

DIGITS = 4
"""Digits of a density."""


def side_density(case: Case) -> tuple[float, ...]:
    """Density of the stations at equal distances from a side to the middle, with mean 1, for petals that stretch.

    Raises
    ------
    ValueError
        The case has no petals.
    """
    length = case.side_length
    if length is None:
        raise ValueError("this case has no [petals]")
    half = 0.5 * case.bearing.length
    layer = LAYER * length
    density = 1.0 / (max(layer, SHORTEST * half) + np.linspace(0.0, half, POINTS))
    return tuple(float(f"{value:.{DIGITS}g}") for value in density / float(np.mean(density)))
