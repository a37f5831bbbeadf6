"""Solid contacts of the petal pack (18)-(22): gaps, linear in the deflections and the journal displacement.

    journal   g_J = r0 + W - delta/2 - R_j - (e_x cos theta + e_y sin theta) - h_c       exposed strips         (K1)
    bushing   g_B = r_m - r0 - W                                                         phi < phi0             (K2)
    petals    g_P = (r0 + W - delta/2)^{l+1} - (r0 + W + delta/2)^l                      phi0 <= phi <= phi1    (K3)

`h_c` is the contact film thickness. Every gap is `g = rest + by_e e + G W >= 0`. Its nodal reaction `lam >= 0` is zero
where the gap is open, `lam g = 0` (K4). The reactions load the deflection unknowns with `G^T lam`: the virtual work of
a reaction is its product with the variation of its gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.mesh.pack import PackMesh
from petalfoil.sparsity import SparseRows

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GapLines:
    """Gaps of one kind in lines around the shaft, along which a contact point travels.

    Attributes
    ----------
    number : (line, node) int array
        Number of each gap.
    phi : (node,) array
        Local angle of the nodes, the same on all lines [rad].
    stations : int
        Lines of one petal, one an axial station; they follow each other.
    """

    number: NDArray[np.intp]
    phi: Array
    stations: int

    @cached_property
    def slope_weights(self) -> tuple[NDArray[np.intp], Array]:
        """Nodes and their weights in the slope at each, (node, 3): of parabolas, at both ends of chords [1/rad]."""
        step, last = np.diff(self.phi), len(self.phi) - 1
        node = np.clip(np.arange(last + 1)[:, None] + np.arange(-1, 2), 0, last)
        weight = np.zeros((last + 1, 3))
        weight[0, 1:], weight[-1, :2] = np.array([-1.0, 1.0]) / step[0], np.array([-1.0, 1.0]) / step[-1]
        before, after = step[:-1], step[1:]
        both = before + after
        parabolas = -after / (before * both), 1.0 / before - 1.0 / after, before / (after * both)
        weight[1:-1] = np.stack(parabolas, axis=1)
        return node, weight

    @cached_property
    def cell_length(self) -> Array:
        """Angle between neighbouring nodes, (node - 1,) [rad]."""
        return np.diff(self.phi)

    @cached_property
    def mean_cell(self) -> float:
        """Its mean [rad]."""
        return float(np.mean(self.cell_length))

    @cached_property
    def cubics(self) -> tuple[NDArray[np.intp], Array]:
        """Nodes that the gap in each cell reads (K15), (node - 1, 8), and their weights in powers of `t`, (.., 4, 8).

        The two nodes of the cell, then those that the slopes at both read; some of them twice.
        """
        node, weight = self.slope_weights
        ends = np.arange(len(self.phi) - 1)[:, None] + np.arange(2)
        read = np.concatenate([ends, node[ends].reshape(-1, 6)], axis=1)
        slopes = weight[ends] * self.cell_length[:, None, None]  # by `t`
        of_values, of_slopes = hermite.COEFFICIENTS[::2].T, hermite.COEFFICIENTS[1::2].T
        weights = np.empty((*read.shape[:1], 4, 8))
        weights[:, :, :2] = of_values
        weights[:, :, 2:] = np.einsum("ps,csi->cpsi", of_slopes, slopes).reshape(-1, 4, 6)
        return read, weights


@dataclass(frozen=True)
class Contacts:
    """Gaps between journal, petals and bushing: `m` gaps, `n` deflection unknowns.

    Attributes
    ----------
    G : (m, n) sparse
        Derivative of the gaps with respect to the deflection unknowns [1].
    rest : (m,) array
        Gaps of the free petals with a centred journal [m].
    by_e : (m, 2) array
        Derivative of the gaps with respect to the journal displacement [1].
    area : (m,) array
        Area of the node of each gap [m^2]. Contact pressure is reaction over area.
    journal, bushing, petals : slice
        Rows of the gaps on the journal, on the bushing and between petals.
    lines : tuple of GapLines
        The gaps in lines around the shaft; none where the wall has no bending stiffness.
    """

    G: SparseRows
    rest: Array
    by_e: Array
    area: Array
    journal: slice
    bushing: slice
    petals: slice
    lines: tuple[GapLines, ...] = ()

    @property
    def line_numbers(self) -> list[NDArray[np.intp]]:
        """Numbers of the gaps in these lines, (line, node) each."""
        return [line.number for line in self.lines]

    def gaps(self, W: Array, e: Array) -> Array:
        """Gaps at deflections `W` (n,) and displacement `e` (2,), shape (m,) [m]."""
        gaps: Array = self.rest + self.by_e @ e + self.G @ W
        return gaps


@dataclass(frozen=True)
class PetalSizes:
    """What the gaps of a pack need of its petals, one value for each, (count,) [m].

    Attributes
    ----------
    free_radius : (count, n_node) array
        Radius `r0` of the middle surface of the free petals at their nodes.
    metric_radius, thickness : (count,) array
        Radius of the middle surface on the bore, and thickness with coating.
    """

    free_radius: Array
    metric_radius: Array
    thickness: Array

    @property
    def mean_radius(self) -> float:
        """Metric radius of the mean petal: that of areas [m]."""
        first = float(self.metric_radius[0])
        return first + float(np.mean(self.metric_radius - first))


def pack_contacts(mesh: PackMesh, petals: PetalSizes, radii: tuple[float, float]) -> Contacts:
    """Gaps of a petal pack.

    Parameters
    ----------
    mesh : PackMesh
        Grid of the pack.
    petals : PetalSizes
        Its petals.
    radii : (journal_radius, contact_film_thickness)
        `R_j` and `h_c` [m].
    """
    R_j, h_c = radii
    r_m, delta = petals.metric_radius[:, None, None], petals.thickness[:, None, None]
    number, n, N = mesh.free_numbers(), mesh.count, mesh.cells
    r0 = np.broadcast_to(petals.free_radius[:, :, None], mesh.shape)
    theta = np.broadcast_to(mesh.theta[:, :, None], mesh.shape)
    area = np.broadcast_to(petals.mean_radius * mesh.arc_weight[:, None] * mesh.axial.weight, mesh.shape)
    neighbour = np.arange(1, n + 1) % n
    above, below = number[:, mesh.on_neighbour], number[neighbour, : mesh.n_node - N]

    film, wall, lap = mesh.exposed, mesh.on_bushing, mesh.on_neighbour
    journal_gap = r0[:, film] - 0.5 * delta - R_j - h_c
    bushing_gap = r_m - r0[:, wall]
    petal_gap = r0[neighbour, : mesh.n_node - N] - r0[:, lap] - 0.5 * (delta + delta[neighbour])

    n_J, n_B, n_P = journal_gap.size, bushing_gap.size, petal_gap.size
    m = n_J + n_B + n_P
    rows = np.concatenate([np.arange(m), n_J + n_B + np.arange(n_P)])
    cols = np.concatenate([number[:, film].ravel(), number[:, wall].ravel(), above.ravel(), below.ravel()])
    signs = np.concatenate([np.ones(n_J), -np.ones(n_B), -np.ones(n_P), np.ones(n_P)])
    at_root = cols < 0  # a root does not move
    shape = (m, n * (mesh.n_node - 1) * mesh.n_z)
    G = SparseRows(sp.coo_array((signs[~at_root], (rows[~at_root], cols[~at_root])), shape=shape))
    by_e = np.zeros((m, 2))
    by_e[:n_J] = -np.stack([np.cos(theta[:, film]).ravel(), np.sin(theta[:, film]).ravel()], axis=1)
    return Contacts(
        G,
        np.concatenate([journal_gap.ravel(), bushing_gap.ravel(), petal_gap.ravel()]),
        by_e,
        np.concatenate([area[:, film].ravel(), area[:, wall].ravel(), area[:, lap].ravel()]),
        slice(0, n_J),
        slice(n_J, n_J + n_B),
        slice(n_J + n_B, m),
        gap_lines(mesh),
    )


def gap_lines(mesh: PackMesh) -> tuple[GapLines, ...]:
    """Gaps of `pack_contacts` on the journal, on the bushing and between petals: a line per petal and station."""
    lines, first = [], 0
    for nodes in (mesh.exposed, mesh.on_bushing, mesh.on_neighbour):
        phi = mesh.phi[nodes]
        number = first + np.arange(mesh.count * len(phi) * mesh.n_z).reshape(mesh.count, len(phi), mesh.n_z)
        lines.append(GapLines(number.transpose(0, 2, 1).reshape(-1, len(phi)), phi, mesh.n_z))
        first += number.size
    return tuple(lines)


def bore_contacts(theta: Array, clearance: float, area: Array) -> Contacts:
    """Gaps between the journal and a rigid bore.

    Parameters
    ----------
    theta : (m,) array
        Angles of the film nodes [rad].
    clearance : float
        Radial clearance minus the contact film thickness [m].
    area : (m,) array
        Area of each node [m^2].
    """
    m, none = len(theta), slice(0, 0)
    by_e = -np.stack([np.cos(theta), np.sin(theta)], axis=1)
    return Contacts(SparseRows((m, 0)), np.full(m, clearance), by_e, area, slice(0, m), none, none)
