"""The package at rest: preload, reaction against displacement, starting torque (model, question 1)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from petalfoil.analysis.classic_method import is_classic, rest_by_classic
from petalfoil.analysis.fields import coordinates, petal_fields
from petalfoil.analysis.figures import effort, failed_record, forces, given
from petalfoil.analysis.load_curve import points
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.ascent import rest
from petalfoil.equilibria.work import Work
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.problem.build import build_problem
from petalfoil.problem.coupled import CoupledProblem
from petalfoil.results.record import Record


def iterate(
    case: Case,
    eccentricities: Sequence[float] = (0.0,),
    *,
    direction: float = -math.pi / 2.0,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield the package at rest for each displacement [m] along `direction` [rad].

    Raises
    ------
    UsageError
        The case has no petals.
    PackageError
        A displacement leaves the package no room.
    """
    if case.petals is None:
        raise UsageError("a plain bearing has no package: `static` needs a case with [petals]")
    return _records(points(case, eccentricities, direction, 0.0), progress)


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


def at_rest(case: Case, problem: CoupledProblem, work: Work) -> Answer | None:
    """The assembled package by the method of `case`; None, and why in the history, if it did not settle."""
    if not is_classic(case):
        return rest(problem, work)
    try:
        return rest_by_classic(problem, work)
    except ConvergenceError as failure:
        work.note("classic", outcome=str(failure))
        return None


def static_record(case: Case, answer: Answer, work: Work, seconds: float) -> Record:
    """Reactions of the package; there is no film to speak of."""
    carried = forces(case, answer)
    torque = case.surface.friction_coefficient * case.bearing.journal_radius * float(carried["contact_total"])
    fields = petal_fields(case, answer)
    scalars = {
        **given(case),
        **carried,
        "starting_torque": torque,
        "friction_torque": torque,
        "max_stress": float(np.max(np.abs(fields["bending_stress"]))),
        "residual": answer.residual,
        "stable": True,
        "branch": answer.way,
        "branches_known": 1,
        "converged": True,
        "status": "converged",
        "wall_time": seconds,
        **effort(work),
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
