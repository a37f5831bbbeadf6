"""Products of sparse rows are those of SciPy, bit by bit."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose, assert_array_equal

from petalfoil.sparsity import SparseRows, SummedEntries, Triplets, added_blocks


def random_rows(m: int, n: int, seed: int) -> sp.csr_array:
    """A random sparse matrix with entries of very different size, so that the order of sums shows."""
    rng = np.random.default_rng(seed)
    matrix = sp.random_array((m, n), density=0.2, rng=rng, format="csr")
    matrix.data = matrix.data * 10.0 ** rng.integers(-8, 8, len(matrix.data))
    return sp.csr_array(matrix)


@pytest.mark.parametrize(("m", "n"), [(40, 30), (1, 7), (5, 0), (0, 5)])
def test_products_are_those_of_scipy(m: int, n: int) -> None:
    plain, rng = random_rows(m, n, seed=m + n), np.random.default_rng(1)
    rows, x, y = SparseRows(plain), rng.standard_normal(n), rng.standard_normal(m)
    assert_array_equal(rows @ x, plain @ x)
    assert_array_equal(rows.T @ y, plain.T @ y)
    assert_array_equal(rows.magnitude @ x, abs(plain) @ x)
    assert_array_equal(rows.T.toarray(), plain.toarray().T)


def test_other_products_are_left_to_scipy() -> None:
    plain, rng = random_rows(20, 30, seed=3), np.random.default_rng(2)
    rows, block = SparseRows(plain), rng.standard_normal((30, 4))
    assert_array_equal(rows @ block, plain @ block)
    assert_array_equal(rows @ (1j * block[:, 0]), plain @ (1j * block[:, 0]))
    assert_array_equal((rows @ rows.T).toarray(), (plain @ plain.T).toarray())
    assert_array_equal(rows @ block[:, 1], plain @ np.ascontiguousarray(block[:, 1]))


def test_slices_of_rows_are_right_after_the_transpose_was_used() -> None:
    plain = random_rows(20, 30, seed=4)
    rows = SparseRows(plain)
    assert rows.T.shape == (30, 20)
    assert rows[3:7].T.shape == (30, 4)
    assert_array_equal(rows[3:7] @ np.ones(30), plain[3:7] @ np.ones(30))


def test_a_vector_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="30 columns cannot multiply a vector of 20"):
        SparseRows(random_rows(20, 30, seed=5)) @ np.ones(20)


def test_entries_times_factors_transposed_and_of_some_rows() -> None:
    plain, rng = random_rows(20, 30, seed=4), np.random.default_rng(3)
    row, column, some = rng.standard_normal(20), rng.standard_normal(30), np.array([2, 3, 17])

    def whole(entries: Triplets, shape: tuple[int, int]) -> np.ndarray:
        return sp.coo_array((entries.data, (entries.rows, entries.cols)), shape=shape).toarray()

    entries, dense = Triplets.of(plain), plain.toarray()
    assert_array_equal(whole(entries.times(rows=row, cols=column), (20, 30)), row[:, None] * dense * column)
    assert_array_equal(whole(entries.T.times(rows=-1.0), (30, 20)), -dense.T)
    assert_array_equal(whole(entries.from_rows(some, 20), (3, 30)), dense[some])
    assert entries.from_rows(np.arange(20), 20) is entries


def test_blocks_that_overlap_add_up() -> None:
    one, other = random_rows(2, 3, seed=5), random_rows(3, 2, seed=6)
    whole = np.diag([0.0, 0.0, 7.0, 8.0, 0.0])
    whole[:2, 2:] += one.toarray()
    whole[1:4, 1:3] += other.toarray()
    added = added_blocks([(0, 2, one), (1, 1, other.tocsc())], np.array([0.0, 0.0, 7.0, 8.0, 0.0]))
    assert_array_equal(added.toarray(), whole)


def test_blocks_given_by_their_entries() -> None:
    one = random_rows(2, 3, seed=5)
    for held in (one, one.tocsc(), one.tocoo()):
        added = added_blocks([(1, 0, Triplets.of(held)), (1, 0, held)], np.zeros(3))
        assert added.has_canonical_format
        assert_array_equal(added.toarray()[1:], 2.0 * one.toarray())


def test_entries_of_a_product_follow_its_values() -> None:
    """Places of the left factor named twice, and a place of the product that several of them reach."""
    rng, right = np.random.default_rng(8), random_rows(5, 7, seed=9)
    rows, cols = rng.integers(0, 4, 12), rng.integers(0, 5, 12)
    rows[-1], cols[-1] = rows[0], cols[0]
    entries = SummedEntries.of_product(rows, cols, right)
    assert len(np.unique(entries.rows + 4 * entries.cols)) == len(entries.rows)
    for _ in range(2):
        values, left, found = rng.standard_normal(12), np.zeros((4, 5)), np.zeros((4, 7))
        np.add.at(left, (rows, cols), values)
        at = entries.at(values)
        found[at.rows, at.cols] = at.data
        assert_allclose(found, left @ right.toarray(), rtol=1e-14, atol=1e-15)
