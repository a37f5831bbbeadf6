"""Newton on a set of closed gaps."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.cone import ConeProblem
from petalfoil.solvers.contact_newton import ActiveOptions, Closed, Outcome, active_set, evaluate, newton_step
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.unit.solvers.problems import CELLS, OBSTACLE, Spring, string, string_answer
from tests.verification.shell_helpers import ElasticProblem, rows_of


def solve(
    problem: ConeProblem, x: NDArray[np.float64], closed: NDArray[np.bool_], max_steps: int = 12
) -> tuple[Closed | None, Outcome, int]:
    solver = LinearSolver()
    answer, outcome = active_set(problem, x, closed, solver, ActiveOptions(max_steps=max_steps))
    return answer, outcome, solver.counter.factorizations


def test_string_on_its_own_set() -> None:
    w, lam = string_answer()
    answer, outcome, count = solve(string(), np.zeros(CELLS - 1), lam > 0.0)
    assert outcome is Outcome.CONVERGED
    assert answer is not None
    assert count == 1
    assert_allclose(answer.x, w, atol=1e-14)
    assert_allclose(answer.lam, lam, atol=1e-11)


@pytest.mark.parametrize("start", ["closed", "shifted", "ends"])
def test_string_from_other_sets(start: str) -> None:
    w, lam = string_answer()
    closed = {"closed": np.ones(CELLS - 1, dtype=bool), "shifted": np.roll(lam > 0.0, 3), "ends": lam == 0.5}[start]
    answer, outcome, _ = solve(string(), np.zeros(CELLS - 1), closed, max_steps=30)
    assert outcome is Outcome.CONVERGED
    assert answer is not None
    assert_allclose(answer.x, w, atol=1e-14)
    assert np.array_equal(answer.closed, lam > 0.0)


def test_an_answer_already_there_takes_the_one_step_that_gives_its_tangent() -> None:
    w, lam = string_answer()
    answer, _, count = solve(string(), w, lam > 0.0)
    assert answer is not None
    assert count == 1
    tangent = answer.ties.reduce(string().linearize(w).matrix(np.zeros(CELLS - 1)))
    ones = np.ones(answer.ties.n_free)
    assert_allclose(tangent @ answer.factor.solve(ones), ones, rtol=1e-10)


def test_the_tangent_of_a_neighbour_shows_where_its_set_is_wrong() -> None:
    known, _, _ = solve(string(), np.zeros(CELLS - 1), string_answer()[1] > 0.0)
    assert known is not None
    nearer, options = string(distance=0.5 * OBSTACLE), ActiveOptions()
    counts, found = [], []
    for before in (None, known.factor):
        solver = LinearSolver()
        answer, outcome = active_set(nearer, known.x, known.closed, solver, options, before)
        assert outcome is Outcome.CONVERGED
        assert answer is not None
        counts.append(solver.counter.factorizations)
        found.append(answer)
    assert counts[1] == counts[0] - 1
    assert np.array_equal(found[0].closed, found[1].closed)
    assert not np.array_equal(found[1].closed, known.closed)
    assert_allclose(found[1].x, found[0].x, rtol=1e-12)


def test_sets_that_return() -> None:
    """The circulant of Ben Gharbia and Gilbert (2012): a P-matrix on which swapped sets go round for ever."""
    alpha = 1.2
    K = sp.csr_array([[1.0, 0.0, alpha], [alpha, 1.0, 0.0], [0.0, alpha, 1.0]])
    problem = ElasticProblem(K, np.ones(3), rows_of(3, ([0, 1, 2], 1.0)), np.zeros(3), np.ones(3))
    answer, outcome, count = solve(problem, np.zeros(3), np.array([False, True, True]))
    assert outcome is Outcome.CONVERGED
    assert answer is not None
    assert count <= 6
    assert_allclose(answer.x, 1.0 / (1.0 + alpha), rtol=1e-12)


def test_steps_run_out() -> None:
    answer, outcome, _ = solve(string(), np.zeros(CELLS - 1), np.arange(CELLS - 1) == 5, max_steps=1)
    assert answer is None
    assert outcome is Outcome.STEPS


def test_a_chain_held_at_both_ends() -> None:
    problem = ElasticProblem(
        sp.csr_array(np.eye(2)),
        np.zeros(2),
        sp.csr_array([[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]]),
        np.array([0.1, 0.2, 0.3]),
        np.ones(3),
    )
    answer, outcome, _ = solve(problem, np.zeros(2), np.ones(3, dtype=bool))
    assert answer is None
    assert outcome is Outcome.OVERDETERMINED


def test_far_below_zero() -> None:
    _, outcome, _ = solve(string(), np.full(CELLS - 1, 0.6), np.zeros(CELLS - 1, dtype=bool))
    assert outcome is Outcome.PENETRATED


def test_film_that_reads_its_gap() -> None:
    """`x = c / (1 - x)`: the smaller root of `x (1 - x) = c`."""
    answer, outcome, _ = solve(Spring(0.1), np.array([0.3]), np.array([False]))
    assert outcome is Outcome.CONVERGED
    assert answer is not None
    assert_allclose(answer.x, 0.5 - np.sqrt(0.25 - 0.1), rtol=1e-8)


def test_positive_unknowns_stay_positive() -> None:
    """Newton from 0.6 points below zero; four fifths of the way there is as far as it goes."""
    problem, x, options = Spring(0.1), np.array([0.6]), ActiveOptions()
    state = evaluate(problem, x, np.array([False]))
    assert not isinstance(state, Outcome)
    factor = LinearSolver().factor(state.line.matrix(np.zeros(1)))
    assert float((x - factor.solve(state.line.residual))[0]) < 0.0
    assert_allclose(newton_step(problem, state, factor, options), (1.0 - options.boundary_x) * x, rtol=1e-12)
