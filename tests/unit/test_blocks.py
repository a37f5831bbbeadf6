"""Matrices from blocks against those of SciPy."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_array_equal

from petalfoil.sparsity import at_stations, block_diagonal, repeated

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
