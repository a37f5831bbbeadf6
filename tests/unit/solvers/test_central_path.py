"""The central path by its arc length: through folds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers import central_path
from petalfoil.solvers.central_path import PathOptions, PathPoint, follow_central_path, unit
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
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


def point_of_the_path(x: float) -> PathPoint:
    """The point of the path of `SofteningSpring` at `x`."""
    slack, force = 1.0 + x, float(SofteningLine(np.array([x])).residual[0])
    t, z = float(np.log(slack * force)), np.array([force - slack])
    return PathPoint(SofteningSpring(), LinearSolver(), np.array([x]), z, t)


@pytest.mark.parametrize("x", [4.0, 2.2, 1.9, 1.2, 0.8, -0.4])
def test_the_determinant_tells_which_way_the_barrier_goes(x: float) -> None:
    """The path runs from large to small `x`; `mu = (1 + x) F` rises on it where its derivative by `x` is negative."""
    point, ahead = point_of_the_path(x), point_of_the_path(x - 1e-4)
    assert point.residual < 1e-12
    assert point.factor.determinant_sign == -np.sign(ahead.t - point.t)


def test_a_leap_between_parts_of_a_path_does_not_turn_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the first part, where the barrier falls, a step lands between the folds: it rises ahead, `x` falls on."""
    first, between, options = point_of_the_path(4.0), point_of_the_path(1.6), PathOptions(weight=1e-3, aligned=-1.0)
    ahead = unit(first.tangent(), -1.0, options)
    assert ahead.along(between.tangent(), options.weight) < 0.0  # by its angle alone the step would be sent back
    monkeypatch.setattr(central_path, "correct", lambda *_: (between, 3))
    found = central_path.advance(first, ahead, 1.0, options)
    assert found is not None
    assert found[1].t > 0.0
    assert found[1].x[0] < 0.0


def test_a_singular_trial_shortens_the_step(monkeypatch: pytest.MonkeyPatch) -> None:
    first, options, correct, asked = point_of_the_path(4.0), PathOptions(), PathPoint.newton, []

    def singular_at_first(point: PathPoint) -> central_path.Change:
        asked.append(point)
        if len(asked) == 1:
            raise SingularMatrixError
        return correct(point)

    monkeypatch.setattr(PathPoint, "newton", singular_at_first)
    found = central_path.advance(first, unit(first.tangent(), -1.0, options), 0.5, options)
    assert found is not None
    assert found[0].residual <= options.tolerance
    assert abs(found[0].t - first.t) < 0.5


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
