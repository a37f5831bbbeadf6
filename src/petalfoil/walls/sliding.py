"""A leaf pack whose petals also move in their own surface and stretch.

Behind the deflections of all petals follow their displacements along themselves, `V` at the nodes, and in 3-D those
along the shaft, `U` at the cells (`physics.petal_membrane`). In 2-D nothing but friction acts on `V`: without it the
membrane force is zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.pack import PackMesh
from petalfoil.physics.contact import Contacts
from petalfoil.physics.dry_friction import slopes
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.physics.petal_sliding import INNER, OUTER, Faces
from petalfoil.sparsity import SparseRows
from petalfoil.walls.base import Wall
from petalfoil.walls.elasticity import Elasticity

Array = NDArray[np.float64]
Index = NDArray[np.intp]


def sliding(wall: Wall, mesh: PackMesh, petals: Sequence[StretchingPetal], faces: Faces) -> Wall:
    """`wall` with the displacements of its petals in their own surface among the unknowns."""
    contacts, elasticity = wall.contacts, stretching(petals)
    more = elasticity.difference.shape[1] - wall.n_unknown
    still = sp.csr_array((len(contacts.rest), more))
    motions, support = zip(*(petal.free_motions() for petal in petals), strict=True)
    order, slip = free_order(petals), slip_at_gaps(mesh, faces)
    unslipped = sp.csr_array((slip.shape[0], len(order) - slip.shape[1]))
    return replace(
        wall,
        elasticity=elasticity,
        contacts=replace(contacts, G=SparseRows(sp.hstack([contacts.G, still], format="csr"))),
        free_motions=sp.csr_array(sp.block_diag(motions, format="csr")[order]),
        support=sp.csr_array(sp.block_diag(support, format="csc")[:, order]),
        slip=sp.csr_array(sp.hstack([slip, unslipped], format="csr")),
        axial_slip=None if mesh.axial.is_2d else slip_along_shaft(mesh, faces),
        reaction_share=rubbing_gaps(contacts),
    )


def rubbing_gaps(contacts: Contacts) -> sp.csr_array:
    """Every gap on the bushing and between petals limits the friction at its node."""
    every = sp.eye_array(len(contacts.rest), format="csr")
    return sp.csr_array(every[contacts.bushing.start :])


def stretching(petals: Sequence[StretchingPetal]) -> Elasticity:
    """Elastic energy of all petals, their roots held (M9)."""
    known: dict[int, tuple[sp.csr_array, sp.csr_array, sp.csr_array]] = {}
    for petal in petals:
        if id(petal) not in known:
            known[id(petal)] = petal.difference, petal.strain, petal.rigidity_matrix
    factors = zip(*(known[id(petal)] for petal in petals), strict=True)
    difference, strain, rigidity = (sp.block_diag(parts, format="csc") for parts in factors)
    return Elasticity(*(sp.csr_array(part) for part in (difference[:, free_order(petals)], strain, rigidity)))


def free_order(petals: Sequence[StretchingPetal]) -> Index:
    """Where the unknowns are among the displacements of all petals, petal by petal with their roots, (n,).

    Unknowns are the deflections of all petals, then their displacements along themselves, then those along the shaft.
    """
    kind = np.concatenate([np.repeat(np.arange(3), petal.sizes) for petal in petals])
    free = np.flatnonzero(np.concatenate([petal.free for petal in petals]))
    return free[np.argsort(kind[free], kind="stable")]


def over_whole_length(displacement: Array, mesh: PackMesh) -> Array:
    """Displacements (n,) on half of a length, mirrored over the whole: `U` changes its sign."""
    at_nodes = 2 * mesh.count * (mesh.n_node - 1) * mesh.n_z
    along_shaft = displacement[at_nodes:].reshape(-1, mesh.n_z - 1)
    mirrored = np.concatenate([along_shaft, -along_shaft[:, ::-1]], axis=1)
    return np.concatenate([mesh.axial.whole(displacement[:at_nodes].reshape(-1, mesh.n_z)).ravel(), mirrored.ravel()])


def membrane_force(petals: Sequence[StretchingPetal], displacement: Array) -> Array:
    """Membrane force along the petals over the width at all nodes, of the cells beside each the larger one.

    `displacement` are the unknowns [m]; (petal, node, axial) [N/m].
    """
    whole = np.zeros(sum(sum(petal.sizes) for petal in petals))
    whole[free_order(petals)] = displacement
    each = np.split(whole, np.cumsum([sum(petal.sizes) for petal in petals])[:-1])
    force = np.stack([petal.membrane_force(own) for petal, own in zip(petals, each, strict=True)])
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


def dragged_faces(wall: Wall, mesh: PackMesh, faces: Faces) -> sp.csr_array:
    """Motion of the petals' inner faces along the shaft's surface, on all gaps (D6), (m, n); zero off the journal.

    Petals that do not slide by themselves move along themselves as they bend, `V = -(1 / R_p) int W ds`.
    """
    n_free = mesh.count * (mesh.n_node - 1) * mesh.n_z
    petal = np.repeat(np.arange(mesh.count), mesh.n_node * mesh.n_z)
    nodes = np.arange(len(petal)).reshape(mesh.shape)
    free = np.concatenate([row[1:].ravel() for row in nodes])  # roots do not move
    turned = sp.kron(sp.diags_array(faces.arm), sp.kron(node_slopes(mesh.phi), sp.eye_array(mesh.n_z)), format="csr")
    share = sp.diags_array(1.0 - (faces.half_thickness / faces.bend_radius)[petal])
    at = nodes[:, mesh.exposed].ravel()
    if faces.slides:
        own = sp.hstack([turned[at][:, free], share.tocsr()[at][:, free]])
    else:
        bent = sp.diags_array(-faces.metric_radius / faces.bend_radius)
        along = share @ sp.kron(bent, sp.kron(sums_from_root(mesh.phi), sp.eye_array(mesh.n_z)), format="csr")
        own = (turned + along)[at][:, free]
    moving = sp.diags_array((np.diff(wall.contacts.G.indptr)[wall.contacts.journal] > 0).astype(np.float64))
    held = sp.coo_array(moving @ own)
    if held.shape[1] > wall.n_unknown or held.shape[1] < n_free:
        raise ValueError("a wall without the displacements of its petals")
    rows = held.row + wall.contacts.journal.start
    return sp.coo_array((held.data, (rows, held.col)), shape=(len(wall.contacts.rest), wall.n_unknown)).tocsr()


def sums_from_root(phi: Array) -> sp.csr_array:
    """Integral from the first of the nodes `phi` (n,) by the trapezoidal rule, (n, n) [rad]."""
    step = 0.5 * np.diff(phi)
    each = np.zeros((len(phi), len(phi)))
    for k, width in enumerate(step):
        each[k + 1 :, k] += width
        each[k + 1 :, k + 1] += width
    return sp.csr_array(each)


def slip_along_shaft(mesh: PackMesh, faces: Faces) -> sp.csr_array:
    """Slip along the shaft at the same gaps, from all displacements: faces move by `U -+ delta/2 W_z`.

    `U` at a node is the mean of the cells beside it; the root holds it, and at a plane of symmetry it vanishes.
    """
    turn, at_stations = sp.lil_array(node_slopes(mesh.axial.z)), beside_nodes(mesh.n_z)
    if mesh.axial.half:
        turn[-1], at_stations[-1] = 0.0, 0.0
    at_nodes = beside_nodes(mesh.n_node)
    at_nodes[0] = 0.0
    every = sp.eye_array(mesh.count)
    by_U = sp.kron(every, sp.kron(at_nodes, at_stations), format="csr")
    free = sp.eye_array(mesh.n_node, format="csr")[:, 1:]  # roots do not move
    by_W = sp.kron(sp.diags_array(faces.half_thickness), sp.kron(free, turn), format="csr")
    by_V = sp.csr_array(by_W.shape)
    outer, inner = (sp.csr_array(sp.hstack([by_W, by_V, sign * by_U], format="csr")) for sign in (-1.0, 1.0))
    nodes = np.arange(outer.shape[0]).reshape(mesh.shape)
    above, below = nodes[:, mesh.on_neighbour], np.roll(nodes, -1, axis=0)[:, : mesh.n_node - mesh.cells]
    between = outer[above.ravel()] + inner[below.ravel()]
    return sp.csr_array(sp.vstack([outer[nodes[:, mesh.on_bushing].ravel()], between], format="csr"))


def beside_nodes(n: int) -> sp.lil_array:
    """Mean at nodes of what is in the cells beside them, (n, n - 1)."""
    mean = sp.lil_array(sp.diags_array([0.5, 0.5], offsets=[-1, 0], shape=(n, n - 1)))
    mean[0, 0], mean[n - 1, n - 2] = 1.0, 1.0
    return mean


def node_slopes(phi: Array) -> sp.csr_array:
    """Derivative at the nodes `phi` (n,): the mean of that in the cells beside them, shape (n, n)."""
    return sp.csr_array(beside_nodes(len(phi)).tocsr() @ slopes(phi))
