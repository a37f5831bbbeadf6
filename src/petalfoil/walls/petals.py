"""A package of petals between film and bushing."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from petalfoil.case import Case, Edges, Mount, Package, Petals
from petalfoil.mesh.package import PackageMesh, package_mesh
from petalfoil.mesh.strips import exposed_strips
from petalfoil.physics.contact import package_contacts
from petalfoil.physics.forces import node_area
from petalfoil.physics.friction import petal_slip
from petalfoil.physics.shell import PetalShell
from petalfoil.walls.axis import axial_grid
from petalfoil.walls.base import Elasticity, Wall


def petals_of(case: Case) -> tuple[Petals, Package]:
    """The petals of a case that has them, and the geometry that follows."""
    if case.petals is None or case.package is None:
        raise ValueError("this case is a plain bearing: it has no petals")
    return case.petals, case.package


def build_mesh(case: Case) -> PackageMesh:
    """Grid of the package of `case`."""
    petals, package = petals_of(case)
    return package_mesh(petals.count, package.overlap, petals.first_root, case.cells_per_pitch, axial_grid(case))


def build_shell(case: Case, mesh: PackageMesh) -> PetalShell:
    """One petal of `case` on `mesh`."""
    petals, package = petals_of(case)
    return PetalShell(
        phi=mesh.phi,
        axial=mesh.axial,
        metric_radius=package.metric_radius,
        bend_radius=petals.bend_radius,
        rigidity=petals.bending_stiffness,
        poisson_ratio=petals.poisson_ratio,
        clamped=petals.mount is Mount.CLAMPED,
    )


def package_elasticity(shell: PetalShell, mesh: PackageMesh) -> Elasticity:
    """Elastic energy of all petals, their roots held."""
    every, free = sp.eye_array(mesh.count), slice(mesh.n_z, None)
    parts = (shell.difference[:, free], shell.strain, shell.rigidity_matrix)
    return Elasticity(*(sp.csr_array(sp.kron(every, part, format="csr")) for part in parts))


def build(case: Case) -> Wall:
    """Discretise the package of `case`."""
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
    slip, share = petal_slip(mesh, 0.5 * petals.total_thickness / r_m, film.unknown.size)
    load_area = node_area(film, r_m)
    rest = r0[mesh.exposed] - 0.5 * petals.total_thickness - case.bearing.journal_radius
    return Wall(
        name="petals",
        film=film,
        elasticity=package_elasticity(shell, mesh),
        film_unknown=mesh.free_numbers()[:, mesh.exposed],
        load_area=np.broadcast_to(load_area, film.shape),
        rest_film=np.broadcast_to(rest[None, :, None], film.shape),
        contacts=package_contacts(mesh, r0, sizes),
        node_area=r_m * 2.0 * np.pi / mesh.count / mesh.cells * float(mesh.axial.weight.max()),
        free_motions=sp.csr_array(sp.kron(every, motions[free], format="csr")),
        support=sp.csr_array(sp.kron(every, support[:, free], format="csr")),
        slip=slip,
        share=share,
    )
