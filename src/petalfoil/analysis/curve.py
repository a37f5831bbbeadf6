"""`curve`: the load characteristic, the journal displaced step by step, each point from the one before.

A curve follows its branch: along the tangent, on the contact set of the point before. Where that does not lead on, the
interior point takes over from there; if its answer is not where the branch leads by smaller steps, it is a jump.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from petalfoil.analysis.arguments import DOWNWARD, DisplacementDirection, Displacements, Speed
from petalfoil.analysis.classic_method import is_classic, typical_steps
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.displacements import CHARACTERISTIC, displaced
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.heat_results import with_heat
from petalfoil.analysis.operating_point import OperatingPoint, position_point, relaxed
from petalfoil.analysis.past_jump import PastJump
from petalfoil.analysis.records import asked_position, branch, effort, failed_record, solution_record
from petalfoil.analysis.resume import is_same
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.led_points import led, with_nodal_contacts
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.results.layout import Series
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem


@analysis(Series(columns=CHARACTERISTIC), error_bars=True)
def curve(
    case: Case,
    eccentricities: Displacements,
    *,
    direction: DisplacementDirection = DOWNWARD,
    speed: Speed = None,
    progress: Progress | None = None,
) -> Points:
    """Follow the bearing force over the displacement of the journal, at one speed.

    Points that do not converge are named and left blank. With --out the file
    is rewritten as points finish; Ctrl-C keeps what is finished, and --resume
    goes on from it.

    Example: petalfoil curve case.toml --eccentricity "0 um : 280 um : 15"

    Raises
    ------
    PackError
        A displacement leaves the foil pack no clearance; before any point is computed.
    """
    cases = displaced(case, eccentricities, direction, speed)
    return Points(partial(_points, cases, progress), len(cases))


def _points(cases: list[Case], progress: Progress | None, done: Sequence[Record] = ()) -> Iterator[Record]:
    base = build_problem(cases[0])
    before, past = _regained(cases, base, done), PastJump() if _has_jumped(done) else None
    growth = 0.0
    for number, case in enumerate(cases[len(done) :], len(done)):
        problem = displaced_problem(base, case)
        with running(part(progress, number, len(cases)), "curve", typical_steps(case)) as run:
            try:
                found = point_after(case, problem, before, growth=growth)
                growth = found.branch.growth_rate or 0.0
                if found.branch.jump or before is None:
                    past = PastJump() if found.branch.jump else None
                elif past is not None:
                    found = past.told(case, found)
                before = found.answer
                own = (asked_position(case), found.branch, effort(run.seconds))
                record = solution_record("curve", Evaluation.of(case, before), *own)
            except ConvergenceError as failure:
                before, record = None, failed_record("curve", case, failure)
        yield record


def _has_jumped(done: Sequence[Record]) -> bool:
    """Whether the points that are done have jumped since the last one that did not converge."""
    jumped = False
    for record in done:
        jumped = record.converged and (jumped or bool(record.scalars.get("jump")))
    return jumped


def displaced_problem(base: CoupledProblem, case: Case) -> CoupledProblem:
    """The problem of `base` with the journal where the case has it."""
    return base.at(displacement=np.array(case.operation.eccentricity) / base.layout.scales.length)


def _regained(cases: list[Case], base: CoupledProblem, done: Sequence[Record]) -> Solution | None:
    """The solution of the last point that is done; None where it did not converge.

    It is looked for from nothing; where that leads to another branch, along the points before it.
    """
    if not done or not done[-1].converged:
        return None
    last = _along(cases[len(done) - 1 : len(done)], base)
    if last is not None:
        forces = Evaluation.of(cases[len(done) - 1], last).forces()
        if is_same(done[-1], {"force_x": forces.force_x, "force_y": forces.force_y}):
            return last
    return _along(cases[: len(done)], base)


def _along(cases: Sequence[Case], base: CoupledProblem) -> Solution | None:
    """The last solution of a curve; None where it did not converge."""
    found: Solution | None = None
    for case in cases:
        try:
            found = point_after(case, displaced_problem(base, case), found).answer
        except ConvergenceError:
            found = None
    return found


def point_after(
    case: Case, problem: CoupledProblem, before: Solution | None, *, leads: bool = True, growth: float = 0.0
) -> OperatingPoint:
    """A point of the curve, followed from the one `before`; from nothing where there is none.

    Contact points lead there, without a solution with contacts at nodes beside it, unless `leads` is false. `growth` is
    the growth rate of that one [1/s], if it is known.

    Raises
    ------
    ConvergenceError
        It was not found.
    """
    if before is None or is_classic(case):
        own = problem if problem.layout.case is case else None
        found = relaxed(case, problem, before) if is_classic(case) else position_point(case, own)
        return replace(found, branch=replace(found.branch, jump=False))
    here = before.problem.at(displacement=problem.displacement)
    answer, jump = led(before, here) if leads else None, False
    if answer is None:
        before = with_nodal_contacts(before)
        answer, jump = advance(before, here)
        answer = reported(case, with_heat(case, answer), before)
    rate = leading_eigenvalue(answer, growth / case.operation.speed if growth < 0.0 else 0.0)
    return OperatingPoint(answer, branch(rate, case, 2 if jump else None, answer.solution_path, jump))
