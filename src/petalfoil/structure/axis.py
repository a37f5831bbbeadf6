"""The axial grid that a case asks for."""

from __future__ import annotations

from petalfoil.case import Case, Kind
from petalfoil.mesh.axial import AxialGrid, flat_axis, spatial_axis


def axial_grid(case: Case) -> AxialGrid:
    """One station for a flat model; else half the length, or the whole where symmetry is not used."""
    length, model = case.bearing.length, case.model
    if model.kind is Kind.FLAT:
        return flat_axis(length)
    return spatial_axis(length, case.axial_cells, half=model.symmetry, grading=case.axial_grading)
