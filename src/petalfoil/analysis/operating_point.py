"""The equilibrium that an analysis is about: at a position of the journal, or under a load.

Where several equilibria exist, the answer is the one that the assembled pack reaches from rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.branch_choice import from_rest, others
from petalfoil.analysis.by_coarse_film import by_coarse_film
from petalfoil.analysis.classic_method import by_classic, newton_only
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.friction_told import follows_path
from petalfoil.analysis.heat_results import with_heat
from petalfoil.analysis.neighbours import begun, keep
from petalfoil.analysis.records import branch
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.analysis.thermal_limit import beyond_thermal_limit
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.branches import different, found_by_chance, pressing_least
from petalfoil.equilibrium.coarse_start import by_coarse_grid
from petalfoil.equilibrium.heated import ThermalRunawayError
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.equilibrium.whole_length import balance_from_nothing, first_attempt
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.parts import AppliedLoad, Branch
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.loaded import load_of
from petalfoil.units import format_percent

Vector = tuple[float, float]

SMALLER_LOADS = (0.1, 0.01, 0.001)
"""Fractions of a load without a balance at which its reason is looked for."""

SOLID_CONTACT = 0.9
"""Contact fraction above which the film is no support any more."""


@dataclass(frozen=True)
class ForceResidual:
    """What is left of the balance of film, contacts and load."""

    force_residual: float


@dataclass(frozen=True)
class OperatingPoint:
    """An equilibrium and what is known of it.

    Attributes
    ----------
    answer : Solution
        Film, petals and contacts.
    branch : Branch
        How it was reached, and whether it is stable.
    loaded : tuple
        Load and force residual; empty where the position was given.
    """

    answer: Solution
    branch: Branch
    loaded: tuple[object, ...] = ()


def operating_point(case: Case, load: Vector | None) -> OperatingPoint:
    """The equilibrium under a load [N] where one is given, else at the case's eccentricity.

    Its stations are those that every analysis of the case has (`with_stations`): those of the case of its answer.

    Raises
    ------
    ConvergenceError
        None was found.
    """
    case = with_stations(case)
    if load is None and case.operation.load is None:
        return position_point(case)
    wanted = applied_load(case, load)
    found = loaded_point(at(case, eccentricity=(0.0, 0.0)), wanted)
    loaded = AppliedLoad.of(wanted, case.operation.moment), ForceResidual(found.answer.force_residual)
    return replace(found, loaded=loaded)


def position_point(case: Case, problem: CoupledProblem | None = None) -> OperatingPoint:
    """The equilibrium to report at the case's eccentricity, as results are taken from it; arguments of `at_position`.

    Raises
    ------
    ConvergenceError
        None was found.
    """
    problem = problem or build_problem(case)
    return from_coarse_grid(problem, None) or with_reported(case, at_position(case, problem))


def loaded_point(case: Case, load: Vector) -> OperatingPoint:
    """The balance to report under a load [N], as results are taken from it.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    problem = build_problem(case) if case.shares_evenly else None
    found = None if problem is None else from_coarse_grid(problem, load)
    return found or with_reported(case, OperatingPoint(*under_load(case, load, problem)))


def from_coarse_grid(problem: CoupledProblem, load: Vector | None) -> OperatingPoint | None:
    """The equilibrium with contacts between nodes that a coarser grid leads to, at its position or under a load [N].

    None where that leads nowhere, or where there may be others: `at_position` and `under_load` then tell which it is.
    """
    case = problem.layout.case
    wanted = None if load is None else load_of(case, load, problem.layout)
    found = by_coarse_grid(problem, wanted) or by_coarse_film(problem, wanted)
    if found is None:
        return None
    rate = leading_eigenvalue(found, rate_on_few_cells(found))
    if rate.real > 0.0:
        return None
    found = replace(found, on_few_cells=None, coarse_rate=0.0)
    keep(found, alone=False)
    return OperatingPoint(found, branch(rate, case, 1 if load is None else None, found.solution_path))


def rate_on_few_cells(found: Solution) -> float:
    """Growth rate of the equilibrium on few cells or under a coarse film that led to the one `found`, 0 of none [1]."""
    below, outer = found.on_few_cells, current_run()
    if below is None or below.contacts is None:
        return found.coarse_rate
    with running() as run:
        rate = leading_eigenvalue(below).real
    outer.coarse.factorizations += run.probes.factorizations
    return rate


def with_reported(case: Case, found: OperatingPoint) -> OperatingPoint:
    """The operating point with the equilibrium that results are taken from, its growth rate among them."""
    answer = found.answer
    if answer.other is not None or answer.friction is not None:  # those of both bearings, or of a path, are found
        return found
    answer = reported(case, found.answer)
    if answer.elements is None:  # in 3-D the growth rate stays that of contacts at nodes
        return replace(found, answer=answer)
    known = found.branch
    rate = branch(leading_eigenvalue(answer), case, known.known_equilibria, known.solution_path, known.jump)
    return replace(found, answer=answer, branch=rate)


def at(case: Case, speed: float | None = None, eccentricity: Vector | None = None) -> Case:
    """The case at another speed [rad/s] and eccentricity [m], where they are given; checked anew."""
    given = {"operation.speed": speed, "operation.eccentricity": eccentricity}
    changes = {name: value for name, value in given.items() if value is not None}
    return case.replace(**changes) if changes else case


def applied_load(case: Case, load: Vector | None) -> Vector:
    """The load to balance [N]: the one given, else the case's."""
    newton_only(case)
    wanted = case.operation.load if load is None else load
    if wanted is None:
        raise UsageError("no load to balance: give one, or set operation.load in the case")
    return wanted


