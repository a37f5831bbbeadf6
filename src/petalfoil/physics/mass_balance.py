"""Mass balance of the control volumes of the film, one for each pressure unknown, and its sparse derivative.

A control volume (cell) surrounds each node. The flux through a face leaves one cell and enters the next. Mass is
therefore conserved to rounding for any fluxes. The same code serves strips with ambient edges, strips with continuous
edges and a closed circle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.reynolds import Flux, axial_flux, circumferential_flux
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class Entries:
    """Positions of the entries of a sparse matrix in a fixed order. Entries at the same position are added."""

    rows: Index
    cols: Index


@dataclass(frozen=True)
class FilmBalance:
    """Mass balance of the film on one grid.

    Parameters
    ----------
    mesh : FilmMesh
        Strips and pressure unknowns.
    radius : float
        Journal radius, the reference of axial lengths [m].
    knudsen : float
        Knudsen number on the reference film at ambient pressure (F7); zero without slip [1].
    """

    mesh: FilmMesh
    radius: float
    knudsen: float = 0.0

    @cached_property
    def dphi(self) -> Array:
        """Angles between neighbouring nodes, shape (node - 1, 1) [rad]."""
        return np.diff(self.mesh.phi)[:, None]

    @cached_property
    def dZ(self) -> Array:
        """Axial distances between stations over the journal radius, shape (axial - 1,) [1]."""
        return np.diff(self.mesh.axial.z) / self.radius

    @cached_property
    def width_Z(self) -> Array:
        """Axial width of the cells over the journal radius, shape (axial,) [1]."""
        return self.mesh.axial.weight / self.radius

    @cached_property
    def area(self) -> Array:
        """Area of the cells over the journal radius squared, shape (node, axial) [1]."""
        return self.mesh.arc_weight[:, None] * self.width_Z[None, :]

    @cached_property
    def _faces(self) -> list[tuple[Index, Index]]:
        """Film nodes (flattened indices) on both sides of every face: circumferential, then axial."""
        nodes = np.arange(self.mesh.unknown.size).reshape(self.mesh.shape)
        along = (nodes[:, :-1].ravel(), nodes[:, 1:].ravel())
        across = (nodes[..., :-1].ravel(), nodes[..., 1:].ravel())
        return [along, across]

    def fluxes(self, P: Array, H: Array, Lam: float) -> tuple[Flux, Flux]:
        """Circumferential and axial mass flows through all faces: flux times face width.

        On a half model the axial flow is that of both halves (`axial.copies`), like the widths of the cells.
        """
        along = circumferential_flux(P, H, Lam, self.dphi, self.knudsen)
        across = axial_flux(P, H, self.dZ, self.knudsen)
        return along.times(self.width_Z), across.times(self._width_phi)

    @cached_property
    def _width_phi(self) -> Array:
        """Arc of the cells, that of both halves on a half model, shape (node, 1) [rad]."""
        return self.mesh.arc_weight[:, None] * self.mesh.axial.copies

    def residual(self, fluxes: tuple[Flux, Flux]) -> Array:
        """Residual of the mass balance (F4): net outflow of the cell of each pressure unknown, (n_unknown,) [1]."""
        return self._collect(self.outflow(fluxes))

    def outflow(self, fluxes: tuple[Flux, Flux]) -> Array:
        """Net outflow of the cell of every film node, (strip, node, axial) [1].

        At an ambient node it is the inflow from the surroundings into the film, that is, minus the leakage.
        """
        return self._add_up((fluxes[0].value, fluxes[1].value), -1.0)

    def side_leakage(self, fluxes: tuple[Flux, Flux]) -> float:
        """Gas that leaves at both ends, pressure times volume a second, over `p_a^2 h_ref^3 / (12 mu)` [1].

        Gas that enters again where the film is below ambient pressure is not subtracted. In a film that runs on all
        round the difference is nothing. A 2-D film has no ends.
        """
        axial, unknown = self.mesh.axial, self.mesh.unknown
        leaving = -self.outflow(fluxes)
        ends = leaving[..., [0] if axial.half else [0, -1]]
        shared = unknown[:, -1, unknown.shape[2] // 2] >= 0  # the film runs on over the edge: two halves of one cell
        ends[:, -1] += np.roll(ends[:, 0], -1, axis=0)
        ends[:, -1] *= shared[:, None]
        return float(np.maximum(ends[:, 1:], 0.0).sum())

    def row_scale(self, fluxes: tuple[Flux, Flux]) -> Array:
        """Sum of the magnitudes of the flows in each balance, (n_unknown,) [1]: the scale of its residual."""
        return self._collect(self._add_up((fluxes[0].scale, fluxes[1].scale), 1.0))

    def _add_up(self, faces: tuple[Array, Array], sign: float) -> Array:
        """What goes through circumferential and axial faces, at the node before each and, times `sign`, behind it."""
        along, across = faces
        total = np.zeros(self.mesh.shape)
        total[:, :-1] += along
        total[:, 1:] += sign * along
        if across.size:
            total[..., :-1] += across
            total[..., 1:] += sign * across
        return total

    @cached_property
    def _stencil(self) -> tuple[Index, Index]:
        """Row (pressure unknown, -1 if ambient) and column (film node) of every derivative of a flow."""
        numbers = self.mesh.unknown.ravel()
        rows, cols = [], []
        for node0, node1 in self._faces:
            for row_node in (node0, node1):
                for col_node in (node0, node1):
                    rows.append(numbers[row_node])
                    cols.append(col_node)
        return np.concatenate(rows), np.concatenate(cols)

    @cached_property
    def by_pressure(self) -> Entries:
        """Positions of the derivatives with respect to the pressure unknowns."""
        rows, cols = self._stencil
        return Entries(rows[self._pressure_mask], self.mesh.unknown.ravel()[cols][self._pressure_mask])

    @cached_property
    def _pressure_mask(self) -> NDArray[np.bool_]:
        rows, cols = self._stencil
        return (rows >= 0) & (self.mesh.unknown.ravel()[cols] >= 0)

    @cached_property
    def by_film(self) -> Entries:
        """Positions of the derivatives with respect to the film thickness at every film node (flattened index)."""
        rows, cols = self._stencil
        return Entries(rows[rows >= 0], cols[rows >= 0])

    def tangent(self, fluxes: tuple[Flux, Flux]) -> tuple[Array, Array]:
        """Derivatives of `residual`, in the order of `by_pressure` and of `by_film`."""
        both = [flux.derivatives for flux in fluxes]
        by_P = np.concatenate([d.ravel() for f in both for d in (f.by_P0, f.by_P1, -f.by_P0, -f.by_P1)])
        by_H = np.concatenate([d.ravel() for f in both for d in (f.by_H0, f.by_H1, -f.by_H0, -f.by_H1)])
        return by_P[self._pressure_mask], by_H[self._stencil[0] >= 0]

    def storage(self, P: Array, H: Array, Lam: float) -> Array:
        """Gas stored in the cell of each unknown (F5), `2 Lam P H` times its area; its rate adds to `residual`."""
        return self._collect(2.0 * Lam * P * H * self.area)

    def _collect(self, nodal: Array) -> Array:
        return add_up(self._cells, nodal.ravel(), self.mesh.n_unknown + 1)[:-1]

    @cached_property
    def _cells(self) -> Index:
        """Cell of every film node, one behind the last for ambient nodes; (node of the film,)."""
        return np.asarray(self.mesh.unknown.ravel() % (self.mesh.n_unknown + 1))

    @cached_property
    def storage_entries(self) -> Entries:
        """Positions of the derivatives of `storage`: pressure unknown, film node."""
        numbers = self.mesh.unknown.ravel()
        inside = np.flatnonzero(numbers >= 0)
        return Entries(numbers[inside], inside)

    def storage_tangent(self, P: Array, H: Array, Lam: float) -> tuple[Array, Array]:
        """Derivatives of `storage` with respect to pressure and film, in the order of `storage_entries`."""
        factor = 2.0 * Lam * self.area
        inside = self.storage_entries.cols
        return (factor * H).ravel()[inside], (factor * P).ravel()[inside]

    def nodal_pressure(self, unknowns: Array) -> Array:
        """Pressure at every film node, (strip, node, axial) [1]: the unknowns, and 1 at ambient nodes."""
        padded = np.ones(len(unknowns) + 1)
        padded[:-1] = unknowns
        return padded[self.mesh.unknown]  # the last one where the number is -1
