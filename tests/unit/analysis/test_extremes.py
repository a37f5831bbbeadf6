"""Extremes between nodes."""

import numpy as np
import pytest

from petalfoil.analysis.extremes import highest, lowest, vertex


def test_a_parabola_is_found_exactly_on_any_spacing() -> None:
    x = np.array([0.1, 0.35, 0.5])
    value, place = vertex(x, 2.0 + 3.0 * (x - 0.31) ** 2)
    assert value == pytest.approx(2.0, rel=1e-13)
    assert place == pytest.approx(0.31, rel=1e-13)


def test_error_falls_as_the_fourth_power_while_the_nodes_second() -> None:
    errors = []
    for n in (33, 65, 129):
        x = np.linspace(0.0, 1.0, n)
        field = np.broadcast_to(np.cos(5.0 * (x - 0.513))[None, :, None], (2, n, 3))
        errors.append(abs(highest(field, x).value - 1.0))
    assert np.log2(errors[0] / errors[-1]) / 2.0 > 3.0
    assert errors[-1] < 1e-7


def test_at_a_border_the_node_stands() -> None:
    field = np.array([[[3.0], [2.0], [1.0]]])
    low = lowest(field, np.array([0.0, 1.0, 2.0]))
    assert (low.value, low.phi, low.strip, low.axial) == (1.0, 2.0, 0, 0)
