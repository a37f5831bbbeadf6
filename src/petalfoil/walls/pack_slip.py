"""Slip at the contact points of a pack of Hermite elements, 2-D: turning and sliding of both faces (D1), (M2).

A contact of petal `l` with the one below joins the outer face of `l` and the inner face of `l + 1`; one on the bushing
has the outer face alone. With the unknowns of the pack and the friction forces `T` of all contacts

    s = B w - C T                                                                                            (M4)

A friction force loads the petals by `- B^T T`. Every contact has an outer face at a place of its own: `C` is positive
definite, and petals that stick are as stiff as their membranes, not stiffer.

A journal that turns drags the inner faces that it touches along. What it does to the petals is known from the motion
`D w` of these faces (D6).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.asperity_contact import ContactSamples, DraggedSamples
from petalfoil.physics.gap_curves import ContactPoints, Facing
from petalfoil.physics.petal_sliding import (
    INNER,
    OUTER,
    FacePlaces,
    face_compliance,
    face_compliance_by_place,
    face_slip,
    face_slip_by_place,
    slide_by_integral,
)
from petalfoil.walls.element_pack import ElementPack

Array = NDArray[np.float64]
Index = NDArray[np.intp]


def touching_faces(pack: ElementPack, points: ContactPoints) -> tuple[Index, FacePlaces]:
    """Contact of each face that touches bushing or petal, and its place; contacts on the journal slip on no petal."""
    n, curves, facing = pack.mesh.count, pack.curves, list(pack.nodes)
    element, place = curves.locate(points.every_curve, points.every_position)
    element = element - curves.first[points.every_curve]
    kind, above = np.divmod(points.every_curve, n)
    first = np.array([nodes.start for nodes in pack.nodes.values()])[kind]
    outer = np.flatnonzero(kind != facing.index(Facing.JOURNAL))
    inner = np.flatnonzero(kind == facing.index(Facing.PETAL))
    return np.concatenate([outer, inner]), FacePlaces(
        petal=np.concatenate([above[outer], (above[inner] + 1) % n]),
        element=np.concatenate([(first + element)[outer], element[inner]]),
        place=np.concatenate([place[outer], place[inner]]),
        side=np.concatenate([np.full(len(outer), OUTER), np.full(len(inner), INNER)]),
    )


def faces_on_journal(pack: ElementPack, points: ContactPoints) -> tuple[Index, FacePlaces]:
    """Contact of each inner face that touches the journal, and its place."""
    curves, contact = pack.curves, np.flatnonzero(points.every_curve < pack.mesh.count)
    petal = points.every_curve[contact]
    element, place = curves.locate(petal, points.every_position[contact])
    element = element + pack.nodes[Facing.JOURNAL].start - curves.first[petal]
    return contact, FacePlaces(petal, element, place, np.full(len(contact), INNER))


def slip_rows(pack: ElementPack, points: ContactPoints) -> sp.csr_array:
    """`B`: slip at all contact points from the unknowns, (j, n) [1]; rows of contacts on the journal are empty."""
    contact, at = touching_faces(pack, points)
    rows = face_slip(pack.faces, at, pack.elements.element_angle)
    return of_contacts(pack, rows, (contact, at), len(points.reaction))


def slip_by_place(pack: ElementPack, points: ContactPoints) -> sp.csr_array:
    """Derivative of `slip_rows` by the place of each contact, counted in elements; (j, n) [1]."""
    contact, at = touching_faces(pack, points)
    rows = face_slip_by_place(pack.faces, at, pack.elements.element_angle)
    return of_contacts(pack, rows, (contact, at), len(points.reaction))


def dragged_faces(pack: ElementPack, points: ContactPoints) -> tuple[sp.csr_array, sp.csr_array]:
    """`D`: motion of the inner faces along the journal at all contact points, from the unknowns, (j, n) [1] (D6).

    And its derivative by the place in the element. Rows of contacts elsewhere are empty. Petals that do not slide by
    themselves move along themselves as they bend.
    """
    contact, at = faces_on_journal(pack, points)
    faces, angle = replace(pack.faces, slides=True), pack.elements.element_angle
    own = face_slip(faces, at, angle), face_slip_by_place(faces, at, angle)
    value, by_place = (of_contacts(pack, rows, (contact, at), len(points.reaction)) for rows in own)
    return value, by_place


def dragged_samples(pack: ElementPack, samples: ContactSamples, friction: float) -> DraggedSamples:
    """The same at the samples of contact pressures, times the coefficient of `friction` [1] (D6)."""
    faces = replace(pack.faces, slides=True)
    on_journal = np.flatnonzero(samples.curve < pack.mesh.count)
    petal = samples.curve[on_journal]
    element = pack.nodes[Facing.JOURNAL].start + samples.element[on_journal] - pack.curves.first[petal]
    inner, angle = np.full(len(petal), INNER), pack.elements.element_angle[element]
    start = FacePlaces(petal, element, np.zeros(len(petal)), inner)
    along = friction * slide_by_integral(faces, petal, inner)
    slid = along[:, None] * hermite.integrals(element, start.place, pack.elements.element_angle)
    before = from_unknowns(pack, sp.csr_array(slid), (on_journal, start), len(samples.element))
    turn, slide = (basis(samples.place) for basis in (partial(hermite.basis, derivative=1), hermite.integral_basis))
    within = np.zeros_like(samples.rows)
    arm = friction * faces.arm[petal] / angle
    within[on_journal] = arm[:, None, None] * turn + (along * angle)[:, None, None] * slide
    within[on_journal, :, 1::2] *= angle[:, None, None]
    return DraggedSamples(within, before)


def of_contacts(pack: ElementPack, of_faces: Array, where: tuple[Index, FacePlaces], count: int) -> sp.csr_array:
    """Rows of faces (f, 2 n_node), each of its own petal, summed at their few contacts from the unknowns, (count, n).

    Dense until the end: SciPy's checks of small matrices took longer than all sums.
    """
    (contact, at), petals = where, pack.mesh.count
    rows = np.zeros((count, petals, of_faces.shape[1]))
    np.add.at(rows, (contact, at.petal), of_faces)
    return sp.csr_array((pack.nodal.T @ rows.reshape(count, petals * of_faces.shape[1]).T).T)


def from_unknowns(
    pack: ElementPack, of_faces: sp.csr_array, where: tuple[Index, FacePlaces], count: int
) -> sp.csr_array:
    """Rows of faces (f, 2 n_node), each of its own petal, summed at their contacts from the unknowns, (count, n)."""
    (contact, at), own = where, of_faces.tocoo()
    columns = 2 * len(pack.elements.phi) * at.petal[own.row] + own.col
    shape = (count, pack.nodal.shape[0])
    return sp.csr_array(sp.coo_array((own.data, (contact[own.row], columns)), shape=shape).tocsr() @ pack.nodal)


def slip_compliance(pack: ElementPack, points: ContactPoints) -> Array:
    """`C`: slip that friction forces take back by stretching the petals, (j, j) [m/N]."""
    contact, at = touching_faces(pack, points)
    of_faces = face_compliance(pack.faces, at, pack.elements.element_angle, pack.mesh.axial.length)
    return at_contacts(of_faces, contact, len(points.reaction))


def slip_compliance_by_place(pack: ElementPack, points: ContactPoints) -> Array:
    """Derivative of `slip_compliance` by the place of the first contact of each pair, in elements, (j, j) [m/N]."""
    contact, at = touching_faces(pack, points)
    of_faces = face_compliance_by_place(pack.faces, at, pack.elements.element_angle, pack.mesh.axial.length)
    return at_contacts(of_faces, contact, len(points.reaction))


def at_contacts(of_faces: Array, contact: Index, count: int) -> Array:
    """Pairs of faces (f, f) summed at the pairs of their contacts, (count, count)."""
    out = np.zeros((count, count))
    np.add.at(out, (contact[:, None], contact), of_faces)
    return out


def stretched_along(pack: ElementPack, points: ContactPoints, force: Array) -> Array:
    """How far friction forces `force` (j,) [N] move the nodes of the pack along their petals, roots apart (M2).

    Shape (count, n_node - 1) [m].
    """
    contact, at = touching_faces(pack, points)
    faces = pack.faces
    pulls = -faces.share(at.petal, at.side) * force[contact]
    reached = np.minimum(pack.mesh.phi[1:, None], pack.elements.angle_at(at.element, at.place)) * pulls  # (node, face)
    own = at.petal[:, None] == np.arange(pack.mesh.count)
    over = faces.metric_radius / (faces.membrane * pack.mesh.axial.length)
    return np.asarray(over[:, None] * (reached @ own).T)


def membrane_of_pulls(pack: ElementPack, points: ContactPoints, friction: Array, drag: Array) -> Array:
    """Membrane force over the width at all nodes of the pack: what pulls at the petal from there to its free edge (M2).

    `friction` (j,) are the friction forces between petals and on the bushing, `drag` (j,) those of a journal that turns
    on the faces that it touches [N]; shape (count, n_node) [N/m].
    """
    (contact, at), (touched, inner) = touching_faces(pack, points), faces_on_journal(pack, points)
    faces = pack.faces
    pulls = -faces.share(at.petal, at.side) * friction[contact], faces.share(inner.petal, inner.side) * drag[touched]
    force = np.zeros((pack.mesh.count, len(pack.mesh.phi)))
    for face, pull in zip((at, inner), pulls, strict=True):
        angle = pack.elements.angle_at(face.element, face.place)
        beyond = np.where(angle[:, None] >= pack.mesh.phi, pull[:, None], 0.0)  # (face, node)
        np.add.at(force, face.petal, beyond)
    return np.asarray(force / pack.mesh.axial.length)
