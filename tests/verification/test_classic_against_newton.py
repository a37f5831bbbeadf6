"""Two methods that share nothing but the equations give one answer: the paper's own and the coupled Newton."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.solve import solve
from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.results.record import Record
from tests.cases import case

pytestmark = pytest.mark.compiled

CASES_2D = [(f"paper_n{n}", {"model.cells_per_pitch": 12}) for n in (6, 8, 10)]
CASES_3D = [("paper_n8_spatial", {"model.cells_per_pitch": 10, "model.axial_cells": 16})]  # 23 x 17 nodes per petal
AGREE = 1e-4
"""Required agreement; 1e-5 is what the paper's own stop at 1e-5 gives (most of these are closer)."""


def both(bearing: Case) -> tuple[Record, Record]:
    """Records of the classic method and of Newton, both with contacts at nodes."""
    classic = bearing.replace(**{"model.method": "classic"})
    return solve.record(classic), solve.record(bearing.replace(**{"model.contacts": "nodes"}))


@pytest.mark.parametrize("e", [0.0, 200e-6])
@pytest.mark.parametrize(
    ("name", "grid"),
    [*CASES_2D, *(pytest.param(*case_3d, marks=pytest.mark.slow) for case_3d in CASES_3D)],
    ids=["n6", "n8", "n10", "3d"],
)
def test_load_film_and_pressure_agree(name: str, grid: dict[str, object], e: float) -> None:
    classic, newton = both(case(name, **{**grid, "operation.eccentricity": (0.0, -e)}))
    assert classic.converged
    assert newton.converged
    mine, theirs = classic.scalars, newton.scalars
    push = np.sum(np.abs(newton.fields["pressure"] - 1e5)) / newton.fields["pressure"].size * 5e-2 * 5e-2 * np.pi
    for component in ("force_x", "force_y", "contact_normal_force"):
        assert_allclose(mine[component], theirs[component], rtol=0.0, atol=AGREE * push)
    if e > 0.0:
        assert_allclose(mine["bearing_force"], theirs["bearing_force"], rtol=AGREE)
    assert_allclose(classic.fields["film_thickness"], newton.fields["film_thickness"], rtol=AGREE)
    assert_allclose(classic.fields["pressure"], newton.fields["pressure"], rtol=AGREE)
    assert mine["stable"] == theirs["stable"]
    assert_allclose(mine["growth_rate"], theirs["growth_rate"], rtol=1e-2)
    assert float(mine["residual"]) < 1e-4


@pytest.mark.parametrize("mount", ["hinged", "clamped"])
def test_preload_and_starting_torque_agree(mount: str) -> None:
    nodal = {"model.cells_per_pitch": 16, "model.contacts": "nodes"}
    bearing = case("paper_n8", **{**nodal, "petals.mount": mount})
    classic = bearing.replace(**{"model.method": "classic"})
    positions = (0.0, 150e-6)
    for mine, theirs in zip(static.records(classic, positions), static.records(bearing, positions), strict=True):
        assert mine.converged
        for figure in ("contact_normal_force", "starting_torque", "max_bending_stress"):
            assert_allclose(mine.scalars[figure], theirs.scalars[figure], rtol=AGREE)
        assert_allclose(mine.fields["deflection"], theirs.fields["deflection"], rtol=0.0, atol=1e-8)
        most = np.max(theirs.fields["petal_contact_pressure"])
        for where in ("petal", "journal", "bushing"):
            name = f"{where}_contact_pressure"
            assert_allclose(mine.fields[name], theirs.fields[name], rtol=0.0, atol=1e-3 * most)


@pytest.mark.parametrize("grid", [{}, {"model.kind": "2d", "model.axial_cells": None}], ids=["3d", "2d"])
def test_a_plain_bearing_agrees(grid: dict[str, object]) -> None:
    changes = {"model.cells_per_pitch": 48, "model.axial_cells": 12, **grid}
    classic, newton = both(case("plain_journal", **changes))
    assert_allclose(classic.scalars["bearing_force"], newton.scalars["bearing_force"], rtol=AGREE)
    assert_allclose(classic.fields["pressure"], newton.fields["pressure"], rtol=AGREE)
