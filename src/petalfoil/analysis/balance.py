"""`balance`: the journal position under a load (model, question 3)."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.analysis.arguments import Load, Moment, Speed
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.operating_point import ForceResidual, applied_load, at, loaded_point
from petalfoil.analysis.other_bearing import bearing_of, of_rotor, rotor_parts
from petalfoil.analysis.records import effort, position, solution_record
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.results.layout import SinglePoint
from petalfoil.results.parts import AppliedLoad
from petalfoil.results.record import Record

ON_FILM = 0.01
"""Contact fraction below which the film alone is said to carry the load."""


@dataclass(frozen=True)
class CarriedBy:
    """What carries the load."""

    carried_by: str


@analysis(SinglePoint(), error_bars=True)
def balance(
    case: Case,
    load: Load = None,
    *,
    moment: Moment = None,
    speed: Speed = None,
    progress: Progress | None = None,
) -> Record:
    """Find the position of the journal under a load.

    Results as from solve, at that position. A load that the film does not
    carry alone is an answer too: "carried by" tells the part of solid contact.
    Under a moment about the bearing's centre the journal tilts as well. Of a
    rotor in two bearings (rotor.span) load and moment are those of the rotor.

    Example: petalfoil balance case.toml --load "0 N, -50 N" --speed "60000 rpm"

    Raises
    ------
    UsageError
        No load is given.
    ConvergenceError
        No position was found.
    """
    case, wanted = at(case, speed, (0.0, 0.0)), applied_load(case, load)
    if moment is not None:
        askew = case.operation.tilt if case.bearings > 1 else None
        case = case.replace(**{"operation.moment": moment, "operation.tilt": askew})
    with running(progress, "balance") as run:
        found = loaded_point(case, wanted)
        loaded = AppliedLoad.of(wanted, case.operation.moment)
        return balance_record("balance", case, found.answer, loaded, found.branch, effort(run.seconds))


def balance_record(analysis: str, case: Case, found: Solution, *parts: object) -> Record:
    """The record of a balance, at the position found."""
    bearing = bearing_of(case, found)
    evaluated = Evaluation.of(bearing, found)
    own = (position(bearing, found), ForceResidual(found.force_residual), carrier(evaluated.contact_fraction))
    record = solution_record(analysis, evaluated, *own, *parts, *rotor_parts(case, found))
    return record if found.other is None else of_rotor(record, case)


def carrier(contact_fraction: float) -> CarriedBy:
    """What carries the load, in words."""
    if contact_fraction < ON_FILM:
        return CarriedBy("film")
    return CarriedBy(
        f"touching: solid contact makes {100.0 * contact_fraction:.0f} % of the normal forces on the journal"
    )
