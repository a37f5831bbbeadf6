"""Fields of an answer on the whole bearing: arrays and coordinates of a record."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.shell import bending_stress
from petalfoil.walls.petals import build_mesh, build_shell, petals_of

Array = NDArray[np.float64]
Named = dict[str, Array]


def film_fields(answer: Solution) -> Named:
    """Pressure [Pa] and film thickness [m] over the whole length, (strip, node, axial)."""
    problem = answer.problem
    scales, axial = problem.layout.scales, problem.layout.wall.film.axial
    return {
        "pressure": axial.whole(problem.pressure(answer.x) * scales.pressure),
        "film_thickness": axial.whole(problem.film(answer.x) * scales.length),
    }


def contact_pressure(answer: Solution, rows: slice) -> Array:
    """Contact pressure on the gaps `rows`, (k,) [Pa]."""
    layout = answer.problem.layout
    pressure: Array = answer.lam[rows] * layout.scales.force / layout.wall.contacts.area[rows]
    return pressure


def petal_fields(case: Case, answer: Solution) -> Named:
    """Deflection, radius, contact pressures and stress of the petals, (petal, node, axial), SI."""
    petals, package = petals_of(case)
    mesh, contacts = build_mesh(case), answer.problem.layout.wall.contacts
    W = np.zeros(mesh.shape)
    W[:, 1:] = answer.x[: answer.problem.layout.n_wall].reshape(mesh.count, -1, mesh.n_z)
    W *= answer.problem.layout.scales.length
    r0 = package.free_radius(mesh.phi)
    on_bushing, on_neighbour = np.zeros(mesh.shape), np.zeros(mesh.shape)
    on_bushing[:, mesh.on_bushing] = contact_pressure(answer, contacts.bushing).reshape(mesh.count, -1, mesh.n_z)
    on_neighbour[:, mesh.on_neighbour] = contact_pressure(answer, contacts.petals).reshape(mesh.count, -1, mesh.n_z)
    on_journal = contact_pressure(answer, contacts.journal).reshape(mesh.count, -1, mesh.n_z)
    stress = bending_stress(build_shell(case, mesh), W, petals.youngs_modulus, petals.thickness)
    whole = mesh.axial.whole
    return {
        "journal_contact_pressure": whole(on_journal),
        "deflection": whole(W),
        "radius": whole(r0[None, :, None] + W),
        "free_radius": r0,
        "bushing_contact_pressure": whole(on_bushing),
        "petal_contact_pressure": whole(on_neighbour),
        "bending_stress": whole(stress),
    }


def coordinates(case: Case, answer: Solution) -> dict[str, NDArray[np.generic]]:
    """Coordinates of the fields."""
    film = answer.problem.layout.wall.film
    strips = len(film.theta)
    coords: dict[str, NDArray[np.generic]] = {
        "petal": np.arange(strips),
        "root_angle": film.theta[:, 0] - film.phi[0],
        "phi_exposed": film.phi,
        "z": film.axial.whole_z,
    }
    if case.petals is not None:
        coords["phi"] = build_mesh(case).phi
    return coords


def all_fields(case: Case, answer: Solution) -> Named:
    """All fields of an answer."""
    fields = film_fields(answer)
    return fields if case.petals is None else {**fields, **petal_fields(case, answer)}
