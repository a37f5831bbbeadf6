"""One implicit stage in time: film, wall, contacts and rotor in one Newton, exact in its contacts.

Every stage of the scheme asks for a state whose rates lead to it from a base: with `rate` one over its implicit part,

    film     net outflow + rate (m - m_base) = 0                         (O2)
    rotor    M rate^2 (e - e_base - v_base / rate) = F + loads           (O3)

and wall and contacts as at rest. One factorisation, with both displacements of the journal bordered, serves as many
corrections, stages and steps as it contracts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.stage_tangent import Tangent, tangent_of
from petalfoil.dynamics.time_state import TimeState
from petalfoil.solvers.cone import scaled_residual
from petalfoil.solvers.contact_newton import ActiveOptions, ContactState, revise, searched
from petalfoil.solvers.interior_point import room
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from petalfoil.system.loaded import FilmForce
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIGNS = ActiveOptions()
"""How far gaps and reactions may miss zero."""

RENEWALS, RENEWALS_RUBBING = 3, 20
"""Tangents with one contact set; where petals stick and slip, the tangent changes with them."""

CYCLING = 2
"""Tangents after which sticking and slipping may come back to where they were: secants take the derivatives' place."""

PATIENCE = 2
"""Times that all gaps of wrong sign change at once before the set is searched for."""


@dataclass(frozen=True)
class StageOptions:
    """Numbers of the method."""

    accuracy: float = 1e-6
    """Correction after which a stage is done [reference films, ambient pressures]."""
    corrections: int = 8
    """Most corrections with one contact set."""
    slow: float = 0.2
    """Contraction past which the tangent is renewed."""
    slow_rubbing: float = 0.6
    """The same with friction, whose limits follow the reactions a correction late."""
    sets: int = 8
    """Most contact sets tried in a stage."""


@dataclass(frozen=True)
class Stage:
    """What a stage asks for.

    Attributes
    ----------
    problem : StepProblem
        Film and wall with the stage's base mass, speed and rate; its displacement does not matter.
    base : TimeState
        Where the rates lead from.
    inertia, gyroscopic : (d, d) array
        `M`, and what turns velocities across [1].
    outside : (2,) array
        Loads at the stage's time over the unit of force [1].
    film : FilmForce
        Force of the film on the journal.
    """

    problem: StepProblem
    base: TimeState
    inertia: Array
    gyroscopic: Array
    outside: Array
    film: FilmForce

    @property
    def rate(self) -> float:
        """One over the implicit part of the step."""
        return self.problem.rate

    def left(self, P: Array, reaction: Array, e: Array) -> Array:
        """Force that is left over for acceleration at `e` (O3), (2,) [1]; `reaction` is the contacts' force."""
        reached = e - self.base.e - self.base.v / self.rate
        turned = self.gyroscopic @ (self.rate * (e - self.base.e))
        force: Array = self.film.at(P) + reaction + self.outside - self.inertia @ (self.rate**2 * reached) - turned
        return force

    def pressed(self, lam: Array) -> Stage:
        """The same stage with friction limited by the reactions `lam` (m,)."""
        rubbing = self.problem.rubbing
        if rubbing is None:
            return self
        normal = replace(rubbing, normal=rubbing.friction.normal(lam))
        return replace(self, problem=replace(self.problem, rubbing=normal))

    def between(self, state: ContactState, x: Array) -> Stage:
        """The same with secants of the friction between a state and the iterate `x` before it."""
        pressed = self.pressed(state.lam)
        rubbing = pressed.problem.rubbing
        if rubbing is None:
            return self
        return replace(pressed, problem=replace(pressed.problem, rubbing=rubbing.between(state.x, x)))

    def rubbed(self, state: ContactState) -> FrictionState | None:
        """Slip and friction at a state."""
        pressed = self.pressed(state.lam).problem.rubbing
        return None if pressed is None else pressed.after(state.x)

    def moving(self, stored: Array, e: Array) -> TimeState:
        """Gas, position and velocity of a state of this stage."""
        return TimeState(stored, e, self.rate * (e - self.base.e))