def under_load(case: Case, load: Vector, problem: CoupledProblem | None = None) -> tuple[Solution, Branch]:
    """The balance to report: if the first one found is unstable, the one that is followed from rest under the load.

    The load is that of the whole rotor: two bearings carry half of it each. `problem` is that of the case, if it is at
    hand.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    if not case.shares_evenly:
        return on_shaft(case, load)
    if follows_path(case):
        found = SpeedLine(case, load, leads=False).climb(case.operation.speed)
        return found, Branch(solution_path=found.solution_path)
    found, rate = begun_under_load(problem or build_problem(case), load)
    if case.heat is not None:
        found = in_heat(case, found, load)
        rate = leading_eigenvalue(found)
    alone = branch(rate, case, None, found.solution_path)
    if not rate.real > 0.0:
        return found, alone
    try:
        risen = SpeedLine(case, load, leads=False).climb(case.operation.speed)
    except ConvergenceError as failure:
        current_run().note("climb", outcome=str(failure))
        return found, alone
    other = leading_eigenvalue(risen)
    if other.real > 0.0:
        return found, alone
    return risen, branch(other, case, 2, "followed from rest under the load; another balance is unstable")


def begun_under_load(problem: CoupledProblem, load: Vector) -> tuple[Solution, complex]:
    """The first balance found, with the temperatures of the problem, and its leading eigenvalue.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    wanted = load_of(problem.layout.case, load, problem.layout)
    try:
        found, rate = begun(problem, wanted, lambda: balance_from_nothing(problem, wanted))
    except ConvergenceError as failure:
        raise beyond_capacity(problem, load, failure) from failure
    keep(found, alone=not rate.real > 0.0)
    return found, rate


def on_shaft(case: Case, load: Vector) -> tuple[Solution, Branch]:
    """The equilibrium of a rotor whose bearings do not share the load evenly.

    Raises
    ------
    ConvergenceError
        It has none.
    """
    try:
        found = RotorInBearings.of(case, load).at(case.operation.speed)
    except ThermalRunawayError as failure:
        raise beyond_thermal_limit(case, load, failure) from failure
    rates = [leading_eigenvalue(one) for one in (found, found.other) if one is not None]
    return found, branch(max(rates, key=lambda rate: rate.real), case, None, found.solution_path)


def in_heat(case: Case, found: Solution, load: Vector | None) -> Solution:
    """The equilibrium with its heat network; an error that tells the speed where it has no steady temperature.

    Raises
    ------
    ThermalRunawayError
        There is none.
    """
    try:
        return with_heat(case, found)
    except ThermalRunawayError as failure:
        raise beyond_thermal_limit(case, load, failure) from failure


def beyond_capacity(problem: CoupledProblem, load: Vector, failure: ConvergenceError) -> ConvergenceError:
    """The error of a load without a balance: where solid contact carries smaller ones already, it is beyond capacity.

    Parameters
    ----------
    problem : CoupledProblem
        The bearing.
    load : (x, y)
        The load [N].
    failure : ConvergenceError
        Why it has no balance; returned where a smaller load has none either, or the film carries it.
    """
    whole = load_of(problem.layout.case, load, problem.layout)
    for fraction in SMALLER_LOADS if np.any(load) else ():
        try:
            found = balance_cold(problem, fraction * whole)
        except ConvergenceError:
            continue
        carried = Evaluation.of(problem.layout.case, found).contact_fraction
        if carried < SOLID_CONTACT:
            return failure
        size = float(np.hypot(*load))
        return ConvergenceError(
            f"a load of {size:g} N is beyond the capacity of the bearing: at {fraction * size:g} N solid contact "
            f"carries {format_percent(carried, digits=4)} of it already",
            history=failure.history,
            advice="reduce the load; contact_fraction at smaller loads tells how much solid contact carries",
        )
    return failure


def at_position(case: Case, problem: CoupledProblem | None = None) -> OperatingPoint:
    """The equilibrium to report at the case's eccentricity; `problem` is that of the case, if it is at hand.

    That of the cold start, if it was found at the first barrier and not by chance, is stable and the only one known;
    else the one to which the pack is followed from zero speed, as long as it is stable. Where that branch is lost it is
    the stable one that presses least on the journal.

    Raises
    ------
    ConvergenceError
        Neither a cold start nor the continuation from zero speed found one.
    """
    if case.operation.moment is not None and case.bearings == 1:
        raise UsageError(
            "operation.moment is balanced together with a load: give one, or the slopes operation.tilt in its place"
        )
    problem = problem or build_problem(case)
    first, rate = begun(problem, None, lambda: first_attempt(problem))
    known, found = others(case, problem, first, rate)
    alone = known == 1 and first is not None and not found_by_chance(first) and not rate.real > 0.0
    if first is not None:
        keep(first, alone=alone)
    path, rates = "", [rate]
    if not alone:
        found, rates, path = from_rest(problem, pressing_least(found))
    if case.heat is not None:
        found = [in_heat(case, found[0], None), *found[1:]]
        rates = [leading_eigenvalue(found[0]), *rates[1:]]
    known = max(known, len(different(found)))
    return OperatingPoint(found[0], branch(rates[0], case, known, path or found[0].solution_path))


def relaxed(case: Case, problem: CoupledProblem, neighbour: Solution | None = None) -> OperatingPoint:
    """The equilibrium that the paper's method comes to rest at, from nothing or from a neighbouring point.

    Raises
    ------
    ConvergenceError
        A number of steps was used up.
    """
    answer = by_classic(problem, neighbour)
    return OperatingPoint(answer, branch(leading_eigenvalue(answer), case, None, answer.solution_path))
