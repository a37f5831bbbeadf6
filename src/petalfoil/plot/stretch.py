"""The radial map of a cross-section: what lies between bushing and journal is drawn larger than it is.

Every radius `r` about the bushing's axis is drawn at `R_B − s (R_B − r)`. Needs NumPy alone: figures on paper and in a
browser share it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]

CLEARANCE_SHARE = 0.5
"""Largest share of the bore's radius that the default scale gives to the radial clearance."""


@dataclass(frozen=True)
class Stretch:
    """The radial map of the drawing.

    Parameters
    ----------
    bore : float
        Radius of the bushing [m].
    scale : float
        How many times too large the radial clearance is drawn.
    foil : float
        Drawn height of a foil behind the bore [m].
    """

    bore: float
    scale: float
    foil: float = 0.0

    @property
    def bushing(self) -> float:
        """Drawn inner radius of the bushing [m]."""
        return self.bore + self.foil

    def radius(self, r: Floats) -> Floats:
        """Drawn radius of a radius about the bushing's axis [m]."""
        return self.bore - self.scale * (self.bore - r)

    def points(self, r: Floats, theta: Floats) -> Floats:
        """Drawn places, one a row, of radii and bushing angles [m]."""
        drawn = self.radius(r)
        return np.stack([drawn * np.cos(theta), drawn * np.sin(theta)], axis=-1)


def petal_outline(radius: Floats, theta: Floats, half: float, stretch: Stretch) -> Floats:
    """Outline of a petal: its inner face, and back along its outer one."""
    inner, outer = stretch.points(radius - half, theta), stretch.points(radius + half, theta)
    return np.concatenate([inner, outer[::-1]])


ROUND = 0.3
"""Largest drawn displacement over the drawn radius of the journal by default: beyond it a circle looks squashed, since
the map stretches radii and keeps angles."""


def round_scale(bore: float, journal: float, displaced: float = 0.0) -> float:
    """The largest of 1, 2, 5, 10, ... that keeps the radial clearance within its share and the journal round.

    Parameters
    ----------
    bore, journal : float
        Radii of bushing and journal [m].
    displaced : float
        Displacement of the journal [m].
    """
    clearance = bore - journal
    most = max(min(CLEARANCE_SHARE * bore / clearance, ROUND * bore / (displaced + ROUND * clearance)), 1.0)
    decade = 10.0 ** math.floor(math.log10(most))
    return max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= most)
