"""The compiled inner loops and those in NumPy give the same numbers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.classic import numpy_kernels
from petalfoil.classic.columns import ContactColumns
from petalfoil.classic.descent import PackDescent
from petalfoil.classic.film_cells import film_cells
from petalfoil.classic.kernels import DescentSettings, KernelBackend, MarchSettings, kernels
from petalfoil.classic.method_options import ClassicOptions
from tests.unit.classic.bearings import KINDS, bearing

pytestmark = pytest.mark.compiled

Array = NDArray[np.float64]


def stacks(layers: int, count: int = 200) -> tuple[ContactColumns, Array]:
    """Columns of `layers` and fewer over random nodes, and deflections for them."""
    rng = np.random.default_rng(layers)
    heights = rng.integers(1, layers + 1, count)
    node = np.full((layers, count), -1)
    node.T[np.arange(layers) < heights[:, None]] = rng.permutation(int(heights.sum()))
    between = np.vstack([np.zeros(count), rng.normal(size=(layers - 1, count))])
    shift = np.where(node >= 0, np.cumsum(between, axis=0), np.inf)
    low = rng.normal(size=count) - 1.0
    return ContactColumns(node, shift, low, low + rng.uniform(0.5, 3.0, count), heights), rng.normal(size=heights.sum())


@pytest.mark.parametrize("layers", [1, 2, 3, 4, 6])
def test_the_projections_are_equal(layers: int) -> None:
    from petalfoil.classic import compiled_kernels

    columns, W = stacks(layers)
    wanted = numpy_kernels.project(W, columns)
    compiled_kernels.project(W, columns)
    assert_allclose(W, wanted, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("kind", KINDS)
def test_the_marches_are_equal(kind: str) -> None:
    problem = bearing(kind)
    rng = np.random.default_rng(2)
    mesh = problem.layout.balance.mesh
    cells = film_cells(problem.layout.balance, rng.uniform(0.3, 3.0, mesh.shape), problem.bearing_number)
    start = problem.layout.balance.nodal_pressure(rng.uniform(0.7, 2.0, mesh.n_unknown)).ravel()
    ends = []
    for engine in KernelBackend:
        P = start.copy()
        ends.append((P, kernels(engine).march(P, cells, MarchSettings(0.95, 0.1, -1.0, 320))))
    (P_numba, (steps_numba, left_numba)), (P_numpy, (steps_numpy, left_numpy)) = ends
    assert steps_numba == steps_numpy == 320
    assert_allclose(P_numba, P_numpy, rtol=1e-12)
    assert_allclose(left_numba, left_numpy, rtol=1e-8, atol=1e-12)
    assert np.max(np.abs(P_numba - start)) > 0.1


@pytest.mark.parametrize("momentum", [False, True])
@pytest.mark.parametrize("kind", ["2d", "half"])
def test_the_descents_are_equal(kind: str, momentum: bool) -> None:
    problem = bearing(kind)
    pack = PackDescent(problem, ClassicOptions(momentum=momentum))
    load = np.random.default_rng(3).normal(size=problem.layout.n_wall)
    ends = []
    for engine in KernelBackend:
        W = np.zeros(problem.layout.n_wall)
        settings = DescentSettings(pack.step, momentum, -1.0, 400)
        ends.append((W, kernels(engine).descend(W, load, pack.shell, pack.columns, settings)))
    (W_numba, (steps_numba, left_numba)), (W_numpy, (steps_numpy, left_numpy)) = ends
    assert steps_numba == steps_numpy == 400
    assert_allclose(W_numba, W_numpy, rtol=0.0, atol=1e-10 * np.max(np.abs(W_numpy)))
    assert_allclose(left_numba, left_numpy, rtol=1e-6)
    assert left_numpy > 1e-6
