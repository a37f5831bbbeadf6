"""The central path by its arc length: through folds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.central_path import PathOptions, follow_central_path
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.sparsity import SparseRows
from tests.unit.solvers.problems import CELLS, string, string_answer
from tests.verification.shell_helpers import cold_point

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SofteningSpring:
    """`F = ((x - 2)^2 + 0.1) (x + 1/2)` against the gap `1 + x`: `mu = (1 + x) F` has a least value near x = 2.

    The path comes from large `x` and `mu`, turns back near x = 2 and again near x = 1, and ends at x = -1/2.
    """

    @property
    def G(self) -> SparseRows:
        return SparseRows([[1.0]])

    @property
    def acting(self) -> SparseRows:
        return self.G

    @property
    def weight(self) -> Array:
        return np.ones(1)

    @property
    def elimination_key(self) -> None:
        return None

    @property
    def positive(self) -> slice:
        return slice(0, 0)

    def gaps(self, x: Array) -> Array:
        return 1.0 + x

    def admits(self, x: Array) -> bool:
        return True

    def linearize(self, x: Array, shift: Array | None = None) -> SofteningLine:
        return SofteningLine(x)


@dataclass(frozen=True)
class SofteningLine:
    x: Array

    @property
    def residual(self) -> Array:
        out: Array = ((self.x - 2.0) ** 2 + 0.1) * (self.x + 0.5)
        return out

    @property
    def row_scale(self) -> Array:
        return np.ones(1)

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        slope = 2.0 * (self.x[0] - 2.0) * (self.x[0] + 0.5) + (self.x[0] - 2.0) ** 2 + 0.1
        return sp.csc_array([[slope + barrier_weight[0] + rate]])

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        return np.zeros(1)


FAR = PrimalDualPoint(np.array([5.0]), np.array([6.0]), np.array([15.0]))
"""Near the path at a barrier of 100."""


def test_through_two_folds() -> None:
    end = follow_central_path(SofteningSpring(), FAR, (100.0, 1e-8), LinearSolver(), PathOptions())
    assert end is not None
    assert_allclose(end.x, -0.5, atol=1e-6)
    assert_allclose(end.lam * end.s, end.barrier(np.ones(1)), rtol=1e-12)
    assert end.barrier(np.ones(1)) <= 1e-8


def test_the_string_as_an_interior_point_has_it() -> None:
    problem, options = string(), PathOptions()
    end = follow_central_path(problem, cold_point(problem, CELLS - 1), (1.0, 1e-10), LinearSolver(), options)
    assert end is not None
    w, lam = string_answer()
    assert_allclose(end.x, w, atol=1e-5)
    assert_allclose(end.lam, lam, atol=1e-2)


@pytest.mark.parametrize("options", [PathOptions(steps=3), replace(PathOptions(), start_corrections=0)])
def test_a_path_that_is_lost(options: PathOptions) -> None:
    assert follow_central_path(SofteningSpring(), FAR, (100.0, 1e-8), LinearSolver(), options) is None
