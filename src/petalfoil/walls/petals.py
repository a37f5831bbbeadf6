"""A leaf pack: petals between film and bushing that overlap and rest on each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import ClassVar, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case, Edges, Method, ModelKind, Mount, PackGeometry, Petals, PetalTheory
from petalfoil.case.petal_table import Petal
from petalfoil.mesh.pack import PackMesh, pack_mesh
from petalfoil.mesh.splines import monotone
from petalfoil.mesh.strips import exposed_strips
from petalfoil.physics.contact import PetalSizes, pack_contacts
from petalfoil.physics.dry_friction import petal_slip
from petalfoil.physics.forces import node_area
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.physics.petal_sliding import Faces
from petalfoil.physics.shell import PetalShell, bending_stress
from petalfoil.sparsity import block_diagonal
from petalfoil.walls.backing import covered, on_springs
from petalfoil.walls.base import PlacedContacts, Wall, WallState, axial_grid
from petalfoil.walls.between_grids import on_other_grid
from petalfoil.walls.bump_foil import foundation_stiffness
from petalfoil.walls.elasticity import Elasticity
from petalfoil.walls.element_pack import ElementPack, element_pack
from petalfoil.walls.kind import Capability, Fields, Scalars, WallKind
from petalfoil.walls.sliding import dragged_faces, membrane_force, over_whole_length, sliding

Array = NDArray[np.float64]
T = TypeVar("T")

SHELLS = 16
"""Petals that are remembered with their matrices, some 2 MB each in 3-D: results of each point of a curve, and each
journal position, ask for the same."""

REFERENCE_FILM = 1e-5
"""Reference film of a petal bearing [m]: its films are some micrometres to some tens thick."""

FREE_SHAPE_ANGLES = 2001
"""Angles at which the free shape is searched for its height and for where it meets the journal."""


def petals_of(case: Case) -> tuple[Petals, PackGeometry]:
    """The petals of a case that has them, and the geometry that follows."""
    if case.petals is None or case.pack is None:
        raise ValueError("this case has no [petals]")
    return case.petals, case.pack


def build_mesh(case: Case) -> PackMesh:
    """Grid of the foil pack of `case`."""
    petals, pack = petals_of(case)
    return pack_mesh(petals.count, pack.overlap, petals.first_root, case.cells_per_pitch, axial_grid(case))


def build_shells(case: Case, mesh: PackMesh) -> list[PetalShell]:
    """The petals of `case` on `mesh`, one by one; equal ones are the same object."""
    petals, _ = petals_of(case)
    clamped, each = petals.mount is Mount.CLAMPED, list(zip(petals.each, case.packs, strict=True))
    made = {(petal, pack): shell_of(petal, pack, mesh, clamped) for petal, pack in dict.fromkeys(each)}
    return [made[one] for one in each]


@lru_cache(maxsize=SHELLS)
def shell_of(petal: Petal, pack: PackGeometry, mesh: PackMesh, clamped: bool) -> PetalShell:
    """A petal on `mesh`."""
    return PetalShell(
        phi=mesh.phi,
        axial=mesh.axial,
        metric_radius=pack.metric_radius,
        bend_radius=pack.reference_radius,
        rigidity=petal.bending_stiffness,
        poisson_ratio=petal.poisson_ratio,
        clamped=clamped,
    )


def petal_sizes(case: Case, mesh: PackMesh) -> PetalSizes:
    """Free shapes, metric radii and thicknesses of the petals of `case`."""
    free = {pack: pack.free_radius(mesh.phi) for pack in dict.fromkeys(case.packs)}
    return PetalSizes(
        np.stack([free[pack] for pack in case.packs]),
        np.array([pack.metric_radius for pack in case.packs]),
        np.array([pack.thickness for pack in case.packs]),
    )


def petal_faces(case: Case) -> Faces:
    """What the petals of `case` slide on."""
    petals, _ = petals_of(case)
    return Faces(
        half_thickness=np.array([0.5 * pack.thickness for pack in case.packs]),
        metric_radius=np.array([pack.metric_radius for pack in case.packs]),
        bend_radius=np.array([pack.reference_radius for pack in case.packs]),
        membrane=np.array([petal.membrane_stiffness for petal in petals.each]),
        slides=case.petal_theory is PetalTheory.SHELL,
    )


def stretches(case: Case) -> bool:
    """Whether petals stretch: in 3-D by their theory; in 2-D nothing but friction can stretch them."""
    alone = case.model.kind is ModelKind.TWO_D and not (case.surface.petal_friction > 0.0 or case.drags_petals)
    return case.petal_theory is PetalTheory.SHELL and case.model.method is Method.NEWTON and not alone


def stretching_petals(case: Case, shells: list[PetalShell]) -> list[StretchingPetal]:
    """Petals that bend as `shells`, and stretch; equal ones are the same object."""
    petals, made = petals_of(case)[0].each, dict[int, StretchingPetal]()
    for petal, shell in zip(petals, shells, strict=True):
        if id(shell) not in made:
            made[id(shell)] = StretchingPetal(shell, petal.membrane_stiffness)
    return [made[id(shell)] for shell in shells]


def pack_elasticity(shells: list[PetalShell], mesh: PackMesh) -> Elasticity:
    """Elastic energy of all petals, their roots held."""
    free = slice(mesh.n_z, None)
    return Elasticity(
        diagonal(of_each(shells, lambda shell: shell.difference[:, free])),
        diagonal([shell.strain for shell in shells]),
        diagonal([shell.rigidity_matrix for shell in shells]),
    )


def of_each(shells: list[PetalShell], function: Callable[[PetalShell], T]) -> list[T]:
    """What a function gives of each petal, computed once for equal ones."""
    found: dict[int, T] = {}
    for shell in shells:
        if id(shell) not in found:
            found[id(shell)] = function(shell)
    return [found[id(shell)] for shell in shells]


def released(shell: PetalShell, mesh: PackMesh) -> tuple[sp.csr_array, sp.csr_array]:
    """Motions of a petal without bending energy and the root force in each (S4), the root's own row left out."""
    motions, support = shell.free_motions()
    return sp.csr_array(motions[mesh.n_z :]), sp.csr_array(support[:, mesh.n_z :])


