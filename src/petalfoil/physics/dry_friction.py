"""Coulomb friction between petals and between petals and bushing (D1)-(D3).

When a petal bends, its cross-sections turn. Its faces, at half the thickness from the middle surface, move along the
arc by `-+ delta/2 W_phi / r_m`. Two petals in contact slip by the sum of both motions. A petal slips on the bushing by
its own motion.

    s = B W                                                            slip                             (D1)
    T = clip(T_0 + mu N_0 / s_f (s - s_0), -mu N, mu N)                friction force against the slip  (D2)
    force on the petals = -B^T T,  dissipated energy = int T ds

`s_0`, `T_0` and `N_0` are slip, friction force and normal force at the start of the step. `s_f` is the slip over which
friction builds up. For `s_f -> 0` the law is Coulomb's. Slip is evaluated in the cells between nodes: central
differences at nodes would give friction forces that alternate from node to node. The normal force `N` of a cell is half
of the reactions of its two nodes; the outermost nodes have one cell and load it with their whole reaction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.pack import PackMesh
from petalfoil.sparsity import at_stations, block_diagonal, compressed, repeated

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Friction:
    """Coulomb friction in `k` sliding cells, between `n` deflection unknowns and `m` gaps.

    Attributes
    ----------
    coefficient : float
        Friction coefficient `mu` [1].
    stiffness : (k,) array
        Stiffness of a sticking cell, `mu N_0 / s_f`, in this step.
    slip : (k, n) sparse
        `B`, derivative of the slip with respect to the deflection unknowns [1].
    reaction_share : (k, m) sparse
        Part of the reaction of each gap that loads each cell [1].
    width : float
        `s_f`, in the unit of deflection.
    compliance : (k, k) array or None
        `C`, slip that friction forces take back by stretching the petals (M4); None where nothing stretches, or where
        tangential displacements are unknowns.
    exact : bool
        The law has no width (M6): petals that slide along themselves give enough.
    directions : int
        Directions of slip at each contact: cells are those of all contacts along the petals, then, where there are two,
        those along the shaft.
    """

    coefficient: float
    stiffness: Array
    slip: sp.csr_array
    reaction_share: sp.csr_array
    width: float
    compliance: Array | None = None
    exact: bool = False
    directions: int = 1

    def in_step(self, lam: Array) -> Friction:
        """The friction law in a step that starts with the reactions `lam` (m,)."""
        return replace(self, stiffness=self.coefficient * self.normal(lam) / self.width)

    def normal(self, lam: Array) -> Array:
        """Normal forces `N` of the cells from the reactions `lam` (m,); (k,)."""
        normal: Array = self.reaction_share @ np.maximum(lam, 0.0)
        return normal

    @property
    def flexibility(self) -> Array:
        """Slip by the forces of sticking cells that carry load: of the contacts and of the petals, (k, k)."""
        own = np.diag(1.0 / self.stiffness)
        return own if self.compliance is None else own + self.compliance

    def magnitude(self, slip: NDArray[Any]) -> Array:
        """Size of the slip of each cell's contact, of both its directions together, (k,); (E11)."""
        size: Array = np.abs(slip)
        if self.directions == 1:
            return size
        return np.tile(np.linalg.norm(size.reshape(self.directions, -1), axis=0), self.directions)

    def over_directions(self, columns: NDArray[Any]) -> NDArray[Any]:
        """Sum of the columns (j, k) of each contact, at all its cells, (j, k)."""
        if self.directions == 1:
            return columns
        each = columns.reshape(len(columns), self.directions, -1)
        return np.tile(each.sum(axis=1), (1, self.directions))

    def among(self, cells: NDArray[np.intp]) -> Friction:
        """The law in some of the cells."""
        compliance = None if self.compliance is None else self.compliance[np.ix_(cells, cells)]
        return replace(
            self,
            stiffness=self.stiffness[cells],
            slip=self.slip[cells],
            reaction_share=self.reaction_share[cells],
            compliance=compliance,
        )

    def force(self, slip: Array, before: tuple[Array, Array], normal: Array) -> tuple[Array, Array]:
        """Friction force `T` and its derivative with respect to the slip (D2), (k,) each.

        Parameters
        ----------
        slip : (k,) array
            Slip now.
        before : pair of (k,) arrays
            Slip and friction force at the start of the step.
        normal : (k,) array
            Normal forces `N`.
        """
        (slip_0, force_0), limit = before, self.coefficient * np.maximum(normal, 0.0)
        trial = force_0 + self.stiffness * (slip - slip_0)
        stuck = np.abs(trial) <= limit  # a cell that has slipped sticks again when the slip reverses
        return np.clip(trial, -limit, limit), np.where(stuck & (limit > 0.0), self.stiffness, 0.0)


