"""A tiny report: three packages on coarse grids, a few points, four variations."""

from __future__ import annotations

import pytest

from petalfoil.report.claims import Evidence
from petalfoil.report.reproduce import run
from petalfoil.report.scope import Scope

PLACES = (0.0, 100e-6, 200e-6, 280e-6)

TINY = Scope(
    flat_cells=32,
    flat=PLACES,
    spatial_cells=10,
    spatial_axial=4,
    spatial=PLACES,
    study_cells=24,
    studied=("reference", "clamped_tangent", "hinged_30", "bounds"),
    grids=((17, 5),),
)


@pytest.fixture(scope="session")
def evidence() -> Evidence:
    """Everything, computed once."""
    return run(TINY)
