"""Matrices from blocks against those of SciPy."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_array_equal

from petalfoil.sparsity import SparseRows, Triplets, at_stations, block_diagonal, compressed, repeated, rows_of_blocks

rng = np.random.default_rng(2)
WIDE = sp.random_array((3, 5), density=0.4, rng=rng, format="csr")
EMPTY = sp.csr_array((2, 0))


def assert_same(one: sp.csr_array, other: sp.sparray) -> None:
    """Entry by entry, the order in which they are held included."""
    wanted = sp.csr_array(other)
    wanted.eliminate_zeros()
    assert one.shape == wanted.shape
    assert_array_equal(one.indptr, wanted.indptr)
    assert_array_equal(one.indices, wanted.indices)
    assert_array_equal(one.data, wanted.data)


def test_blocks_along_the_diagonal() -> None:
    """Sparse, dense and empty ones; zeros of dense parts are not stored."""
    parts = [WIDE, np.array([[1.0, 0.0], [0.0, 2.0]]), EMPTY, WIDE.tocsc()]
    assert_same(block_diagonal(parts), sp.block_diag(parts, format="csr"))


def test_no_blocks() -> None:
    """A matrix without rows."""
    assert block_diagonal([]).shape == (0, 0)


@pytest.mark.parametrize("matrix", [WIDE, EMPTY])
def test_one_block_several_times(matrix: sp.csr_array) -> None:
    """The product of the identity with it."""
    assert_same(repeated(matrix, 4), sp.kron(sp.eye_array(4), matrix, format="csr"))


@pytest.mark.parametrize("count", [1, 3])
def test_a_matrix_at_stations(count: int) -> None:
    """Its product with the identity."""
    assert_same(at_stations(WIDE, count), sp.kron(WIDE, sp.eye_array(count), format="csr"))


@pytest.mark.parametrize("kind", [sp.csr_array, sp.csc_array, SparseRows])
def test_compressed_matrices_are_those_of_scipy(kind: type[sp.sparray]) -> None:
    """Entries, shape and products; the next of the same shape has its own arrays, and indices of 32 bits."""
    wanted = [kind(sp.random_array((4, 4), density=0.4, rng=rng, format="csr")) for _ in range(2)]
    made = [compressed(kind, m.data, m.indices.astype(np.int64), m.indptr.astype(np.int64), m.shape) for m in wanted]
    for one, other in zip(made, wanted, strict=True):
        assert type(one) is kind
        assert one.indices.dtype == one.indptr.dtype == np.int32
        assert_array_equal(one.toarray(), other.toarray())
        assert_array_equal(one @ np.arange(4.0), other @ np.arange(4.0))
        assert_array_equal((one @ other).toarray(), (other @ other).toarray())


def test_transposes_and_magnitudes_of_rows() -> None:
    """As SciPy's, whatever the sign of the entries."""
    rows = SparseRows(WIDE - 2.0 * WIDE.tocsr()[[1, 2, 0]])
    assert_array_equal(rows.T.toarray(), rows.toarray().T)
    assert_array_equal(rows.magnitude.toarray(), np.abs(rows.toarray()))
    assert rows.T @ np.ones(3) == pytest.approx(rows.toarray().T @ np.ones(3))


def test_rows_of_blocks_beside_and_below_each_other() -> None:
    """As `block_array`; zeros of a diagonal are left out."""
    diagonal = np.array([1.0, 0.0, 3.0])
    found = rows_of_blocks([(0, 0, WIDE), (0, 5, Triplets.diagonal(diagonal)), (3, 5, WIDE[:2, :3].tocsc())], (5, 8))
    assert_same(found, sp.block_array([[WIDE, sp.diags_array(diagonal)], [None, WIDE[:2, :3]]], format="csr"))