def petal_slip(mesh: PackMesh, arm: Array, first: int) -> tuple[sp.csr_array, sp.csr_array]:
    """Slip matrix `B` and reaction weights, for the cells on the bushing, then those between petals.

    Parameters
    ----------
    mesh : PackMesh
        Grid of the pack.
    arm : (count,) array
        Half the thickness of each petal over its metric radius, `delta / (2 r_m)` [1].
    first : int
        Index of the first gap on the bushing. The gaps between petals follow those on the bushing.
    """
    count, n_z, N = mesh.count, mesh.n_z, mesh.cells
    cells = np.arange(count * (mesh.n_node - 1) * n_z).reshape(count, -1, n_z)
    along = at_stations(slopes(mesh.phi), n_z)[:, n_z:]  # roots do not move
    slope = block_diagonal([one * along for one in arm])
    above, below = cells[:, N:], cells[np.arange(1, count + 1) % count, : cells.shape[1] - N]
    slip = sp.vstack([slope[cells[:, :N].ravel()], slope[above.ravel()] + slope[below.ravel()]], format="csr")
    # gaps on the bushing exist at the inner nodes of its cells only, gaps between petals at all nodes of theirs
    on_bushing, between = halves(N + 1)[:, 1:-1], halves(cells.shape[1] - N + 1)
    weights = block_diagonal([repeated(at_stations(part, n_z), count) for part in (on_bushing, between)])
    on_journal = sp.csr_array((weights.shape[0], first))
    return sp.csr_array(slip), sp.csr_array(sp.hstack([on_journal, weights], format="csr"))


def slopes(phi: Array) -> sp.csr_array:
    """Derivative in the cells between the nodes `phi` (n,), shape (n - 1, n)."""
    each = 1.0 / np.diff(phi)
    return beside_cells(-each, each)


def halves(n: int) -> sp.csr_array:
    """Parts of `n` nodal reactions in the cells between the nodes, shape (n - 1, n): halves, at the ends the whole."""
    own, next_one = np.full(n - 1, 0.5), np.full(n - 1, 0.5)
    own[0], next_one[-1] = 1.0, 1.0
    return beside_cells(own, next_one)


def beside_cells(behind: Array, ahead: Array) -> sp.csr_array:
    """Weights (n - 1,) of the nodes behind and ahead of each cell between `n` nodes, shape (n - 1, n)."""
    n, data = len(behind) + 1, np.stack([behind, ahead], axis=1).ravel()
    cols = (np.arange(n - 1)[:, None] + np.arange(2)).ravel()
    return compressed(sp.csr_array, data, cols, np.arange(0, 2 * n, 2), (n - 1, n))


def equivalent_stiffness(stiffness: Array, limit: Array, amplitude: Array) -> tuple[Complex, Complex]:
    """Complex stiffness of the friction by harmonic balance (E10), and its derivative by `ln A`, (k,) each.

    It is the fundamental harmonic of the friction force over that of the slip. Its imaginary part times `pi A^2` is the
    area of the hysteresis loop, `4 mu N (A - mu N / k)`.

    Parameters
    ----------
    stiffness : (k,) array
        Stiffness `k` while sticking.
    limit : (k,) array
        Slip limit `mu N`, constant over the cycle.
    amplitude : (k,) array
        Slip amplitude `A`.
    """
    slides = stiffness * amplitude > limit
    elastic = np.divide(limit, stiffness * amplitude, out=np.ones_like(limit), where=slides)  # r = mu N / (k A)
    turn = np.arccos(1.0 - 2.0 * elastic)
    equivalent = (turn - 0.5 * np.sin(2.0 * turn)) / np.pi + 4.0j / np.pi * elastic * (1.0 - elastic)
    by_elastic = 8.0 / np.pi * np.sqrt(elastic * (1.0 - elastic)) + 4.0j / np.pi * (1.0 - 2.0 * elastic)
    return stiffness * equivalent, np.where(slides, -stiffness * elastic * by_elastic, 0.0)  # dr / d(ln A) = -r
