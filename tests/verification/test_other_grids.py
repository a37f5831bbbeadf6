"""Equilibria that an answer on another grid leads to, where nothing else finds one: the grid is not to show in them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.equilibrium.branches import different
from petalfoil.equilibrium.cold_start import nothing_found, solve_cold
from petalfoil.equilibrium.other_grids import by_other_grids, carried, grids, opened, or_from_other_grids
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.equilibrium.under_load import by_other_grids as balance_by_other_grids
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from tests import fuzz
from tests.cases import case

UNANSWERED_OTHERWISE = [49, 805, 1296]
"""Numbers of `make fuzz`: no barrier, march, central path or longer bearing leads to an equilibrium of these."""


def endless(cells: int, **changes: object) -> CoupledProblem:
    """The paper's eight petals, whose film has no ends."""
    return build_problem(case("paper_n8", **{"model.cells_per_pitch": cells, "model.edges": "continuous", **changes}))


def lost(problem: CoupledProblem) -> Solution:
    """A search that finds nothing."""
    raise nothing_found(endless=problem.endless)


def test_nodes_that_both_grids_have_keep_their_values() -> None:
    """Grids of 16 and 32 cells are nested: deflections and pressures at every other node are those of the finer one."""
    fine, coarse = endless(32), endless(16)
    known = solve_cold(fine)
    x = carried(known, coarse)
    deflection = [q.layout.wall.film_unknown for q in (fine, coarse)]
    moving = deflection[1] >= 0
    assert_allclose(x[deflection[1][moving]], known.x[deflection[0][:, ::2][moving]], rtol=1e-12)
    assert_allclose(coarse.pressure(x), fine.pressure(known.x)[:, ::2], rtol=1e-12)


def test_pairs_of_a_start_are_on_the_central_path() -> None:
    problem = endless(16)
    point = opened(problem, problem.layout.ambient(np.zeros(problem.layout.n_wall)), 0.01)
    assert_allclose(point.lam * point.s, 0.01 * problem.weight)
    assert np.all(point.s >= 0.1)


@pytest.mark.slow
def test_the_answer_does_not_depend_on_the_grid_that_led_to_it() -> None:
    """A bearing with one equilibrium: the position is fixed, or that of a load."""
    problem = endless(16)
    cold, led = solve_cold(problem), or_from_other_grids(lost, problem)
    assert "cells per pitch" in led.solution_path
    assert led.residual <= RESIDUAL_TOLERANCE
    assert len(different([cold, led])) == 1
    load = np.array([0.0, -3.0])
    balance, by_grids = balance_cold(problem, load), balance_by_other_grids(problem, load)
    assert by_grids is not None
    assert by_grids.force_residual <= 1e-8
    assert_allclose(by_grids.problem.displacement, balance.problem.displacement, atol=1e-6)


def test_other_grids_serve_films_without_ends_only() -> None:
    """The search's own error stands where there is no other grid to try."""
    ambient = endless(16, **{"model.edges": "ambient"})
    assert list(grids(ambient)) == []
    with running() as run, pytest.raises(ConvergenceError, match="no equilibrium found"):
        or_from_other_grids(lost, ambient)
    assert run.film.factorizations == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", UNANSWERED_OTHERWISE)
def test_bearings_that_snap_are_led_to_from_another_grid(number: int) -> None:
    """3 to 5 s each, of all forces on the petals none that pulls."""
    problem = build_problem(fuzz.bearing(number).replace(**{"model.contacts": "nodes"}))
    with running():
        found = by_other_grids(problem)
    assert found is not None
    assert found.residual <= RESIDUAL_TOLERANCE
    assert found.problem.layout is problem.layout
    assert np.min(found.lam / problem.weight) >= -RESIDUAL_TOLERANCE
    assert np.min(problem.gaps(found.x)) >= -RESIDUAL_TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize("number", UNANSWERED_OTHERWISE)
def test_solve_ends_there_by_itself(number: int) -> None:
    """Minutes: every other way is tried before."""
    answer = fuzz.solved(number, at_nodes=True)
    assert answer.solution_path is not None
    assert "cells per pitch" in answer.solution_path
