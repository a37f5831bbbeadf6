"""Tests of the sparse factorisation."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse.csgraph import structural_rank

from petalfoil.solvers import sparse_lu
from petalfoil.solvers.sparse_lu import Columns, LinearSolver, SingularMatrixError, equilibrate, parity


def badly_scaled(n: int = 30) -> sp.csc_array:
    rng = np.random.default_rng(7)
    matrix = sp.random_array((n, n), density=0.2, rng=rng) + sp.diags_array(rng.uniform(1.0, 2.0, n))
    rows, cols = 10.0 ** rng.uniform(-9.0, 9.0, (2, n))
    return sp.csc_array(sp.diags_array(rows) @ matrix @ sp.diags_array(cols))


def test_equilibrate_scales_to_one() -> None:
    matrix = badly_scaled()
    columns, row, col = equilibrate(matrix)
    scaled = columns.matrix
    assert_allclose(scaled.toarray(), row[:, None] * matrix.toarray() * col[None, :], rtol=1e-12)
    assert_allclose(abs(scaled).max(axis=0).toarray().ravel(), 1.0, rtol=1e-12)
    assert abs(scaled).max() <= 1.0 + 1e-12


def test_equilibrate_leaves_empty_lines_alone() -> None:
    matrix = sp.csc_array(np.array([[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, -8.0]]))
    scaled, row, col = equilibrate(matrix)
    assert_allclose(scaled.matrix.toarray(), np.diag([0.0, 1.0, -1.0]), rtol=0.0)
    assert row[0] == col[0] == 1.0


@pytest.mark.parametrize("weight", [1.0, 1.0 + 2.0j], ids=["real", "complex"])
def test_columns_in_another_order_and_times_a_vector(weight: complex) -> None:
    rng = np.random.default_rng(3)
    matrix = sp.csc_array(weight * badly_scaled()) if weight.imag else badly_scaled()
    columns, x, order = Columns(matrix.data, matrix.indices, matrix.indptr), rng.normal(size=30), rng.permutation(30)
    x = x.astype(matrix.dtype)
    assert_array_equal(columns.in_order(order).matrix.toarray(), matrix.toarray()[np.ix_(order, order)])
    assert_array_equal(columns.times(x), matrix @ x)
    assert_array_equal(columns.magnitude.matrix.toarray(), np.abs(matrix.toarray()))


def test_solve_of_one_and_several_right_hand_sides() -> None:
    matrix = badly_scaled()
    x = np.random.default_rng(8).uniform(1.0, 2.0, (30, 3))
    x /= abs(matrix).max(axis=0).toarray().ravel()[:, None]  # so that no unknown drowns in another one's rounding
    factor = LinearSolver().factor(matrix)
    assert_allclose(factor.solve(matrix @ x), x, rtol=1e-9)
    assert_allclose(factor.solve(matrix @ x[:, 0]), x[:, 0], rtol=1e-9)


@pytest.mark.parametrize(
    "matrix",
    [np.zeros((2, 2)), np.array([[1.0, 0.0], [2.0, 0.0]]), np.array([[1.0, np.nan], [0.0, 1.0]]), [[np.inf]]],
    ids=["zero", "empty column", "nan", "inf"],
)
def test_what_has_no_inverse(matrix: object) -> None:
    with pytest.raises(SingularMatrixError):
        LinearSolver().factor(sp.csc_array(matrix))


def test_lines_that_share_one_column_have_no_inverse_and_never_reach_superlu(monkeypatch: pytest.MonkeyPatch) -> None:
    """In symmetric mode it writes past its arrays there: two series of 3000 such matrices ended the process."""
    monkeypatch.setattr(sparse_lu.spla, "splu", lambda *_, **__: pytest.fail("factorised"))
    matrix = np.diag([1.0, 0.0, 0.0, 2.0])
    matrix[1, 0] = matrix[2, 0] = matrix[0, 1] = matrix[0, 2] = 1.0
    with pytest.raises(SingularMatrixError, match="without a pivot"):
        LinearSolver().factor(sp.csc_array(matrix))


@pytest.mark.parametrize("seed", range(40))
def test_pivots_by_their_places(seed: int) -> None:
    """As SciPy's structural rank has it; with a full diagonal at once."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 40))
    matrix = sp.csc_array(sp.random_array((n, n), density=0.08, rng=rng) + sp.diags_array(rng.integers(0, 2, n) * 1.0))
    full = structural_rank(sp.csr_array(matrix)) == n
    assert equilibrate(matrix)[0].has_pivots == full
    assert equilibrate(sp.csc_array(matrix + sp.eye_array(n)))[0].has_pivots


def test_counts() -> None:
    solver = LinearSolver()
    for n in (3, 5, 2):
        solver.factor(sp.csc_array(sp.eye_array(n)))
    assert solver.counter.factorizations == 3
    assert solver.counter.largest == 5


@pytest.mark.parametrize(
    ("order", "even"), [([0, 1, 2], 1), ([1, 0, 2], -1), ([1, 2, 0], 1), ([3, 2, 1, 0], 1), ([], 1)]
)
def test_parity(order: list[int], even: int) -> None:
    assert parity(np.array(order, dtype=int)) == even


@pytest.mark.parametrize("seed", range(8))
def test_sign_of_the_determinant(seed: int) -> None:
    """Also with rows exchanged and in an order that is remembered."""
    rng = np.random.default_rng(seed)
    dense = np.where(rng.random((9, 9)) < 0.4, rng.standard_normal((9, 9)), 0.0) + np.diag(rng.standard_normal(9))
    solver, signs = LinearSolver(), []
    for _ in range(3):
        signs.append(solver.factor(sp.csc_array(dense), solver.elimination("one kind")).determinant_sign)
    assert signs == [np.sign(np.linalg.det(dense))] * 3
