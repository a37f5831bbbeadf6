"""Newton on a set of closed gaps, which it corrects as it goes: exact zeros, exact reactions, cheap warm starts.

A closed gap whose reaction pulls is opened, an open gap that has gone negative is closed. Near an answer this needs
a few steps; far from it the set advances a node a step and may cycle, so after a few changes the set is searched for
among the gaps in doubt (`set_search`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.cone import ConeProblem, Linearized
from petalfoil.solvers.constraints import Ties, tie
from petalfoil.solvers.contact_search import most_doubts, near, search
from petalfoil.solvers.sparse_lu import Factor, LinearSolver, SingularMatrixError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


class Outcome(Enum):
    """How an attempt ended."""

    CONVERGED = "converged"
    STEPS = "the steps ran out"
    OVERDETERMINED = "closed gaps hold a chain at both ends"
    PENETRATED = "a gap went far below zero"
    SINGULAR = "the reduced system has no solution"


@dataclass(frozen=True)
class ActiveOptions:
    """Numbers of the method."""

    tolerance: float = 1e-8
    """Largest scaled residual of an answer."""
    sign: float = 1e-8
    """Gaps and reactions (over their weight) that miss zero by less are zero."""
    max_steps: int = 12
    patience: int = 1
    """Times that all gaps of wrong sign are swapped at once before the set is searched for."""
    chords: int = 4
    """Most steps that one factorisation may serve beyond its own."""
    near: float = 1e-2
    """Residual below which the same factorisation is tried again."""
    gain: float = 0.1
    """Factor that such a step must take off the residual."""
    boundary_x: float = 0.8
    """Fraction of the way to zero for unknowns that must stay positive."""


@dataclass(frozen=True)
class Closed:
    """An answer: unknowns, reactions and closed gaps, with the last factorised tangent for predictions.

    Attributes
    ----------
    x : (n,) array
        Unknowns.
    lam : (m,) array
        Reactions, zero on open gaps.
    closed : (m,) bool array
        Gaps that are closed.
    residual : float
        Largest scaled residual.
    ties, factor
        Closed gaps as ties, and the reduced tangent near the answer.
    line
        The equations at the answer.
    """

    x: Array
    lam: Array
    closed: Mask
    residual: float
    ties: Ties = field(repr=False)
    factor: Factor = field(repr=False)
    line: Linearized | None = field(default=None, repr=False)


def active_set(
    problem: ConeProblem,
    x: Array,
    closed: Mask,
    solver: LinearSolver,
    options: ActiveOptions,
    before: Factor | None = None,
) -> tuple[Closed | None, Outcome]:
    """Newton from `x` with the gaps `closed`, correcting the set, until residual and signs agree.

    `before`, the tangent of a neighbour with the same set, serves the first step: it shows where the set is wrong.
    """
    factor: Factor | None = None
    doubt, swaps = np.zeros(len(closed), dtype=bool), 0
    state = evaluate(problem, x, closed)
    if before is not None and not isinstance(state, Outcome):
        state = evaluate(problem, newton_step(problem, state, before, options), closed, state.ties)
    for step in range(options.max_steps + 1):
        if isinstance(state, Outcome):
            return None, state
        wanted = revise(problem, state, options) if step or before is not None else state.closed
        unchanged = bool(np.array_equal(wanted, state.closed))
        done = unchanged and state.residual <= options.tolerance and settled(problem, state, options)
        if done and factor is not None:  # without a tangent, one more step: refinement and prediction need it
            known = (state.x, state.lam, state.closed, state.residual, state.ties, factor, state.line)
            return Closed(*known), Outcome.CONVERGED
        if step == options.max_steps:
            break
        doubt, swaps = doubt | (wanted != state.closed), swaps + (not unchanged)
        found = searched(problem, state, doubt, solver) if swaps > options.patience and not unchanged else None
        if found is not None:
            state, factor = found, None
            continue
        if not unchanged:
            state = evaluate(problem, state.x, wanted)
            if isinstance(state, Outcome):
                return None, state
        try:
            matrix = state.ties.reduce(state.line.matrix(np.zeros(len(wanted))))
            factor = solver.factor(matrix, state.ties.rank(problem.rank))
        except SingularMatrixError:
            return None, Outcome.SINGULAR
        state = evaluate(problem, newton_step(problem, state, factor, options), wanted, state.ties)
        state = with_the_same_factor(problem, state, factor, options)
    return None, Outcome.STEPS


def with_the_same_factor(
    problem: ConeProblem, state: ContactState | Outcome, factor: Factor, options: ActiveOptions
) -> ContactState | Outcome:
    """Further steps with the factor at hand, as long as the set is right and each gains a digit.

    Near the answer the tangent hardly changes: a step costs a solve, a fiftieth of another factorisation.
    """
    for _ in range(options.chords):
        if isinstance(state, Outcome) or state.residual <= options.tolerance or state.residual > options.near:
            break
        if not settled(problem, state, options):
            break
        ahead = evaluate(problem, newton_step(problem, state, factor, options), state.closed, state.ties)
        if isinstance(ahead, Outcome) or ahead.residual > options.gain * state.residual:
            break
        state = ahead
    return state


def searched(
    problem: ConeProblem, state: ContactState, doubt: Mask, solver: LinearSolver
) -> ContactState | Outcome | None:
    """The state after a step that looks for the set among the gaps in doubt and their neighbours; None if none fits."""
    matrix = state.line.matrix(np.zeros(len(doubt)))
    wide = near(problem, doubt, matrix)
    if np.count_nonzero(wide) > most_doubts(problem):
        wide = doubt
    found = search(problem, (state.x, state.gaps, state.closed, state.line), wide, solver)
    return None if found is None else evaluate(problem, *found)


@dataclass(frozen=True)
class ContactState:
    """An iterate that closes its closed gaps exactly."""

    x: Array
    lam: Array
    closed: Mask
    residual: float
    ties: Ties
    line: Linearized
    gaps: Array


DEEP = -0.5
"""A gap this far below zero (in units of the reference film) is no small correction any more."""


def evaluate(problem: ConeProblem, x: Array, closed: Mask, ties: Ties | None = None) -> ContactState | Outcome:
    """Close the gaps `closed` exactly, and find residual and reactions there; `ties` are theirs, if known."""
    ties = ties or tie(problem.G, closed)
    if not ties.determinate:
        return Outcome.OVERDETERMINED
    x = x + ties.close(problem.gaps(x)[closed])
    gaps = problem.gaps(x)
    kept = x[problem.positive]
    if np.min(gaps, initial=0.0) < DEEP or np.min(kept, initial=1.0) <= 0.0 or not np.all(np.isfinite(x)):
        return Outcome.PENETRATED
    if not problem.admits(x):
        return Outcome.PENETRATED
    line = problem.linearize(x)
    lam = np.zeros(len(closed))
    lam[closed] = ties.reactions(line.residual)
    residual = float(np.max(np.abs(line.residual - problem.G.T @ lam) / line.size, initial=0.0))
    return ContactState(x, lam, closed, residual, ties, line, gaps)


def revise(problem: ConeProblem, state: ContactState, options: ActiveOptions) -> Mask:
    """Keep closed what pushes, close what has gone negative."""
    below: Mask = state.gaps < -options.sign
    if not state.closed.any():
        return below
    noise = np.maximum(problem.weight, abs(problem.G) @ state.line.size)  # rows that lose digits blur reactions too
    pushing = state.lam > -options.sign * noise
    return np.where(state.closed, pushing, below)


def settled(problem: ConeProblem, state: ContactState, options: ActiveOptions) -> bool:
    """Signs of gaps and reactions are those of an answer."""
    return bool(np.array_equal(revise(problem, state, options), state.closed))


def newton_step(problem: ConeProblem, state: ContactState, factor: Factor, options: ActiveOptions) -> Array:
    """The next iterate, damped where unknowns must stay positive."""
    step = state.ties.spread(factor.solve(-state.ties.gather(state.line.residual)))
    kept = problem.positive
    value, change = state.x[kept], step[kept]
    falling = change < 0.0
    reach = options.boundary_x * np.min(value[falling] / -change[falling], initial=np.inf)
    return state.x + min(1.0, float(reach)) * step
