"""Cubic curves through values at nodes: those of SciPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline, PchipInterpolator

from petalfoil.mesh.splines import CubicCurve, monotone, smooth

SEED = np.random.default_rng(7)
PAIRS: list[tuple[Callable[..., CubicCurve], Callable[..., Any]]] = [
    (smooth, CubicSpline),
    (monotone, PchipInterpolator),
]


@pytest.mark.parametrize("count", [2, 3, 4, 5, 33])
@pytest.mark.parametrize("axis", [0, 1, 2, -1])
@pytest.mark.parametrize(("ours", "theirs"), PAIRS)
def test_values_and_derivatives_are_scipy_s(ours: Any, theirs: Any, axis: int, count: int) -> None:
    nodes = np.cumsum(SEED.uniform(0.1, 1.0, count))
    values = np.moveaxis(SEED.normal(size=(count, 3, 2)), 0, axis)
    places = np.concatenate([nodes, SEED.uniform(nodes[0] - 0.2, nodes[-1] + 0.2, 40)])
    for derivative in range(4):
        found, wanted = ours(nodes, values, axis)(places, derivative), theirs(nodes, values, axis)(places, derivative)
        assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * np.max(np.abs(wanted), initial=1.0))


@pytest.mark.parametrize("values", [[0.0, 1.0, 1.0, 3.0, 2.0], [0.0, 5.0, 4.9, 5.1, -9.0], [1.0, 1.0, 1.0, 1.0, 1.0]])
def test_a_monotone_curve_stays_between_its_values(values: list[float]) -> None:
    nodes, y = np.array([0.0, 0.5, 0.6, 2.0, 2.1]), np.array(values)
    for i in range(4):
        between = monotone(nodes, y, 0)(np.linspace(nodes[i], nodes[i + 1], 50))
        assert np.min(between) >= min(y[i], y[i + 1]) - 1e-14
        assert np.max(between) <= max(y[i], y[i + 1]) + 1e-14
    places = np.linspace(0.0, 2.1, 99)
    assert_allclose(monotone(nodes, y, 0)(places), PchipInterpolator(nodes, y)(places), rtol=1e-14)


def test_a_smooth_curve_is_a_cubic_where_values_are() -> None:
    nodes, places = np.array([0.0, 0.3, 1.0, 1.1, 2.0]), np.linspace(-0.5, 2.5, 31)
    cubic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])
    curve = smooth(nodes, cubic(nodes), 0)
    assert_allclose(curve(places), cubic(places), rtol=1e-12, atol=1e-12)
    assert_allclose(curve(places, 1), cubic.deriv()(places), rtol=1e-11, atol=1e-11)