def diagonal(parts: Sequence[sp.csr_array]) -> sp.csr_array:
    """The matrix with a block for each petal."""
    return block_diagonal(parts)


class PetalWall(WallKind):
    """The wall of a case with [petals]."""

    name: ClassVar[str] = "petal"
    table: ClassVar[type[Petals]] = Petals
    capabilities: ClassVar[frozenset[Capability]] = frozenset(Capability)
    has_stress: ClassVar[bool] = True

    def build(self, case: Case) -> Wall:
        """Discretise the pack of `case`."""
        mesh = build_mesh(case)
        film = exposed_strips(mesh, continuous=case.model.edges is Edges.CONTINUOUS)
        shells, sizes = build_shells(case, mesh), petal_sizes(case, mesh)
        motions, support = zip(*of_each(shells, lambda shell: released(shell, mesh)), strict=True)
        R_j, h_c, r_m = case.bearing.journal_radius, case.surface.contact_film_thickness, sizes.mean_radius
        slip, reaction_share = petal_slip(mesh, 0.5 * sizes.thickness / sizes.metric_radius, film.unknown.size)
        rest = sizes.free_radius[:, mesh.exposed] - 0.5 * sizes.thickness[:, None] - R_j
        wall = Wall(
            film=film,
            elasticity=pack_elasticity(shells, mesh),
            film_unknown=mesh.free_numbers()[:, mesh.exposed],
            load_area=np.broadcast_to(node_area(film, r_m), film.shape),
            rest_film=np.broadcast_to(rest[:, :, None], film.shape),
            contacts=pack_contacts(mesh, sizes, (R_j, h_c)),
            node_area=r_m * 2.0 * np.pi / mesh.count / mesh.cells * float(mesh.axial.weight.max()),
            reference_film=REFERENCE_FILM,
            free_motions=diagonal(motions),
            support=diagonal(support),
            slip=slip,
            reaction_share=reaction_share,
        )
        if stretches(case):
            wall = sliding(wall, mesh, stretching_petals(case, shells), petal_faces(case))
        if case.drags_petals:
            wall = replace(wall, dragged=dragged_faces(wall, mesh, petal_faces(case)))
        if stretches(case):
            return wall
        return wall if case.backing is None else on_springs(wall, mesh, case.backing, springs_from(case))

    def elements(self, case: Case, wall: Wall) -> ElementPack | None:
        """The pack in Hermite elements, where it is 2-D and on a rigid bushing."""
        if not wall.film.axial.is_2d or case.backing is not None:
            return None
        mesh = build_mesh(case)
        return element_pack(build_shells(case, mesh), mesh, wall, case.model.petal_cells, petal_faces(case))

    def loses_energy(self, case: Case) -> bool:
        """By the loss factor of its backing springs."""
        return case.backing is not None and case.backing.loss_factor > 0.0

    def pitch(self, case: Case) -> float | None:
        """Angle between neighbouring roots [rad]."""
        return petals_of(case)[0].pitch

    def fields(self, case: Case, wall: Wall, state: WallState) -> Fields:
        """Deflection, radii, contact pressures and bending stress."""
        (petals, _), mesh, rows = petals_of(case), build_mesh(case), wall.contacts
        W, pressure, whole = nodal(mesh, state.deflection), state.contact_pressure, mesh.axial.whole
        on_bushing, on_neighbour = np.zeros(mesh.shape), np.zeros(mesh.shape)
        on_bushing[:, mesh.on_bushing] = pressure[rows.bushing].reshape(mesh.count, -1, mesh.n_z)
        on_neighbour[:, mesh.on_neighbour] = pressure[rows.petals].reshape(mesh.count, -1, mesh.n_z)
        shells, stress = build_shells(case, mesh), np.zeros_like(W)
        for one in dict.fromkeys(petals.each):
            mine = [k for k, petal in enumerate(petals.each) if petal == one]
            stress[mine] = bending_stress(shells[mine[0]], W[mine], one.youngs_modulus, one.thickness)
        placed = {} if state.placed is None else self._placed(case, state.placed)
        return {
            **placed,
            **self._stretched(case, mesh, state),
            "journal_contact_pressure": whole(pressure[rows.journal].reshape(mesh.count, -1, mesh.n_z)),
            "deflection": whole(W),
            **self.cross_section(case, state.deflection),
            "bushing_contact_pressure": whole(on_bushing),
            "petal_contact_pressure": whole(on_neighbour),
            "bending_stress": whole(stress),
        }

    def _stretched(self, case: Case, mesh: PackMesh, state: WallState) -> Fields:
        """Stress of the membranes, where petals stretch: by their displacements, or by what pulls between nodes."""
        if not stretches(case):
            return {}
        thickness = np.array([petal.thickness for petal in petals_of(case)[0].each])
        if state.membrane is None:
            force = membrane_force(stretching_petals(case, build_shells(case, mesh)), state.deflection)
        else:
            force = state.membrane[:, :, None]
        stress = force / thickness[:, None, None]
        return {"membrane_stress": mesh.axial.whole(stress)}

    def _placed(self, case: Case, contacts: PlacedContacts) -> Fields:
        """Contacts between nodes; their bending stress is the larger one of the two petals."""
        petals, _ = petals_of(case)
        both = np.stack([contacts.petal, (contacts.petal + 1) % petals.count], axis=1)
        E, nu, delta = (
            np.array([getattr(one, name) for one in petals.each])[both]
            for name in ("youngs_modulus", "poisson_ratio", "thickness")
        )
        stress = E / (1.0 - nu**2) * 0.5 * delta * contacts.curvature
        larger = np.nanargmax(np.abs(stress), axis=1) if len(stress) else np.zeros(0, dtype=np.intp)
        return {
            "contact_petal": contacts.petal.astype(np.float64),
            "contact_facing": contacts.facing.astype(np.float64),
            "contact_angle": contacts.angle,
            "contact_force": contacts.force,
            "contact_bending_stress": np.take_along_axis(stress, larger[:, None], axis=1)[:, 0],
        }

    def over_whole_length(self, case: Case, deflection: Array) -> Array:
        """Displacements of petals that stretch are at nodes and at cells."""
        if not stretches(case):
            return super().over_whole_length(case, deflection)
        return over_whole_length(deflection, build_mesh(case))

    def interpolates(self, case: Case) -> bool:
        """Only of petals that bend: nothing but their nodes has unknowns."""
        return case.backing is None and not stretches(case)

    def interpolated(self, case: Case, to: Case, deflection: Array) -> Array:
        """By monotone cubics along the petals, (n,)."""
        mesh, other = build_mesh(case), build_mesh(to)
        return np.asarray(monotone(mesh.phi, nodal(mesh, deflection), axis=1)(other.phi)[:, 1:].ravel())

    def prolonged(self, case: Case, to: Case, deflection: Array) -> Array:
        """By cubic splines along the petals and along the shaft, (n,)."""
        return on_other_grid(deflection, build_mesh(case), build_mesh(to))

    def coordinates(self, case: Case, wall: Wall) -> Fields:
        """Angle from the root of a petal [rad]."""
        return {"phi": build_mesh(case).phi}

    def cross_section(self, case: Case, deflection: Array) -> Fields:
        """Radius of the mid-surface, free of the mean petal (node,) and deformed of all (..., petal, node, axial) [m].

        With backing springs also their deflection behind the petals, likewise.
        """
        (_, pack), mesh = petals_of(case), build_mesh(case)
        r0 = petal_sizes(case, mesh).free_radius
        radius = mesh.axial.whole(r0[:, :, None] + nodal(mesh, deflection))
        section = {"free_radius": pack.free_radius(mesh.phi), "radius": radius}
        if case.backing is not None:
            section["backing_deflection"] = mesh.axial.whole(crowns(mesh, deflection, springs_from(case)))
        return section

    def scalars(self, fields: Fields) -> Scalars:
        """Maximum bending stress, that at contacts between nodes among it; how far backing springs are pressed in."""
        at_contacts = np.max(np.abs(fields.get("contact_bending_stress", np.zeros(0))), initial=0.0)
        stress = max(float(np.max(np.abs(fields["bending_stress"]))), float(at_contacts))
        found: Scalars = {"max_bending_stress": stress}
        if "membrane_stress" in fields:
            found["max_membrane_stress"] = float(np.max(np.abs(fields["membrane_stress"])))
        if "backing_deflection" in fields:
            found["max_backing_deflection"] = float(np.max(fields["backing_deflection"]))
        return found

    def geometry(self, case: Case) -> Scalars:
        """Thickness of the mean petal, height and start of the springs behind it."""
        sizes: Scalars = {"petal_thickness": petals_of(case)[0].total_thickness}
        if case.backing is not None:
            sizes |= {"backing_height": case.backing.height, "backing_start": case.backing.start}
        return sizes

    def check_scalars(self, case: Case) -> Scalars:
        """Overlap, layers, stiffness, free shape of the mean petal."""
        petals, pack = petals_of(case)
        phi = np.linspace(0.0, pack.petal_angle, FREE_SHAPE_ANGLES)
        r0 = pack.free_radius(phi)
        inner = r0 - 0.5 * pack.thickness - case.bearing.journal_radius
        touching = np.flatnonzero(inner <= 0.0)
        return {
            "overlap": pack.overlap,
            "layers": pack.layers,
            "petal_angle": pack.petal_angle,
            "pitch": pack.pitch,
            "covered_angle": pack.covered_angle,
            "metric_radius": pack.metric_radius,
            "bending_stiffness": petals.bending_stiffness,
            "root_tilt": pack.root_tilt,
            "first_contact_angle": float(phi[touching[0]]) if len(touching) else math.nan,
            "free_petal_height": float(np.max(pack.metric_radius - r0)),
            **({} if case.backing is None else {"foundation_stiffness": foundation_stiffness(case.backing)}),
        }


def nodal(mesh: PackMesh, deflection: Array) -> Array:
    """Deflections (..., n) at all nodes of the petals, zero at the roots; (..., petal, node, axial) [m]."""
    W = np.zeros((*deflection.shape[:-1], *mesh.shape))
    inner = W[..., 1:, :]
    inner[:] = deflection[..., : mesh.count * (mesh.n_node - 1) * mesh.n_z].reshape(inner.shape)  # others are behind
    return W


def springs_from(case: Case) -> float:
    """Angle from a root at which backing springs begin [rad]."""
    return 0.0 if case.backing is None else case.backing.start / case.bearing.bushing_radius


def crowns(mesh: PackMesh, deflection: Array, start: float) -> Array:
    """Deflections (..., n) of backing springs from the angle `start` on, elsewhere zero.

    Shape (..., petal, node, axial) [m].
    """
    V = np.zeros((*deflection.shape[:-1], *mesh.shape))
    behind = np.arange(mesh.n_node)[mesh.on_bushing][covered(mesh, start) > 0.0]
    shape = (*V.shape[:-2], len(behind), mesh.n_z)
    V[..., behind, :] = deflection[..., -mesh.count * len(behind) * mesh.n_z :].reshape(shape)
    return V
