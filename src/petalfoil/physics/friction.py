"""Dry friction where petals slide on each other and on the bushing (D1)-(D3).

A petal that bends turns, and its faces, half a thickness from the middle, move along it by `-+ delta/2 W_phi / r_m`:
two petals in contact slide over each other by the sum, a petal slides over the bushing by its own part.

    s = B W                                                            slip                         (D1)
    T = clip(T_0 + mu N_0 / s_f (s - s_0), -mu N, mu N)                force against it             (D2)
    force on the petals = -B^T T,  energy lost = int T ds

Coulomb's law where the width `s_f` of the stick goes to zero, the slip in which friction builds up on any grid.
`s_0`, `T_0` and `N_0` are slip, force and reaction before the step. Slip is taken between nodes (at nodes, by central
differences, forces alternate from node to node); a node's reaction presses on the cells on both sides of it in halves,
the last one's on its only one: `N`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.package import PackageMesh

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Friction:
    """Coulomb friction on some gaps.

    Attributes
    ----------
    coefficient : float
        `mu` [1].
    stiffness : (k,) array
        `mu N_0 / s_f`, of the stick, in this step.
    slip : (k, n) sparse
        `B`, slip by the deflection unknowns [1].
    share : (k, m) sparse
        Share of each gap's reaction that presses where it slides [1].
    width : float
        `s_f`, in the unit of deflection.
    """

    coefficient: float
    stiffness: Array
    slip: sp.csr_array
    share: sp.csr_array
    width: float

    def sticking(self, lam: Array) -> Friction:
        """The law in a step that begins with the reactions `lam` (m,)."""
        return replace(self, stiffness=self.coefficient * self.normal(lam) / self.width)

    def normal(self, lam: Array) -> Array:
        """`N` from all reactions, (k,)."""
        pressed: Array = self.share @ np.maximum(lam, 0.0)
        return pressed

    def force(self, slip: Array, before: tuple[Array, Array], normal: Array) -> tuple[Array, Array]:
        """`T` and its derivative by the slip (D2), (k,), from slip and force before; `normal` are the reactions."""
        (slip_0, force_0), limit = before, self.coefficient * np.maximum(normal, 0.0)
        trial = force_0 + self.stiffness * (slip - slip_0)
        stuck = np.abs(trial) <= limit  # a contact that has slipped sticks first when it is moved anew
        return np.clip(trial, -limit, limit), np.where(stuck & (limit > 0.0), self.stiffness, 0.0)


def petal_slip(mesh: PackageMesh, arm: float, first: int) -> tuple[sp.csr_array, sp.csr_array]:
    """`B` by the free deflections, and the share of each gap's reaction, for cells on the bushing and between petals.

    Parameters
    ----------
    mesh : PackageMesh
        Grid of the package.
    arm : float
        Half a thickness over the metric radius, `delta / (2 r_m)` [1].
    first : int
        Number of the first gap on the bushing: those between petals follow.
    """
    count, n_z, N = mesh.count, mesh.n_z, mesh.cells
    cells = np.arange(count * (mesh.n_node - 1) * n_z).reshape(count, -1, n_z)
    along = sp.kron(slopes(mesh.phi), sp.eye_array(n_z), format="csr")
    slope = sp.csr_array(sp.kron(sp.eye_array(count), along[:, n_z:], format="csr"))  # roots do not move
    above, below = cells[:, N:], cells[np.arange(1, count + 1) % count, : cells.shape[1] - N]
    slip = sp.vstack([slope[cells[:, :N].ravel()], slope[above.ravel()] + slope[below.ravel()]], format="csr")
    # gaps on the bushing are between its cells; between petals both ends are gaps too
    on_bushing, between = halves(N + 1)[:, 1:-1], halves(cells.shape[1] - N + 1)
    parts = [sp.kron(sp.kron(sp.eye_array(count), part), sp.eye_array(n_z)) for part in (on_bushing, between)]
    share = sp.block_diag(parts, format="csr")
    before = sp.csr_array((share.shape[0], first))
    return sp.csr_array(arm * slip), sp.csr_array(sp.hstack([before, share], format="csr"))


def slopes(phi: Array) -> sp.csr_array:
    """Derivative in the cells between nodes `phi` (n,), (n - 1, n)."""
    n, each = len(phi), 1.0 / np.diff(phi)
    return sp.csr_array(sp.diags_array([-each, each], offsets=[0, 1], shape=(n - 1, n)))


def halves(n: int) -> sp.csr_array:
    """Share of the reactions of `n` nodes in the cells between them, (n - 1, n): halves, but for the ends."""
    share = sp.lil_array(sp.diags_array([0.5, 0.5], offsets=[0, 1], shape=(n - 1, n)))
    share[0, 0], share[n - 2, n - 1] = 1.0, 1.0
    return sp.csr_array(share)


def equivalent_stiffness(stiffness: Array, limit: Array, amplitude: Array) -> tuple[Complex, Complex]:
    """Fundamental harmonic of the friction over that of the slip (E10), and its derivative by `ln A`, (k,).

    Its imaginary part times `pi A^2` is the area of the loop, `4 mu N (A - mu N / k)`.

    Parameters
    ----------
    stiffness : (k,) array
        `k`, of the stick.
    limit : (k,) array
        `mu N`, constant over the cycle.
    amplitude : (k,) array
        `A`, of the slip.
    """
    slid = stiffness * amplitude > limit
    share = np.divide(limit, stiffness * amplitude, out=np.ones_like(limit), where=slid)  # of the slip, springs back
    turn = np.arccos(1.0 - 2.0 * share)
    equivalent = (turn - 0.5 * np.sin(2.0 * turn)) / np.pi + 4.0j / np.pi * share * (1.0 - share)
    by_share = 8.0 / np.pi * np.sqrt(share * (1.0 - share)) + 4.0j / np.pi * (1.0 - 2.0 * share)
    return stiffness * equivalent, np.where(slid, -stiffness * share * by_share, 0.0)
