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
from petalfoil.equilibrium.branches import by_short_steps
from petalfoil.equilibrium.coarse_film import coarser_film, from_coarse_film, points_near
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
        known = None if first is None else points_near(first)
        run.note("coarse film", outcome="no equilibrium leads on" if known is None else "contact points")
    if first is None or known is None:
        return None
    found = from_coarse_film(known, problem, load)
    if found is None:
        return None
    path = f"from the equilibrium on {case.cells_per_pitch} cells per pitch: {first.solution_path}"
    return replace(found, solution_path=path)


def alone(case: Case, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium with contacts at nodes from nothing; None where others are known, or may be by its path."""
    start = partial(first_attempt, problem) if load is None else partial(balance_from_nothing, problem, load)
    try:
        found, rate = begun(problem, load, start)
    except ConvergenceError as failure:  # the grid that was asked for will say why
        current_run().note("coarse film", outcome=str(failure))
        return None
    if found is None:
        return None
    sure = not rate.real > 0.0 and (load is not None or not by_short_steps(found))
    sole = sure and (load is not None or others(case, problem, found, rate)[0] == 1)
    keep(found, alone=sole)
    return found if sole else None
