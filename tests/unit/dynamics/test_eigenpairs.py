"""Numbers and shapes that solve equations: found anew, and from those of equations nearby with fewer evaluations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.dynamics import eigenpairs
from petalfoil.dynamics.eigenpairs import Eigenpair, solved, solved_from

Complex = NDArray[np.complex128]

A = np.array([[-0.1 + 2.0j, 0.4, 0.1], [0.2, -0.3 + 3.0j, 0.3j], [0.1j, 0.2, 0.5 + 1.0j]])
CHANGED = A + 0.1 * np.array([[0.3, 0.2j, 0.1], [0.5j, -0.4, 0.2], [0.1, 0.3, 0.6j]])
SIZE = 3.0


class Counted:
    """Residual `(A - number) v + c |v| v / (1 + |v|)`, and how often it was asked for."""

    def __init__(self, matrix: Complex, stiffening: float = 0.0) -> None:
        self.matrix, self.stiffening, self.count = matrix, stiffening, 0

    def __call__(self, number: complex, v: Complex) -> Complex:
        self.count += 1
        size = np.linalg.norm(v)
        left: Complex = self.matrix @ v - number * v + self.stiffening * size / (1.0 + size) * np.conj(v) * v
        return left


def known() -> Eigenpair:
    """An eigenpair of `A`."""
    numbers, shapes = np.linalg.eig(A)
    found = solved(Counted(A), (numbers[0] + 0.01, shapes[:, 0]), SIZE)
    assert found is not None
    assert found.number == pytest.approx(numbers[0], abs=1e-7)
    return found


def by_number(found: Eigenpair) -> NDArray[np.float64]:
    """Its slope by the number itself and by the shape."""
    slope = found.slope.copy()
    slope[:, [0, len(slope) // 2]] /= found.unit
    return slope


@pytest.mark.parametrize("other", [lambda: Counted(CHANGED), lambda: Counted(CHANGED, 0.2)], ids=["linear", "bent"])
def test_a_solution_from_one_nearby_with_fewer_evaluations(other: Callable[[], Counted]) -> None:
    one, anew = other(), other()
    found, again = solved_from(one, known(), SIZE), solved(anew, known().motion, SIZE)
    assert found is not None
    assert again is not None
    assert np.max(np.abs(one(*found.motion))) <= 3.0 * eigenpairs.SOLVED * SIZE
    assert found.number == pytest.approx(again.number, abs=1e-7)
    assert_allclose(found.v, again.v, atol=1e-7)
    assert_allclose(by_number(found), by_number(again), atol=1e-4 * SIZE)
    assert one.count < 0.8 * anew.count


def test_the_number_of_changed_equations_is_their_eigenvalue() -> None:
    found = solved_from(Counted(CHANGED), known(), SIZE)
    assert found is not None
    assert np.min(np.abs(np.linalg.eigvals(CHANGED) - found.number)) < 1e-7


def test_where_the_derivative_leads_away_the_solution_is_found_without_it() -> None:
    astray = known()
    astray = Eigenpair(astray.number, astray.v, -1e-3 * astray.slope, astray.unit, astray.pivot)
    found = solved_from(Counted(CHANGED), astray, SIZE)
    assert found is not None
    assert np.min(np.abs(np.linalg.eigvals(CHANGED) - found.number)) < 1e-7
