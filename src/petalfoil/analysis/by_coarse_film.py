"""A 2-D equilibrium by way of a coarse film: the whole search from nothing is done there, at little cost.

Only an equilibrium that is stable, and the only one known, leads on.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.branch_choice import others
from petalfoil.analysis.neighbours import begun, keep
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import eigenvalue_at_hand
from petalfoil.equilibrium.branches import by_short_steps
from petalfoil.equilibrium.coarse_film import coarser_film, from_coarse_film, points_near
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import counted_as_coarse, current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.whole_length import balance_from_nothing, first_attempt
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


def by_coarse_film(problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium at the position of `problem`, or under a `load` (n_position,), by way of a coarse film.

    None where none is worth it, where it has no contact points or may have other equilibria, or where they do not lead
    to some under the film of `problem`.
    """
    case = coarser_film(problem.layout.case, load)
    if case is None or problem.layout.elements is None:
        return None
    with counted_as_coarse() as run:
        coarse = build_problem(case)
        coarse = coarse.at(bearing_number=problem.bearing_number, displacement=problem.displacement)
        there = None if load is None else load * problem.layout.scales.force / coarse.layout.scales.force
        first = alone(case, coarse, there)
        run.note("coarse film", outcome="no equilibrium leads on" if first is None else "contact points")
    known = None if first is None else first.elements
    if first is None or not isinstance(known, PointContacts):
        return None
    found = from_coarse_film(known, problem, load)
    if found is None:
        return None
    path = f"from the equilibrium on {case.cells_per_pitch} cells per pitch: {first.solution_path}"
    return replace(found, solution_path=path, coarse_rate=first.coarse_rate)


def alone(case: Case, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium with contact points from nothing; None where others are known, or may be by its path."""
    try:
        found, rate = begun(problem, load, partial(from_nothing, problem, load), eigenvalue_at_hand)
    except ConvergenceError as failure:  # the grid that was asked for will say why
        current_run().note("coarse film", outcome=str(failure))
        return None
    if found is None or rate.real > 0.0 or is_doubtful(found, load):
        return None
    sole = load is not None or others(case, problem, found, rate)[0] == 1
    keep(replace(found, elements=None, elements_sought=False), alone=sole)
    points = at_points(found) if sole else None
    return None if points is None else replace(points, coarse_rate=rate.real)


def from_nothing(problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium from nothing, with its contact points; None without such, or if others may be by its path."""
    first = first_attempt(problem) if load is None else balance_from_nothing(problem, load)
    return None if first is None or is_doubtful(first, load) else at_points(first)


def is_doubtful(found: Solution, load: Array | None) -> bool:
    """Whether there may be other equilibria by the path to one; not asked under a load."""
    return load is None and by_short_steps(found)


def at_points(solution: Solution) -> Solution | None:
    """The solution with the contact points near it; None where there are none. They are sought once."""
    if solution.elements is not None:
        return solution
    points = points_near(solution)
    return None if points is None else replace(solution, elements=points, elements_sought=True)
