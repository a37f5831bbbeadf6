"""``petalfoil converge``: the same case on finer and finer grids."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from petalfoil.cli import parsing
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Coarsest, Json, Levels, Out, Plot, Position, Speed
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar
from petalfoil.cli.streams import say

if TYPE_CHECKING:
    from petalfoil.results import Record


def converge(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    speed: Speed = None,
    eccentricity: Position = None,
    levels: Levels = 3,
    coarsest: Coarsest = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Solve a case on nested grids: order, limit and error bar of every figure.

    A bar is trusted where the observed order is near that of the method, 2.
    JSON: "grids" as from solve, with cells_per_pitch and axial_cells, and
    "quantities": values, order, limit, error, trusted of each figure.

    Example: petalfoil converge case.toml --coarsest 32 --levels 4 --json
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        omega, position = parsing.speed(speed), parsing.position(eccentricity)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import grid_study
        from petalfoil.cli.study import StudyAnswer

        cases = grid_study.grids(definition, levels, coarsest, speed=omega, eccentricity=position)
        with bar("converge") as report:
            records, interrupted = _finished(grid_study.iterate(cases, report), levels)
        estimates = tuple(grid_study.table(records))
        outputs.deliver(
            StudyAnswer(verb="converge", records=tuple(records), estimates=estimates, interrupted=interrupted)
        )


def _finished(grids: Iterable[Record], count: int) -> tuple[list[Record], bool]:
    """The records of all grids; or, when the user interrupted, of those that were finished."""
    records: list[Record] = []
    try:
        for record in grids:
            records.append(record)
    except KeyboardInterrupt:
        if sum(record.converged for record in records) < 2:
            raise
        say(f"interrupted: {len(records)} of {count} grids are finished and kept")
        return records, True
    return records, False
