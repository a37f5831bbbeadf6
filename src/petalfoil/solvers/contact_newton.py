"""Newton's method on active contacts, which it corrects as it goes: exact zeros, exact reactions, cheap warm starts.

The active contacts are held closed and eliminated, so that Newton's method sees smooth equations. A contact whose
reaction pulls is released, a gap that has gone negative is closed. Near a solution this takes a few steps. Far from it
the set advances by a node a step and may cycle: after a few changes it is searched for among the gaps in doubt
(`contact_search`).

One loop serves every variant; what differs is a `ContactEquations` (`contact_equations`).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints, constrain
from petalfoil.solvers.contact_equations import (
    ContactEquations,
    ContactFailure,
    ContactOptions,
    ContactOutcome,
    ContactState,
    Correction,
    Step,
    StepVerdict,
    evaluate,
    revise,
)
from petalfoil.solvers.contact_search import search
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, ContactProblem
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class ActiveContacts:
    """A solution: unknowns, reactions and active contacts, with the last tangent for refinement and predictions."""

    state: ContactState
    tangent: BorderedTangent = field(repr=False)

    @property
    def x(self) -> Array:
        """Unknowns, (n,)."""
        return self.state.x

    @property
    def lam(self) -> Array:
        """Reactions, (m,), zero on open gaps."""
        return self.state.lam

    @property
    def active(self) -> Mask:
        """Active contacts, (m,)."""
        return self.state.active

    @property
    def constraints(self) -> ContactConstraints:
        """The same as constraints."""
        return self.state.constraints


AnyEquations = TypeVar("AnyEquations", bound=ContactEquations)
Start = tuple[Array, Array, Mask]
"""Unknowns (n,), bordered unknowns (d,), active contacts (m,)."""


def contact_newton(
    equations: ContactEquations,
    start: Start,
    solver: LinearSolver,
    options: ContactOptions,
    tangent: BorderedTangent | None = None,
) -> tuple[ActiveContacts | None, ContactOutcome]:
    """Solve `equations` from `start`, correcting the active contacts, until residual and signs agree.

    `tangent`, that of a neighbour, serves the first steps if it fits the contacts.
    """
    try:
        return iterate(equations, start, solver, options, tangent), ContactOutcome.CONVERGED
    except ContactFailure as failure:
        return None, failure.outcome


def solve_contacts(
    problem: ContactProblem,
    start: tuple[Array, Mask],
    solver: LinearSolver,
    options: ContactOptions | None = None,
    tangent: BorderedTangent | None = None,
) -> tuple[ActiveContacts | None, ContactOutcome]:
    """`contact_newton` of a problem as it is, from unknowns (n,) and active contacts (m,)."""
    x, active = start
    return contact_newton(
        ContactEquations(problem), (x, np.zeros(0), active), solver, options or ContactOptions(), tangent
    )


def iterate(
    equations: ContactEquations,
    start: Start,
    solver: LinearSolver,
    options: ContactOptions,
    tangent: BorderedTangent | None,
) -> ActiveContacts:
    """`contact_newton` that raises `ContactFailure` where it finds no solution."""
    tangent = fitting(equations, tangent, start)
    state = evaluate(equations, start[:2], options, constraints_of(equations, start, tangent))
    before, doubt, changes, count = state, np.zeros(len(state.active), dtype=bool), 0, 0
    for _ in range(options.tangents + (tangent is not None)):
        # A tangent: a borrowed one as long as it serves, else a factorisation.
        borrowed = tangent is not None
        if tangent is None:
            renewed = equations.renewed(state, before, count)
            if renewed is not equations:
                equations, state = renewed, evaluate(renewed, (state.x, state.b), options, state.constraints)
            entry = start[:2] if options.tangent_at_entry and not count else (state.x, state.b)
            tangent = factorise(equations, state, entry, solver)

        # Newton steps with it, as long as they contract.
        before = state
        try:
            equations, state, tangent, converged = steps_with(equations, state, tangent, options)
        except ContactFailure:
            if not (borrowed and options.borrow):
                raise
            tangent, count = None, count + 1
            continue

        # Contacts of wrong sign: an active one that pulls, a gap below zero.
        wanted = state.active
        if options.revise_early or converged or np.any(state.gaps < -RESIDUAL_TOLERANCE):
            wanted = revise(equations.problem, state)

        # The same contacts: a solution, or another tangent.
        if np.array_equal(wanted, state.active):
            if converged and (options.borrow or not borrowed):
                return ActiveContacts(state, tangent)
            tangent, count = None, count + 1
            if count == options.tangents_per_set:
                break
            continue

        # Other contacts: all change at once; a set that keeps changing is searched for.
        doubt, changes, count = doubt | (wanted != state.active), changes + 1, 0
        found = search(equations.at(state.b), state, doubt, solver) if changes > options.patience else None
        x, active = found or (state.x, wanted)
        start = x, state.b, active
        tangent = fitting(equations, tangent if options.borrow else None, start)
        state = before = evaluate(equations, start[:2], options, constraints_of(equations, start, tangent))
    raise ContactFailure(ContactOutcome.STEPS)


def steps_with(
    equations: AnyEquations, state: ContactState, tangent: BorderedTangent, options: ContactOptions
) -> tuple[AnyEquations, ContactState, BorderedTangent, bool]:
    """Newton steps with one tangent; what they reach, the tangent, and whether the state solves the equations.

    Near the solution the tangent hardly changes, so that a step costs a solve instead of a factorisation.
    """
    last = np.inf
    for number in range(options.steps):
        equations = equations.lagged(state)
        correction = corrected(equations, state, tangent)
        if number:
            tangent = tangent.seen(correction.size, state.residual)
        length = equations.step_length(state, correction)
        ahead = state.x + length * correction.x, state.b + length * correction.b
        after: ContactState | None = None
        failure = ContactOutcome.DIVERGED
        try:
            after = evaluate(equations, ahead, options, state.constraints, correction.stops)
        except ContactFailure as failed:
            failure = failed.outcome
        step = Step(number, state, after, length, correction.size, last, tangent.response)
        verdict = equations.verdict(step, options)
        if verdict is StepVerdict.FAIL:
            raise ContactFailure(failure)
        if verdict is StepVerdict.REJECT or after is None:
            break
        state, last = after, correction.size
        if verdict is not StepVerdict.GO_ON:
            return equations, state, tangent, verdict is StepVerdict.CONVERGED
    return equations, state, tangent, False


def corrected(equations: ContactEquations, state: ContactState, tangent: BorderedTangent) -> Correction:
    """Newton's correction of unknowns and bordered unknowns.

    Stops resist the bordered unknowns, whatever the others do: a small complementarity problem. The other unknowns move
    by their pushes only where they rub.
    """
    residual = state.linearized.residual
    if not equations.border.size:
        return Correction(tangent.tangent.step(residual), np.zeros(0), np.zeros(0))
    settled, db, stiffness = border_change(equations, residual, (state.x, state.b), tangent)
    stops, pushes = tangent.constraints.stops, np.zeros(0)
    if len(stops):
        arms = tangent.border.gap_derivative[stops] + equations.problem.G[stops] @ tangent.units
        dragged, pulls = (None, arms.T) if tangent.constraints.acting is None else stop_pushes(equations, tangent)
        give = np.linalg.solve(stiffness, pulls)
        found = solve_lcp(arms @ give, state.gaps[stops] + arms @ db, np.zeros(len(arms), dtype=bool))
        if found is None:
            raise ContactFailure(ContactOutcome.OVERDETERMINED)
        db, pushes = db + give @ found, found
        settled = settled if dragged is None else settled + dragged @ found
    return Correction(settled + tangent.units @ db, db, pushes)


def stop_pushes(equations: ContactEquations, tangent: BorderedTangent) -> tuple[Array, Array]:
    """Change of the unknowns (n, j) and force on the bordered unknowns (d, j) by a unit push of each stop that rubs."""
    stops, border = tangent.constraints.stops, tangent.border
    pushed = [tangent.respond(-row) for row in equations.problem.acting[stops].toarray()]
    forces = border.by_reactions[:, stops] + np.column_stack([border.rows(*one) for one in pushed])
    return np.column_stack([change for change, _ in pushed]), forces


def border_change(
    equations: ContactEquations, residual: Array, at: tuple[Array, Array], tangent: BorderedTangent
) -> tuple[Array, Array, Array]:
    """Block elimination, stops apart, at unknowns and bordered unknowns `at`.

    Returns
    -------
    settled, db, stiffness
        Change of the unknowns at fixed bordered unknowns (n,), change of these (d,), and what resists it (d, d).
    """
    (x, b), (settled, lam) = at, tangent.respond(residual)
    stiffness = equations.border_stiffness - tangent.gradient
    db = np.linalg.solve(stiffness, equations.imbalance(x + settled, lam, b))
    return settled, np.asarray(db, dtype=np.float64), stiffness


def factorise(
    equations: ContactEquations, state: ContactState, at: tuple[Array, Array], solver: LinearSolver
) -> BorderedTangent:
    """The tangent on the contacts of `state`, there or at other unknowns and bordered unknowns."""
    linearized = state.linearized if at[0] is state.x else equations.at(at[1]).linearize(at[0])
    matrix, border = linearized.matrix(np.zeros(len(state.lam))), equations.border
    try:
        factor = state.constraints.factor(matrix, solver, equations.problem.elimination_key)
    except SingularMatrixError:
        raise ContactFailure(ContactOutcome.SINGULAR) from None
    return BorderedTangent.at(Tangent(matrix, state.constraints, factor), border, linearized)


def fitting(equations: ContactEquations, tangent: BorderedTangent | None, start: Start) -> BorderedTangent | None:
    """The tangent, if it serves the contacts of `start`, as it is or after an exchange of a few."""
    if tangent is None:
        return None
    G, acting = equations.problem.G, equations.problem.acting
    if (tangent.constraints.acting is None) is not (acting is G):  # a shaft at rest and one that turns
        return None
    return tangent if tangent.serves(start[2]) else tangent.exchanged((G, acting), start[2])


def constraints_of(equations: ContactEquations, start: Start, tangent: BorderedTangent | None) -> ContactConstraints:
    """The contacts of `start` as constraints; those of a tangent that fits them."""
    if tangent is not None:
        return tangent.constraints
    return constrain(equations.problem.G, start[2], equations.stops, equations.problem.acting)
