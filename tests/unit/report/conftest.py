"""A small report: three packs on coarse grids, a few points, four assumptions."""

from __future__ import annotations

import pytest

from petalfoil.report.claims import Evidence
from petalfoil.report.load_characteristics import Scope
from petalfoil.report.reproduce import run

PLACES = (0.0, 100e-6, 200e-6, 280e-6)

TINY = Scope(
    cells_2d=32,
    displacements_2d=PLACES,
    cells_3d=10,
    axial_cells_3d=4,
    displacements_3d=PLACES,
    assumption_cells=24,
    assumptions=("reference", "clamped_tangent", "hinged_30", "bounds"),
    grids=((17, 5),),
)


@pytest.fixture(scope="session")
def evidence() -> Evidence:
    """All results, computed once."""
    return run(TINY)
