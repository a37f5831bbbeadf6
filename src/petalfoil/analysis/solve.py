"""`solve`: film, petals and contacts in equilibrium at one position of the journal at one speed."""

from __future__ import annotations

from dataclasses import replace

from petalfoil.analysis.arguments import JournalPosition, Speed
from petalfoil.analysis.classic_method import is_classic, typical_steps
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.operating_point import OperatingPoint, Vector, at, operating_point, relaxed
from petalfoil.analysis.other_bearing import bearing_of, of_rotor, rotor_parts
from petalfoil.analysis.records import asked_position, effort, position, solution_record
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import UsageError
from petalfoil.results.layout import SinglePoint
from petalfoil.results.parts import Branch
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem


@analysis(SinglePoint(), error_bars=True)
def solve(
    case: Case,
    *,
    speed: Speed = None,
    eccentricity: JournalPosition = None,
    progress: Progress | None = None,
) -> Record:
    """Find film and petals in equilibrium at one position of the journal.

    The position is --eccentricity, else the case's; where the case gives a
    load instead, the one that balances it. Gives the force on the journal,
    film, contacts, torque, leakage and stress; with --error also how far each
    is from its grid-converged value.

    Example: petalfoil solve case.toml --eccentricity "0 um, -100 um" --json

    Raises
    ------
    UsageError
        The case gives both a load and an eccentricity.
    ConvergenceError
        No equilibrium was found.
    PackError
        The displaced journal leaves the foil pack no clearance.
    """
    return point(placed(at(case, speed), eccentricity), progress)


def placed(case: Case, eccentricity: Vector | None) -> Case:
    """The case at a position, or under its load: what of both is meant.

    Raises
    ------
    UsageError
        No position is asked for, and the case gives both, or a load that its method does not balance.
    """
    if eccentricity is not None:
        return case.replace(**{"operation.eccentricity": eccentricity, "operation.load": None})
    if case.operation.load is not None and any(case.operation.eccentricity):
        raise UsageError(
            "the case gives both operation.load and operation.eccentricity, and one follows from the other: give an "
            "eccentricity with the call, leave one of them out of the case, or ask `balance` for the position under "
            "the load"
        )
    if case.operation.load is not None and is_classic(case):
        raise UsageError(
            "the case gives operation.load, under which the classic method finds no position: give an eccentricity "
            'with the call, or set model.method = "newton"'
        )
    return case


def point(case: Case, progress: Progress | None = None) -> Record:
    """The record of the case's position, or of the one that balances its load, on its grid."""
    loaded = case.operation.load is not None
    with running(progress, "solve", typical_steps(case)) as run:
        if is_classic(case) and not loaded:
            found = relaxed(case, build_problem(case))
        else:
            found = operating_point(case, None)
        bearing = bearing_of(case, found.answer)
        place = position(bearing, found.answer) if loaded or case.heat is not None else asked_position(case)
        own = (place, path_told(found), *found.loaded, effort(run.seconds), *rotor_parts(case, found.answer))
        record = solution_record("solve", Evaluation.of(bearing, found.answer), *own)
        return record if found.answer.other is None else of_rotor(record, case)


def path_told(found: OperatingPoint) -> Branch:
    """How the equilibrium was reached; of a balance, that the position follows from the case's load."""
    if not found.loaded:
        return found.branch
    return replace(found.branch, solution_path=f"at the position that balances the load: {found.branch.solution_path}")
