"""One equilibrium whose journal is free to tilt or held at its slopes: the same unknowns, more coordinates or less."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import nothing_found
from petalfoil.equilibrium.line_sets import with_lines
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.build import build_problem, build_tilting, lever_of
from petalfoil.system.coupled import CoupledProblem


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
    problem = build_tilting(case)
    e = problem.displacement.copy()
    e[:2] = answer.position
    found = at_same_state(problem.at(displacement=e), answer)
    if answer.lines is None:
        return found
    return replace(with_lines(replace(found, load=None)), load=found.load)  # at this position, whatever holds it


def held(case: Case, answer: Solution) -> Solution:
    """The equilibrium of a journal that is held at the slopes that `answer` has.

    Raises
    ------
    ConvergenceError
        The equations are not solved there.
    """
    if answer.problem.layout.n_position == len(case.operation.eccentricity):
        return answer
    e = answer.position * answer.problem.layout.scales.length
    slopes = tuple(map(float, e[2:] / lever_of(case)))
    problem = build_problem(case.replace(**{"operation.tilt": slopes, "operation.moment": None}))
    found = at_same_state(problem.at(displacement=answer.position[:2]), answer)
    return found if answer.lines is None else with_lines(found)


def at_same_state(problem: CoupledProblem, answer: Solution) -> Solution:
    """The solution of `problem` with the unknowns and active contacts of `answer`, at its speed."""
    one, run = answer.problem, current_run()
    problem = problem.at(bearing_number=one.bearing_number, temperatures=one.temperatures)
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
