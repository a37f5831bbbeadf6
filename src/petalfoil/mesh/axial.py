"""Nodes along the shaft: one station (flat), half the length (aligned shaft) or the whole length."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class AxialGrid:
    """Axial nodes and the length that each stands for.

    Attributes
    ----------
    z : (n_z,) array
        Node positions from one end of the bearing [m].
    weight : (n_z,) array
        Length of shaft that a node stands for [m]; sums to the bearing length. On a half model each node
        counts its mirror image too, so that energies, forces and flows are those of the whole bearing.
    length : float
        Bearing length [m].
    half : bool
        The last node lies on the plane of symmetry.
    """

    z: NDArray[np.float64]
    weight: NDArray[np.float64]
    length: float
    half: bool

    @property
    def flat(self) -> bool:
        """One station stands for the whole length: the flat model."""
        return len(self.z) == 1

    @property
    def copies(self) -> float:
        """How many times the gridded part makes the bearing: 2 on a half model."""
        return 2.0 if self.half else 1.0

    def whole(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Mirror nodal values (last axis: axial) of a half model onto the whole length."""
        if not self.half:
            return values
        return np.concatenate([values, values[..., -2::-1]], axis=-1)

    @property
    def whole_z(self) -> NDArray[np.float64]:
        """Node positions over the whole length [m]."""
        return np.concatenate([self.z, self.length - self.z[-2::-1]]) if self.half else self.z


def flat_axis(length: float) -> AxialGrid:
    """One station that stands for the whole length: forces per metre times the length."""
    return AxialGrid(np.array([0.5 * length]), np.array([length]), length, half=False)


def spatial_axis(length: float, cells: int, *, half: bool) -> AxialGrid:
    """`cells` uniform cells over the whole length [m]; half of them (rounded up) on a half model."""
    count = (cells + 1) // 2 if half else cells
    extent = 0.5 * length if half else length
    z = np.linspace(0.0, extent, count + 1)
    weight = np.full(count + 1, extent / count)
    weight[[0, -1]] *= 0.5
    return AxialGrid(z, weight * (2.0 if half else 1.0), length, half)
