"""The package at rest: preload, reaction against displacement, starting torque (model, question 1)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from petalfoil.analysis.classic_method import is_classic, rest_by_classic
from petalfoil.analysis.fields import coordinates, wall_fields
from petalfoil.analysis.figures import Named, effort, failed_record, forces, given
from petalfoil.analysis.hysteresis import follow, legs
from petalfoil.analysis.load_curve import points
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.case import Case
from petalfoil.equilibrium.ascent import rest
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls import Capability, required, wall_kind


def iterate(
    case: Case,
    eccentricities: Sequence[float] = (0.0,),
    *,
    direction: float = -math.pi / 2.0,
    loop: bool = False,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield the package at rest for each displacement [m] along `direction` [rad].

    With friction between the petals each state comes from the one before, the first from the assembled package; `loop`
    goes back and there again, so that a closed cycle stands between the ends of the first and of the third leg.

    Raises
    ------
    UsageError
        The wall has no pack at zero speed; or a loop is asked for where petals have no friction, or of a single point.
    PackageError
        A displacement leaves the package no room.
    """
    required(case, Capability.PACK, "`static`")
    cases = points(case, eccentricities, direction, 0.0)
    if case.surface.petal_friction > 0.0 and not is_classic(case):
        if loop and len(cases) < 2:
            raise UsageError("a loop needs at least two displacements")
        return _with_friction(legs(cases, loop), progress)
    if loop:
        raise UsageError("a loop needs friction: give surface.petal_friction, and the default method")
    return _records(cases, progress)


def _with_friction(way: list[tuple[str, Case]], progress: Progress | None) -> Iterator[Record]:
    for number, point in enumerate(follow(way)):
        if progress is not None:
            progress(number / len(way), f"static: {point.leg}")
        extra: Named = {"leg": point.leg, "petal_friction_work": point.lost}
        if point.answer is None:
            status = "not converged: the package did not settle on the way"
            yield failed_record("static", point.case, status, point.work, {"leg": point.leg})
        else:
            yield static_record(point.case, point.answer, point.work, point.seconds, extra)


def _records(cases: list[Case], progress: Progress | None) -> Iterator[Record]:
    base = build_problem(cases[0])
    for number, case in enumerate(cases):
        clock, work = Clock(), telling_work(None, "static")
        if progress is not None:
            progress(number / len(cases), "static")
        with one_thread():
            problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
            answer = at_rest(case, problem, work)
        if answer is None:
            yield failed_record("static", case, "not converged: the package did not settle", work)
        else:
            yield static_record(case, answer, work, clock.seconds)


def at_rest(case: Case, problem: CoupledProblem, work: RunLog) -> Solution | None:
    """The assembled package by the method of `case`; None, and why in the history, if it did not settle."""
    if not is_classic(case):
        return rest(problem, work)
    try:
        return rest_by_classic(problem, work)
    except ConvergenceError as failure:
        work.note("classic", outcome=str(failure))
        return None


def static_record(case: Case, answer: Solution, work: RunLog, seconds: float, extra: Named | None = None) -> Record:
    """Reactions of the package; there is no film to speak of."""
    carried = forces(case, answer)
    torque = case.surface.friction_coefficient * case.bearing.journal_radius * float(carried["contact_normal_force"])
    fields = wall_fields(case, answer)
    scalars = {
        **given(case),
        **carried,
        "starting_torque": torque,
        "friction_torque": torque,
        **wall_kind(case).scalars(fields),
        "residual": answer.residual,
        "stable": True,
        "solution_path": answer.way,
        "known_equilibria": 1,
        "converged": True,
        "status": "converged",
        "wall_time": seconds,
        **effort(work),
        **(extra or {}),
    }
    return Record(
        analysis="static",
        scalars=scalars,
        fields=dict(fields),
        coords=coordinates(case, answer),
        case_toml=case.to_toml(),
        title=case.title,
        history=list(work.history),
    )
