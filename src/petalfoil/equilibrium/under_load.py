"""The journal's position under a load: film, petals, contacts and journal in one Newton.

From nothing through the interior point, with the position among its unknowns; from a neighbour, and to finish, on the
contact set with the position bordered: one factorisation a step serves the state and both directions of displacement.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.bottomed_out import pressed_solid
from petalfoil.equilibrium.cold_start import GOALS, content, nothing_found
from petalfoil.equilibrium.linear_response import Motion, Response
from petalfoil.equilibrium.loaded import Balance, force_residual, journal_force, size_of
from petalfoil.equilibrium.package_at_rest import assembled
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import from_closed
from petalfoil.equilibrium.warm_start import RESTART_BARRIER, keep_open, predict
from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.contact_newton import ActiveOptions, Closed, ContactState, Outcome, evaluate, revise, searched
from petalfoil.solvers.interior_point import InteriorOptions, contact_set, interior_point
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.loaded import FilmForce, LoadedProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BARRIERS = (3.0, 30.0, 0.3)
"""Barriers at which film and load join the assembled package."""

FORCE_TOLERANCE = 1e-9
"""Largest force residual of a balance, over the load."""


def balance_cold(problem: CoupledProblem, load: Array, work: RunLog) -> Balance:
    """Solve from nothing at the load `load` (2,) over the unit of force.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    found = from_nothing(problem, load, work) or loaded_gradually(problem, load, work)
    if found is None:
        raise nothing_found(work)
    return found


def from_nothing(problem: CoupledProblem, load: Array, work: RunLog) -> Balance | None:
    """Cold starts, each barrier in turn; None if none leads to a balance."""
    for barrier in BARRIERS:
        try:
            found = attempt(problem, load, barrier, work)
        except SingularMatrixError as failure:
            work.note("balance", outcome=str(failure))
            continue
        if found is not None:
            return found
    return None


def loaded_gradually(problem: CoupledProblem, load: Array, work: RunLog) -> Balance | None:
    """Balance a share of the load, then more and more of it; None if that leads nowhere."""
    for share in SHARES:
        known = from_nothing(problem, share * load, work)
        while known is not None and share < 1.0:
            share = min(1.0, 2.0 * share)
            known = from_neighbour(known, problem, share * load, work)
        if known is not None:
            return known
    return None


SHARES = (0.25, 0.0625, 0.015625)
"""Shares of a load from which all of it is reached: for loads tens of times the capacity of the film."""


def attempt(problem: CoupledProblem, load: Array, barrier: float, work: RunLog) -> Balance | None:
    """One cold start; None if it leads nowhere."""
    start = assembled(problem, barrier, work)
    return through_interior(
        problem, ConePoint(np.append(start.x, problem.displacement), start.s, start.lam), load, work
    )


def through_interior(problem: CoupledProblem, start: ConePoint, load: Array, work: RunLog) -> Balance | None:
    """The interior point with the position among its unknowns, then Newton on the contact set; None if it fails."""
    whole, point = LoadedProblem(problem, load), start
    for goal in GOALS:
        options = InteriorOptions(least_barrier=0.1 * goal)
        point, found = interior_point(whole, point, work.film_solver, options, work.watch("balance", content(goal)))
        if not found:
            return None
        z, closed = contact_set(whole, point, work.film_solver)
        balance = newton(problem.at(displacement=z[-2:]), (z[:-2], closed), load, work)
        if balance is not None:
            return balance
    return pressed_solid(whole, point, work)


def rebalance(known: Balance, problem: CoupledProblem, load: Array, work: RunLog) -> Balance:
    """The balance of `problem` (at another speed) or of another load, from a neighbour that is known.

    Raises
    ------
    ConvergenceError
        Nothing was found, not even from nothing.
    """
    found = from_neighbour(known, problem, load, work)
    return found or balance_cold(problem.at(displacement=np.zeros(2)), load, work)


def from_neighbour(known: Balance, problem: CoupledProblem, load: Array, work: RunLog) -> Balance | None:
    """By the tangent and the contact set of `known`, else by the interior point from there; None if neither leads."""
    here = problem.at(displacement=known.answer.problem.displacement)
    x = keep_open(known.answer.x, predict(known.answer, here), here.positive)
    found = newton(here, (x, known.answer.in_contact), load, work, WARM)
    if found is not None:
        return found
    s = np.maximum(here.gaps(x), np.sqrt(RESTART_BARRIER))
    lam = np.maximum(known.answer.lam, RESTART_BARRIER * here.weight / s)
    try:
        return through_interior(here, ConePoint(np.append(x, here.displacement), s, lam), load, work)
    except SingularMatrixError as failure:
        work.note("balance", outcome=str(failure))
        return None


WARM = ActiveOptions(max_steps=8)
"""A contact set that leads on from a neighbour does so in a few steps."""


