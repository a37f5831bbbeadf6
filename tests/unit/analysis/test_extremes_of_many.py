"""Extremes of many fields at once."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.extremes import highest, lowest
from petalfoil.analysis.extremes_of_many import highest_of_each, lowest_of_each


@pytest.mark.parametrize("grid", [(33, 1), (12, 9), (4, 3), (2, 2), (3, 1), (7, 2)])
@pytest.mark.parametrize("rough", [0.0, 0.02, 1.0])
def test_extremes_of_many_fields_are_those_of_each(grid: tuple[int, int], rough: float) -> None:
    """Smooth fields, whose quartics hold, and rough ones, where parabolas and ends do."""
    rng = np.random.default_rng(5)
    phi, z = (np.cumsum(rng.uniform(0.85, 1.15, n)) for n in grid)
    wave, turn = rng.uniform(0.1, 0.6, (2, 40, 6, 1, 1))
    smooth = np.cos(wave * phi[:, None] + turn * z[None, :] + rng.uniform(0.0, 6.0, (40, 6, 1, 1)))
    fields = 3.0 + smooth + rough * rng.normal(size=smooth.shape)
    assert_allclose(lowest_of_each(fields, phi, z), [lowest(one, phi, z).value for one in fields], rtol=1e-12)
    assert_allclose(highest_of_each(fields, phi, z), [highest(one, phi, z).value for one in fields], rtol=1e-12)


def test_the_extremes_are_between_nodes() -> None:
    """Of a quartic in both directions the lowest value is exact."""
    x, z = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 7)
    u, v = x[:, None] - 0.47, z[None, :] - 0.55
    field = 1.0 + u**2 + 0.5 * v**2 + 0.3 * u * v + 0.4 * u**3 + u**2 * v**2 + u**4
    assert_allclose(lowest_of_each(np.array([[field], [2.0 * field]]), x, z), [1.0, 2.0], rtol=1e-13)
    assert field.min() > 1.0001
