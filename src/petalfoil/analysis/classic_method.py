"""The paper's own method behind the same verbs: its state as an answer, with the same figures and flags."""

from __future__ import annotations

from petalfoil.case import Case, Method
from petalfoil.classic import ClassicRun, ClassicState, assembled, relax
from petalfoil.classic.relaxation import HistoryRow
from petalfoil.equilibrium.run_context import TYPICAL_STEPS, current_run
from petalfoil.equilibrium.solution import Solution, unrefined
from petalfoil.errors import UsageError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

TYPICAL_OUTER = 150.0
"""Outer iterations of a typical run."""


def is_classic(case: Case) -> bool:
    """Whether the case asks for the paper's method."""
    return case.model.method is Method.CLASSIC


def typical_steps(case: Case) -> float:
    """Rows of history that a run of `case` typically writes."""
    return TYPICAL_OUTER if is_classic(case) else TYPICAL_STEPS


def newton_only(case: Case) -> None:
    """Refuse the paper's method where a question needs the tangent of an answer.

    Raises
    ------
    UsageError
        The case asks for the paper's method.
    """
    if is_classic(case):
        raise UsageError(
            'this needs model.method = "newton": the classic method has no tangent; it solves, follows curves and '
            "finds the foil pack at zero speed"
        )


def by_classic(problem: CoupledProblem, known: Solution | None = None) -> Solution:
    """The equilibrium that film and foil pack relax to, from the assembled pack or from a `known` neighbour.

    Raises
    ------
    ConvergenceError
        A number of steps was used up.
    """
    reached = relax(telling_run(problem), None if known is None else start_from(known))
    way = "the assembled pack" if known is None else "the neighbouring point"
    return answer_of(problem, reached, f"film and foil pack relaxed in turn from {way}, {reached.outer} times")


def rest_by_classic(problem: CoupledProblem) -> Solution:
    """The assembled pack with its film at rest, by gradient descent.

    Raises
    ------
    ConvergenceError
        A number of steps was used up.
    """
    still = problem.at(bearing_number=0.0)
    reached = assembled(telling_run(still))
    current_run().note("classic", pack_steps=reached.pack_steps)
    return answer_of(still, reached, "assembled pack at zero speed, by gradient descent")


def telling_run(problem: CoupledProblem) -> ClassicRun:
    """A run of the classic method that writes the history of the current run."""
    run = current_run()

    def tell(row: HistoryRow) -> None:
        run.note("classic", **row)

    def pulse() -> None:
        if run.tell is not None:
            run.tell("classic")

    return ClassicRun(problem, tell=tell, pulse=pulse)


def start_from(known: Solution) -> ClassicState:
    """A known neighbour as a start."""
    return ClassicState(known.deflection, known.x[known.problem.positive], known.lam, 0, 0, 0)


def answer_of(problem: CoupledProblem, reached: ClassicState, way: str) -> Solution:
    """Where the method came to rest, as an answer; its residual is what it is, some 1e-6."""
    x = problem.layout.unknowns.join({DEFLECTION: reached.w, PRESSURE: reached.P})
    return unrefined(problem, x, reached.lam, way)
