"""The load characteristics of the paper's packages under one set of assumptions."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from petalfoil.analysis.curve import curve
from petalfoil.report.paper import package
from petalfoil.report.scope import COMPARED, Scope
from petalfoil.results import Record
from petalfoil.results.dataset import curve_dataset

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[float, str], None]

TANGENT: Mapping[str, object] = {"petals.mount": "clamped", "petals.root_tilt": 0.0}
"""Roots clamped along the bore's tangent."""


@dataclass(frozen=True)
class Curve:
    """Load characteristic of one package.

    Attributes
    ----------
    count : int
        Petals.
    records : tuple of Record
        Its points; the first has the journal central.
    """

    count: int
    records: tuple[Record, ...]

    @property
    def label(self) -> str:
        """For legends."""
        return f"{self.count} petals"

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The curve as labelled data."""
        return curve_dataset(self.records)

    def figure(self, name: str) -> list[float]:
        """A figure at every point; nan where it did not converge."""
        return [float(record.reported().get(name, math.nan)) for record in self.records]

    def displacements(self) -> list[float]:
        """How far the journal is displaced at every point [m]."""
        return [
            math.hypot(*map(float, (r.scalars["eccentricity_x"], r.scalars["eccentricity_y"]))) for r in self.records
        ]

    def load(self, e: float) -> float:
        """`|F|` at a displacement, between points along a straight line [N]."""
        return float(np.interp(e, self.displacements(), self.figure("bearing_force")))

    def loads(self) -> tuple[float, ...]:
        """`|F|` at the compared displacements [N]."""
        return tuple(self.load(e) for e in COMPARED)


@dataclass(frozen=True)
class Family:
    """Curves of all numbers of petals under one set of assumptions.

    Attributes
    ----------
    name : str
        Start of its files' names.
    says : str
        The assumptions, for people.
    grid : str
        The grid, for people.
    curves : tuple of Curve
        One for each number of petals.
    """

    name: str
    says: str
    grid: str
    curves: tuple[Curve, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """Load of the most petals over that of the fewest at the compared displacements [1]."""
        return tuple(many / few for few, many in zip(self.curves[0].loads(), self.curves[-1].loads(), strict=True))

    @property
    def points(self) -> list[Record]:
        """Every point of every curve."""
        return [record for curve in self.curves for record in curve.records]


def flat(name: str, says: str, changes: Mapping[str, object], scope: Scope, progress: Progress) -> Family:
    """The flat model."""
    grid = {"model.cells_per_pitch": scope.flat_cells}
    curves = _curves({**changes, **grid}, scope.counts, scope.flat, progress)
    return Family(f"{name}_flat", says, f"{scope.flat_cells} cells a pitch", curves)


def spatial(name: str, says: str, changes: Mapping[str, object], scope: Scope, progress: Progress) -> Family:
    """The spatial model."""
    grid = {
        "model.kind": "3d",
        "model.cells_per_pitch": scope.spatial_cells,
        "model.axial_cells": scope.spatial_axial,
    }
    curves = _curves({**changes, **grid}, scope.counts, scope.spatial, progress)
    return Family(f"{name}_spatial", says, f"{scope.spatial_cells} × {scope.spatial_axial} cells a pitch", curves)


def _curves(
    changes: Mapping[str, object], counts: tuple[int, ...], displacements: tuple[float, ...], progress: Progress
) -> tuple[Curve, ...]:
    curves = []
    for number, count in enumerate(counts):
        report = part(progress, number, len(counts), f"{count} petals")
        records = curve.records(package(count, **changes), displacements, progress=report)
        curves.append(Curve(count, tuple(records)))
    return tuple(curves)


def part(progress: Progress, number: int, count: int, text: str) -> Progress:
    """Progress of one of `count` equal parts."""

    def report(share: float, _: str) -> None:
        progress((number + share) / count, text)

    return report