@dataclass(frozen=True)
class Solved:
    """A stage's answer, and the tangent that found it."""

    x: Array
    lam: Array
    closed: Mask
    moving: TimeState
    residual: float
    tangent: Tangent
    rubbed: FrictionState | None


def solve_stage(
    stage: Stage, start: tuple[Array, Array, Mask], tangent: Tangent | None, solver: LinearSolver, options: StageOptions
) -> Solved | None:
    """Find the stage's state from `start`: unknowns, displacement, closed gaps; None if there is none near it."""
    x, e, closed = start
    doubt = np.zeros(len(closed), dtype=bool)
    for count in range(options.sets):
        found = with_set(stage, (x, e, closed), tangent, solver, options)
        if found is None:
            return None
        state, e, tangent, done = found
        wanted = revise(stage.problem, state, SIGNS)
        if done and np.array_equal(wanted, state.closed):
            stored = stage.problem.at(displacement=e).stored(state.x)
            rubbed = stage.rubbed(state)
            return Solved(state.x, state.lam, state.closed, stage.moving(stored, e), state.residual, tangent, rubbed)
        doubt |= wanted != state.closed
        x, closed = state.x, wanted
        if count >= PATIENCE:
            sought = searched(stage.problem.at(displacement=e), state, doubt, solver)
            if isinstance(sought, ContactState):
                x, closed = sought.x, sought.closed
    return None


def with_set(
    stage: Stage, start: tuple[Array, Array, Mask], tangent: Tangent | None, solver: LinearSolver, options: StageOptions
) -> tuple[ContactState, Array, Tangent, bool] | None:
    """Newton with the contact set given, the tangent renewed where it does not contract; None if that fails.

    Where a step would pierce the film it ends short of that, to have the gaps closed that it ran into.
    """
    x, e, closed = start
    if tangent is not None and not tangent.serves(closed):
        tangent = tangent.exchanged(closed)
    usable = tangent is not None
    for renewal in range(RENEWALS if stage.problem.rubbing is None else RENEWALS_RUBBING):
        if not usable or tangent is None:
            tangent = tangent_of(stage.problem.at(displacement=e), x, closed, solver)
            if tangent is None:
                return None
        once = stage.problem.rubbing is not None and renewal >= CYCLING
        reached = contract(stage, (x, e), tangent, replace(options, corrections=1) if once else options)
        if reached is not None:
            state, e, done = reached
            if done or np.any(state.gaps < -SIGNS.sign):
                return state, e, tangent, done
            stage = stage.between(state, x) if renewal >= CYCLING else stage.pressed(state.lam)
            x = state.x
        elif renewal and not usable:
            return None
        usable = False
    return None


def contract(
    stage: Stage, start: tuple[Array, Array], tangent: Tangent, options: StageOptions
) -> tuple[ContactState, Array, bool] | None:
    """Corrections with one tangent: state, displacement, and whether they are an answer; None if they diverge."""
    (x, e), last, push = start, np.inf, np.zeros(len(tangent.stops))
    slow = options.slow if stage.problem.rubbing is None else options.slow_rubbing
    for _ in range(options.corrections):
        state = evaluate(stage, (x, e), push, tangent)
        if state is None:
            return None
        stage = stage.pressed(state.lam)
        found = eliminated(stage, state, tangent, e)
        if found is None:
            return None
        change, de, push = found
        size, reach = measure(change, de), open_share(stage, (state.x, e), (change, de))
        if size > 2.0 * last:
            return None if stage.problem.rubbing is None else (state, e, False)
        slope = size / last if np.isfinite(last) else options.slow
        x, e = state.x + reach * change, e + reach * de
        done = size * min(1.0, slope / max(1.0 - slope, 0.1)) <= options.accuracy and reach == 1.0
        if done or reach < 1.0 or (np.isfinite(last) and slope > slow):
            break
        last = size
    end = evaluate(stage, (x, e), push, tangent)
    return None if end is None else (end, e, done)


