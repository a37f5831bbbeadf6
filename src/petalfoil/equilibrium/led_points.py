"""Contact points led from one equilibrium to the next, contacts at nodes left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.continuation import WARM
from petalfoil.equilibrium.element_contacts import clear_of_journal, placed
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_points import followed
from petalfoil.equilibrium.nodal_state import sampled_solution
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.equilibrium.under_load import WARM as WARM_UNDER_LOAD
from petalfoil.equilibrium.under_load import newton
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


PARTS = (1, 2)
"""Parts into which the way to another speed is cut under a load. One point of the rig's run-up, at four times the speed
of the one before, is reached in two, in fewer factorisations than with contacts at nodes. At given positions of ten
petals none was."""


def led(known: Solution, problem: CoupledProblem, load: Array | None = None) -> Solution | None:
    """The solution of `problem` whose contact points follow those of `known`, under a `load` (n_position,) or not.

    None where they do not lead there.
    """
    near = known.elements
    if not isinstance(near, PointContacts) or near.equations.problem.layout is not problem.layout:
        return None
    for parts in PARTS if load is not None else PARTS[:1]:
        try:
            found = near
            for between in on_the_way(near.equations.problem, problem, parts):
                found = followed(found, placed(between, found, load), load)
            return sampled_solution(clear_of_journal(found), load)
        except NoPointsError as failure:
            current_run().note("followed", parts=parts, outcome=str(failure))
    return None


def on_the_way(start: CoupledProblem, end: CoupledProblem, parts: int) -> Iterator[CoupledProblem]:
    """The problems at equal parts of the way in speed from `start` to `end`, which comes last."""
    slow, fast = start.bearing_number, end.bearing_number
    for part in range(1, parts):
        yield end.at(bearing_number=slow + part / parts * (fast - slow))
    yield end


def with_nodal_contacts(known: Solution) -> Solution:
    """The equilibrium with contacts at nodes near one whose nodes are only sampled; the same where there is none."""
    if known.contacts is not None or known.elements is None:
        return known
    problem, run = known.problem, current_run()
    if known.load is not None:
        found = newton(problem, (known.x, known.active), known.load, WARM_UNDER_LOAD)
    else:
        contacts, outcome = solve_contacts(problem, (known.x, known.active), run.film_solver, WARM)
        run.note("contacts", outcome=outcome.value)
        found = from_contacts(problem, contacts, known.solution_path)
    return known if found is None else replace(found, elements=known.elements, elements_sought=True)
