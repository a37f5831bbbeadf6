"""Bending of one petal: Kirchhoff-Love shell, inextensible along the arc (33)-(39).

Energy by finite differences (`docs/theory.md`, S1-S3), with `W > 0` outward:

    E_b = D/2 sum [ chi_phi^2 + chi_z^2 + 2 nu chi_phi chi_z + 2 (1 - nu) chi_phiz^2 ] r_m dphi dz
    chi_phi = W_phiphi / r_m^2 + W / R_p^2,   chi_z = W_zz,   chi_phiz = W_phiz / r_m

Curvatures stand at nodes (three points), twist at cell centres. At a free edge the curvature across it is
condensed: `chi_across = -nu chi_along` leaves `(1 - nu^2) chi_along^2`; at a free corner nothing is left. A rigid
root and a plane of symmetry mirror the first node. Natural conditions (25)-(32) then come out by themselves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.package import trapezoid

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PetalShell:
    """One petal on its grid; unknown `W` at all nodes, (node, axial) flattened, the root row included.

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
        Rigid mount (24): `W_phi = 0` at the root. Otherwise hinged (25): no moment there.
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
        """`K` with `E_b = W K W / 2`, shape (n_node n_z, n_node n_z) [N/m]."""
        D, nu, r_m = self.rigidity, self.poisson_ratio, self.metric_radius
        full, along_phi, along_z = self._weights
        B_phi, B_z, B_tw, cell = self.curvature_phi, self.curvature_z, self._twist, self._cell_weight

        bending_phi = B_phi.T @ sp.diags_array(full + (1.0 - nu**2) * along_phi) @ B_phi
        bending_z = B_z.T @ sp.diags_array(full + (1.0 - nu**2) * along_z) @ B_z
        coupling = nu * (B_phi.T @ sp.diags_array(full) @ B_z)
        twist = 2.0 * (1.0 - nu) * (B_tw.T @ sp.diags_array(cell) @ B_tw)
        return sp.csr_array(D * r_m * (bending_phi + bending_z + coupling + coupling.T + twist))

    @cached_property
    def curvature_phi(self) -> sp.csr_array:
        """`W -> chi_phi` at the nodes; rows where it is condensed or known to vanish are empty [1/m^2]."""
        n, phi = len(self.phi), self.phi
        rows = np.arange(1, n - 1)
        before, after = phi[1:-1] - phi[:-2], phi[2:] - phi[1:-1]
        left, right = 2.0 / (before * (before + after)), 2.0 / (after * (before + after))
        second = sp.coo_array(
            (np.concatenate([left, -left - right, right]), (np.tile(rows, 3), np.concatenate([rows - 1, rows, rows + 1]))),
            shape=(n, n),
        ).tolil()
        keep = np.ones(n)
        keep[-1] = 0.0
        if self.clamped:  # the node before the root mirrors the first one
            second[0, 0], second[0, 1] = -2.0 / (phi[1] - phi[0]) ** 2, 2.0 / (phi[1] - phi[0]) ** 2
        else:
            keep[0] = 0.0
        along = second.tocsr() / self.metric_radius**2 + sp.diags_array(keep / self.bend_radius**2)
        return sp.csr_array(sp.kron(along, sp.eye_array(len(self.axial.z)), format="csr"))

    @cached_property
    def curvature_z(self) -> sp.csr_array:
        """`W -> chi_z` at the nodes; empty on the free side edges and in the flat model [1/m^2]."""
        n_z = len(self.axial.z)
        across = sp.lil_array((n_z, n_z))
        if n_z > 1:
            inverse = 1.0 / (self.axial.z[1] - self.axial.z[0]) ** 2
            for j in range(1, n_z - 1):
                across[j, j - 1], across[j, j], across[j, j + 1] = inverse, -2.0 * inverse, inverse
            if self.axial.half:  # the node past the plane of symmetry mirrors the one before it
                across[n_z - 1, n_z - 2], across[n_z - 1, n_z - 1] = 2.0 * inverse, -2.0 * inverse
        return sp.csr_array(sp.kron(sp.eye_array(len(self.phi)), across.tocsr(), format="csr"))

    @cached_property
    def _weights(self) -> tuple[Array, Array, Array]:
        """Nodal weights (angle times length) of the full energy, of `chi_phi` alone, of `chi_z` alone."""
        weight = trapezoid(self.phi)[:, None] * self.axial.weight[None, :]
        tip = np.zeros(weight.shape, dtype=bool)
        tip[-1] = True
        root = np.zeros_like(tip)
        root[0] = True
        side = np.zeros_like(tip)
        if not self.axial.flat:
            side[:, 0] = True
            side[:, -1] |= not self.axial.half
        # W = 0 along the root: chi_z vanishes there, and chi_phi too where the root is hinged (its row is empty)
        full = np.where(side | tip, 0.0, weight)
        along_phi = np.where(side & ~tip, weight, 0.0)
        along_z = np.where(tip & ~side & ~root, weight, 0.0)
        return full.ravel(), along_phi.ravel(), along_z.ravel()

    @cached_property
    def _twist(self) -> sp.csr_array:
        """`W -> chi_phiz` at the cell centres [1/m^2]; no rows in the flat model."""
        d_phi = _difference(self.phi)
        d_z = _difference(self.axial.z)
        return sp.csr_array(sp.kron(d_phi, d_z, format="csr") / self.metric_radius)

    @cached_property
    def _cell_weight(self) -> Array:
        """Angle times length of each cell; both halves of a half model."""
        cells = np.diff(self.phi)[:, None] * np.diff(self.axial.z)[None, :]
        return (self.axial.copies * cells).ravel()

    def curvatures(self, W: Array) -> tuple[Array, Array]:
        """`chi_phi`, `chi_z` at all nodes, the condensed ones filled in, each of W's shape (..., node, axial) [1/m]."""
        nu = self.poisson_ratio
        flat = W.reshape(-1, self.curvature_phi.shape[1])
        chi_phi = (self.curvature_phi @ flat.T).T.reshape(W.shape).copy()
        chi_z = (self.curvature_z @ flat.T).T.reshape(W.shape).copy()
        if not self.axial.flat:
            sides = [0] if self.axial.half else [0, -1]
            for side in sides:
                chi_z[..., side] = -nu * chi_phi[..., side]
            chi_phi[..., -1, :] = -nu * chi_z[..., -1, :]
            chi_phi[..., -1, sides] = chi_z[..., -1, sides] = 0.0
        return chi_phi, chi_z

    def free_motions(self) -> tuple[Array, Array]:
        """Motions uniform along the shaft that bend nothing, once the root is released, and its force in them (S4).

        Returns
        -------
        motions : (n_node n_z, k) array
            Discrete `cos(k s)` with the root moved by 1 and, for a hinged root, `sin(k s)` about it.
        support : (k, n_node n_z) array
            Force of the root in each motion from the deflections [N/m]: an equilibrium under nodal loads `f` has
            `motions^T f + support W = 0`.
        """
        n_z = len(self.axial.z)
        along = self.curvature_phi[:: n_z, :: n_z].toarray()
        seeds = [(1.0, -along[0, 0] / along[0, 1])] if self.clamped else [(1.0, 1.0), (0.0, 1.0)]
        motions = np.array(seeds).T
        for row in along[1:-1]:
            i = len(motions) - 1
            motions = np.vstack([motions, -(row[i - 1] * motions[i - 1] + row[i] * motions[i]) / row[i + 1]])
        root_rows = np.asarray(self.stiffness[:n_z].sum(axis=0)).ravel()
        return np.repeat(motions, n_z, axis=0), np.outer(motions[0], root_rows)


def _difference(nodes: Array) -> sp.csr_array:
    """First differences over `nodes`, shape (n - 1, n)."""
    n = len(nodes)
    inverse = 1.0 / np.diff(nodes)
    return sp.csr_array(sp.diags_array([-inverse, inverse], offsets=[0, 1], shape=(n - 1, n)))


def bending_stress(shell: PetalShell, W: Array, youngs_modulus: float, thickness: float) -> Array:
    """Bending stress along the arc at the surface of the metal, shape of `W` [Pa].

    `sigma = E / (1 - nu^2) delta0 / 2 (chi_phi + nu chi_z)`: the assembly strain is part of it.
    """
    chi_phi, chi_z = shell.curvatures(W)
    nu = shell.poisson_ratio
    return youngs_modulus / (1.0 - nu**2) * 0.5 * thickness * (chi_phi + nu * chi_z)
