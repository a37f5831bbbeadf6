"""Extremes between nodes."""

import numpy as np
import pytest
from numpy.typing import NDArray

from petalfoil.analysis.extremes import highest, lowest, vertex

Array = NDArray[np.float64]
ONE = np.zeros(1)


def bowl(x: Array, z: Array) -> Array:
    """Lowest at (0.513, 0.44), where it is -1; the two directions are coupled."""
    u, v = x[:, None] - 0.513, z[None, :] - 0.44
    return np.asarray(-np.cos(3.0 * u + v) * np.cos(2.0 * v - u))


def graded(n: int) -> Array:
    """Nodes that crowd toward both ends."""
    s = np.linspace(0.0, 1.0, n)
    return np.asarray(s - 0.6 / (2.0 * np.pi) * np.sin(2.0 * np.pi * s))


def test_a_parabola_is_found_exactly_on_any_spacing() -> None:
    x = np.array([0.1, 0.35, 0.5])
    value, place = vertex(x, 2.0 + 3.0 * (x - 0.31) ** 2)
    assert value == pytest.approx(2.0, rel=1e-13)
    assert place == pytest.approx(0.31, rel=1e-13)


def test_a_quartic_in_both_directions_is_found_exactly_on_any_spacing() -> None:
    x, z = graded(9) ** 1.1, graded(7)
    u, v = x[:, None] - 0.47, z[None, :] - 0.55
    field = 1.0 + u**2 + 0.5 * v**2 + 0.3 * u * v + 0.4 * u**3 + u**2 * v**2 + u**4
    low = lowest(field[None], x, z)
    assert low.value == pytest.approx(1.0, rel=1e-13)
    assert (low.phi, low.z) == pytest.approx((0.47, 0.55), rel=1e-7)


@pytest.mark.parametrize("nodes", [np.linspace, lambda a, b, n: graded(n)])
def test_error_falls_as_the_fifth_power_in_both_directions(nodes: type) -> None:
    errors, places = [], []
    for n in (17, 33, 65):
        x, z = nodes(0.0, 1.0, n), nodes(0.0, 1.0, n)
        low = lowest(np.broadcast_to(bowl(x, z), (2, n, n)), x, z)
        errors.append(abs(low.value + 1.0))
        places.append(float(np.hypot(low.phi - 0.513, low.z - 0.44)))
    assert np.log2(errors[0] / errors[-1]) / 2.0 > 4.5
    assert np.log2(places[0] / places[-1]) / 2.0 > 3.5
    assert errors[-1] < 1e-8


def test_the_lowest_value_may_lie_on_another_strip_than_the_lowest_node() -> None:
    x = np.linspace(0.0, 1.0, 11)
    on_a_node, between_nodes = -np.cos(4.0 * (x - 0.5)), -1.002 * np.cos(4.0 * (x - 0.55))
    field = np.array([on_a_node, between_nodes])[:, :, None]
    assert field.argmin() < len(x)  # the lowest node is on the first strip
    low = lowest(field, x, ONE)
    assert low.strip == 1
    assert (low.value, low.phi) == pytest.approx((-1.002, 0.55), rel=5e-5)
    high = highest(-field, x, ONE)
    assert (high.strip, high.value) == (1, -low.value)


def test_at_a_border_the_node_stands_in_that_direction_alone() -> None:
    x, z = np.linspace(0.0, 1.0, 33), np.linspace(0.0, 1.0, 17)
    field = (z[None, :] + 1.0) * (2.0 - np.cos(5.0 * (x[:, None] - 0.513)))
    low = lowest(field[None], x, z)
    assert low.z == 0.0
    assert (low.value, low.phi) == pytest.approx((1.0, 0.513), rel=1e-6)
    corner = np.array([[[3.0], [2.0], [1.0]]])
    low = lowest(corner, np.array([0.0, 1.0, 2.0]), ONE)
    assert (low.value, low.phi, low.strip, low.z) == (1.0, 2.0, 0, 0.0)


def test_a_kink_does_not_carry_the_extreme_off() -> None:
    x = np.linspace(0.0, 1.0, 21)
    spike = np.where(x < 0.52, 1.0 - x, 1.0 + 40.0 * (x - 0.51))
    low = lowest(spike[None, :, None], x, ONE)
    k = int(spike.argmin())
    assert spike[k] - 0.25 * max(spike[k - 1] - spike[k], spike[k + 1] - spike[k]) <= low.value <= spike[k]
    assert x[k - 1] < low.phi < x[k + 1]


def test_two_nodes_in_a_direction_have_no_inside() -> None:
    field = np.array([[[2.0, 1.5], [3.0, 4.0]]])
    low = lowest(field, np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    assert (low.value, low.phi, low.z) == (1.5, 0.0, 1.0)
