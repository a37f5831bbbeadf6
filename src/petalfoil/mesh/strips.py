"""The film grid: strips that cover the circle, and their pressure unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.pack import PackMesh
from petalfoil.mesh.quadrature import trapezoid


@dataclass(frozen=True)
class FilmMesh:
    """Film strips with equal local angles. Nodal arrays are (strip, node, axial).

    Attributes
    ----------
    phi : (n_node,) array
        Local angles of a strip's nodes [rad].
    theta : (n_strip, n_node) array
        Angles of the nodes in the bushing frame [rad].
    axial : AxialGrid
        Stations along the shaft.
    unknown : (n_strip, n_node, n_z) int array
        Index of the pressure unknown at each node, -1 where the pressure is ambient. With continuous edges the last
        node of a strip and the first node of the next strip have the same pressure unknown. Each keeps its own film
        thickness: the step of the film lies exactly between the two and is not averaged.
    """

    phi: NDArray[np.float64]
    theta: NDArray[np.float64]
    axial: AxialGrid
    unknown: NDArray[np.intp]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of nodal arrays, (strip, node, axial)."""
        return self.unknown.shape

    @cached_property
    def n_unknown(self) -> int:
        """Number of pressure unknowns."""
        return int(self.unknown.max()) + 1

    def at_unknowns(self, nodal: NDArray[np.float64]) -> NDArray[np.float64]:
        """The pressure unknowns (n_unknown,) of values at nodes (strip, node, axial)."""
        out, inside = np.empty(self.n_unknown), self.unknown >= 0
        out[self.unknown[inside]] = nodal[inside]
        return out

    @cached_property
    def arc_weight(self) -> NDArray[np.float64]:
        """Weights of the trapezoidal rule along a strip, shape (n_node,) [rad]."""
        return trapezoid(self.phi)


def pressure_numbers(shape: tuple[int, int, int], axial: AxialGrid, *, continuous: bool) -> NDArray[np.intp]:
    """Indices of the pressure unknowns at nodes of `shape` (strip, node, axial), -1 where the pressure is ambient."""
    n_strip, _, n_z = shape
    free = np.ones(shape, dtype=bool)
    free[:, 0, :] = False  # ambient, or equal to the last node of the previous strip
    free[:, -1, :] = continuous
    if n_z > 1:
        free[:, :, 0] = False
        free[:, :, -1] &= axial.half
    unknown = np.full(shape, -1)
    unknown[free] = np.arange(int(free.sum()))
    if continuous:
        unknown[:, 0, :] = unknown[np.arange(n_strip) - 1, -1, :]
    return unknown


def exposed_strips(mesh: PackMesh, *, continuous: bool) -> FilmMesh:
    """Film strips of a petal pack, one for each petal."""
    phi = mesh.phi[mesh.exposed]
    theta = mesh.theta[:, mesh.exposed]
    unknown = pressure_numbers((*theta.shape, mesh.n_z), mesh.axial, continuous=continuous)
    return FilmMesh(phi, theta, mesh.axial, unknown)


def whole_circle(cells: int, axial: AxialGrid) -> FilmMesh:
    """The film of a plain journal bearing: one strip that closes on itself."""
    phi = np.linspace(0.0, 2.0 * np.pi, cells + 1)
    unknown = pressure_numbers((1, cells + 1, len(axial.z)), axial, continuous=True)
    return FilmMesh(phi, phi[None, :], axial, unknown)
