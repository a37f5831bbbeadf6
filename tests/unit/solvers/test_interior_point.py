"""Primal-dual interior point."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.solvers.interior_point import InteriorOptions, InteriorStep, StepHistory, Watch, interior_point, recentre
from petalfoil.solvers.problem import PrimalDualPoint, fraction_to_boundary
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.unit.solvers.problems import CELLS, Spring, string, string_answer
from tests.verification.shell_helpers import ElasticProblem, cold_point

Path = list[tuple[PrimalDualPoint, InteriorStep]]


def content(barrier: float, path: Path) -> Watch:
    """A watch that keeps what it saw."""

    def watch(point: PrimalDualPoint, step: InteriorStep) -> bool:
        path.append((point, step))
        return step.barrier < barrier and max(step.residual, step.infeasibility) < 1e-9

    return watch


def test_string_from_nothing() -> None:
    problem, path = string(), Path()
    point, done = interior_point(
        problem, cold_point(problem, CELLS - 1), LinearSolver(), InteriorOptions(), content(1e-12, path)
    )
    w, lam = string_answer()
    assert done
    assert_allclose(point.x, w, atol=1e-6)
    assert_allclose(point.lam, lam, atol=1e-3)
    assert len(path) <= 20
    for seen, step in path:
        assert min(seen.s.min(), seen.lam.min()) > 0.0
        assert_allclose(step.barrier, seen.lam @ seen.s / (CELLS - 1), rtol=1e-12)


def test_barriers_fall_as_fast_as_the_boundary_lets_them() -> None:
    problem, path = string(distance=0.05), Path()
    interior_point(problem, cold_point(problem, CELLS - 1), LinearSolver(), InteriorOptions(), content(1e-14, path))
    barriers = np.array([step.barrier for _, step in path])
    assert np.all(np.diff(barriers[2:]) < 0.0)
    assert barriers[-1] < 0.03 * barriers[-2]  # the fraction to the boundary, 0.98, leaves 0.02


def test_steps_run_out() -> None:
    problem, solver = string(), LinearSolver()
    _, done = interior_point(
        problem, cold_point(problem, CELLS - 1), solver, InteriorOptions(max_steps=3), lambda point, step: False
    )
    assert not done
    assert solver.counter.factorizations == 4


def test_least_barrier_stops_the_fall() -> None:
    problem, path = string(), Path()
    options = InteriorOptions(least_barrier=1e-2, max_steps=40)
    interior_point(problem, cold_point(problem, CELLS - 1), LinearSolver(), options, content(0.0, path))
    assert_allclose(path[-1][1].barrier, 1e-2, rtol=0.15)
    products = path[-1][0].lam * path[-1][0].s
    assert_allclose(products, 1e-2, rtol=0.25)  # near the central path; the predictor aims past it


def test_without_gaps_it_is_newton() -> None:
    K = sp.csr_array([[2.0, 1.0], [1.0, 3.0]])
    problem = ElasticProblem(K, np.array([1.0, -1.0]), sp.csr_array((0, 2)), np.zeros(0), np.zeros(0))
    solver, path = LinearSolver(), Path()
    start = PrimalDualPoint(np.zeros(2), np.zeros(0), np.zeros(0))
    point, done = interior_point(problem, start, solver, InteriorOptions(), content(1.0, path))
    assert done
    assert solver.counter.factorizations == 1
    assert_allclose(point.x, np.linalg.solve(K.toarray(), [1.0, -1.0]), rtol=1e-12)


def test_film_reads_the_slack() -> None:
    """Started where the gap is shut (x = 1.5), the film still has its slack; it ends where `x (1 - x) = c`."""
    path = Path()
    start = PrimalDualPoint(np.array([1.5]), np.ones(1), np.ones(1))
    point, done = interior_point(Spring(0.1), start, LinearSolver(), InteriorOptions(), content(1e-12, path))
    assert done
    assert_allclose(point.x, 0.5 - np.sqrt(0.25 - 0.1), rtol=1e-8)
    xs = np.array([float(seen.x[0]) for seen, _ in path])
    assert np.all(xs[1:] >= 0.199 * xs[:-1])  # x must stay positive: four fifths of the way at most


@pytest.mark.parametrize(
    ("value", "change", "expected"),
    [([1.0, 2.0], [1.0, 0.0], np.inf), ([1.0, 2.0], [-2.0, -1.0], 0.5), ([], [], np.inf), ([0.0], [-1.0], 0.0)],
)
def test_fraction_to_the_boundary(value: list[float], change: list[float], expected: float) -> None:
    assert fraction_to_boundary(np.array(value), np.array(change)) == expected


def test_pace_marches_after_two_short_steps() -> None:
    options = InteriorOptions()
    once = StepHistory().after(0.1, 1.0, options)
    assert (once.short, once.rate) == (1, 0.0)
    assert once.after(0.5, 1.0, options).short == 0
    twice = once.after(0.1, 1.0, options)
    assert twice.rate == 1.0 / options.first_time


def test_pace_of_a_march() -> None:
    options = InteriorOptions()
    march = StepHistory(0.1, 0, 1.0)
    assert march.after(1.0, 1.0, options).rate == 1.0 / options.growth
    assert march.after(0.5, 1.0, options).rate == 1.0
    assert march.after(0.1, 1.0, options).rate == options.growth
    assert StepHistory(0.1, 0, 1.0 / options.shortest_time).after(0.1, 1.0, options).rate == 1.0 / options.shortest_time
    assert march.after(1.0, 1e-3 * options.near, options).rate == 0.0  # arrived
    assert StepHistory(1.0, 0, 1.1 / options.longest_time).after(1.0, 1.0, options).rate == 0.0  # as good as no march


def test_recentre_moves_only_what_ran_ahead() -> None:
    point = PrimalDualPoint(np.zeros(3), np.array([1.0, 1.0, 1e-4]), np.array([1.0, 2.0, 1e-4]))
    moved = recentre(point, np.ones(3))
    assert_allclose(moved.s[:2], point.s[:2], rtol=0.0)
    assert_allclose(moved.lam[:2], point.lam[:2], rtol=0.0)
    assert_allclose(moved.s[2] * moved.lam[2], 0.1 * point.barrier(np.ones(3)), rtol=1e-12)
    assert_allclose(moved.s[2] / moved.lam[2], 1.0, rtol=1e-12)
