"""Backing springs behind petals: springs side by side, whose free crowns stand inside the bushing radius.

The crown behind each node that faces a strip has a deflection `V` of its own. The petal rests on the crowns instead
of the rigid bushing, and may leave them:

    g_B = r_m - h_s - r0 - W + V >= 0      phi_s < phi < phi0                                (K2)
    k_b (1 + i gamma) V = lambda_B / area           gamma = 0 at rest                         (B7)

A crown that no petal touches is at rest, `V = 0`. In whirl its loss is that of a bump foil (B5).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Backing
from petalfoil.mesh.pack import PackMesh
from petalfoil.sparsity import SparseRows
from petalfoil.walls.base import Wall
from petalfoil.walls.bump_foil import foundation_stiffness
from petalfoil.walls.elasticity import Elasticity

Array = NDArray[np.float64]


def on_springs(wall: Wall, mesh: PackMesh, backing: Backing, start: float) -> Wall:
    """The foil pack of a wall on backing springs: the crowns' deflections follow those of the petals.

    A contact on springs is spread: its nodes stay nodes, and are no points that travel along a rigid bushing (K5).

    Parameters
    ----------
    wall : Wall
        Petals of `mesh` on a rigid bushing.
    mesh : PackMesh
        Grid of the pack.
    backing : Backing
        The springs.
    start : float
        Angle from the roots at which they begin [rad].
    """
    contacts, n, m = wall.contacts, wall.n_unknown, len(wall.contacts.rest)
    share = np.broadcast_to(covered(mesh, start)[:, None], (mesh.count, mesh.cells - 1, mesh.n_z))
    facing = contacts.bushing.start + np.flatnonzero(share)
    k = len(facing)
    springs = sp.diags_array(foundation_stiffness(backing) * contacts.area[facing] * share[share > 0.0])
    pressed = sp.coo_array((np.ones(k), (facing, np.arange(k))), shape=(m, k))
    rest = contacts.rest.copy()
    rest[facing] -= backing.height
    return replace(
        wall,
        elasticity=with_springs(wall.elasticity, springs),
        contacts=replace(
            contacts,
            G=SparseRows(sp.hstack([contacts.G, pressed], format="csr")),
            rest=rest,
            lines=tuple(line for line in contacts.lines if not np.isin(line.number, facing).any()),
        ),
        free_motions=sp.csr_array(sp.vstack([wall.free_motions, sp.csr_array((k, wall.free_motions.shape[1]))])),
        support=sp.csr_array(sp.hstack([wall.support, sp.csr_array((wall.support.shape[0], k))])),
        slip=sp.csr_array(sp.hstack([wall.slip, sp.csr_array((wall.slip.shape[0], k))])),
        loss=lossy(n, backing.loss_factor * springs) if backing.loss_factor else None,
    )


def covered(mesh: PackMesh, start: float) -> Array:
    """Part of the cell around each node on the bushing that a strip from the angle `start` [rad] on covers; (node,)."""
    phi, facing = mesh.phi, np.arange(mesh.n_node)[mesh.on_bushing]
    before, after = 0.5 * (phi[facing - 1] + phi[facing]), 0.5 * (phi[facing] + phi[facing + 1])
    share: Array = np.clip((after - start) / (after - before), 0.0, 1.0)
    return share


def with_springs(petals: Elasticity, springs: sp.dia_array) -> Elasticity:
    """Elastic energy of the petals and of springs (k, k) [N/m], whose deflections follow theirs."""
    every = sp.eye_array(springs.shape[0])
    pairs = ((petals.difference, every), (petals.strain, every), (petals.rigidity, springs))
    return Elasticity(*(sp.csr_array(sp.block_diag(pair, format="csr")) for pair in pairs))


def lossy(n: int, loss: sp.dia_array) -> sp.csr_array:
    """Loss (k, k) of the springs among all deflections, those of `n` unknowns of the petals first [N/m]."""
    return sp.csr_array(sp.block_diag([sp.csr_array((n, n)), loss], format="csr"))
