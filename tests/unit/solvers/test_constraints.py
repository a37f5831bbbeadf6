"""Closed gaps against dense linear algebra, for random sets."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints, constrain
from tests.verification.shell_helpers import rows_of

N = 14


def random_gaps(rng: np.random.Generator) -> sp.csr_array:
    """Rows of +-1 on one unknown, and differences of two."""
    holds = [(rng.integers(N, size=4), 1.0)]
    pushes = [(rng.integers(N, size=4), -1.0)]
    pairs = np.array([rng.choice(N, 2, replace=False) for _ in range(12)])
    differences = [(pairs[:, 0], 1.0), (pairs[:, 1], -1.0)]
    return sp.csr_array(sp.vstack([rows_of(N, *terms) for terms in (holds, pushes, differences)], format="csr"))


def random_sets() -> list[tuple[sp.csr_array, NDArray[np.bool_]]]:
    """Gaps and closed ones among them, as many as say nothing twice."""
    rng = np.random.default_rng(11)
    found: list[tuple[sp.csr_array, NDArray[np.bool_]]] = []
    while len(found) < 20:
        G = random_gaps(rng)
        closed = rng.random(G.shape[0]) < rng.uniform(0.05, 0.5)
        rows = G[closed].toarray()
        if closed.any() and np.linalg.matrix_rank(rows) == len(rows):
            found.append((G, closed))
    return found


def moves(ties: ContactConstraints) -> NDArray[np.float64]:
    """The motions that ties leave, one a column."""
    return np.stack([ties.spread(unit) for unit in np.eye(ties.n_free)], axis=1)


@pytest.mark.parametrize(("G", "closed"), random_sets())
def test_against_the_dense_null_space(G: sp.csr_array, closed: NDArray[np.bool_]) -> None:
    rng = np.random.default_rng(12)
    rows, ties = G[closed].toarray(), constrain(G, closed)
    null = scipy.linalg.null_space(rows)
    Z = moves(ties)
    assert ties.determinate
    assert ties.n_free == null.shape[1]
    assert_allclose(rows @ Z, 0.0, atol=0.0)
    assert np.linalg.matrix_rank(np.hstack([Z, null])) == ties.n_free

    matrix, residual = rng.normal(size=(N, N)), rng.normal(size=N)
    assert_allclose(ties.reduce(sp.csc_array(matrix)).toarray(), Z.T @ matrix @ Z, atol=1e-13)
    assert_allclose(ties.gather(residual), Z.T @ residual, atol=1e-14)

    gaps = rng.normal(size=len(rows))
    assert_allclose(ties.close(gaps), np.linalg.lstsq(rows, -gaps, rcond=None)[0], atol=1e-12)
    lam = rng.normal(size=len(rows))
    assert_allclose(ties.reactions(rows.T @ lam), lam, atol=1e-12)


def test_nothing_closed() -> None:
    G = rows_of(3, ([0, 1], 1.0))
    ties = constrain(G, np.zeros(2, dtype=bool))
    assert ties.determinate
    assert ties.n_free == 3
    assert_allclose(ties.close(np.zeros(0)), 0.0, atol=0.0)
    assert ties.reactions(np.ones(3)).shape == (0,)


@pytest.mark.parametrize(
    "rows",
    [
        np.array([[1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]]),  # held at both ends
        np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]]),  # a node between two walls
        np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [-1.0, 0.0, 1.0]]),  # a ring
    ],
    ids=["chain", "between walls", "ring"],
)
def test_what_is_said_twice_is_not_determinate(rows: NDArray[np.float64]) -> None:
    G = sp.csr_array(rows)
    assert not constrain(G, np.ones(len(rows), dtype=bool)).determinate
    assert constrain(G, np.arange(len(rows)) > 0).determinate


def test_everything_held() -> None:
    ties = constrain(rows_of(2, ([0, 1], 1.0)), np.ones(2, dtype=bool))
    assert ties.n_free == 0
    assert_allclose(ties.spread(np.zeros(0)), 0.0, atol=0.0)
    assert ties.reduce(sp.csc_array(np.eye(2))).shape == (0, 0)


def test_equations_of_unknowns_that_move_together_are_compared_with_the_largest_scale() -> None:
    """Reactions leave the mean of a group's residuals in each of its rows, rounding of the largest included."""
    G = sp.csr_array(np.array([[1.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]))
    ties = constrain(G, np.array([True, True]))
    assert ties.largest(np.array([1.0, 50.0, 3.0, 7.0])).tolist() == [50.0, 50.0, 3.0, 7.0]
    assert ties.reactions(np.array([0.0, 2.0, 0.0, 0.0]))[0] == pytest.approx(-1.0)
