"""An equilibrium with contact lines on a fine grid, from that of the same bearing on a coarse one.

On a few cells the pack is assembled, film and pack go through the interior point, and contact lines are found between
nodes. All of it is carried over (`prolonged_lines.py`), and Newton's method with contact lines goes on from there: they
travel, and need not be found node by node. On a grid with many more cells that takes steps from grid to grid.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.branches import (
    STRETCH,
    by_short_steps,
    found_by_chance,
    known_on_few_cells,
    longest_contact,
    off_path,
)
from petalfoil.equilibrium.line_chords import by_chords, by_tangent
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.line_sets import split, with_lines
from petalfoil.equilibrium.line_signs import corrected_early, freed, revised
from petalfoil.equilibrium.nodal_state import sampled_lines
from petalfoil.equilibrium.prolonged_lines import prolonged
from petalfoil.equilibrium.run_context import counted_as_coarse, current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.whole_length import balance_from_nothing, first_attempt
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

FEWEST_CELLS, FEWEST_AXIAL = 16, 16
"""Cells per pitch and over the length of the coarsest grid. Of six petals at 150 to 250 um 12 cells per pitch do not
lead to 64, where 16 do so in two tangents."""

FINER_ROUND, FINER_ALONG = 6, 3
"""Largest ratios of cells per pitch, and of cells over the length, from one grid to the next."""

WORTH = 3.0
"""Least number of cells over those of the coarse grid: with fewer an equilibrium there saves little."""

TANGENTS = 10
"""Most tangents on the fine grid: two to seven serve."""

SETS = 4
"""Most sets of contacts that one factor serves."""

FREES = 3
"""Tangents after which points at which the gap does not curve upward become contacts at nodes, and no other way."""


def by_coarse_grid(problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium at the position of `problem`, or under a `load` (n_position,), by way of a coarser grid.

    None for a case that does not begin so (`begins_with_lines`), where no coarser grid is worth it, where it has no
    contact lines or may have other equilibria, or where its lines do not lead to some on the grid of `problem`.
    """
    case = problem.layout.case
    coarse = coarser(case) if begins_with_lines(case, load) and not problem.layout.fields else None
    known = None if coarse is None else on_coarse_grid(problem, coarse, load)
    if coarse is None or known is None or not isinstance(known.lines, LineContacts):
        return None
    here = problem if load is None else problem.at(displacement=known.lines.problem.displacement)
    try:
        start = freed(prolonged(known.lines, here, load))
        found = split(settled_early(replace(start, points=start.points.lowest(start.gaps))))
    except NoLinesError as failure:
        current_run().note("contact lines", outcome=str(failure))
        return None
    current_run().note("contact lines", points=len(found.reaction), nodes=int(found.held.sum()))
    path = f"from the equilibrium on {coarse.cells_per_pitch} × {coarse.axial_cells} cells"
    answer = replace(sampled_lines(found, load), solution_path=path, on_few_cells=known.on_few_cells or known)
    answer = replace(answer, shortest_step=known.shortest_step, step_count=known.step_count)
    return None if longest_contact(answer) >= STRETCH else answer


def begins_with_lines(case: Case, load: Array | None) -> bool:
    """Whether a coarser grid may lead to its equilibrium: one with contact lines, no temperatures or friction.

    A moment is balanced under a load only.
    """
    slides, balances = case.surface.petal_friction == 0.0, load is not None or case.operation.moment is None
    has_lines = case.has_contact_lines and case.heat is None and case.shares_evenly
    return has_lines and slides and balances and case.operation.speed > 0.0


def coarser(case: Case) -> Case | None:
    """The same bearing on the next coarser grid; None where that saves little."""
    cells, axial = case.cells_per_pitch, case.axial_cells
    if cells > FINER_ROUND * FEWEST_CELLS or axial > FINER_ALONG * FEWEST_AXIAL:
        cells, axial = max(cells // 2, FEWEST_CELLS), max(axial // 2, FEWEST_AXIAL)
    else:
        cells, axial = min(cells, FEWEST_CELLS), min(axial, FEWEST_AXIAL)
    if case.cells_per_pitch * case.axial_cells < WORTH * cells * axial:
        return None
    return case.replace(**{"model.cells_per_pitch": cells, "model.axial_cells": axial})


def on_coarse_grid(problem: CoupledProblem, case: Case, load: Array | None) -> Solution | None:
    """The equilibrium of a coarser grid with its contact lines; None where it has none, or is `doubtful`.

    Its factorisations are counted apart.
    """
    coarse = build_problem(case)
    if coarse.layout.n_position != problem.layout.n_position:  # free to tilt by itself, not by its case
        return None
    coarse = coarse.at(bearing_number=problem.bearing_number, displacement=problem.displacement)
    with counted_as_coarse():
        if load is not None:
            load = load * problem.layout.scales.force / coarse.layout.scales.force
        return found_there(coarse, load) if coarser(case) is None else by_coarse_grid(coarse, load)


def found_there(problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium with its contact lines from nothing; None where there is none, or it is `doubtful`."""
    try:
        found = first_attempt(problem) if load is None else balance_from_nothing(problem, load)
    except ConvergenceError as failure:  # the grid that was asked for will say why
        current_run().note("coarse grid", outcome=str(failure))
        return None
    return None if found is None or doubtful(found) else with_lines(found)


def doubtful(answer: Solution) -> bool:
    """Whether it is to be found on its own grid: petals lie along each other, or it may not be the only one.

    Ends of long contacts recede node by node. Under a load no others are looked for.
    """
    return longest_contact(answer) >= STRETCH or (answer.load is None and may_not_be_alone(answer))


def may_not_be_alone(answer: Solution) -> bool:
    """Whether rounding or another start leads elsewhere: its path was left and a few cells know of others."""
    if not by_short_steps(answer):
        return off_path(answer)
    return found_by_chance(answer) or known_on_few_cells(answer.problem) > 1


def settled_early(state: LineContacts) -> LineContacts:
    """Newton's method from afar: signs are looked at after each tangent, before it has converged.

    Raises
    ------
    NoLinesError
        The film closes, contacts do not determine the petals, or it does not converge.
    """
    if not state.problem.admits(state.x):
        raise NoLinesError("the film closes")
    for count in range(TANGENTS):
        state = by_tangent(state)
        for _ in range(SETS):
            other = revised(state) if state.balanced else corrected_early(state, frees=count < FREES)
            if other is None:
                return state
            if other is state:
                break
            state = by_chords(other)
            if state is other:
                break
    raise NoLinesError(f"the residual is {state.residual:.1e} after {TANGENTS} tangents")
