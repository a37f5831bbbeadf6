"""The grid of the petal pack: nodes of all petals, and which of them face film, bushing and neighbour."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.axial import GRIDS, AxialGrid, fixed
from petalfoil.mesh.pitch import petal_angles
from petalfoil.mesh.quadrature import trapezoid


@dataclass(frozen=True, slots=True, eq=False)
class PackMesh:
    """Nodes of `n` equal petals. The local angle of a node is measured from the root of its petal.

    Meshes of the same numbers are the same object.

    Attributes
    ----------
    count : int
        Number of petals, `n`.
    cells : int
        Cells per pitch, `N`. Node `i` of petal `l` lies over node `i - N` of petal `l + 1`.
    phi : (n_node,) array
        Local angles of the nodes [rad].
    roots : (count,) array
        Angles of the roots in the bushing frame [rad].
    axial : AxialGrid
        Stations along the shaft.
    """

    count: int
    cells: int
    phi: NDArray[np.float64]
    roots: NDArray[np.float64]
    axial: AxialGrid

    @property
    def n_node(self) -> int:
        """Number of nodes per petal, root and free edge included."""
        return len(self.phi)

    @property
    def n_z(self) -> int:
        """Number of axial stations."""
        return len(self.axial.z)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of nodal arrays, (petal, node, axial)."""
        return self.count, self.n_node, self.n_z

    @property
    def exposed(self) -> slice:
        """Nodes of a petal that bound the film, `phi3 <= phi <= phi1`."""
        return slice(self.n_node - self.cells - 1, self.n_node)

    @property
    def on_bushing(self) -> slice:
        """Free nodes that face the bushing, `0 < phi < phi0`."""
        return slice(1, self.cells)

    @property
    def on_neighbour(self) -> slice:
        """Nodes of petal `l` that lie over petal `l + 1`, `phi0 <= phi <= phi1`."""
        return slice(self.cells, self.n_node)

    @property
    def theta(self) -> NDArray[np.float64]:
        """Angles of all nodes in the bushing frame, shape (count, n_node) [rad]."""
        return self.roots[:, None] + self.phi[None, :]

    @property
    def arc_weight(self) -> NDArray[np.float64]:
        """Weights of the trapezoidal rule along a petal, shape (n_node,) [rad]."""
        return trapezoid(self.phi)

    def free_numbers(self) -> NDArray[np.intp]:
        """Index of the deflection unknown at every node, -1 at the roots, shape (petal, node, axial)."""
        numbers = np.arange(self.count * (self.n_node - 1) * self.n_z).reshape(self.count, -1, self.n_z)
        roots = np.full((self.count, 1, self.n_z), -1)
        return np.concatenate([roots, numbers], axis=1)


@lru_cache(maxsize=GRIDS)
def pack_mesh(count: int, overlap: float, first_root: float, cells: int, axial: AxialGrid) -> PackMesh:
    """Grid of a pack with `cells` cells per pitch. Petals are `overlap` pitches long [1]; `first_root` in [rad]."""
    pitch = 2.0 * np.pi / count
    roots = first_root + pitch * np.arange(count, dtype=np.float64)
    return PackMesh(count, cells, fixed(petal_angles(pitch, overlap, cells)), fixed(roots), axial)
