"""How much `reproduce` runs: numbers of petals, grids, displacements."""

from __future__ import annotations

from dataclasses import dataclass

MICROMETRE = 1e-6

COMPARED = (100e-6, 200e-6, 280e-6)
"""Displacements at which loads are compared [m]; every curve has them."""


def _micrometres(*values: float) -> tuple[float, ...]:
    return tuple(value * MICROMETRE for value in values)


@dataclass(frozen=True, kw_only=True)
class Scope:
    """Grids and displacements of the whole report.

    Attributes
    ----------
    counts : tuple of int
        Numbers of petals, the smallest first.
    flat_cells, spatial_cells, spatial_axial : int
        Cells a pitch and over the length.
    flat, spatial : tuple of float
        Displacements of the curves [m]; they begin at 0 and contain `COMPARED`.
    study_cells : int
        Cells a pitch of the study, flat.
    studied : tuple of str
        Names of the variations; empty for all.
    grids : tuple of (int, int)
        Nodes along a petal and along the axis, as the paper counts them.
    """

    counts: tuple[int, ...] = (6, 8, 10)
    flat_cells: int = 128
    flat: tuple[float, ...] = _micrometres(*range(0, 281, 20))
    spatial_cells: int = 40
    spatial_axial: int = 16
    spatial: tuple[float, ...] = _micrometres(0, 50, 100, 150, 200, 240, 280)
    study_cells: int = 48
    studied: tuple[str, ...] = ()
    grids: tuple[tuple[int, int], ...] = ((17, 11), (24, 17), (35, 31))
