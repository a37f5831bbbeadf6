"""Equivalent stiffness and damping of petals that rub, in 2-D: the default grid against one twice as fine."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.coefficients import coefficients
from tests.cases import case


@pytest.mark.slow
@pytest.mark.parametrize("amplitude", ["1 um", "10 um", "50 um"])
@pytest.mark.parametrize(("name", "load"), [("paper_n8", 20.0), ("rig", 55.6)])
def test_stiffness_and_damping_converge(name: str, load: float, amplitude: str) -> None:
    """Within 0.2 %."""
    of = case(name, **{"surface.petal_friction": 0.3})
    fine = of.replace(**{"model.cells_per_pitch": 2 * of.cells_per_pitch})
    found = [coefficients(one, load=(0.0, -load), amplitude=amplitude) for one in (of, fine)]
    assert all(one["friction_harmonics"] >= 8 for one in found)
    for entries in ("stiffness", "damping"):
        coarse, finer = (np.diag(one[entries].values[0]) for one in found)
        assert_allclose(coarse, finer, rtol=2e-3)
