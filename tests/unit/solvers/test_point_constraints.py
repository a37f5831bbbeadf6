"""Contacts between nodes as eliminated unknowns, against dense linear algebra."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.point_constraints import PointConstraints, constrain_points
from tests.unit.solvers.test_constraints import N, random_sets

Array = NDArray[np.float64]


def constrained(seed: int) -> tuple[Array, PointConstraints]:
    """Dense rows of node contacts and points that say nothing twice, and the constraints."""
    rng = np.random.default_rng(seed)
    sets = random_sets()
    while True:
        G, closed = sets[rng.integers(len(sets))]
        points = sp.csr_array(rng.normal(size=(3, N)) * (rng.random((3, N)) < 0.25))
        rows = np.vstack([G[closed].toarray(), points.toarray()])
        if np.linalg.matrix_rank(rows, tol=1e-6) == len(rows):
            return rows, constrain_points(constrain(G, closed), points)


@pytest.mark.parametrize("seed", range(12))
def test_against_the_dense_null_space(seed: int) -> None:
    rows, constraints = constrained(seed)
    rng, null = np.random.default_rng(seed), scipy.linalg.null_space(rows)
    Z = constraints.basis.toarray()
    assert constraints.determinate
    assert constraints.n_free == null.shape[1]
    assert_allclose(rows @ Z, 0.0, atol=1e-13)
    assert np.linalg.matrix_rank(np.hstack([Z, null])) == constraints.n_free

    matrix, free = rng.normal(size=(N, N)), rng.normal(size=constraints.n_free)
    assert_allclose(constraints.reduce(sp.csc_array(matrix)).toarray(), Z.T @ matrix @ Z, atol=1e-12)
    assert_allclose(constraints.spread(free), Z @ free, atol=1e-13)
    assert_allclose(constraints.gather(matrix[0]), Z.T @ matrix[0], atol=1e-13)
    assert_allclose(constraints.spread(Z.T), Z @ Z.T, atol=1e-12)
    assert_allclose(constraints.gather(matrix), Z.T @ matrix, atol=1e-12)
    gaps, lam = rng.normal(size=len(rows)), rng.normal(size=len(rows))
    assert_allclose(constraints.close(gaps), np.linalg.lstsq(rows, -gaps, rcond=None)[0], atol=1e-10)
    assert_allclose(constraints.reactions(rows.T @ lam), lam, atol=1e-10)


def test_unknowns_are_ordered_with_those_they_depend_on() -> None:
    _, constraints = constrained(3)
    Z = np.abs(constraints.basis.toarray())
    for row, group in zip(Z, constraints.group, strict=True):
        if group >= 0:
            assert row[group] == row.max() > 0.0
        else:
            assert not row.any()


def test_a_point_that_repeats_a_node_contact_is_not_determinate() -> None:
    G = sp.csr_array(np.eye(N))
    closed = np.arange(N) < 3
    repeated = sp.csr_array(0.5 * (np.eye(N)[[0]] + np.eye(N)[[2]]))
    assert constrain_points(constrain(G, closed), sp.csr_array(np.eye(N)[[5]])).determinate
    assert not constrain_points(constrain(G, closed), repeated).determinate


def test_a_row_without_unknowns_constrains_nothing() -> None:
    G, closed = sp.csr_array(np.eye(N)), np.arange(N) < 3
    row = sp.csr_array(np.eye(N)[[5, 6]])
    row.data[1] = 0.0
    constraints = constrain_points(constrain(G, closed), row)
    assert not constraints.determinate
    assert constraints.n_free == N - 4
