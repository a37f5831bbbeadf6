"""Which of several equilibria at a position is reported, and how many are known.

It is the one to which the assembled pack is followed from zero speed. Where that branch is lost, it is the stable one
that presses least on the journal: which starts lead somewhere, and which of them first, is up to rounding there.
"""

from __future__ import annotations

from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.branches import (
    cold_answers,
    different,
    found_by_chance,
    is_coarse,
    known_on_few_cells,
    may_have_others,
)
from petalfoil.equilibrium.cold_start import BARRIERS, by_barriers, by_slower_ways, solve_cold
from petalfoil.equilibrium.continuation import ascend, settle
from petalfoil.equilibrium.lengthening import lengthened
from petalfoil.equilibrium.other_grids import or_from_other_grids
from petalfoil.equilibrium.solution import Solution
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls import Capability, wall_kind


def others(case: Case, problem: CoupledProblem, first: Solution | None, rate: complex) -> tuple[int, list[Solution]]:
    """Number of equilibria known at a position, and the different ones on the case's own grid, the `first` at the head.

    They are looked for where there may be others than the `first`: on its own grid where rounding may have led to it,
    on a coarse one elsewhere.
    """
    found = [] if first is None else [first]
    doubtful = first is None or may_have_others(first, rate)
    if doubtful and wall_kind(case).can(Capability.SEVERAL_EQUILIBRIA):
        if not found_by_chance(first) and not is_coarse(case):
            return known_on_few_cells(problem), found
        found = different([*found, *cold_answers(problem)])
    if not found:
        found = list(filter(None, [by_barriers(problem, BARRIERS[1:])]))
    return max(1, len(found)), found


def from_rest(problem: CoupledProblem, known: list[Solution]) -> tuple[list[Solution], list[complex], str]:
    """The equilibrium followed from zero speed and those `known`, their eigenvalues, and a solution path.

    The first is the one to report; the path is empty where its own tells it.

    Raises
    ------
    ConvergenceError
        None is known and none was found.
    """
    risen, jumps = ascend(problem)
    found = [*([] if risen is None else [risen]), *known] or [last_resort(problem)]
    rates = [leading_eigenvalue(answer) for answer in found]
    path = "" if risen is None else ascent_text(jumps)
    return settled(found, rates, path) if rates[0].real > 0.0 else (found, rates, path)


def last_resort(problem: CoupledProblem) -> Solution:
    """The equilibrium where neither a cold start nor the continuation from zero speed found one.

    Raises
    ------
    ConvergenceError
        Nothing was found.
    """
    if problem.layout.film_rows.inventory is None:
        return solve_cold(problem, ())
    return by_slower_ways(problem) or or_from_other_grids(lengthened, problem)


def settled(found: list[Solution], rates: list[complex], path: str) -> tuple[list[Solution], list[complex], str]:
    """Put first where the unstable equilibrium at the head of `found` goes, if that is stable."""
    stable = [k for k, rate in enumerate(rates) if not rate.real > 0.0]
    rested = None if stable else settle(found[0])
    if rested is not None:
        found, rates = [*found, rested], [*rates, leading_eigenvalue(rested)]
        stable = [] if rates[-1].real > 0.0 else [len(found) - 1]
    if not stable:
        return found, rates, path
    first = stable[0]
    order = [first, *(k for k in range(len(found)) if k != first)]
    text = f"{found[first].solution_path}; the branch from rest has lost its stability below this speed"
    return [found[k] for k in order], [rates[k] for k in order], text


def ascent_text(jumps: int) -> str:
    """How the followed branch was reached."""
    text = "followed from the assembled pack at zero speed up to speed"
    return text if jumps == 0 else f"{text}; the branch ended {jumps} time(s) on the way and the bearing settled anew"
