"""Contact points and contact lines led from one equilibrium to the next, contacts at nodes left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.continuation import WARM, on_the_way
from petalfoil.equilibrium.element_contacts import clear_of_journal, placed
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_lines import followed_lines
from petalfoil.equilibrium.followed_points import followed
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.nodal_state import sampled_lines, sampled_solution
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.settled_points import still_settled
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
    """The solution of `problem` whose contacts between nodes follow those of `known`; None where they lead nowhere.

    Under a `load` (n_position,) or not.
    """
    if known.problem.layout is not problem.layout:
        return None
    if isinstance(known.elements, PointContacts):
        return led_by_points(known.elements, problem, load)
    return led_by_lines(known.lines, problem, load) if isinstance(known.lines, LineContacts) else None


def led_by_points(near: PointContacts, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The same from contact points."""
    for parts in PARTS if load is not None else PARTS[:1]:
        try:
            found, start = near, near.equations.problem
            for share in np.arange(1, parts) / parts:
                found = followed(found, placed(on_the_way(start, problem, share), found, load), load)
            found = followed(found, placed(problem, found, load), load)
            return sampled_solution(clear_of_journal(still_settled(found, near, load)), load)
        except NoPointsError as failure:
            current_run().note("followed", parts=parts, outcome=str(failure))
    return None


def led_by_lines(near: LineContacts, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The same from contact lines."""
    try:
        return sampled_lines(followed_lines(near, problem, load), load)
    except NoLinesError as failure:
        current_run().note("followed", outcome=str(failure))
        return None


def with_nodal_contacts(known: Solution) -> Solution:
    """The equilibrium with contacts at nodes near one whose nodes are only sampled; the same where there is none."""
    if known.contacts is not None or (known.elements is None and known.lines is None):
        return known
    problem, run = known.problem, current_run()
    if known.load is not None:
        found = newton(problem, (known.x, known.active), known.load, WARM_UNDER_LOAD)
    else:
        contacts, outcome = solve_contacts(problem, (known.x, known.active), run.film_solver, WARM)
        run.note("contacts", outcome=outcome.value)
        found = from_contacts(problem, contacts, known.solution_path)
    if found is None:
        return known
    return replace(found, elements=known.elements, lines=known.lines, elements_sought=True)
