"""Bending and stretching of one petal: a thin cylindrical shell with the displacements `W`, `V` (along the petal), `U`.

With the arc length `s = r_m phi` and `W > 0` outward (`docs/theory.md`, M8-M10)

    eps_s = V_s + W / R_p ,   eps_z = U_z ,   gamma = U_s + V_z
    E_m = B/2 int [ eps_s^2 + eps_z^2 + 2 nu eps_s eps_z + (1 - nu)/2 gamma^2 ] ds dz ,   B = 12 D / delta_0^2
    chi_s = W_ss + W / R_p^2 ,   chi_z = W_zz ,   chi_sz = W_sz - V_z / R_p

On the grid of the petal `W` and `V` are at the nodes and `U` is at the centres of the cells. Then each strain is a
central difference in its own place: `eps_s`, `eps_z` in the middle of the cells along the petal at each station,
`gamma` at each node along the petal in the middle of the cells along the shaft, twist at the centres of the cells.
Where these strains vanish, the deflections of a developable surface are left and nothing less: nothing locks as the
petal becomes thin.

At free sides there is no membrane force across, so that `eps_z = -nu eps_s`; at the free edge there is no shear force.
The root holds `V` and `U`, and at a plane of symmetry `U` vanishes. In 2-D there is one station, and what depends on
the place along the shaft is left out: `eps_s` alone remains (M5).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.quadrature import trapezoid
from petalfoil.physics.shell import PetalShell, neighbour_differences

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StretchingPetal:
    """One petal that bends and stretches. Its unknowns are `W`, `V` at all nodes, `U` at all cells, the root included.

    Attributes
    ----------
    shell : PetalShell
        The petal that only bends, with its grid.
    membrane : float
        Membrane stiffness `B` [N/m].
    """

    shell: PetalShell
    membrane: float

    @property
    def n_z(self) -> int:
        """Stations along the shaft."""
        return len(self.shell.axial.z)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Number of values of `W`, `V`, `U`, those at the root included."""
        n = len(self.shell.phi)
        return n * self.n_z, n * self.n_z, (n - 1) * (self.n_z - 1)

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Values that the root leaves free, (sum of sizes,)."""
        keep = np.ones(sum(self.sizes), dtype=bool)
        keep[: self.n_z] = keep[self.sizes[0] : self.sizes[0] + self.n_z] = False
        return keep

    # ------------------------------------------------------------------------------------------ grid

    @cached_property
    def _arc(self) -> Array:
        """Length of each cell along the petal [m]."""
        return np.asarray(self.shell.metric_radius * np.diff(self.shell.phi))

    @cached_property
    def _along_shaft(self) -> Array:
        """Length of each cell along the shaft [m]."""
        return np.diff(self.shell.axial.z)

    @cached_property
    def _sides(self) -> NDArray[np.bool_]:
        """Stations that are free sides, (n_z,)."""
        sides = np.zeros(self.n_z, dtype=bool)
        if not self.shell.axial.is_2d:
            sides[0], sides[-1] = True, not self.shell.axial.half
        return sides

    # ------------------------------------------------------------------------------------------ energy

    @cached_property
    def difference(self) -> sp.csr_array:
        """Matrix from (`W`, `V`, `U`) to differences and sums of neighbours, entries +-1.

        In this order: those of bending, sums of `W` along the petal, differences of `V` along the petal and along the
        shaft, of `U` likewise, `U` itself.
        """
        n, m = len(self.shell.phi), self.n_z
        along, across, along_u, across_u = (neighbour_differences(count) for count in (n, m, n - 1, m - 1))
        blocks = [
            [self.shell.difference, None, None],
            [_over_grid(abs(along), m), None, None],
            [None, _over_grid(along, m), None],
            [None, _at_each(n, across), None],
            [None, None, _over_grid(along_u, m - 1)],
            [None, None, _at_each(n - 1, across_u)],
            [None, None, sp.eye_array((n - 1) * (m - 1))],
        ]
        return sp.csr_array(sp.block_array(blocks, format="csr"))

    @cached_property
    def strain(self) -> sp.csr_array:
        """Matrix from `difference` to the strains: those of bending, `eps_s`, `eps_z`, `gamma`."""
        by_V, by_U, at_root = self._sheared
        blocks = [
            [self.shell.strain, None, None, self._twist_by_V, None, None, None],
            [None, self._bowed, self._stretched, None, None, None, None],
            [None, None, None, None, None, *self._stretched_along_shaft],
            [None, None, None, by_V, by_U, None, at_root],
        ]
        return sp.csr_array(sp.block_array(blocks, format="csr"))

    @cached_property
    def rigidity_matrix(self) -> sp.csr_array:
        """Moments and membrane forces from strains, quadrature weights included."""
        B, nu = self.membrane, self.shell.poisson_ratio
        axial, arc = self.shell.axial, self._arc
        area = arc[:, None] * axial.weight
        inside, side = (np.where(where, area, 0.0).ravel() for where in (~self._sides, self._sides))
        along = sp.diags_array(B * (inside + (1.0 - nu**2) * side))
        across, coupling = sp.diags_array(B * inside), sp.diags_array(B * nu * inside)
        sheared = trapezoid(self.shell.phi) * self.shell.metric_radius
        shear = 0.5 * B * (1.0 - nu) * axial.copies * np.multiply.outer(sheared, self._along_shaft).ravel()
        blocks = [
            [self.shell.rigidity_matrix, None, None, None],
            [None, along, coupling, None],
            [None, coupling, across, None],
            [None, None, None, sp.diags_array(shear)],
        ]
        return sp.csr_array(sp.block_array(blocks, format="csr"))

    @property
    def _bowed(self) -> sp.csr_array:
        """`eps_s` by the sums of `W`."""
        cells = len(self._arc) * self.n_z
        return sp.csr_array(sp.diags_array(np.full(cells, 0.5 / self.shell.bend_radius)))

    @property
    def _stretched(self) -> sp.csr_array:
        """`eps_s` by the differences of `V` along the petal."""
        return sp.csr_array(sp.diags_array(np.repeat(1.0 / self._arc, self.n_z)))

    @property
    def _twist_by_V(self) -> sp.csr_array:
        """Strains of bending by the differences of `V` along the shaft: twist at the centres of the cells."""
        n, m = len(self.shell.phi), self.n_z
        by_length = sp.diags_array(-0.5 / (self.shell.bend_radius * self._along_shaft), shape=(m - 1, m - 1))
        at_centres = sp.kron(abs(neighbour_differences(n)), by_length)
        rows = self.shell.strain.shape[0] - (n - 1) * (m - 1)
        return sp.csr_array(sp.vstack([sp.csr_array((rows, n * (m - 1))), at_centres], format="csr"))

    @property
    def _stretched_along_shaft(self) -> tuple[sp.csr_array, sp.csr_array]:
        """`eps_z` by the differences of `U` along the shaft, and by `U` itself beside a plane of symmetry."""
        cells, m = len(self._arc), self.n_z
        between = 2.0 / (self._along_shaft[:-1] + self._along_shaft[1:])
        inner = sp.diags_array(between, offsets=-1, shape=(m, max(m - 2, 0)))
        mirrored = sp.lil_array((m, m - 1))
        if self.shell.axial.half:
            mirrored[m - 1, m - 2] = -2.0 / self._along_shaft[-1]
        return _at_each(cells, inner), _at_each(cells, mirrored)

    @property
    def _sheared(self) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array]:
        """`gamma` by the differences of `V` along the shaft, of `U` along the petal, and by `U` itself at the root."""
        n, cells = len(self.shell.phi), self.n_z - 1
        held = np.append(np.ones(n - 1), 0.0)  # no shear force at the free edge
        by_V = np.multiply.outer(held, 1.0 / self._along_shaft).ravel()
        between = sp.diags_array(2.0 / (self._arc[:-1] + self._arc[1:]), offsets=-1, shape=(n, n - 2))
        root = sp.coo_array(([2.0 / self._arc[0]], ([0], [0])), shape=(n, n - 1))
        by_V_rows = sp.diags_array(by_V, shape=(n * cells, n * cells))
        return sp.csr_array(by_V_rows), _over_grid(between, cells), _over_grid(root, cells)

    # ------------------------------------------------------------------------------------------ answers

    def membrane_force(self, displacement: Array) -> Array:
        """Force along the petal over the width in the middle of the cells, from all displacements; (n - 1, n_z) [N/m].

        `displacement` are (`W`, `V`, `U`), the root included [m].
        """
        first = self.shell.strain.shape[0]
        along = slice(first, first + len(self._arc) * self.n_z)
        force = (self.rigidity_matrix[along] @ (self.strain @ (self.difference @ displacement))).reshape(-1, self.n_z)
        return np.asarray(force / (self._arc[:, None] * self.shell.axial.weight))

    def free_motions(self) -> tuple[Array, Array]:
        """Motions without energy when the root is released, and the force of the root, as those of `PetalShell`.

        In them the petal moves along itself as it must: `eps_s = 0`.
        """
        bends, _ = self.shell.free_motions()
        n, m = len(self.shell.phi), self.n_z
        W = bends.reshape(n, m, -1)
        step = -0.5 * (self._arc / self.shell.bend_radius)[:, None, None] * (W[:-1] + W[1:])
        V = np.concatenate([np.zeros_like(W[:1]), np.cumsum(step, axis=0)])
        still = np.zeros((self.sizes[2], W.shape[-1]))
        root = np.zeros(sum(self.sizes))
        root[:m] = 1.0
        strained = self.strain @ (self.difference @ root)
        rows = self.difference.T @ (self.strain.T @ (self.rigidity_matrix.T @ strained))
        motions = np.concatenate([bends, V.reshape(n * m, -1), still])
        return motions, np.outer(W[0, 0], rows)


def _over_grid(along: sp.csr_array, stations: int) -> sp.csr_array:
    """A matrix along the petal at each of `stations`."""
    return sp.csr_array(sp.kron(along, sp.eye_array(stations), format="csr"))


def _at_each(nodes: int, across: sp.csr_array) -> sp.csr_array:
    """A matrix along the shaft at each of `nodes`."""
    return sp.csr_array(sp.kron(sp.eye_array(nodes), across, format="csr"))
