"""The operating point: where the journal sits under a load (model, question 3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.equilibrium import Named, about, positioned
from petalfoil.analysis.figures import effort, forces, record_of
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.loaded import Balance
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem

Array = NDArray[np.float64]

FLOATS = 0.01
"""Share of the contacts below which a journal is said to float."""


def run(
    case: Case,
    load: tuple[float, float] | None = None,
    *,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Find the position of the journal under `load` [N], by default the case's.

    A load that the film does not carry alone is an answer too: the record says which share the contacts bear.

    Raises
    ------
    UsageError
        No load is given, or it is zero.
    ConvergenceError
        No position was found.
    """
    case, wanted = positioned(case, speed, (0.0, 0.0)), loaded(case, load)
    clock, work = Clock(), telling_work(progress, "balance")
    with one_thread():
        found, known = settled(case, wanted, work)
    extra: Named = {**known, **effort(work), "wall_time": clock.seconds}
    return balance_record("balance", case, found, {**extra, **given_load(wanted)}, work)


def settled(case: Case, load: tuple[float, float], work: RunLog) -> tuple[Balance, Named]:
    """The balance to report and what is known of its stability: if unstable, the one that the climb from rest finds.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    problem = build_problem(case)
    found = balance_cold(problem, np.array(load) / problem.layout.scales.force, work)
    rate, way = leading_eigenvalue(found.answer, work), found.answer.way
    if not rate.real > 0.0:
        return found, about(rate, case, (1, way))
    try:
        risen = SpeedLine(case, load, work).climb(case.operation.speed)
    except ConvergenceError as failure:
        work.note("climb", outcome=str(failure))
        return found, about(rate, case, (1, way))
    other = leading_eigenvalue(risen.answer, work)
    if other.real > 0.0:
        return found, about(rate, case, (1, way))
    return risen, about(other, case, (2, "followed from rest under the load; another balance is unstable"))


def loaded(case: Case, load: tuple[float, float] | None) -> tuple[float, float]:
    """The load to balance [N]."""
    newton_only(case)
    wanted = case.operation.load if load is None else load
    if wanted is None:
        raise UsageError("no load to balance: give one, or set operation.load in the case")
    if not np.hypot(*wanted) > 0.0:
        raise UsageError("a load of zero leaves the journal where it is: give one that is not zero")
    return wanted


def given_load(load: tuple[float, float]) -> Named:
    """The load as figures."""
    return {"load_x": load[0], "load_y": load[1]}


def balance_record(analysis: str, case: Case, found: Balance, extra: Named, work: RunLog) -> Record:
    """The record of a balance, at the position found."""
    share = float(forces(case, found.answer)["contact_fraction"])
    e = found.answer.problem.displacement * found.answer.problem.layout.scales.length
    own: Named = {
        "eccentricity_x": float(e[0]),
        "eccentricity_y": float(e[1]),
        "force_residual": found.force_residual,
        "carried_by": "film" if share < FLOATS else f"touching: contact carries {100.0 * share:.0f} %",
    }
    return record_of(analysis, case, found.answer, {**extra, **own}, work)