def newton(
    problem: CoupledProblem, start: tuple[Array, Mask], load: Array, work: RunLog, options: ActiveOptions | None = None
) -> Balance | None:
    """Newton from unknowns and closed gaps `start`, with the position of `problem` as its start; None if it fails."""
    numbers = options or ActiveOptions()
    x, closed = start
    doubt, swaps = np.zeros(len(closed), dtype=bool), 0
    state, before = evaluate(problem, x, closed), np.inf
    for step in range(numbers.max_steps + 1):
        if isinstance(state, Outcome):
            work.note("contacts", outcome=state.value)
            return None
        wanted = revise(problem, state, numbers) if step else state.closed
        unchanged = bool(np.array_equal(wanted, state.closed))
        left = float(np.hypot(*(journal_force(problem, state.x[problem.positive], state.lam) + load)))
        work.note("contacts", residual=state.residual, force=left, touching=int(state.closed.sum()))
        settled = state.residual <= (ROUNDED if state.residual > 0.5 * before else numbers.tolerance)
        if step and unchanged and settled and left <= FORCE_TOLERANCE * size_of(load):
            balance = finished(problem, state, load, work)
            if balance is not None:
                return balance
        before = state.residual
        doubt, swaps = doubt | (wanted != state.closed), swaps + (not unchanged)
        if not unchanged:
            found = searched(problem, state, doubt, work.film_solver) if swaps > numbers.patience else None
            state = evaluate(problem, state.x, wanted) if found is None else found
            if isinstance(state, Outcome):
                return None
        moved = bordered_step(problem, state, load, work)
        if moved is None:
            return None
        problem, x = moved
        state = evaluate(problem, x, state.closed)
    return None


ROUNDED = 1e-6
"""A residual below this that no longer halves is rounding: gaps closed over slivers of cells. Refinement removes it."""


def bordered_step(
    problem: CoupledProblem, state: ContactState, load: Array, work: RunLog
) -> tuple[CoupledProblem, Array] | None:
    """One Newton step of state and position: block elimination with one factorisation and three solves."""
    try:
        response = Motion(problem, problem.linearize(state.x), state.closed, state.ties).respond(0.0, work.film_solver)
    except SingularMatrixError:
        return None
    ties, residual = state.ties, state.line.residual
    settle = ties.spread(response.factor.solve(-ties.gather(residual)))
    lam = ties.reactions(residual + response.apply(settle))
    by_e = problem.layout.wall.contacts.by_e[state.closed]
    pressures = state.x[problem.positive] + settle[problem.positive]
    left = FilmForce.of(problem).at(pressures) + by_e.T @ lam + load
    follow, de = made_up(response, left)
    change = settle + follow
    share = reach(problem, state.x, change, de)
    return problem.at(displacement=problem.displacement + share * de), state.x + share * change


def reach(problem: CoupledProblem, x: Array, change: Array, de: Array) -> float:
    """Share of a step that keeps pressures positive and moves the journal by at most ten reference films."""
    kept = problem.positive
    falling = change[kept] < 0.0
    pressures = 0.8 * np.min(x[kept][falling] / -change[kept][falling], initial=np.inf)
    return float(min(1.0, pressures, MOST_FILMS / max(float(np.hypot(*de)), 1e-300)))


MOST_FILMS = 10.0
"""Longest move of the journal in a step, in reference films (100 um for petals, ten clearances for a plain bore)."""


def finished(problem: CoupledProblem, state: ContactState, load: Array, work: RunLog) -> Balance | None:
    """Refine the state; the position follows where the refined film pushes otherwise. One factorisation."""
    response = Motion(problem, problem.linearize(state.x), state.closed, state.ties).respond(0.0, work.film_solver)
    closed = Closed(state.x, state.lam, state.closed, state.residual, state.ties, response.factor)
    best: Balance | None = None
    for _ in range(CORRECTIONS):
        answer = from_closed(problem, closed, "balanced with the load")
        if answer is None:
            return best
        left = force_residual(answer, load)
        if best is None or left < best.force_residual:
            best = Balance(answer, left)
        if left <= FORCE_TOLERANCE:
            return best
        force = journal_force(problem, answer.x[problem.positive], answer.lam)
        change, de = made_up(response, force + load)
        problem = problem.at(displacement=problem.displacement + de)
        closed = replace(closed, x=answer.x + change, lam=answer.lam)
    return best


CORRECTIONS = 3
"""Refinements of a balance: the second is for loads that are small beside what pushes on the journal all round."""


def made_up(response: Response, left: Array) -> tuple[Array, Array]:
    """Changes of the unknowns (n,) and of the position (2,) that make up for a force `left` (2,) on the journal."""
    changes, gradient = response.units()
    de = np.asarray(np.linalg.solve(gradient, -left), dtype=np.float64)
    return changes @ de, de