def evaluate(stage: Stage, at: tuple[Array, Array], push: Array, tangent: Tangent) -> ContactState | None:
    """Close the closed gaps exactly and evaluate the equations; None where the film is not open."""
    (x, e), ties, closed = at, tangent.ties, tangent.closed.copy()
    problem = stage.problem.at(displacement=e)
    if np.any(closed):
        x = x + ties.close(problem.gaps(x)[closed])
    if not problem.admits(x) or np.min(x[problem.positive], initial=1.0) <= 0.0 or not np.all(np.isfinite(x)):
        return None
    line = problem.linearize(x)
    lam = np.zeros(len(closed))
    lam[tangent.stops] = push
    back = problem.G.T
    lam[closed] = ties.reactions(line.residual - back @ lam if len(push) else line.residual)
    residual = scaled_residual(line, back @ lam)
    closed[tangent.stops] = push > 0.0
    return ContactState(x, lam, closed, residual, ties, line, problem.gaps(x))


def freely(stage: Stage, residual: Array, tangent: Tangent, at: tuple[Array, Array]) -> tuple[Array, Array, Array]:
    """Film, wall and ties settle against `residual`; the rotor follows the force that is left over, stops apart.

    Parameters
    ----------
    at : (P, e)
        Pressure unknowns and displacement.

    Returns
    -------
    settle, de, stiffness
        Change of the unknowns at a journal that stays (n,), of the displacement (2,), and what resists it (2, 2).
    """
    (P, e), (settle, lam) = at, tangent.settle(residual)
    reaction = stage.problem.layout.wall.contacts.by_e.T @ lam
    left = stage.left(P + settle[stage.problem.positive], reaction, e)
    stiffness: Array = stage.inertia * stage.rate**2 + stage.gyroscopic * stage.rate - tangent.gradient
    return settle, np.asarray(np.linalg.solve(stiffness, left), dtype=np.float64), stiffness


def eliminated(stage: Stage, state: ContactState, tangent: Tangent, e: Array) -> tuple[Array, Array, Array] | None:
    """Change of the unknowns (n,), of the displacement (2,), and reactions of the stops (k,); None if they contradict.

    Stops hold the journal alone, whatever film and wall do: a complementarity problem of their own.
    """
    settle, de, stiffness = freely(stage, state.line.residual, tangent, (state.x[stage.problem.positive], e))
    if not len(tangent.stops):
        return settle + tangent.units @ de, de, np.zeros(0)
    arm = stage.problem.layout.wall.contacts.by_e[tangent.stops] + stage.problem.G[tangent.stops] @ tangent.units
    give = np.linalg.solve(stiffness, arm.T)
    push = solve_lcp(arm @ give, state.gaps[tangent.stops] + arm @ de, np.zeros(len(arm), dtype=bool))
    if push is None:
        return None
    de = de + give @ push
    return settle + tangent.units @ de, de, push


def measure(change: Array, de: Array) -> float:
    """Size of a correction: displacement and deflections in reference films, pressures in ambient ones."""
    return float(max(np.max(np.abs(change), initial=0.0), np.max(np.abs(de))))


def open_share(stage: Stage, at: tuple[Array, Array], step: tuple[Array, Array]) -> float:
    """Share of a step of unknowns and displacement that leaves pressures and film positive, at most 1."""
    (x, e), (change, de), problem = at, step, stage.problem
    pressure = room(x[problem.positive], change[problem.positive])
    film = problem.at(displacement=e).film(x)
    ahead = problem.at(displacement=e + de).film(x + change)
    return float(min(1.0, 0.8 * pressure, 0.95 * room(film, ahead - film)))
