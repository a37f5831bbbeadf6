"""The contact set of linearised equations, found at once."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_equations import ContactState
from petalfoil.solvers.contact_search import neighbours, search
from petalfoil.solvers.problem import ContactProblem
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.unit.solvers.problems import CELLS, string, string_answer

NODES = np.arange(CELLS - 1)


def state(problem: ContactProblem, x: NDArray[np.float64], active: NDArray[np.bool_]) -> ContactState:
    """An iterate, not solved for."""
    held, line = constrain(problem.G, active), problem.linearize(x)
    return ContactState(x, np.zeros(0), np.zeros(len(active)), active, np.inf, held, line, problem.gaps(x))


@pytest.mark.parametrize(
    "closed", [NODES < 0, NODES >= 0, (NODES > 3) & (NODES < 20), NODES == 12], ids=["none", "all", "some", "one"]
)
def test_whatever_was_closed(closed: NDArray[np.bool_]) -> None:
    problem, (w, lam) = string(), string_answer()
    x = np.where(closed, problem.rest, 0.0)
    solver = LinearSolver()
    found = search(problem, state(problem, x, closed), NODES >= 0, solver)
    assert found is not None
    assert solver.counter.factorizations == 1
    assert_allclose(found[0], w, atol=1e-12)
    assert np.array_equal(found[1], lam > 0.0)


def test_gaps_out_of_doubt_stay() -> None:
    problem, (w, lam) = string(), string_answer()
    closed = lam > 0.0
    firm = (NODES > 15) & (NODES < 22)
    x = np.where(firm, problem.rest, 0.0)
    found = search(problem, state(problem, x, firm), (NODES > 5) & ~firm, LinearSolver())
    assert found is not None
    assert np.array_equal(found[1], closed)
    assert_allclose(found[0], w, atol=1e-12)


def test_neighbours_are_neighbours() -> None:
    problem = string()
    matrix = problem.linearize(np.zeros(CELLS - 1)).matrix(np.zeros(CELLS - 1))
    assert np.flatnonzero(neighbours(problem, NODES == 10, matrix)).tolist() == [9, 10, 11]
    assert not neighbours(problem, NODES < 0, matrix).any()
