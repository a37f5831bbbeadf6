"""Loads of a clamped beam on springs: those of its dense equations, at both ends of the range of springs."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.physics.petal_elements import clamped_beam
from petalfoil.physics.sprung_beam import on_springs


@pytest.mark.parametrize("places", [2, 5, 48])
@pytest.mark.parametrize("stiffest", [1e-3, 1e3, 1e8])
def test_the_loads_are_those_of_the_dense_equations(places: int, stiffest: float) -> None:
    """(S8), springs of one beam differ by 3000; the beam is straight where it has no compliance."""
    rng = np.random.default_rng(places)
    t = (np.arange(places) + 0.5) / places
    b = clamped_beam(t[:, None], t[None, :])
    k = stiffest * np.exp(rng.uniform(-8.0, 0.0, (7, places)))
    C, r = rng.uniform(0.5, 2.0, 7), rng.standard_normal((7, places, 3))
    C[3] = 0.0
    x = on_springs(k, C, r)
    dense = np.linalg.solve(np.eye(places) + k[:, :, None] * C[:, None, None] * b, r)
    assert_allclose(x, dense, rtol=0.0, atol=1e-9 * np.max(np.abs(dense)))
    assert np.array_equal(x[3], r[3])
