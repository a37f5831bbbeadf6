"""The 2-D film without ends is the limit of a long bearing, in motion too."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import petalfoil
from tests.cases import case

LENGTHS = 20.0
"""Length over diameter: the ends of the 3-D bearing leave 4 % of its film's force."""


def per_metre(kind: str, ratio: float) -> NDArray[np.float64]:
    """Stiffness and damping times speed at a whirl ratio, over the length, (2, 2, 2) [N/m^2]."""
    plain = case("plain_journal")
    length = LENGTHS * 2.0 * plain.bearing.journal_radius
    changes = {"model.kind": kind, "model.edges": "continuous", "model.cells_per_pitch": 48, "bearing.length": length}
    changes["operation.eccentricity"] = (0.0, -0.6 * plain.bearing.clearance)
    if kind == "3d":
        changes["model.axial_cells"] = 32
    found = petalfoil.coefficients(plain.replace(**changes), [ratio * plain.operation.speed])
    return np.stack([found.stiffness.values[0], found.damping.values[0] * plain.operation.speed]) / length


@pytest.mark.parametrize("ratio", [0.05, 0.5])
def test_coefficients_are_those_of_a_long_bearing(ratio: float) -> None:
    """With the gas of the 2-D film at equilibrium at every instant, damping was off by its own size."""
    long, limit = per_metre("3d", ratio), per_metre("2d", ratio)
    assert_allclose(limit, long, rtol=0.0, atol=0.08 * np.max(np.abs(long)))
