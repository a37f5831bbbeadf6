"""The constraints as the paper prints them: fixed bounds (21), (22) instead of contact between petals.

    W >= R_j + e.n + h_c + 3/2 delta - r0     where a petal is covered,   0 < phi < phi3    (21)
    W <= R_B - 3/2 delta - r0                   where it lies on another,   phi0 <= phi       (22)

The bounds leave the space of one layer for the neighbouring petal, wherever that petal is. Petals then interact through
the film only. The other constraints do not change. (The paper prints `R_j` for `R_B` in (22), and `delta0` for
`delta`.)
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.physics.contact import Contacts
from petalfoil.physics.forces import contact_fraction, node_area
from petalfoil.sparsity import SparseRows
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls.petals import build_mesh, petals_of

Array = NDArray[np.float64]


def bounded_loads(case: Case, displacements: tuple[float, ...]) -> tuple[tuple[float, ...], float, float]:
    """`|F|` at downward displacements [N], normal film force on the centred journal [N], largest contact fraction [1].

    A point that did not converge, and those after it, are nan.
    """
    problem = bounded(case)
    problems = [
        problem.at(displacement=np.array([0.0, -e]) / problem.layout.scales.length) for e in (0.0, *displacements)
    ]
    with one_thread():
        solutions = _curve(problems)
    forces = [_forces(place, solution, case) for place, solution in zip(problems, solutions, strict=True)]
    loads, normal_forces, fractions = zip(*forces, strict=True)
    return tuple(loads[1:]), normal_forces[0], float(np.max(fractions))


def _curve(problems: list[CoupledProblem]) -> list[Solution | None]:
    """The solutions along a curve; None from the first point that does not converge."""
    solutions: list[Solution | None] = []
    try:
        previous = solve_cold(problems[0])
        solutions.append(previous)
        for problem in problems[1:]:
            previous, _ = advance(previous, problem)
            solutions.append(previous)
    except ConvergenceError:  # reported as nan by `bounded_loads`
        pass
    return solutions + [None] * (len(problems) - len(solutions))


def _forces(problem: CoupledProblem, solution: Solution | None, case: Case) -> tuple[float, float, float]:
    """Load [N], normal force of the film [N], contact fraction [1]."""
    if solution is None:
        return math.nan, math.nan, math.nan
    film, scales, radius = problem.layout.wall.film, problem.layout.scales, case.bearing.journal_radius
    excess = (problem.pressure(solution.x) - 1.0) * scales.pressure
    reactions = np.zeros(len(solution.lam))  # bounds that move with the journal do not touch it
    reactions[problem.layout.wall.contacts.journal] = solution.lam[problem.layout.wall.contacts.journal]
    force = problem.journal_force(solution.x, reactions) * scales.force
    contact = float(reactions.sum() * scales.force)
    area = node_area(film, radius)
    return float(np.hypot(*force)), float(np.sum(excess * area)), contact_fraction(contact, excess, area)


def bounded(case: Case) -> CoupledProblem:
    """The coupled problem of `case` with fixed bounds instead of contact between its petals."""
    problem = build_problem(case)
    wall = replace(problem.layout.wall, contacts=bounds(case, problem.layout.wall.contacts))
    return replace(problem, layout=replace(problem.layout, wall=wall))


def bounds(case: Case, contacts: Contacts) -> Contacts:
    """Gaps of the pack, with the fixed bounds instead of the gaps between petals."""
    (petals, pack), mesh = petals_of(case), build_mesh(case)
    delta, least = petals.total_thickness, case.bearing.journal_radius + case.surface.contact_film_thickness
    r0 = np.broadcast_to(pack.free_radius(mesh.phi)[None, :, None], mesh.shape)
    theta = np.broadcast_to(mesh.theta[:, :, None], mesh.shape)
    area = np.broadcast_to(pack.metric_radius * mesh.arc_weight[:, None] * mesh.axial.weight, mesh.shape)
    covered, lap, kept = slice(1, mesh.n_node - mesh.cells - 1), mesh.on_neighbour, slice(0, contacts.bushing.stop)
    number, n = mesh.free_numbers(), contacts.G.shape[1]
    direction = np.stack([np.cos(theta[:, covered]).ravel(), np.sin(theta[:, covered]).ravel()], axis=1)
    inner, outer = (
        (r0[:, covered] - least - 1.5 * delta).ravel(),
        (case.bearing.bushing_radius - 1.5 * delta - r0[:, lap]),
    )
    rows = (contacts.G[kept], _selected(number[:, covered], 1.0, n), _selected(number[:, lap], -1.0, n))
    rest = np.concatenate([contacts.rest[kept], inner, outer.ravel()])
    return Contacts(
        G=SparseRows(sp.vstack(rows, format="csr")),
        rest=rest,
        by_e=np.concatenate([contacts.by_e[kept], -direction, np.zeros((outer.size, 2))]),
        area=np.concatenate([contacts.area[kept], area[:, covered].ravel(), area[:, lap].ravel()]),
        journal=contacts.journal,
        bushing=contacts.bushing,
        petals=slice(contacts.bushing.stop, len(rest)),
    )


def _selected(numbers: NDArray[np.intp], sign: float, n: int) -> sp.csr_array:
    """Rows that select one deflection each, with a sign."""
    cols = numbers.ravel()
    return sp.coo_array((np.full(len(cols), sign), (np.arange(len(cols)), cols)), shape=(len(cols), n)).tocsr()
