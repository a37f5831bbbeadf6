"""Small dense complementarity problems."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.solvers.lcp import interior_set, solve_lcp, swap

CIRCULANT = np.array([[1.0, 0.0, 1.2], [1.2, 1.0, 0.0], [0.0, 1.2, 1.0]])
"""Ben Gharbia and Gilbert (2012): swapped sets go round on it."""


@pytest.mark.parametrize("rank", [3, 12, 20])
@pytest.mark.parametrize("seed", range(5))
def test_answers_of_convex_problems(seed: int, rank: int) -> None:
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(12, rank))
    M, z0 = A @ A.T / rank, np.maximum(rng.normal(size=12), 0.0)
    q = np.where(z0 > 0.0, 0.0, rng.uniform(0.1, 1.0, 12)) - M @ z0  # a problem that has an answer
    z = solve_lcp(M, q, rng.random(12) < 0.5)
    assert z is not None
    w = M @ z + q
    assert z.min() >= 0.0
    assert w.min() > -1e-9
    assert_allclose(z * w, 0.0, atol=1e-9)


def test_where_swapping_goes_round() -> None:
    q, guess = -np.ones(3), np.array([True, False, False])
    assert swap(CIRCULANT, q, guess) is None
    assert interior_set(CIRCULANT, q).all()
    z = solve_lcp(CIRCULANT, q, guess)
    assert z is not None
    assert_allclose(z, 1.0 / 2.2, rtol=1e-12)


def test_no_answer_is_no_answer() -> None:
    assert solve_lcp(np.array([[-1.0]]), np.array([-1.0]), np.array([False])) is None


def test_a_matrix_of_zeros_warns_of_nothing() -> None:
    assert solve_lcp(np.zeros((2, 2)), -np.ones(2), np.zeros(2, dtype=bool)) is None
