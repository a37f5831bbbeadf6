"""The load characteristic: the journal displaced step by step, each point from the one before.

A curve follows its branch: along the tangent, on the contact set of the point before. Where that does not lead on, the
interior point takes over from there; if its answer is not where the branch leads by smaller steps, it is a jump.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from petalfoil.analysis.classic_method import is_classic, typical_steps
from petalfoil.analysis.equilibrium import Named, about, chosen, positioned, relaxed
from petalfoil.analysis.figures import effort, failed_record, record_of
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem


def iterate(
    case: Case,
    eccentricities: Sequence[float],
    *,
    direction: float = -math.pi / 2.0,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield a record for each displacement [m] along `direction` [rad]; a failed point is recorded and passed over.

    Raises
    ------
    PackageError
        A displacement leaves the package no room; before any point is computed.
    """
    cases = points(case, eccentricities, direction, speed)
    return _records(cases, progress)


def points(case: Case, eccentricities: Sequence[float], direction: float, speed: float | None) -> list[Case]:
    """The case at every displacement, each checked."""
    n = np.round([math.cos(direction), math.sin(direction)], 15)  # -90 deg means straight down
    return [positioned(case, speed, (float(e * n[0]), float(e * n[1]))) for e in eccentricities]


def _records(cases: list[Case], progress: Progress | None) -> Iterator[Record]:
    known: Solution | None = None
    base = build_problem(cases[0])
    for number, case in enumerate(cases):
        clock, work = Clock(), telling_work(part(progress, number, len(cases)), "curve", typical_steps(case))
        problem = base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)
        try:
            with one_thread():
                known, extra = _point(case, problem, known, work)
        except ConvergenceError as failure:
            known = None
            yield failed_record("curve", case, f"not converged: {failure}", work)
            continue
        yield record_of("curve", case, known, {**extra, **effort(work), "wall_time": clock.seconds}, work)


def _point(case: Case, problem: CoupledProblem, known: Solution | None, work: RunLog) -> tuple[Solution, Named]:
    if is_classic(case):
        answer, extra = relaxed(case, problem, work, known)
        return answer, {**extra, "jump": False}
    if known is None:
        answer, extra = chosen(case, work)
        return answer, {**extra, "jump": False}
    answer, jump = advance(known, problem, work)
    rate = leading_eigenvalue(answer, work)
    return answer, {**about(rate, case, (2 if jump else 1, answer.way)), "jump": jump}
