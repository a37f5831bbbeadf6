"""`solve`: film, petals and contacts in equilibrium at one position of the journal at one speed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from petalfoil.analysis.arguments import Flag, Position, Speed
from petalfoil.analysis.classic_method import is_classic, typical_steps
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.grid_study import error_bars
from petalfoil.analysis.operating_point import at, at_position, relaxed
from petalfoil.analysis.records import asked_position, effort, solution_record
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError
from petalfoil.results.layout import Point
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem

ErrorBars = Annotated[bool, Flag(help="Add error bars, from a study on the case's grid and two more.")]


@analysis(Point())
def solve(
    case: Case,
    *,
    speed: Speed = None,
    eccentricity: Position = None,
    error: ErrorBars = False,
    progress: Progress | None = None,
) -> Record:
    """Find film and petals in equilibrium at one position of the journal.

    Gives the force on the journal, film, contacts, torque, leakage and stress;
    with --error also how far each is from its grid-converged value.

    Example: petalfoil solve case.toml --eccentricity "0 um, -100 um" --json

    Raises
    ------
    ConvergenceError
        No equilibrium was found.
    PackageError
        The displaced journal leaves the package no clearance.
    """
    record = point(at(case, speed, eccentricity), progress)
    return with_error_bars(record, progress) if error else record


def point(case: Case, progress: Progress | None = None) -> Record:
    """The record of the case's position, on its grid."""
    with running(progress, "solve", typical_steps(case)) as run:
        found = relaxed(case, build_problem(case)) if is_classic(case) else at_position(case)
        own = (asked_position(case), found.branch, effort(run.seconds))
        return solution_record("solve", Evaluation.of(case, found.answer), *own)


def with_error_bars(record: Record, progress: Progress | None) -> Record:
    """The record with error bars; with none, and a remark why, where only its own grid has a solution."""
    try:
        return replace(record, errors=error_bars(record, point, progress))
    except ConvergenceError as failure:
        return replace(record, errors={}, remarks=(f"no error bars: {failure}",))
