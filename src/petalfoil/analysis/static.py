"""`static`: the foil pack at zero speed: preload, force over displacement, starting torque (model, question 1)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

import numpy as np

from petalfoil.analysis.arguments import DOWNWARD, TURNING_ONLY, DisplacementDirection, Displacements, Flag
from petalfoil.analysis.classic_method import is_classic, rest_by_classic
from petalfoil.analysis.contact_model import ContactModel, reported
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.displacements import CHARACTERISTIC, displaced
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import coordinates, wall_fields
from petalfoil.analysis.friction_told import ASSEMBLED, TURNED, ContactsOnPath, FrictionTold
from petalfoil.analysis.hysteresis import follow, legs
from petalfoil.analysis.records import asked_position, effort, failed_record, geometry, record_of
from petalfoil.analysis.runs import Points
from petalfoil.case import Case, PetalTheory
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.run_context import Progress, current_run, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.layout import Series
from petalfoil.results.parts import Branch, Leg, RunOutcome
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls import Capability, required, wall_kind

Loop = Annotated[
    bool, Flag(help=f"Load, unload and reload the pack: the hysteresis of petals with friction. {TURNING_ONLY}")
]


@dataclass(frozen=True)
class Torque:
    """Torque of dry friction at rest."""

    starting_torque: float
    friction_torque: float


def preload(points: list[dict[str, Any]]) -> dict[str, Any]:
    """Normal force [N] and starting torque [N m] of the centred journal; null without such a point."""
    for point in points:
        if math.hypot(point["eccentricity_x"], point["eccentricity_y"]) == 0.0:
            return {"preload": point.get("contact_normal_force"), "starting_torque": point.get("starting_torque")}
    return {"preload": None, "starting_torque": None}


@analysis(Series(columns=CHARACTERISTIC, head=preload), error_bars=True)
def static(
    case: Case,
    eccentricities: Displacements = (0.0,),
    *,
    direction: DisplacementDirection = DOWNWARD,
    loop: Loop = False,
    progress: Progress | None = None,
) -> Points:
    """Press the journal into the foil pack at zero speed: preload, load, starting torque.

    Preload and starting torque are those of the centred journal, so let the
    displacements begin at 0. A journal whose rubbing pulls at the petals
    (surface.journal_rubbing) is about to turn. With --out the file is rewritten as points
    finish; Ctrl-C keeps what is finished, and --resume goes on from it.

    With friction between the petals (surface.petal_friction) each point
    depends on those before it. Petals that slide along themselves are first
    laid without friction round a thinner journal, which then grows to its
    radius; --loop takes the journal back to the first point and out again.

    Example: petalfoil static case.toml --eccentricity "0 um : 280 um : 15"

    Raises
    ------
    UsageError
        The wall has no pack at zero speed; or a loop is asked for where petals have no friction, or of a single point.
    PackError
        A displacement leaves the foil pack no clearance.
    """
    required(case, Capability.PACK, "`static`")
    cases = displaced(case, eccentricities, direction, 0.0)
    if case.surface.petal_friction > 0.0 and not is_classic(case):
        if case.drags_petals:
            raise UsageError(
                "friction between petals is followed round a journal that does not turn: set "
                'surface.journal_rubbing = "torque", or ask `runup`, whose path ends with a journal that does'
            )
        if loop and len(cases) < 2:
            raise UsageError("a loop needs at least two displacements, such as '0 um : 200 um : 5'")
        way = legs(cases, loop)
        return Points(partial(_with_friction, way, progress), len(way))
    if loop:
        raise UsageError("a loop needs friction: give surface.petal_friction, and the default method")
    return Points(partial(_without_friction, cases, progress), len(cases))


def _with_friction(
    way: list[tuple[str, Case]], progress: Progress | None, done: Sequence[Record] = ()
) -> Iterator[Record]:
    exact = way[0][1].petal_theory is PetalTheory.SHELL
    for number, point in enumerate(follow(way)):
        if number < len(done):
            continue  # friction depends on the way: it is gone once more
        if progress is not None:
            progress(number / len(way), f"static: {point.leg}")
        with point.run.active():
            if point.answer is None:
                reason = "no equilibrium of the foil pack was found on the path"
                record = failed_record("static", point.case, reason, Leg(point.leg))
            else:
                told = FrictionTold(ASSEMBLED if exact else TURNED, point.lost)
                contacts = ContactsOnPath.of(point.answer, point.point_share)
                own = (Leg(point.leg), told, contacts, effort(point.seconds))
                record = static_record(point.case, point.answer, *own)
        yield record


def _without_friction(cases: list[Case], progress: Progress | None, done: Sequence[Record] = ()) -> Iterator[Record]:
    base = build_problem(cases[0])
    for number, case in enumerate(cases[len(done) :], len(done)):
        if progress is not None:
            progress(number / len(cases), "static")
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        with running() as run:
            answer = at_rest(case, problem)
            if answer is None:
                record = failed_record("static", case, "no equilibrium of the foil pack was found")
            else:
                answer = reported(case, answer)
                record = static_record(case, answer, ContactModel.of(answer), effort(run.seconds))
        yield record


def at_rest(case: Case, problem: CoupledProblem) -> Solution | None:
    """The assembled pack by the method of `case`; None, and why in the history, if none was found."""
    if not is_classic(case):
        return rest(problem)
    try:
        return rest_by_classic(problem)
    except ConvergenceError as failure:
        current_run().note("classic", outcome=str(failure))
        return None


def static_record(case: Case, answer: Solution, *parts: object) -> Record:
    """The record of a foil pack at zero speed: its reactions; there is no film to speak of."""
    found = Evaluation.of(case, answer)
    forces, fields = found.forces(), wall_fields(found)
    torque = case.surface.friction_coefficient * case.bearing.journal_radius * forces.contact_normal_force
    return record_of(
        "static",
        case,
        *geometry(case),
        asked_position(case),
        forces,
        Torque(torque, torque),
        wall_kind(case).scalars(fields),
        Branch(solution_path=answer.solution_path, stable=True),
        RunOutcome(residual=answer.reported_residual),
        *parts,
        fields=dict(fields),
        coords=coordinates(found),
    )
