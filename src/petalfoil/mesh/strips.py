"""The film's view of the bearing: strips that tile the circle, and the numbers of their pressures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.package import PackageMesh
from petalfoil.mesh.quadrature import trapezoid


@dataclass(frozen=True, slots=True)
class FilmMesh:
    """Film strips, each with the same local angles; arrays are (strip, node, axial).

    Attributes
    ----------
    phi : (n_node,) array
        Local angles of a strip's nodes [rad].
    theta : (n_strip, n_node) array
        Their angles in the bushing frame [rad].
    axial : AxialGrid
        Stations along the shaft.
    unknown : (n_strip, n_node, n_z) int array
        Number of the pressure unknown at each node; -1 where the pressure is ambient. Where the film runs on
        over a petal's edge, the last node of a strip and the first of the next share one pressure while each
        keeps its own film thickness: the step sits exactly on the node and is never averaged.
    """

    phi: NDArray[np.float64]
    theta: NDArray[np.float64]
    axial: AxialGrid
    unknown: NDArray[np.intp]

    @property
    def shape(self) -> tuple[int, int, int]:
        """(strip, node, axial)."""
        return self.unknown.shape

    @property
    def n_unknown(self) -> int:
        """Pressure unknowns."""
        return int(self.unknown.max()) + 1

    @property
    def arc_weight(self) -> NDArray[np.float64]:
        """Angle that each node of a strip stands for; half cells at the strip's edges, shape (n_node,) [rad]."""
        return trapezoid(self.phi)


def pressure_numbers(shape: tuple[int, int, int], axial: AxialGrid, *, continuous: bool) -> NDArray[np.intp]:
    """Number the pressure unknowns of `shape` (strip, node, axial) nodes; -1 where ambient."""
    n_strip, _, n_z = shape
    free = np.ones(shape, dtype=bool)
    free[:, 0, :] = False  # ambient, or tied to the last node of the strip before
    free[:, -1, :] = continuous
    if n_z > 1:
        free[:, :, 0] = False
        free[:, :, -1] &= axial.half
    unknown = np.full(shape, -1)
    unknown[free] = np.arange(int(free.sum()))
    if continuous:
        unknown[:, 0, :] = unknown[np.arange(n_strip) - 1, -1, :]
    return unknown


def exposed_strips(mesh: PackageMesh, *, continuous: bool) -> FilmMesh:
    """The strips that a package exposes to the film, one a petal."""
    phi = mesh.phi[mesh.exposed]
    theta = mesh.theta[:, mesh.exposed]
    unknown = pressure_numbers((*theta.shape, mesh.n_z), mesh.axial, continuous=continuous)
    return FilmMesh(phi, theta, mesh.axial, unknown)


def whole_circle(cells: int, axial: AxialGrid) -> FilmMesh:
    """One strip that closes on itself: the film of a plain journal bearing."""
    phi = np.linspace(0.0, 2.0 * np.pi, cells + 1)
    unknown = pressure_numbers((1, cells + 1, len(axial.z)), axial, continuous=True)
    return FilmMesh(phi, phi[None, :], axial, unknown)
