"""A leaf pack: petals between film and bushing that overlap and rest on each other."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case, Edges, Mount, Package, Petals
from petalfoil.mesh.pack import PackMesh, pack_mesh
from petalfoil.mesh.strips import exposed_strips
from petalfoil.physics.contact import pack_contacts
from petalfoil.physics.dry_friction import petal_slip
from petalfoil.physics.forces import node_area
from petalfoil.physics.shell import PetalShell, bending_stress
from petalfoil.walls.base import Wall, WallState, axial_grid
from petalfoil.walls.elasticity import Elasticity
from petalfoil.walls.element_pack import ElementPack, element_pack
from petalfoil.walls.kind import Capability, Fields, Scalars, WallKind

Array = NDArray[np.float64]

REFERENCE_FILM = 1e-5
"""Reference film of a petal bearing [m]: its films are some micrometres to some tens thick."""

FREE_SHAPE_ANGLES = 2001
"""Angles at which the free shape is searched for its height and for where it meets the journal."""


def petals_of(case: Case) -> tuple[Petals, Package]:
    """The petals of a case that has them, and the geometry that follows."""
    if case.petals is None or case.package is None:
        raise ValueError("this case has no [petals]")
    return case.petals, case.package


def build_mesh(case: Case) -> PackMesh:
    """Grid of the package of `case`."""
    petals, package = petals_of(case)
    return pack_mesh(petals.count, package.overlap, petals.first_root, case.cells_per_pitch, axial_grid(case))


def build_shell(case: Case, mesh: PackMesh) -> PetalShell:
    """One petal of `case` on `mesh`."""
    petals, package = petals_of(case)
    return PetalShell(
        phi=mesh.phi,
        axial=mesh.axial,
        metric_radius=package.metric_radius,
        bend_radius=package.bend_radius,
        rigidity=petals.bending_stiffness,
        poisson_ratio=petals.poisson_ratio,
        clamped=petals.mount is Mount.CLAMPED,
    )


def package_elasticity(shell: PetalShell, mesh: PackMesh) -> Elasticity:
    """Elastic energy of all petals, their roots held."""
    every, free = sp.eye_array(mesh.count), slice(mesh.n_z, None)
    parts = (shell.difference[:, free], shell.strain, shell.rigidity_matrix)
    return Elasticity(*(sp.csr_array(sp.kron(every, part, format="csr")) for part in parts))


class PetalWall(WallKind):
    """The wall of a case with [petals]."""

    name: ClassVar[str] = "petal"
    table: ClassVar[type[Petals]] = Petals
    capabilities: ClassVar[frozenset[Capability]] = frozenset(Capability)
    has_stress: ClassVar[bool] = True

    def build(self, case: Case) -> Wall:
        """Discretise the pack of `case`."""
        (petals, package), mesh = petals_of(case), build_mesh(case)
        film = exposed_strips(mesh, continuous=case.model.edges is Edges.CONTINUOUS)
        r_m, r0 = package.metric_radius, package.free_radius(mesh.phi)
        sizes = {
            "journal_radius": case.bearing.journal_radius,
            "metric_radius": r_m,
            "thickness": petals.total_thickness,
            "contact_film_thickness": case.surface.contact_film_thickness,
        }
        free = slice(mesh.n_z, None)  # the root row does not move
        shell, every = build_shell(case, mesh), sp.eye_array(mesh.count)
        motions, support = shell.free_motions()
        slip, reaction_share = petal_slip(mesh, 0.5 * petals.total_thickness / r_m, film.unknown.size)
        rest = r0[mesh.exposed] - 0.5 * petals.total_thickness - case.bearing.journal_radius
        return Wall(
            film=film,
            elasticity=package_elasticity(shell, mesh),
            film_unknown=mesh.free_numbers()[:, mesh.exposed],
            load_area=np.broadcast_to(node_area(film, r_m), film.shape),
            rest_film=np.broadcast_to(rest[None, :, None], film.shape),
            contacts=pack_contacts(mesh, r0, sizes),
            node_area=r_m * 2.0 * np.pi / mesh.count / mesh.cells * float(mesh.axial.weight.max()),
            reference_film=REFERENCE_FILM,
            free_motions=sp.csr_array(sp.kron(every, motions[free], format="csr")),
            support=sp.csr_array(sp.kron(every, support[:, free], format="csr")),
            slip=slip,
            reaction_share=reaction_share,
        )

    def elements(self, case: Case, wall: Wall) -> ElementPack | None:
        """The pack in Hermite elements, where it is 2-D."""
        if not wall.film.axial.is_2d:
            return None
        (petals, package), mesh = petals_of(case), build_mesh(case)
        arm = 0.5 * petals.total_thickness / package.metric_radius
        return element_pack(build_shell(case, mesh), mesh, wall, arm)

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
        stress = bending_stress(build_shell(case, mesh), W, petals.youngs_modulus, petals.thickness)
        return {
            "journal_contact_pressure": whole(pressure[rows.journal].reshape(mesh.count, -1, mesh.n_z)),
            "deflection": whole(W),
            **self.cross_section(case, state.deflection),
            "bushing_contact_pressure": whole(on_bushing),
            "petal_contact_pressure": whole(on_neighbour),
            "bending_stress": whole(stress),
        }

    def coordinates(self, case: Case, wall: Wall) -> Fields:
        """Angle from the root of a petal [rad]."""
        return {"phi": build_mesh(case).phi}

    def cross_section(self, case: Case, deflection: Array) -> Fields:
        """Radius of the mid-surface of the petals, free (node,) and deformed (petal, node, axial) [m]."""
        (_, package), mesh = petals_of(case), build_mesh(case)
        r0 = package.free_radius(mesh.phi)
        return {"free_radius": r0, "radius": mesh.axial.whole(r0[None, :, None] + nodal(mesh, deflection))}

    def scalars(self, fields: Fields) -> Scalars:
        """Maximum bending stress."""
        return {"max_bending_stress": float(np.max(np.abs(fields["bending_stress"])))}

    def geometry(self, case: Case) -> Scalars:
        """Thickness of a petal."""
        return {"petal_thickness": petals_of(case)[0].total_thickness}

    def check_scalars(self, case: Case) -> Scalars:
        """Overlap, layers, stiffness, free shape."""
        petals, package = petals_of(case)
        phi = np.linspace(0.0, package.petal_angle, FREE_SHAPE_ANGLES)
        r0 = package.free_radius(phi)
        inner = r0 - 0.5 * package.thickness - case.bearing.journal_radius
        touching = np.flatnonzero(inner <= 0.0)
        return {
            "overlap": package.overlap,
            "layers": package.layers,
            "petal_angle": package.petal_angle,
            "pitch": package.pitch,
            "covered_angle": package.covered_angle,
            "metric_radius": package.metric_radius,
            "bending_stiffness": petals.bending_stiffness,
            "root_tilt": package.root_tilt,
            "first_contact_angle": float(phi[touching[0]]) if len(touching) else math.nan,
            "free_petal_height": float(np.max(package.metric_radius - r0)),
        }


def nodal(mesh: PackMesh, deflection: Array) -> Array:
    """Deflections (n,) at all nodes of the petals, zero at the roots; (petal, node, axial) [m]."""
    W = np.zeros(mesh.shape)
    W[:, 1:] = deflection.reshape(mesh.count, -1, mesh.n_z)
    return W
