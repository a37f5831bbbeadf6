"""Load characteristics of the packs of the paper under one set of assumptions, and the extent of the report."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from petalfoil.analysis.curve import curve
from petalfoil.report.paper_cases import IN_3D, paper_case
from petalfoil.results import Record
from petalfoil.results.dataset import curve_dataset

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[float, str], None]

MICROMETRE = 1e-6

COMPARED = (100e-6, 200e-6, 280e-6)
"""Displacements at which loads are compared [m]. Every characteristic contains them."""

TANGENT: Mapping[str, object] = {"petals.mount": "clamped", "petals.root_tilt": 0.0}
"""Petals clamped tangentially to the bore."""


def _micrometres(*values: float) -> tuple[float, ...]:
    return tuple(value * MICROMETRE for value in values)


@dataclass(frozen=True, kw_only=True)
class Scope:
    """Grids and displacements of the report.

    Attributes
    ----------
    counts : tuple of int
        Numbers of petals in ascending order.
    cells_2d : int
        Cells per pitch of the 2-D characteristics.
    displacements_2d, displacements_3d : tuple of float
        Displacements of the characteristics [m]. They begin with 0 and contain `COMPARED`.
    cells_3d, axial_cells_3d : int
        Cells per pitch and axial cells of the 3-D characteristics.
    assumption_cells : int
        Cells per pitch of the varied assumptions, 2-D.
    assumptions : tuple of str
        Names of the assumptions to vary; empty for all.
    grids : tuple of (int, int)
        Nodes per petal and axial nodes, as the paper counts them.
    """

    counts: tuple[int, ...] = (6, 8, 10)
    cells_2d: int = 128
    displacements_2d: tuple[float, ...] = _micrometres(*range(0, 281, 20))
    cells_3d: int = 40
    axial_cells_3d: int = 16
    displacements_3d: tuple[float, ...] = _micrometres(0, 50, 100, 150, 200, 240, 280)
    assumption_cells: int = 48
    assumptions: tuple[str, ...] = ()
    grids: tuple[tuple[int, int], ...] = ((17, 11), (24, 17), (35, 31))


@dataclass(frozen=True)
class LoadCharacteristic:
    """Load characteristic of one pack.

    Attributes
    ----------
    count : int
        Number of petals.
    records : tuple of Record
        Its points. The journal of the first is centred.
    """

    count: int
    records: tuple[Record, ...]

    @property
    def label(self) -> str:
        """Text for legends."""
        return f"{self.count} petals"

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The characteristic as labelled data."""
        return curve_dataset(self.records)

    def values(self, name: str) -> list[float]:
        """A scalar result at every point; nan where the point did not converge."""
        return [float(record.reported().get(name, math.nan)) for record in self.records]

    def displacements(self) -> list[float]:
        """Journal displacement at every point [m]."""
        return [
            math.hypot(*map(float, (r.scalars["eccentricity_x"], r.scalars["eccentricity_y"]))) for r in self.records
        ]

    def load(self, e: float) -> float:
        """`|F|` at a displacement, by linear interpolation between points [N]."""
        return float(np.interp(e, self.displacements(), self.values("bearing_force")))

    def loads(self) -> tuple[float, ...]:
        """`|F|` at the compared displacements [N]."""
        return tuple(self.load(e) for e in COMPARED)


@dataclass(frozen=True)
class CharacteristicFamily:
    """Load characteristics of all packs under one set of assumptions.

    Attributes
    ----------
    name : str
        First part of the names of its files.
    description : str
        The assumptions.
    grid : str
        The grid.
    curves : tuple of LoadCharacteristic
        One for each number of petals.
    """

    name: str
    description: str
    grid: str
    curves: tuple[LoadCharacteristic, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """Load with the most petals over load with the fewest, at the compared displacements [1]."""
        return tuple(many / few for few, many in zip(self.curves[0].loads(), self.curves[-1].loads(), strict=True))

    @property
    def points(self) -> list[Record]:
        """All points of all characteristics."""
        return [record for curve in self.curves for record in curve.records]


def family_2d(
    name: str, description: str, changes: Mapping[str, object], scope: Scope, progress: Progress
) -> CharacteristicFamily:
    """The characteristics of the 2-D model."""
    grid = {"model.cells_per_pitch": scope.cells_2d}
    curves = _curves({**changes, **grid}, scope.counts, scope.displacements_2d, progress)
    return CharacteristicFamily(f"{name}_2d", description, f"{scope.cells_2d} cells per pitch", curves)


def family_3d(
    name: str, description: str, changes: Mapping[str, object], scope: Scope, progress: Progress
) -> CharacteristicFamily:
    """The characteristics of the 3-D model."""
    grid = {
        **IN_3D,
        "model.cells_per_pitch": scope.cells_3d,
        "model.axial_cells": scope.axial_cells_3d,
    }
    curves = _curves({**changes, **grid}, scope.counts, scope.displacements_3d, progress)
    label = f"{scope.cells_3d} cells per pitch × {scope.axial_cells_3d} axial cells"
    return CharacteristicFamily(f"{name}_3d", description, label, curves)


def _curves(
    changes: Mapping[str, object], counts: tuple[int, ...], displacements: tuple[float, ...], progress: Progress
) -> tuple[LoadCharacteristic, ...]:
    curves = []
    for number, count in enumerate(counts):
        report = part(progress, number, len(counts), f"{count} petals")
        records = curve.records(paper_case(count, **changes), displacements, progress=report)
        curves.append(LoadCharacteristic(count, tuple(records)))
    return tuple(curves)


def part(progress: Progress, number: int, count: int, text: str) -> Progress:
    """Progress of one of `count` equal parts."""

    def report(fraction: float, _: str) -> None:
        progress((number + fraction) / count, text)

    return report
