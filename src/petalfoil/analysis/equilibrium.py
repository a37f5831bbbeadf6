"""One position of the journal at one speed: film, petals and contacts in equilibrium.

Where several equilibria exist, the answer is the one that the assembled package reaches from rest.
"""

from __future__ import annotations

import math

from petalfoil.analysis.classic_method import by_classic, is_classic, typical_steps
from petalfoil.analysis.figures import effort, record_of
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.case import Case, ModelKind
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.ascent import ascend
from petalfoil.equilibrium.branches import distinct, probe
from petalfoil.equilibrium.cold_start import nothing_found, solve_cold
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.warm_start import settle
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls import Capability, wall_kind

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
    clock, work = Clock(), telling_work(progress, "solve", typical_steps(case))
    with one_thread():
        answer, known = relaxed(case, build_problem(case), work) if is_classic(case) else chosen(case, work)
    extra: Named = {**known, **effort(work), "wall_time": clock.seconds}
    return record_of("solve", case, answer, extra, work)


def positioned(case: Case, speed: float | None, eccentricity: tuple[float, float] | None) -> Case:
    """The case at another speed and eccentricity; checked anew."""
    changes: dict[str, object] = {}
    if speed is not None:
        changes["operation.speed"] = speed
    if eccentricity is not None:
        changes["operation.eccentricity"] = eccentricity
    return case.replace(**changes) if changes else case


def chosen(case: Case, work: RunLog) -> tuple[Solution, Named]:
    """The equilibrium to report, and what is known of its branch and stability.

    Raises
    ------
    ConvergenceError
        Neither a cold start nor the way up from rest found one.
    """
    problem = build_problem(case)
    found = from_nothing(problem, work)
    rates = [leading_eigenvalue(answer, work) for answer in found]
    several = wall_kind(case).can(Capability.SEVERAL_EQUILIBRIA)
    known = probe(build_problem(coarse(case)), work) if several else 1
    way = ""
    if known > 1 or not found or rates[0].real > 0.0:
        risen, jumps = ascend(problem, work)
        if risen is not None:
            found, rates = [risen, *found], [leading_eigenvalue(risen, work), *rates]
            way = ascent_text(jumps)
    if not found:
        raise nothing_found(work)
    if rates[0].real > 0.0:
        found, rates, way = settled(found, rates, way, work)
    known = max(known, distinct(found))
    return found[0], about(rates[0], case, (known, way or found[0].way))


def relaxed(case: Case, problem: CoupledProblem, work: RunLog, known: Solution | None = None) -> tuple[Solution, Named]:
    """The equilibrium that the paper's method comes to rest at, from nothing or from a `known` neighbour.

    Raises
    ------
    ConvergenceError
        A number of steps was used up.
    """
    answer = by_classic(problem, work, known)
    return answer, about(leading_eigenvalue(answer, work), case, (1, answer.way))


def from_nothing(problem: CoupledProblem, work: RunLog) -> list[Solution]:
    """The answer of a cold start, if there is one."""
    try:
        return [solve_cold(problem, work)]
    except ConvergenceError as failure:
        work.note("film", outcome=str(failure))
        return []


def settled(
    found: list[Solution], rates: list[complex], way: str, work: RunLog
) -> tuple[list[Solution], list[complex], str]:
    """Put first where the unstable equilibrium at the head of `found` goes, if that is stable."""
    stable = [k for k, rate in enumerate(rates) if not rate.real > 0.0]
    rested = None if stable else settle(found[0], work)
    if rested is not None:
        found, rates = [*found, rested], [*rates, leading_eigenvalue(rested, work)]
        stable = [] if rates[-1].real > 0.0 else [len(found) - 1]
    if not stable:
        return found, rates, way
    first = stable[0]
    order = [first, *(k for k in range(len(found)) if k != first)]
    text = f"{found[first].way}; the branch from rest has lost its stability below this speed"
    return [found[k] for k in order], [rates[k] for k in order], text


def coarse(case: Case) -> Case:
    """The same bearing on the grid of the probe."""
    changes: dict[str, object] = {"model.cells_per_pitch": min(case.cells_per_pitch, PROBE_CELLS)}
    if case.model.kind is ModelKind.THREE_D:
        changes["model.axial_cells"] = min(case.axial_cells, PROBE_AXIAL)
    return case.replace(**changes)


def about(rate: complex, case: Case, branch: tuple[int, str]) -> Named:
    """Branch and stability as figures; a shaft at rest has no film that could grow."""
    omega = case.operation.speed
    return {
        "stable": not rate.real > 0.0,
        "growth_rate": rate.real * omega if not math.isnan(rate.real) else math.nan,
        "growth_frequency": abs(rate.imag) * omega if not math.isnan(rate.imag) else math.nan,
        "known_equilibria": branch[0],
        "solution_path": branch[1],
    }


def ascent_text(jumps: int) -> str:
    """How the followed branch was reached."""
    text = "followed from the assembled package at rest up to speed"
    return text if jumps == 0 else f"{text}; the branch ended {jumps} time(s) on the way and the bearing settled anew"
