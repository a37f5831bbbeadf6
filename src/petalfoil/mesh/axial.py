"""Axial nodes: one station (2-D), half the length (aligned shaft, 3-D) or the whole length (3-D)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.quadrature import cubic_weights, trapezoid

GRIDS = 64
"""Grids that are remembered: each result of each point of a curve asks for the same."""


@dataclass(frozen=True, eq=False)
class AxialGrid:
    """Axial nodes and the length that each node represents. Grids of the same numbers are the same object.

    Attributes
    ----------
    z : (n_z,) array
        Node positions from one end of the bearing [m].
    weight : (n_z,) array
        Length of shaft that a node represents [m]. The weights sum to the bearing length. On a half model the
        weight of a node includes its mirror image. Energies, forces and flows are then those of the whole bearing.
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
        """Weights that integrate the pressure along the shaft, (n_z,) [m]. They sum to the bearing length.

        The pressure gradient is largest at the bearing ends. The rule integrates cubics through the nearest four nodes
        of the whole length. It is of fourth order on any smooth grid. On a coarse and strongly graded grid a weight of
        that rule can be negative: a positive pressure would then pull on the journal. There the trapezoidal `weight`
        is used instead. The control volumes of the film always use `weight`.
        """
        if self.is_2d:
            return self.weight
        whole = cubic_weights(self.whole_z)
        if np.min(whole) <= 0.0:
            return self.weight
        gridded = self.copies * whole[: len(self.z)]
        if self.half:
            gridded[-1] *= 0.5  # the node in the plane of symmetry is its own mirror image
        return gridded

    @property
    def is_2d(self) -> bool:
        """Whether one station represents the whole length (2-D model, no side leakage)."""
        return len(self.z) == 1

    @property
    def copies(self) -> float:
        """Bearing length over the length of the grid: 2 on a half model [1]."""
        return 2.0 if self.half else 1.0

    def whole(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nodal values over the whole length; those of a half model are mirrored. The last axis is axial."""
        if not self.half:
            return values
        return np.concatenate([values, values[..., -2::-1]], axis=-1)

    @property
    def whole_z(self) -> NDArray[np.float64]:
        """Node positions over the whole length, mirrored on a half model [m]."""
        return np.concatenate([self.z, self.length - self.z[-2::-1]]) if self.half else self.z


@lru_cache(maxsize=GRIDS)
def axis_2d(length: float) -> AxialGrid:
    """The axis of the 2-D model: one station with the weight `length` [m]."""
    return AxialGrid(fixed(np.array([0.5 * length])), fixed(np.array([length])), length, half=False)


def axis_3d(length: float, cells: int, *, half: bool, grading: float = 0.0, density: Sequence[float] = ()) -> AxialGrid:
    """The axis of the 3-D model: `cells` cells over the whole `length` [m].

    A half model has the first half of them, rounded up. With `grading` > 0 the cells become smaller toward the bearing
    ends. The largest cell is about `(1 + grading) / (1 - grading)` times the smallest. A `density` at equal distances
    from an end to the middle places the stations instead.
    """
    return _axis(length, cells + (cells % 2 if half else 0), half, grading, tuple(density))


@lru_cache(maxsize=GRIDS)
def _axis(length: float, cells: int, half: bool, grading: float, density: tuple[float, ...]) -> AxialGrid:
    """The same, `cells` even on a half model."""
    s = np.arange(cells // 2 + 1 if half else cells + 1) / cells
    z = length * (equidistributed(density, s) if density else s - grading / (2.0 * np.pi) * np.sin(2.0 * np.pi * s))
    return AxialGrid(fixed(z), fixed(trapezoid(z) * (2.0 if half else 1.0)), length, half)


def fixed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same values, not to be written to: what is remembered has many readers."""
    values.setflags(write=False)
    return values


def equidistributed(density: Sequence[float], s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Places over the length that have the parts `s` (k,) of all stations before them, (k,) [1].

    Parameters
    ----------
    density : sequence of float
        Relative density of the stations at equal distances from an end to the middle; a monotone cubic between them,
        mirrored at the middle. Grids with more cells are then nested in the same smooth map.
    s : (k,) array
        Parts of the stations, 0 to 1.
    """
    from scipy.interpolate import PchipInterpolator  # 0.3 s: only for stations that are adapted

    at = np.linspace(0.0, 0.5, len(density))
    before = PchipInterpolator(at, np.asarray(density, dtype=np.float64)).antiderivative()
    nearer, total = np.minimum(s, 1.0 - s), 2.0 * float(before(0.5))
    places = np.array([_first_root(before.solve(part * total, extrapolate=False)) for part in nearer])
    places[nearer >= 0.5] = 0.5
    return np.where(s > 0.5, 1.0 - places, places)


def _first_root(roots: NDArray[np.float64]) -> float:
    """The root of an increasing function within its range; 0 where rounding puts it before the start."""
    return float(roots[0]) if len(roots) else 0.0
