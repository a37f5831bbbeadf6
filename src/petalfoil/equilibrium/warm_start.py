"""From a known equilibrium to a neighbour: along the tangent, on the contact set that it had."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import finish
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution, from_closed
from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.contact_newton import ActiveOptions, active_set
from petalfoil.solvers.interior_point import InteriorOptions
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

RESTART_BARRIER = 0.3
"""Barrier of a warm interior point: 0.1 to 1 cost 7 to 11 factorisations, smaller ones stall near the old set."""


def predict(known: Solution, problem: CoupledProblem) -> Array:
    """First-order change of the unknowns from `known` to another speed or position (T4), shape (n,); no factorisation.

    Closed gaps stay closed; the tangent is the last one that led to `known`.
    """
    closed = known.closed
    if closed is None:
        return np.zeros_like(known.x)
    moved = problem.gaps(known.x) - known.problem.gaps(known.x)
    follow = closed.ties.close(moved[closed.closed])
    before = known.problem.linearize(known.x)
    force = before.matrix(np.zeros(len(moved))) @ follow + before.by_shift(moved)
    if problem.bearing_number != known.problem.bearing_number:
        faster = known.problem.at(bearing_number=problem.bearing_number)
        force = force + faster.linearize(known.x).residual - before.residual
    change: Array = follow + closed.ties.spread(closed.factor.solve(-closed.ties.gather(force)))
    return change


def follow(
    known: Solution,
    problem: CoupledProblem,
    work: RunLog,
    options: ActiveOptions | None = None,
    change: Array | None = None,
) -> Solution | None:
    """The neighbour of `known` on its own branch: tangent and contact set, nothing else; None if they do not lead.

    `change` is what `predict` foretells, if it is known already; likewise in `restart`.
    """
    start = keep_open(known.x, predict(known, problem) if change is None else change, problem.positive)
    try:
        before = None if known.closed is None else known.closed.factor
        closed, outcome = active_set(
            problem, start, known.in_contact, work.film_solver, options or ActiveOptions(), before
        )
    except SingularMatrixError as failure:
        work.note("contacts", outcome=str(failure))
        return None
    work.note("contacts", outcome=outcome.value)
    return from_closed(problem, closed, "followed from the neighbouring point")


def restart(known: Solution, problem: CoupledProblem, work: RunLog, change: Array | None = None) -> Solution | None:
    """The interior point from `known`, widened; it may find another branch."""
    x = keep_open(known.x, predict(known, problem) if change is None else change, problem.positive)
    s = np.maximum(problem.gaps(x), np.sqrt(RESTART_BARRIER))
    lam = np.maximum(known.lam, RESTART_BARRIER * problem.weight / s)
    try:
        return finish(problem, ConePoint(x, s, lam), "interior point from the neighbouring point", work)
    except SingularMatrixError as failure:
        work.note("film", outcome=str(failure))
        return None


def settle(unstable: Solution, work: RunLog) -> Solution | None:
    """Disturb an unstable equilibrium and march in time to where it goes; None if it comes to no rest."""
    problem = unstable.problem
    x = unstable.x.copy()
    pressures = x[problem.positive]
    x[problem.positive] = pressures * (1.0 + DISTURBANCE * np.random.default_rng(0).standard_normal(len(pressures)))
    s = np.maximum(problem.gaps(x), np.sqrt(RESTART_BARRIER))
    lam = np.maximum(unstable.lam, RESTART_BARRIER * problem.weight / s)
    way = "marched in time from a disturbed unstable equilibrium"
    try:
        return finish(problem, ConePoint(x, s, lam), way, work, InteriorOptions(march=True))
    except SingularMatrixError as failure:
        work.note("film", outcome=str(failure))
        return None


DISTURBANCE = 0.01
"""Relative disturbance of the pressures of an unstable equilibrium."""


def keep_open(x: Array, change: Array, positive: slice) -> Array:
    """Add `change`, shortened so that no pressure falls by more than four fifths."""
    falling = change[positive] < 0.0
    reach = 0.8 * np.min(x[positive][falling] / -change[positive][falling], initial=np.inf)
    return x + min(1.0, float(reach)) * change
