"""Solution with a matrix near a factorised one: exact where only the border differs, refused where it is far."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.solvers.near_factor import PRECISE, FactorAtHand, NearFactor, NotNearError
from petalfoil.solvers.sparse_lu import LinearSolver

COMMON = 120


def matrix(border: int, seed: int, change: float = 0.0) -> sp.csc_array:
    """A stiff common block, the same for all seeds but for a relative `change`, and a dense border of its own."""
    same, own = np.random.default_rng(1), np.random.default_rng(seed)
    common = sp.random_array((COMMON, COMMON), density=0.05, rng=same).toarray() + np.diag(
        np.geomspace(1.0, 1e4, COMMON)
    )
    common *= 1.0 + change * own.standard_normal((COMMON, COMMON))
    below, right = own.standard_normal((border, COMMON)), own.standard_normal((COMMON, border))
    return sp.csc_array(np.block([[common, right], [below, own.standard_normal((border, border))]]))


@pytest.mark.parametrize(("before", "after"), [(0, 0), (0, 3), (5, 0), (4, 7)])
@pytest.mark.parametrize("change", [0.0, 0.05])
def test_other_borders_are_solved_with_the_factor_of_a_near_matrix(before: int, after: int, change: float) -> None:
    solver, there = LinearSolver(), matrix(after, 3, change)
    near = NearFactor.of(solver.factor(matrix(before, 2)), there, COMMON)
    rhs = np.random.default_rng(4).standard_normal((COMMON + after, 2))
    exact, dense = np.linalg.solve(there.toarray(), rhs), there.toarray()
    size = np.linalg.norm(exact, axis=0).min()
    assert_allclose(near.solve(rhs), exact, rtol=0.0, atol=10.0 * PRECISE * size)
    transposed = np.linalg.solve(dense.T, rhs[:, 0])
    assert_allclose(
        near.solve_transposed(rhs[:, 0]), transposed, rtol=0.0, atol=10.0 * PRECISE * np.linalg.norm(transposed)
    )
    if not change:  # the border alone differs: no GMRES is needed
        assert_allclose(near.nearly(rhs[:, 0]), exact[:, 0], rtol=1e-8, atol=1e-10 * size)
    assert solver.counter.factorizations == 1


def test_what_is_far_is_refused() -> None:
    far = matrix(2, 3, 40.0)
    near = NearFactor.of(LinearSolver().factor(matrix(2, 2)), far, COMMON)
    with pytest.raises(NotNearError, match="not solved with"):
        near.solve(np.ones(COMMON + 2))


def test_a_singular_border_is_refused() -> None:
    there = matrix(2, 3).tolil()
    there[-1], there[:, -1] = 0.0, 0.0
    with pytest.raises(NotNearError, match="border"):
        NearFactor.of(LinearSolver().factor(matrix(1, 2)), sp.csc_array(there), COMMON)


def test_a_factor_serves_matrices_of_the_same_only() -> None:
    hand, solver, here, other = FactorAtHand(), LinearSolver(), object(), object()
    assert hand.near(matrix(1, 2), COMMON, here, solver) is None
    hand.keep(solver.factor(matrix(1, 2)), here)
    assert hand.near(matrix(3, 3), COMMON, other, solver) is None
    counted = LinearSolver()
    near = hand.near(matrix(3, 3), COMMON, here, counted)
    assert near is not None
    near.solve(np.ones(COMMON + 3))
    assert counted.counter.factorizations == 0 < counted.counter.solves
    hand.drop()
    assert hand.near(matrix(3, 3), COMMON, here, solver) is None
