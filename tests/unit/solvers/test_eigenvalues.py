"""The rightmost eigenvalue by Arnoldi's method on the inverse of the tangent."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.solvers.eigenvalues import CLOSER, SETTLED, UNSEEN, Pencil, arnoldi, rightmost
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


def random_pencil(seed: int, growth: float) -> tuple[Pencil, complex]:
    """A pencil with algebraic rows, and its rightmost eigenvalue by the QZ algorithm, of a real part as wanted."""
    rng, n, first = np.random.default_rng(seed), 90, 25
    J = rng.standard_normal((n, n)) / np.sqrt(n) + 2.0 * np.eye(n)
    M = np.zeros((n, n))
    M[first:] = np.hstack([0.1 * rng.standard_normal((n - first, first)), np.eye(n - first)])
    s = la.eigvals(-J, M)
    s = s[np.isfinite(s) & (np.abs(s) < 1e6)]
    exact = s[np.argmax(s.real)]
    J, exact = J + (exact.real - growth) * M, exact + (growth - exact.real)
    return Pencil(sp.csc_array(J), sp.csc_array(M), slice(first, None)), complex(exact.real, abs(exact.imag))


def apart(found: complex, exact: complex) -> float:
    """Difference in `theta`, over it."""
    return abs(exact / complex(found.real, abs(found.imag)) - 1.0)


@pytest.mark.parametrize("growth", [-0.5, 0.3], ids=["stable", "unstable"])
@pytest.mark.parametrize("seed", range(4))
def test_random_pencils_with_algebraic_rows(seed: int, growth: float) -> None:
    """Against the QZ algorithm, within twice what the method promises of `theta`; growth and decay are told apart."""
    pencil, exact = random_pencil(seed, growth)
    found = rightmost(pencil, LinearSolver())
    assert apart(found, exact) <= 2.0 * SETTLED
    assert (found.real > 0.0) == (exact.real > 0.0) == (growth > 0.0)


@pytest.mark.parametrize("growth", [-0.5, 0.3], ids=["stable", "unstable"])
@pytest.mark.parametrize("near", [-0.3, -0.5, -0.9, -3.0])
@pytest.mark.parametrize("seed", range(4))
def test_a_neighbour_changes_no_eigenvalue(seed: int, near: float, growth: float) -> None:
    """Where the rightmost lies on the other side of the place from which the pencil is seen, all is seen from zero."""
    pencil, exact = random_pencil(seed, growth)
    solver = LinearSolver()
    found = rightmost(pencil, solver, near)
    assert apart(found, exact) <= 2.0 * SETTLED
    assert solver.counter.factorizations == (1 if growth <= CLOSER * near else 2)


def test_a_neighbour_saves_solves() -> None:
    """Thirty eigenvalues that are equal within a few per cent, as those of equal petals are."""
    s = -8.0 * np.concatenate([np.linspace(1.0, 1.3, 30), np.linspace(1.4, 40.0, 200)])
    pencil = Pencil(sp.diags_array(-s, format="csc"), sp.eye_array(len(s), format="csc"), slice(0, None))
    far, close = LinearSolver(), LinearSolver()
    assert_allclose([rightmost(pencil, far).real, rightmost(pencil, close, -8.1).real], -8.0, rtol=1e-9)
    assert close.counter.solves <= 0.6 * far.counter.solves


def test_the_growth_of_a_single_row() -> None:
    assert arnoldi(lambda mass: -mass / 2.0, np.array([3.0])) == pytest.approx(2.0)
