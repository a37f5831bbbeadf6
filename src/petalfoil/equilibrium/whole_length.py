"""A whole length from half of it: the equilibrium of an aligned journal, found on half, mirrored, and then tilted.

A cold start takes some fifteen factorisations, a tilt of an aligned journal two to four. One of the whole length takes
three times as long as one of half: most of them are better done on half.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import BARRIERS, attempt
from petalfoil.equilibrium.continuation import WARM, follow, predicted
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.equilibrium.under_load import RELOADED, balance_cold, from_neighbour, from_nothing, newton
from petalfoil.mesh.axial import AxialGrid
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.build import build_problem, build_tilting
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

MIRRORED = "from the equilibrium of half the length, mirrored"
"""How such a solution was reached."""

TILTED = replace(WARM, patience=0)
"""A tilt changes contacts at both ends. The set is searched for at once, which saves one factorisation of four."""

SAME_PLACE = 1e-9
"""Distance of stations that are the same, over the length."""

ALIGNED = {"operation.tilt": None, "operation.moment": None}
"""What a case must not have for half of its length to be solved."""


def first_attempt(problem: CoupledProblem) -> Solution | None:
    """The equilibrium at the position of `problem`, on half the length first, by the first barrier; None if none."""
    half = half_of(problem)
    known = None if half is None else attempt(half, BARRIERS[0])
    found = None if known is None else from_half(known, problem)
    if known is None or found is None:
        return attempt(problem, BARRIERS[0])
    return replace(found, shortest_step=known.shortest_step, step_count=known.step_count)


def from_half(known: Solution, problem: CoupledProblem) -> Solution | None:
    """The equilibrium of a whole length at its position from that on half of it; None if it does not lead there."""
    aligned, run = whole_of(known, problem), current_run()
    contacts, outcome = solve_contacts(aligned, mirrored(known, aligned), run.film_solver, WARM)
    run.note("mirrored", outcome=outcome.value)
    middle = from_contacts(aligned, contacts, MIRRORED)
    if middle is None or is_aligned(problem):
        return middle
    found = follow(middle, problem, TILTED)
    return None if found is None else replace(found, solution_path=f"{MIRRORED} and tilted")


def balance_from_half(problem: CoupledProblem, load: Array) -> Solution | None:
    """The balance with a load (n_position,) over the unit of force, on half the length first; None if that fails."""
    half = half_of(problem)
    known = None if half is None else from_nothing(half, load[:2] * force_unit(problem) / force_unit(half))
    if known is None:
        return None
    aligned, straight = whole_of(known, problem), np.append(load[:2], np.zeros(len(load) - 2))
    middle = newton(aligned, mirrored(known, aligned), straight)  # without the moment
    if middle is None or middle.contacts is None or (is_aligned(problem) and not np.any(load[2:])):
        return middle
    here = problem.at(displacement=middle.problem.displacement)
    start, tangent = (predicted(middle, here), middle.active), middle.contacts.tangent
    return newton(here, start, load, RELOADED, tangent) or from_neighbour(middle, problem, load)


def balance_from_nothing(problem: CoupledProblem, load: Array) -> Solution:
    """The balance with a load (n_position,) over the unit of force, from nothing; on half the length first.

    Raises
    ------
    ConvergenceError
        No balance was found.
    """
    return balance_from_half(problem, load) or balance_cold(problem, load)


def force_unit(problem: CoupledProblem) -> float:
    """Unit of force of a problem [N]."""
    return problem.layout.scales.force


def half_of(problem: CoupledProblem) -> CoupledProblem | None:
    """The bearing of `problem` under an aligned journal on half of its length, at the same speed and position.

    None where there is no half: in 2-D, on stations without symmetry; and of a rigid wall, over which
    Newton's method takes as few steps by itself.
    """
    layout = problem.layout
    axial = layout.wall.film.axial
    if axial.half or axial.is_2d or not layout.n_wall:
        return None
    half = build_problem(layout.case.replace(**ALIGNED, **{"model.symmetry": True}))
    z = half.layout.wall.film.axial.whole_z
    if len(z) != len(axial.z) or np.max(np.abs(z - axial.z)) > SAME_PLACE * axial.length:
        return None
    return half.at(
        bearing_number=problem.bearing_number,
        displacement=problem.displacement[:2],
        temperatures=problem.temperatures,
    )


def whole_of(known: Solution, problem: CoupledProblem) -> CoupledProblem:
    """The whole length of `problem` under an aligned journal at the position of `known`, free to tilt if it is."""
    case = problem.layout.case.replace(**ALIGNED, **{"model.symmetry": False})
    tilts = problem.layout.n_position > 2
    if is_aligned(problem):
        whole = problem
    else:
        whole = build_tilting(case) if tilts else build_problem(case)
    slopes = np.zeros(problem.layout.n_position - 2)
    return whole.at(
        bearing_number=problem.bearing_number,
        displacement=np.append(known.problem.displacement, slopes),
        temperatures=problem.temperatures,
    )


def is_aligned(problem: CoupledProblem) -> bool:
    """Whether the journal of a whole length is held parallel to the bushing, or free to tilt away from that."""
    given = problem.layout.case.operation.tilt
    return not any(given or ()) and not np.any(problem.displacement[2:])


def mirrored(known: Solution, problem: CoupledProblem) -> tuple[Array, Mask]:
    """Unknowns (n,) and active contacts (m,) over the whole length from an equilibrium on half of it."""
    half, film = known.problem.layout, problem.layout.wall.film
    axial = half.wall.film.axial
    P = film.at_unknowns(axial.whole(known.problem.pressure(known.x)))
    w = known.x[half.unknowns[DEFLECTION]] * (half.scales.length / problem.layout.scales.length)
    whole = wall_kind(half.case).over_whole_length(half.case, w)
    x = problem.layout.unknowns.join({DEFLECTION: whole, PRESSURE: P})
    return x, over_whole(known.active.astype(np.float64), axial) > 0.5


def over_whole(values: Array, half: AxialGrid) -> Array:
    """Values whose stations follow each other in the last place, mirrored over the whole length."""
    return half.whole(values.reshape(-1, len(half.z))).ravel()
