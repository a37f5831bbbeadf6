"""Bending of one petal: Kirchhoff-Love shell, inextensible along the arc (33)-(39).

The bending energy by finite differences (`docs/theory.md`, S1-S3), with `W > 0` outward:

    E_b = D/2 sum [ chi_phi^2 + chi_z^2 + 2 nu chi_phi chi_z + 2 (1 - nu) chi_phiz^2 ] r_m dphi dz
    chi_phi = W_phiphi / r_m^2 + W / R_p^2,   chi_z = W_zz,   chi_phiz = W_phiz / r_m

Curvatures are evaluated at nodes (three points), the twist at cell centres. At a free edge the bending moment across
the edge is zero. The curvature across it is then `chi_across = -nu chi_along`, and the energy there is `(1 - nu^2)
chi_along^2`. At a free corner the bending energy is zero. At a clamped root and at a plane of symmetry the node outside
the grid is the mirror image of the first node inside. The natural boundary conditions (25)-(32) follow from the minimum
of this energy and need no equations of their own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.quadrature import trapezoid
from petalfoil.sparsity import Triplets, at_stations, compressed, repeated, rows_of_blocks

Array = NDArray[np.float64]

REMEMBERED = 8
"""Grids whose differences are remembered: packs of a parameter study share them."""


@dataclass(frozen=True)
class PetalShell:
    """One petal on its grid. The unknown `W` has all nodes, (node, axial) flattened, the root row included.

    Parameters
    ----------
    phi : (n_node,) array
        Nodes from the root to the free edge [rad].
    axial : AxialGrid
        Stations along the shaft.
    metric_radius, bend_radius : float
        `r_m` and `R_p` [m].
    rigidity : float
        `D = E delta0^3 / (12 (1 - nu^2))` [N m].
    poisson_ratio : float
        `nu` [1].
    clamped : bool
        Clamped root (24): `W_phi = 0` at the root. Otherwise hinged (25): no bending moment at the root.
    """

    phi: Array
    axial: AxialGrid
    metric_radius: float
    bend_radius: float
    rigidity: float
    poisson_ratio: float
    clamped: bool

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """Stiffness matrix `K` with `E_b = W K W / 2`, shape (n_node n_z, n_node n_z) [N/m]."""
        S = self.strain @ self.difference
        return sp.csr_array(S.T @ self.rigidity_matrix @ S)

    @cached_property
    def rigidity_matrix(self) -> sp.csr_array:
        """Moments from curvatures and twist, quadrature weights included [N m^3]."""
        D, nu, r_m = self.rigidity, self.poisson_ratio, self.metric_radius
        full, along_phi, along_z = self._weights
        n, twist, coupling = len(full), 2.0 * (1.0 - nu) * self._cell_weight, Triplets.diagonal(D * r_m * (nu * full))
        blocks = [
            (0, 0, Triplets.diagonal(D * r_m * (full + (1.0 - nu**2) * along_phi))),
            (0, n, coupling),
            (n, 0, coupling),
            (n, n, Triplets.diagonal(D * r_m * (full + (1.0 - nu**2) * along_z))),
            (2 * n, 2 * n, Triplets.diagonal(D * r_m * twist)),
        ]
        return rows_of_blocks(blocks, (2 * n + len(twist),) * 2)

    @cached_property
    def difference(self) -> sp.csr_array:
        """Matrix from `W` to (circumferential, axial and mixed differences of neighbours; `W` itself).

        Its entries are +-1. Neighbouring deflections differ little, and their difference is exact in floating point.
        Curvatures from these differences keep digits that second differences of `W` would lose.
        """
        return grid_differences(len(self.phi), len(self.axial.z))

    @cached_property
    def strain(self) -> sp.csr_array:
        """Matrix from `difference @ W` to (`chi_phi`, `chi_z` at the nodes, `chi_phiz` at the cell centres).

        Rows are empty where a curvature follows from another one (free edges) or is zero (hinged root).
        """
        n, n_z = len(self.phi), len(self.axial.z)
        in_place = np.repeat(self._bent / self.bend_radius**2, n_z)
        chi_phi = at_stations(self._second_phi / self.metric_radius**2, n_z)
        chi_z, cells = repeated(self._second_z, n), self._twist_scale
        nodes, after_phi = n * n_z, chi_phi.shape[1]
        after_z = after_phi + chi_z.shape[1]
        blocks = [
            (0, 0, chi_phi),
            (0, after_z + len(cells), Triplets.diagonal(in_place)),
            (nodes, after_phi, chi_z),
            (2 * nodes, after_z, Triplets.diagonal(cells)),
        ]
        return rows_of_blocks(blocks, (2 * nodes + len(cells), after_z + len(cells) + nodes))

    @property
    def _bent(self) -> Array:
        """1 at the nodes along the arc where `chi_phi` has its own row, 0 at the free edge and at a hinged root."""
        keep = np.ones(len(self.phi))
        keep[-1] = 0.0
        keep[0] = float(self.clamped)
        return keep

    @cached_property
    def _second_phi(self) -> sp.csr_array:
        """Matrix from circumferential differences to the second derivative at the nodes [1]."""
        mirrored = 2.0 / (self.phi[1] - self.phi[0]) ** 2  # a clamped root mirrors the first node
        return _second_derivative(self.phi, first=mirrored if self.clamped else None)

    @cached_property
    def _second_z(self) -> sp.csr_array:
        """Matrix from axial differences to the second derivative [1/m^2]. Rows of free sides and of 2-D are empty."""
        z = self.axial.z
        if not self.axial.half:
            return _second_derivative(z)
        return _second_derivative(z, last=-2.0 / (z[-1] - z[-2]) ** 2)  # beyond the plane of symmetry z is mirrored

    @property
    def _twist_scale(self) -> Array:
        """Factors from mixed differences to `chi_phiz` at the cell centres [1/m^2]."""
        area = np.diff(self.phi)[:, None] * np.diff(self.axial.z)[None, :]
        return (1.0 / (self.metric_radius * area)).ravel()

    @cached_property
    def _weights(self) -> tuple[Array, Array, Array]:
        """Nodal weights (angle times length): of the full energy, of `chi_phi` alone, of `chi_z` alone [rad m]."""
        weight = trapezoid(self.phi)[:, None] * self.axial.weight[None, :]
        tip = np.zeros(weight.shape, dtype=bool)
        tip[-1] = True
        root = np.zeros_like(tip)
        root[0] = True
        side = np.zeros_like(tip)
        if not self.axial.is_2d:
            side[:, 0] = True
            side[:, -1] |= not self.axial.half
        # W = 0 along the root: chi_z is zero there, and chi_phi too where the root is hinged (its row is empty)
        full = np.where(side | tip, 0.0, weight)
        along_phi = np.where(side & ~tip, weight, 0.0)
        along_z = np.where(tip & ~side & ~root, weight, 0.0)
        return full.ravel(), along_phi.ravel(), along_z.ravel()

    @cached_property
    def _cell_weight(self) -> Array:
        """Angle times length of each cell, of both halves on a half model [rad m]."""
        cells = np.diff(self.phi)[:, None] * np.diff(self.axial.z)[None, :]
        return (self.axial.copies * cells).ravel()

    def curvatures(self, W: Array) -> tuple[Array, Array]:
        """`chi_phi` and `chi_z` at all nodes, each of the shape of `W` (..., node, axial) [1/m].

        At free edges the curvature across the edge follows from the one along it.
        """
        nu, bent = self.poisson_ratio, self._bent[:, None] / self.bend_radius**2
        chi_phi = _along(self._second_phi / self.metric_radius**2, np.diff(W, axis=-2), -2) + bent * W
        chi_z = _along(self._second_z, np.diff(W, axis=-1), -1)
        if not self.axial.is_2d:
            sides = [0] if self.axial.half else [0, -1]
            for side in sides:
                chi_z[..., side] = -nu * chi_phi[..., side]
            chi_phi[..., -1, :] = -nu * chi_z[..., -1, :]
            chi_phi[..., -1, sides] = chi_z[..., -1, sides] = 0.0
        return chi_phi, chi_z

    def free_motions(self) -> tuple[Array, Array]:
        """Axially uniform motions without bending energy when the root is released, and the root force (S4).

        Returns
        -------
        motions : (n_node n_z, k) array
            Discrete `cos(k s)` with the root moved by 1 and, for a hinged root, `sin(k s)` with the root at rest.
        support : (k, n_node n_z) array
            Force of the root in each motion from the deflections [N/m]. In equilibrium under nodal loads `f`,
            `motions^T f + support W = 0`.
        """
        n_z = len(self.axial.z)
        along = (self._second_phi @ neighbour_differences(len(self.phi))) / self.metric_radius**2
        behind, ahead = along.diagonal(-1).tolist(), along.diagonal(1).tolist()
        here = (along.diagonal() + self._bent / self.bend_radius**2).tolist()
        seeds = [(1.0, -here[0] / ahead[0])] if self.clamped else [(1.0, 1.0), (0.0, 1.0)]
        motions = np.zeros((len(self.phi), len(seeds)))
        for k, (held, first) in enumerate(seeds):
            motion = [held, first]
            for i in range(1, len(self.phi) - 1):
                motion.append(-(behind[i - 1] * motion[i - 1] + here[i] * motion[i]) / ahead[i])
            motions[:, k] = motion
        root = np.zeros(len(self.phi) * n_z)
        root[:n_z] = 1.0
        bent = self.strain @ (self.difference @ root)
        root_rows = self.difference.T @ (self.strain.T @ (self.rigidity_matrix.T @ bent))
        return np.repeat(motions, n_z, axis=0), np.outer(motions[0], root_rows)


def _along(matrix: sp.csr_array, values: Array, axis: int) -> Array:
    """Apply `matrix` along an axis of `values`."""
    first = np.moveaxis(values, axis, 0)
    applied = matrix @ first.reshape(len(first), math.prod(first.shape[1:]))
    return np.moveaxis(applied.reshape(matrix.shape[0], *first.shape[1:]), 0, axis)


@lru_cache(maxsize=REMEMBERED)
def grid_differences(n: int, n_z: int) -> sp.csr_array:
    """`PetalShell.difference` of `n` nodes along the arc at `n_z` stations: the same for all petals."""
    d_phi, d_z = neighbour_differences(n), neighbour_differences(n_z)
    along, across = at_stations(d_phi, n_z), repeated(d_z, n)
    return sp.csr_array(sp.vstack([along, across, sp.kron(d_phi, d_z), sp.eye_array(n * n_z)], format="csr"))


def neighbour_differences(n: int) -> sp.csr_array:
    """Matrix of differences of neighbours among `n` values, shape (n - 1, n), of none (0, 0)."""
    if n == 0:
        return sp.csr_array((0, 0))
    data, starts = np.tile([-1.0, 1.0], n - 1), np.arange(0, 2 * n, 2)
    return compressed(sp.csr_array, data, (np.arange(n - 1)[:, None] + np.arange(2)).ravel(), starts, (n - 1, n))


def _second_derivative(nodes: Array, first: float | None = None, last: float | None = None) -> sp.csr_array:
    """Matrix from differences of neighbours to the second derivative at the inner `nodes`, three points each.

    At the outer nodes the outermost difference counts `first` and `last` times; without these their rows are empty.
    """
    n, cell = len(nodes), np.diff(nodes)
    inner, span = np.arange(1, n - 1), 0.5 * (cell[:-1] + cell[1:])
    rows, cols = [inner, inner], [inner - 1, inner]
    values = [-1.0 / (cell[:-1] * span), 1.0 / (cell[1:] * span)]
    for end, place, value in ((0, 0, first), (n - 1, n - 2, last)):
        if value is not None:
            rows.append(np.array([end]))
            cols.append(np.array([place]))
            values.append(np.array([value]))
    places = (np.concatenate(rows), np.concatenate(cols))
    return sp.csr_array(sp.coo_array((np.concatenate(values), places), shape=(n, max(n - 1, 0))))


def bending_stress(shell: PetalShell, W: Array, youngs_modulus: float, thickness: float) -> Array:
    """Circumferential bending stress at the surface of the metal (J6), shape of `W` [Pa].

    `sigma = E / (1 - nu^2) delta0 / 2 (chi_phi + nu chi_z)`. It contains the stress from assembly.
    """
    chi_phi, chi_z = shell.curvatures(W)
    nu = shell.poisson_ratio
    return youngs_modulus / (1.0 - nu**2) * 0.5 * thickness * (chi_phi + nu * chi_z)
