"""Loads on the grids of the paper."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.analysis.solve import solve
from petalfoil.errors import ConvergenceError
from petalfoil.report.load_characteristics import Progress, Scope
from petalfoil.report.paper_cases import IN_3D, paper_case
from petalfoil.walls.petals import petals_of

COUNT, AT = 8, 200e-6
"""Number of petals and downward displacement [m] of the grid study."""

FEWEST_CELLS = 4
"""Fewest cells per pitch that a case may have."""


@dataclass(frozen=True)
class GridLoad:
    """The load on one grid.

    Attributes
    ----------
    nodes : (int, int)
        Nodes per petal and axial nodes; one axial node is the 2-D model.
    cells : (int, int)
        The nearest numbers of cells per pitch and of axial cells.
    load : float
        `|F|` [N]; nan where it did not converge.
    factorizations : int
        Factorisations of film and pack in a cold start.
    residual : float
        Largest scaled residual.
    """

    nodes: tuple[int, int]
    cells: tuple[int, int]
    load: float
    factorizations: int
    residual: float


def run(scope: Scope, progress: Progress) -> tuple[GridLoad, ...]:
    """Loads of the 2-D and 3-D model on the grids of the scope."""
    grids = [(along, 1) for along, _ in scope.grids] + list(scope.grids)
    loads = []
    for number, nodes in enumerate(grids):
        progress(number / len(grids), "the grids of the paper")
        loads.append(on(nodes))
    return tuple(loads)


def on(nodes: tuple[int, int]) -> GridLoad:
    """The load on one grid."""
    case = paper_case(COUNT)
    overlap = petals_of(case)[1].overlap
    cells = (max(FEWEST_CELLS, round((nodes[0] - 1) / overlap)), max(nodes[1] - 1, 1))
    changes: dict[str, object] = {"model.cells_per_pitch": cells[0]}
    if nodes[1] > 1:
        changes |= {**IN_3D, "model.axial_cells": cells[1]}
    try:
        record = solve.record(case.replace(**changes), eccentricity=(0.0, -AT))
    except ConvergenceError as failure:
        return GridLoad(nodes, cells, math.nan, len(failure.history), math.nan)
    scalars = record.scalars
    count = int(scalars["factorizations"]) + int(scalars["pack_iterations"])
    return GridLoad(nodes, cells, float(scalars["bearing_force"]), count, float(scalars["residual"]))
