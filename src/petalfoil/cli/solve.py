"""``petalfoil solve``: film and petals in equilibrium at one position of the journal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from petalfoil.cli import parsing
from petalfoil.cli.failures import NOT_CONVERGED, handled
from petalfoil.cli.options import CaseFile, ErrorBars, Json, Out, Plot, Position, Speed
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import Report, bar
from petalfoil.cli.streams import say
from petalfoil.errors import ConvergenceError

if TYPE_CHECKING:
    from petalfoil.results import Record


def solve(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    speed: Speed = None,
    eccentricity: Position = None,
    error: ErrorBars = False,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Find film and petals in equilibrium at one position of the journal.

    Gives the force on the journal, film, contacts, torque, leakage and stress;
    with --error also how far each is from its limit for vanishing cells.

    Example: petalfoil solve case.toml --eccentricity "0 um, -100 um" --json
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        omega, position = parsing.speed(speed), parsing.position(eccentricity)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import equilibrium
        from petalfoil.cli.answer import Answer

        with bar("solve") as report:
            record = equilibrium.run(definition, speed=omega, eccentricity=position, progress=report)
            errors = _error_bars(record, report) if error else None
        outputs.deliver(Answer(verb="solve", records=(record,), errors=errors))
        if errors == {}:
            raise typer.Exit(NOT_CONVERGED)


def _error_bars(record: Record, report: Report) -> dict[str, float]:
    """Error bars of the figures; none, and the reason said, where only the case's own grid has an answer."""
    from petalfoil.analysis import grid_study

    try:
        return grid_study.error_bars(record, report)
    except ConvergenceError as failure:
        say(f"no error bars: {failure}")
        return {}
