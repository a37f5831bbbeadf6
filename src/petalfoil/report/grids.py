"""The paper's grids: what the loads of this program are on them."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.analysis.solve import solve
from petalfoil.errors import ConvergenceError
from petalfoil.report.families import Progress
from petalfoil.report.paper import package
from petalfoil.report.scope import Scope

COUNT, AT = 8, 200e-6
"""Petals and downward displacement [m] of the grid study."""


@dataclass(frozen=True)
class Grid:
    """The load on one grid.

    Attributes
    ----------
    nodes : (int, int)
        Along a petal and along the axis; one along the axis is the flat model.
    cells : (int, int)
        Cells a pitch and along the axis that come nearest.
    load : float
        `|F|` [N]; nan where nothing converged.
    factorisations : int
        Of film and package, from nothing.
    residual : float
        Largest scaled residual.
    """

    nodes: tuple[int, int]
    cells: tuple[int, int]
    load: float
    factorisations: int
    residual: float


def run(scope: Scope, progress: Progress) -> tuple[Grid, ...]:
    """Flat and spatial loads on the grids of the scope."""
    wanted = [(along, 1) for along, _ in scope.grids] + list(scope.grids)
    found = []
    for number, nodes in enumerate(wanted):
        progress(number / len(wanted), "the paper's grids")
        found.append(on(nodes))
    return tuple(found)


def on(nodes: tuple[int, int]) -> Grid:
    """One grid."""
    case = package(COUNT)
    overlap = case.package.overlap if case.package is not None else 1.0
    cells = (max(4, round((nodes[0] - 1) / overlap)), max(nodes[1] - 1, 1))
    changes: dict[str, object] = {"model.cells_per_pitch": cells[0]}
    if nodes[1] > 1:
        changes |= {"model.kind": "3d", "model.axial_cells": cells[1]}
    try:
        record = solve.record(case.replace(**changes), eccentricity=(0.0, -AT))
    except ConvergenceError as failure:
        return Grid(nodes, cells, math.nan, len(failure.history), math.nan)
    scalars = record.scalars
    count = int(scalars["factorizations"]) + int(scalars["pack_iterations"])
    return Grid(nodes, cells, float(scalars["bearing_force"]), count, float(scalars["residual"]))
