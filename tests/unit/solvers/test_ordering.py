"""Tests of the order of elimination: its tree, its postorder, and what is kept from one matrix to the next."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose, assert_array_equal

from petalfoil.solvers.sparse_lu import Columns, LinearSolver, symmetric_lu, without_zeros
from petalfoil.sparsity import Elimination, TiedOrder, postorder
from petalfoil.sparsity.ordering import FULLER, GROWN, parents


def grid(n: int, seed: int = 0) -> sp.csc_array:
    """A dominant matrix on the pattern of an n by n grid, some of its couplings cut."""
    rng = np.random.default_rng(seed)
    line = sp.diags_array([1.0, 1.0], offsets=[-1, 1], shape=(n, n))
    pattern = sp.csc_array(sp.kron(line, sp.eye_array(n)) + sp.kron(sp.eye_array(n), line))
    pattern.data = rng.uniform(-1.0, 1.0, pattern.nnz) * (rng.uniform(size=pattern.nnz) < 0.9)
    return sp.csc_array(pattern + 5.0 * sp.eye_array(n * n))


def eliminated(matrix: sp.csc_array, order: np.ndarray) -> tuple[list[set[int]], np.ndarray]:
    """Rows below the diagonal of every column of the factor, and the tree, by elimination on paper."""
    n = matrix.shape[0]
    dense = matrix.toarray()[np.ix_(order, order)]
    below = [{i for i in range(j + 1, n) if dense[i, j] or dense[j, i]} for j in range(n)]
    parent = np.full(n, n)
    for j in range(n):
        if below[j]:
            parent[j] = min(below[j])
            below[parent[j]] |= below[j] - {parent[j]}
    return below, parent


def columns(matrix: sp.csc_array) -> Columns:
    return Columns(matrix.data, matrix.indices, matrix.indptr)


@pytest.mark.parametrize("seed", range(4))
def test_the_tree_is_that_of_elimination_on_paper(seed: int) -> None:
    matrix = without_zeros(grid(7, seed))
    for order in (np.argsort(symmetric_lu(columns(matrix), None).perm_c), np.random.default_rng(seed).permutation(49)):
        assert_array_equal(parents(matrix, order), eliminated(matrix, order)[1])


@pytest.mark.parametrize("seed", range(4))
def test_postorder_fills_in_the_same_and_keeps_subtrees_together(seed: int) -> None:
    matrix = without_zeros(grid(7, seed))
    order = np.argsort(symmetric_lu(columns(matrix), None).perm_c)
    below, _ = eliminated(matrix, order)
    after, parent = eliminated(matrix, postorder(matrix, order))
    assert sum(map(len, after)) == sum(map(len, below))
    members = [{j} for j in range(len(parent))]
    for j, top in enumerate(parent):
        if top < len(parent):
            members[top] |= members[j]
    for j, tree in enumerate(members):
        assert tree == set(range(j + 1 - len(tree), j + 1))


def test_an_order_is_found_once_and_kept() -> None:
    kept, solver = Elimination(), LinearSolver()
    assert kept.known() is None
    for seed in range(3):
        matrix = grid(9, seed)
        factor = solver.factor(matrix, kept)
        x = np.arange(1.0, 82.0)
        assert_allclose(factor.solve(matrix @ x), x, rtol=1e-12)
        assert seed > 0 or factor.order is None
    known = kept.known()
    assert known is not None
    assert_array_equal(np.sort(known), np.arange(81))


def test_an_order_is_found_only_for_a_second_matrix() -> None:
    kept, asked = Elimination(), []

    def order() -> np.ndarray:
        asked.append(True)
        return np.arange(5)

    kept.learn(order, 10.0, 100)
    assert not asked
    for _ in range(2):
        assert_array_equal(kept.known(100), np.arange(5))
    assert len(asked) == 1


def test_an_order_is_given_up_where_factors_have_grown() -> None:
    kept = Elimination()
    kept.learn(lambda: np.arange(5), 10.0)
    kept.learn(None, 12.0)  # in postorder SuperLU stores more: the first such factors are the measure
    kept.learn(None, 0.99 * GROWN * 12.0)
    assert kept.known() is not None
    kept.learn(None, 1.01 * GROWN * 12.0)
    assert kept.known() is None


def test_an_order_does_not_serve_a_matrix_with_more_entries() -> None:
    """The first matrix of an interior point lacks entries of the later ones."""
    kept = Elimination()
    kept.learn(lambda: np.arange(5), 10.0, 100)
    assert kept.known(int(0.99 * FULLER * 100)) is not None
    assert kept.known(int(1.1 * FULLER * 100)) is None
    kept.learn(lambda: np.arange(5), 12.0, 120)
    assert kept.known(120) is not None


def test_orders_pass_from_one_contact_set_to_the_next() -> None:
    kept = Elimination()
    before = TiedOrder(kept.tied, np.array([0, 1, -1, 1, 2]), 3)  # the second and fourth move together, the third not
    before.learn(lambda: np.array([2, 0, 1]), 1.0)
    after = TiedOrder(kept.tied, np.array([0, 1, 2, 3, 0]), 4)  # all move, the first with the last
    order = after.known()
    assert order is not None
    # 0 (with the last of places 1 and 0), then the pair that was one, and the one that was held by its neighbour
    assert_array_equal(order, [0, 1, 2, 3])
    assert TiedOrder(kept.whole, before.group, 3).known() is None


def test_many_right_hand_sides_are_those_one_by_one() -> None:
    matrix = grid(6)
    rhs = np.random.default_rng(1).normal(size=(36, 21))
    factor = LinearSolver().factor(matrix, Elimination())
    assert_allclose(factor.solve(rhs), np.column_stack([factor.solve(column) for column in rhs.T]), rtol=1e-13)
    assert factor.solve(rhs[:, :0]).shape == (36, 0)


def test_stored_zeros_do_not_fill_in() -> None:
    bare = without_zeros(grid(8))
    rows, cols = np.arange(64), np.arange(64)[::-1]
    padded = sp.coo_array(
        (
            np.append(bare.tocoo().data, np.zeros(64)),
            (np.append(bare.tocoo().row, rows), np.append(bare.tocoo().col, cols)),
        )
    ).tocsc()
    assert padded.nnz > bare.nnz
    assert LinearSolver().factor(padded).lu.nnz == LinearSolver().factor(bare).lu.nnz
