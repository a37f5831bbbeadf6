"""One position of the journal at one speed: film, petals and contacts in equilibrium.

Where several equilibria exist, the answer is the one that the assembled package reaches from rest.
"""

from __future__ import annotations

import math

from petalfoil.analysis.figures import effort, record_of
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.case import Case, Kind
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.ascent import ascend
from petalfoil.equilibria.branches import distinct, probe
from petalfoil.equilibria.cold import solve_cold
from petalfoil.equilibria.stability import leading_eigenvalue
from petalfoil.equilibria.work import Work
from petalfoil.problem.build import build_problem
from petalfoil.results.record import Record

PROBE_CELLS, PROBE_AXIAL = 24, 6
"""Grid on which other equilibria are looked for."""

Named = dict[str, float | int | bool | str]


def run(
    case: Case,
    *,
    speed: float | None = None,
    eccentricity: tuple[float, float] | None = None,
    progress: Progress | None = None,
) -> Record:
    """Solve `case`, at another speed [rad/s] or eccentricity [m] if given.

    Raises
    ------
    ConvergenceError
        No equilibrium was found.
    PackageError
        The displaced journal leaves the package no room.
    """
    case = positioned(case, speed, eccentricity)
    clock, work = Clock(), telling_work(progress, "solve")
    with one_thread():
        answer, about = chosen(case, work)
    extra: Named = {**about, **effort(work), "wall_time": clock.seconds}
    return record_of("solve", case, answer, extra, work)


def positioned(case: Case, speed: float | None, eccentricity: tuple[float, float] | None) -> Case:
    """The case at another speed and eccentricity; checked anew."""
    changes: dict[str, object] = {}
    if speed is not None:
        changes["operation.speed"] = speed
    if eccentricity is not None:
        changes["operation.eccentricity"] = eccentricity
    return case.replace(**changes) if changes else case


def chosen(case: Case, work: Work) -> tuple[Answer, Named]:
    """The equilibrium to report, and what is known of its branch and stability."""
    problem = build_problem(case)
    answer = solve_cold(problem, work)
    rate = leading_eigenvalue(answer, work)
    known = 1 if case.petals is None else probe(build_problem(coarse(case)), work)
    if known > 1 or rate.real > 0.0:
        risen, jumps = ascend(problem, work)
        if risen is not None:
            known = max(known, distinct([answer, risen]))
            answer, rate = risen, leading_eigenvalue(risen, work)
            return answer, about(answer, rate, case, (known, ascent_text(jumps)))
        known = max(known, 2)
    return answer, about(answer, rate, case, (known, answer.way))


def coarse(case: Case) -> Case:
    """The same bearing on the grid of the probe."""
    changes: dict[str, object] = {"model.cells_per_pitch": min(case.cells_per_pitch, PROBE_CELLS)}
    if case.model.kind is Kind.SPATIAL:
        changes["model.axial_cells"] = min(case.axial_cells, PROBE_AXIAL)
    return case.replace(**changes)


def about(answer: Answer, rate: complex, case: Case, branch: tuple[int, str]) -> Named:
    """Branch and stability as figures; a shaft at rest has no film that could grow."""
    omega = case.operation.speed
    return {
        "stable": not rate.real > 0.0,
        "growth_rate": rate.real * omega if not math.isnan(rate.real) else math.nan,
        "growth_frequency": abs(rate.imag) * omega if not math.isnan(rate.imag) else math.nan,
        "branches_known": branch[0],
        "branch": branch[1],
    }


def ascent_text(jumps: int) -> str:
    """How the followed branch was reached."""
    text = "followed from the assembled package at rest up to speed"
    return text if jumps == 0 else f"{text}; the branch ended {jumps} time(s) on the way and the bearing settled anew"
