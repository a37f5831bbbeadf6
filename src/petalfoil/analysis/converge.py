"""`converge`: one position of the journal on finer and finer grids."""

from __future__ import annotations

from functools import partial
from typing import Annotated

from petalfoil.analysis.arguments import JournalPosition, Load, Speed, Whole
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.grid_study import MOST_LEVELS, grid_records, grids, parts, table
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.runs import Points
from petalfoil.analysis.solve import placed, point
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress
from petalfoil.mesh.pitch import COARSEST_FAMILY
from petalfoil.results.study import GridStudy

LEAST_GRIDS = 2
"""Grids with a solution below which nothing can be said about convergence."""

GridCount = Annotated[
    int,
    Whole(metavar="COUNT", help="Number of grids, each twice as fine.", at_least=LEAST_GRIDS, at_most=MOST_LEVELS),
]
Coarsest = Annotated[
    int | None,
    Whole(
        metavar="CELLS",
        help="Cells per pitch of the coarsest grid; by default the case's own grid is the finest, if it can be.",
        at_least=COARSEST_FAMILY,
    ),
]


@analysis(GridStudy(conclude=table), excludes={"load": ("eccentricity",)})
def converge(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    speed: Speed = None,
    eccentricity: JournalPosition = None,
    load: Load = None,
    levels: GridCount = 3,
    coarsest: Coarsest = None,
    progress: Progress | None = None,
) -> Points:
    """Solve a case on nested grids: order, grid-converged value and error bar of every result.

    At a position of the journal, or at the one that balances a load, as solve.

    A bar is trusted where the observed order is near that of the method, 2.
    JSON: "grids" as from solve, with cells_per_pitch and axial_cells, and
    "quantities": values, order, limit, error, trusted of each result.

    Example: petalfoil converge case.toml --coarsest 32 --levels 4 --json

    Raises
    ------
    UsageError
        The case gives both a load and an eccentricity.
    ConvergenceError
        Fewer than two grids have a solution.
    PackError
        The displaced journal leaves the foil pack no clearance.
    """
    case = at(case, speed)
    if load is not None:
        case = case.replace(**{"operation.load": load, "operation.eccentricity": (0.0, 0.0)})
    cases = grids(placed(case, eccentricity), levels, coarsest)
    return Points(
        partial(grid_records, cases, point, progress), len(cases), noun="grids", least=LEAST_GRIDS, parts=parts(cases)
    )
