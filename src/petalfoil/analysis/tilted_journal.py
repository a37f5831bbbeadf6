"""One equilibrium whose journal is free to tilt or held at its slopes: the same unknowns, more coordinates or less."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import nothing_found
from petalfoil.equilibrium.led_points import with_nodal_contacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.build import build_problem, build_tilting, lever_of
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


def whole_length(case: Case) -> Case:
    """The case on the grid of its whole length, without which nothing tilts."""
    return case.replace(**{"model.symmetry": False})


def free_to_tilt(case: Case, answer: Solution) -> Solution:
    """The equilibrium of a journal that is free to tilt, from the one found on the whole length.

    Raises
    ------
    ConvergenceError
        The equations are not solved there.
    """
    if answer.problem.layout.n_position > len(case.operation.eccentricity):
        return answer
    tilting = build_tilting(case)
    return same_state(answer, lambda e: tilting.at(displacement=np.append(e[:2], tilting.displacement[2:])))


def held(case: Case, answer: Solution) -> Solution:
    """The equilibrium of a journal that is held at the slopes that `answer` has.

    Raises
    ------
    ConvergenceError
        The equations are not solved there.
    """
    layout = answer.problem.layout
    if layout.n_position == len(case.operation.eccentricity):
        return answer

    def at_slopes(e: Array) -> CoupledProblem:
        slopes = tuple(map(float, e[2:] * layout.scales.length / lever_of(case)))
        problem = build_problem(case.replace(**{"operation.tilt": slopes, "operation.moment": None}))
        return problem.at(displacement=e[:2])

    return same_state(answer, at_slopes)


def same_state(answer: Solution, equations_at: Callable[[Array], CoupledProblem]) -> Solution:
    """The equilibrium of the equations at its position, from `answer`, whose unknowns and contacts solve them.

    Contact lines have a position of their own under a load, apart from that of contacts at nodes.

    Raises
    ------
    ConvergenceError
        The equations are not solved there.
    """
    answer, lines = with_nodal_contacts(answer), answer.lines
    found = at_same_state(equations_at(answer.problem.displacement), answer)
    if lines is None:
        return found
    lines = lines.under(at_operation_of(answer, equations_at(lines.problem.displacement)), None)
    if lines.residual > RESIDUAL_TOLERANCE:
        raise nothing_found()
    return replace(found, lines=lines, elements_sought=True)


def at_same_state(problem: CoupledProblem, answer: Solution) -> Solution:
    """The solution of `problem` with the unknowns and active contacts at nodes of `answer`, at its speed.

    Raises
    ------
    ConvergenceError
        The equations are not solved there.
    """
    problem, run = at_operation_of(answer, problem), current_run()
    contacts, outcome = solve_contacts(problem, (answer.x, answer.active), run.film_solver)
    run.note("contacts", outcome=outcome.value)
    found = from_contacts(problem, contacts, answer.solution_path)
    if found is None:
        raise nothing_found()
    load = answer.load
    if load is None:
        return found
    more = max(problem.layout.n_position - len(load), 0)  # the moments that hold the journal are not told
    return replace(found, load=np.append(load, np.zeros(more))[: problem.layout.n_position])


def at_operation_of(answer: Solution, problem: CoupledProblem) -> CoupledProblem:
    """The equations of `problem` at speed and temperatures of `answer`."""
    one = answer.problem
    return problem.at(bearing_number=one.bearing_number, temperatures=one.temperatures)
