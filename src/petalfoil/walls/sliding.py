"""A leaf pack whose petals also move along themselves and stretch: tangential displacements `V` behind all deflections.

In each cell between two nodes the membrane strain is one number (M1),

    eps = (V_{i+1} - V_i) / (r_m dphi_i) + (W_i + W_{i+1}) / (2 R_p) ,   E_m = 1/2 sum B eps^2 r_m dphi_i omega_z  (M5)

one strain for one further unknown, so that nothing locks. Axial stations stretch each by itself. `V` is zero at the
root; pressure and contacts without friction do not act on it, the membrane force is then zero, and the balance (S4) of
bending alone holds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.pack import PackMesh
from petalfoil.physics.contact import Contacts
from petalfoil.physics.dry_friction import slopes
from petalfoil.physics.petal_sliding import INNER, OUTER, Faces
from petalfoil.sparsity import SparseRows
from petalfoil.walls.base import Wall
from petalfoil.walls.elasticity import Elasticity

Array = NDArray[np.float64]


def sliding(wall: Wall, mesh: PackMesh, faces: Faces) -> Wall:
    """`wall` with the tangential displacements of its petals among the unknowns."""
    contacts, n = wall.contacts, wall.n_unknown
    still = sp.csr_array((len(contacts.rest), n))
    none = sp.csr_array((n, wall.free_motions.shape[1]))
    return replace(
        wall,
        elasticity=stretching(wall.elasticity, mesh, faces),
        contacts=replace(contacts, G=SparseRows(sp.hstack([contacts.G, still], format="csr"))),
        free_motions=sp.csr_array(sp.vstack([wall.free_motions, none], format="csr")),
        support=sp.csr_array(sp.hstack([wall.support, none.T], format="csr")),
        slip=slip_at_gaps(mesh, faces),
        reaction_share=rubbing_gaps(contacts),
    )


def rubbing_gaps(contacts: Contacts) -> sp.csr_array:
    """Every gap on the bushing and between petals limits the friction at its node."""
    every = sp.eye_array(len(contacts.rest), format="csr")
    return sp.csr_array(every[contacts.bushing.start :])


def along_petal(mesh: PackMesh, signs: tuple[float, float]) -> sp.csr_array:
    """Matrix from the nodes of a petal to its cells: `signs` times the values at both ends, (cells, nodes)."""
    n = mesh.n_node
    ends = sp.diags_array([np.full(n - 1, signs[0]), np.full(n - 1, signs[1])], offsets=[0, 1], shape=(n - 1, n))
    return sp.csr_array(sp.kron(ends, sp.eye_array(mesh.n_z), format="csr"))


def of_each(mesh: PackMesh, matrix: sp.csr_array) -> sp.csr_array:
    """A matrix of the nodes of one petal for all, the roots left out."""
    return sp.csr_array(sp.kron(sp.eye_array(mesh.count), matrix[:, mesh.n_z :], format="csr"))


def cell_lengths(mesh: PackMesh, faces: Faces) -> Array:
    """`r_m dphi` of every cell, (count * cells,) [m]."""
    lengths = faces.metric_radius[:, None, None] * np.diff(mesh.phi)[:, None] * np.ones(mesh.n_z)
    return np.asarray(lengths.ravel())


def over_cells(mesh: PackMesh, value: Array) -> Array:
    """One value for each petal (count,) at all of its cells, (count * cells,)."""
    return np.repeat(value, (mesh.n_node - 1) * mesh.n_z)


def membrane(mesh: PackMesh, faces: Faces) -> tuple[Array, Array]:
    """Membrane stiffness of every cell, weights included [N m], and half the curvature of its petal [1/m]."""
    width = np.tile(mesh.axial.weight, mesh.count * (mesh.n_node - 1))
    rigidity = over_cells(mesh, faces.membrane) * cell_lengths(mesh, faces) * width
    return rigidity, over_cells(mesh, 0.5 / faces.bend_radius)


def stretching(bending: Elasticity, mesh: PackMesh, faces: Faces) -> Elasticity:
    """Bending and stretching of all petals (M5)."""
    sums, differences = (of_each(mesh, along_petal(mesh, signs)) for signs in ((1.0, 1.0), (-1.0, 1.0)))
    rigidity, bent = membrane(mesh, faces)
    by_sums, by_differences = sp.diags_array(bent), sp.diags_array(1.0 / cell_lengths(mesh, faces))
    return Elasticity(
        sp.csr_array(sp.block_array([[bending.difference, None], [sums, None], [None, differences]], format="csr")),
        sp.csr_array(sp.block_array([[bending.strain, None, None], [None, by_sums, by_differences]], format="csr")),
        sp.csr_array(sp.block_diag([bending.rigidity, sp.diags_array(rigidity)], format="csr")),
    )


def membrane_force(mesh: PackMesh, faces: Faces, displacement: Array) -> Array:
    """Membrane force over the width at all nodes, of the cells beside each the larger one, (petal, node, axial) [N/m].

    `displacement` are deflections and tangential displacements of all nodes but the roots [m].
    """
    sums, differences = (of_each(mesh, along_petal(mesh, signs)) for signs in ((1.0, 1.0), (-1.0, 1.0)))
    W, V = np.split(displacement, 2)
    strain = over_cells(mesh, 0.5 / faces.bend_radius) * (sums @ W) + (differences @ V) / cell_lengths(mesh, faces)
    force = (over_cells(mesh, faces.membrane) * strain).reshape(mesh.count, mesh.n_node - 1, mesh.n_z)
    before, after = (np.concatenate(pair, axis=1) for pair in ((force[:, :1], force), (force, force[:, -1:])))
    return np.where(np.abs(before) > np.abs(after), before, after)


def slip_at_gaps(mesh: PackMesh, faces: Faces) -> sp.csr_array:
    """Slip at every gap on the bushing and between petals, from deflections and tangential displacements (M4)."""
    count, n_z = mesh.count, mesh.n_z
    nodes = np.arange(count * mesh.n_node * n_z).reshape(mesh.shape)
    petal = np.repeat(np.arange(count), mesh.n_node * n_z)
    turned = sp.kron(sp.diags_array(faces.arm), sp.kron(node_slopes(mesh.phi), sp.eye_array(n_z)), format="csr")
    free = np.concatenate([row[1:].ravel() for row in nodes])  # roots do not move
    outer, inner = (
        sp.csr_array(
            sp.hstack([turned[:, free], sp.diags_array(faces.share(petal, np.full(len(petal), side))).tocsr()[:, free]])
        )
        for side in (OUTER, INNER)
    )
    on_bushing = outer[nodes[:, mesh.on_bushing].ravel()]
    above, below = nodes[:, mesh.on_neighbour], np.roll(nodes, -1, axis=0)[:, : mesh.n_node - mesh.cells]
    return sp.csr_array(sp.vstack([on_bushing, outer[above.ravel()] + inner[below.ravel()]], format="csr"))


def node_slopes(phi: Array) -> sp.csr_array:
    """Derivative at the nodes `phi` (n,): the mean of that in the cells beside them, shape (n, n)."""
    n = len(phi)
    beside = sp.lil_array(sp.diags_array([0.5, 0.5], offsets=[-1, 0], shape=(n, n - 1)))
    beside[0, 0], beside[n - 1, n - 2] = 1.0, 1.0
    return sp.csr_array(beside.tocsr() @ slopes(phi))
