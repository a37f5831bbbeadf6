"""Temperatures of the heat network: one each of film, shaft, pack and bushing."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Temperatures(NamedTuple):
    """Mean temperatures [K]; those of a plain bearing have the surface of the bore in place of a pack."""

    film: float
    shaft: float
    pack: float
    bushing: float

    @classmethod
    def even(cls, temperature: float) -> Temperatures:
        """All at one temperature [K]."""
        return cls(temperature, temperature, temperature, temperature)

    @property
    def nodes(self) -> NDArray[np.float64]:
        """The four temperatures, (4,) [K]."""
        return np.array(self)
