"""Nodes along the shaft: one station (flat), half the length (aligned shaft) or the whole length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.quadrature import cubic_weights, trapezoid


@dataclass(frozen=True)
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

    @cached_property
    def load_weight(self) -> NDArray[np.float64]:
        """Length by which the pressure at a node loads journal and wall, (n_z,) [m]; sums to the bearing length.

        The pressure is as steep as it gets where it meets the surroundings: cubics through the nearest four nodes of
        the whole length are integrated, of fourth order on any smooth grid. The cells of the film keep `weight`, which
        also serves where a few cells shrink so fast that a cubic's weight is negative: pressure would pull there.
        """
        if self.flat:
            return self.weight
        whole = cubic_weights(self.whole_z)
        if np.min(whole) <= 0.0:
            return self.weight
        gridded = self.copies * whole[: len(self.z)]
        if self.half:
            gridded[-1] *= 0.5  # the middle is its own mirror image
        return gridded

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


def axis_2d(length: float) -> AxialGrid:
    """One station that stands for the whole length: forces per metre times the length."""
    return AxialGrid(np.array([0.5 * length]), np.array([length]), length, half=False)


def axis_3d(length: float, cells: int, *, half: bool, grading: float = 0.0) -> AxialGrid:
    """`cells` over the whole length [m], half of them (rounded up) on a half model.

    They shrink smoothly toward the ends: the largest is some `(1 + grading) / (1 - grading)` times the smallest.
    """
    cells += cells % 2 if half else 0
    share = np.arange(cells // 2 + 1 if half else cells + 1) / cells
    z = length * (share - grading / (2.0 * np.pi) * np.sin(2.0 * np.pi * share))
    return AxialGrid(z, trapezoid(z) * (2.0 if half else 1.0), length, half)
