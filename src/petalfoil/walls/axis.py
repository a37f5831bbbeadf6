"""The axial grid that a case asks for."""

from __future__ import annotations

from petalfoil.case import Case, ModelKind
from petalfoil.mesh.axial import AxialGrid, axis_2d, axis_3d


def axial_grid(case: Case) -> AxialGrid:
    """One station for a flat model; else half the length, or the whole where symmetry is not used."""
    length, model = case.bearing.length, case.model
    if model.kind is ModelKind.TWO_D:
        return axis_2d(length)
    return axis_3d(length, case.axial_cells, half=model.symmetry, grading=case.axial_grading)
