"""The rightmost eigenvalue by Arnoldi's method on the inverse of the tangent."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.solvers.eigenvalues import SETTLED, UNSEEN, Pencil, arnoldi, rightmost
from petalfoil.solvers.sparse_lu import LinearSolver


def of(theta: np.ndarray) -> complex:
    start = np.random.default_rng(0).standard_normal(len(theta))
    return arnoldi(lambda mass: theta * mass, start)


@pytest.mark.parametrize(
    "values", [(0.5,), (0.9, 0.5, 0.1, -0.3), (0.7, 0.7, 0.2)], ids=["one", "four", "a double one"]
)
def test_a_space_that_holds_all_there_is_ends_the_search(values: tuple[float, ...]) -> None:
    """A hundred unknowns, few eigenvalues: what rounding adds to the space is no eigenvalue."""
    theta = np.resize(np.array(values), 100)
    exact = max(-1.0 / value for value in values)
    assert_allclose(of(theta), exact, rtol=1e-9)


def test_a_map_to_nothing_decays_at_once() -> None:
    assert of(np.zeros(7)).real == pytest.approx(-1.0 / UNSEEN)


@pytest.mark.parametrize("shift", [-0.5, 0.3], ids=["stable", "unstable"])
@pytest.mark.parametrize("seed", range(4))
def test_random_pencils_with_algebraic_rows(seed: int, shift: float) -> None:
    """Against the QZ algorithm, within twice what the method promises of `theta`; growth and decay are told apart."""
    rng, n, first = np.random.default_rng(seed), 90, 25
    J = rng.standard_normal((n, n)) / np.sqrt(n) + 2.0 * np.eye(n)
    M = np.zeros((n, n))
    M[first:] = np.hstack([0.1 * rng.standard_normal((n - first, first)), np.eye(n - first)])
    s = la.eigvals(-J, M)
    s = s[np.isfinite(s) & (np.abs(s) < 1e6)]
    exact = s[np.argmax(s.real)]
    J, exact = J + (exact.real - shift) * M, exact + (shift - exact.real)  # where its real part is wanted
    found = rightmost(Pencil(sp.csc_array(J), sp.csc_array(M), slice(first, None)), LinearSolver())
    theta = [-1.0 / value for value in (complex(found.real, abs(found.imag)), complex(exact.real, abs(exact.imag)))]
    assert abs(theta[0] - theta[1]) <= 2.0 * SETTLED * abs(theta[1])
    assert (found.real > 0.0) == (exact.real > 0.0) == (shift > 0.0)


def test_the_growth_of_a_single_row() -> None:
    assert arnoldi(lambda mass: -mass / 2.0, np.array([3.0])) == pytest.approx(2.0)
