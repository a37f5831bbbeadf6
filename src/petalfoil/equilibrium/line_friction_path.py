"""The pack without film with friction on contact lines (3-D), moved a step further along a path (M14).

Without film, petals are linear in their displacements. What is not are the places of contact points. With `n`, `n'` the
derivatives of gap and slope at a point, and `B` that of the slips, Newton's method has the tangent of small motions
(E12),

    F - n^T lam + B^T T + n'^T (lam / p'') (p' + n' dx) = 0 ,     p + n dx = 0 ,     dphi = -(p' + n' dx) / p''

and Coulomb's law on the slips `B (x - x_0)` since the step began is the dense problem of (M6) and (M11) by units of
one factor: contacts open, stick or slip in each correction. Then contacts follow by their signs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_signs import closed_beside, met, revised, without
from petalfoil.equilibrium.rubbing_lines import RubbingLines, matched
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_space import KnownState, RubbingContacts, UnitResponses
from petalfoil.solvers.coulomb import ContactForces
from petalfoil.solvers.point_constraints import constrain_points
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, no_border
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.sparsity import SparseRows
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState, slipping

Array = NDArray[np.float64]

SETS = 12
"""Most sets of contacts of a step."""

CORRECTIONS = 12
"""Most factorisations with one set of contacts: three are typical."""

PATIENCE = 2
"""Corrections after which a point at which the gap does not curve upward is two contacts."""

TRUST = 0.5
"""Farthest that a point travels in a correction, in cells."""


class NoPathError(ArithmeticError):
    """A step of a path has no state with contact lines near it; it says why."""


def slide_on_lines(
    pack: FoilPackProblem, before: RubbingLines, solver: LinearSolver, *, rubs: bool = True
) -> RubbingLines | None:
    """The state of `pack` after that `before`; None if there is none with contact lines near it.

    Friction forces stay as they are unless it `rubs`.
    """
    state = replace(before, pack=pack, lost=0.0)
    try:
        for _ in range(SETS):
            state = settled(state, before, solver, rubs=rubs)
            other = revised(state) or closed_beside(state)
            if other is None:
                return replace(state, lost=lost(state, before)) if rubs else state
            state = carrying(state, other)
        failure = f"contacts still change after {SETS} sets of them"
    except (NoPathError, SingularMatrixError) as reason:
        failure = str(reason)
    current_run().note("friction", outcome=failure)
    return None


def carrying(then: RubbingLines, now: LineContacts) -> RubbingLines:
    """Other contacts with the friction forces of those that were there; none on others."""
    last = matched(now, then)
    return then.on(now, np.where(last >= 0, then.force[:, last], 0.0))


def as_one(state: RubbingLines) -> RubbingLines:
    """The state with points that have met as one."""
    one = met(state)
    return state if one is state else carrying(state, one)


def lost(state: RubbingLines, before: RubbingLines) -> float:
    """Energy lost in a step: mean limits times slips, over the units of force and length [1]."""
    last = matched(state, before)
    then = np.where(last >= 0, before.limit[last], 0.0) if len(before.limit) else np.zeros(len(last))
    return float(0.5 * (then + state.limit) @ state.slid(before.x))


def settled(state: RubbingLines, before: RubbingLines, solver: LinearSolver, *, rubs: bool) -> RubbingLines:
    """The state with the contacts as they are, apart from those that open.

    Raises
    ------
    NoPathError
        It is not found.
    """
    for count in range(CORRECTIONS):
        state = as_one(corrected(state, before, solver, rubs=rubs))
        left = state.residual
        if not np.isfinite(left):
            raise NoPathError("petals with friction go to infinity")
        if max(left, state.creep(before.x) if rubs else 0.0) <= RESIDUAL_TOLERANCE:
            return state
        if count >= PATIENCE and np.any(state.doubled):
            return state
    raise NoPathError(f"petals with friction do not settle: {left:.1e} is left")


def corrected(state: RubbingLines, before: RubbingLines, solver: LinearSolver, *, rubs: bool) -> RubbingLines:
    """The state after a correction.

    Raises
    ------
    NoPathError
        The contacts do not determine the petals, or none of their states is consistent.
    """
    tangent, moments = tangent_at(state, solver), state.travel_stiffness * state.slopes
    linear = state.pack.linearize(state.x).residual + state.slope_rows.T @ moments
    pulls = np.zeros(len(state.x)) if rubs else state.pulls
    change, reactions = tangent.respond(linear + pulls, state.closed)
    if not rubs:
        return placed(state, state.x + change, reactions, state.force)
    columns = columns_of(state, tangent)
    found = forces_of(state, before, columns, (change, reactions, state.closed + state.gap_rows @ change))
    x = state.x + change + columns.change @ np.concatenate([found.unknown, found.friction])
    force = np.zeros(state.force.size)
    force[columns.rubbing] = found.friction
    moved = placed(state, x, found.reaction(columns.space), force.reshape(2, -1))
    bears, j = found.states.closed, len(state.held_reaction)
    return moved if bears.all() else moved.on(without(moved, ~bears[:j], ~bears[j:]), moved.force[:, bears])


def placed(state: RubbingLines, x: Array, lam: Array, force: Array) -> RubbingLines:
    """The state at unknowns `x` (n,) under reactions and friction forces, its points where slopes vanish."""
    at, j = replace(state, x=x), len(state.held_reaction)
    farthest = TRUST * state.points.cell_length
    way = np.clip(-at.slopes / state.bending, -farthest, farthest)
    return replace(at, points=state.points.moved(way), held_reaction=lam[:j], reaction=lam[j:], force=force)


def tangent_at(state: RubbingLines, solver: LinearSolver) -> BorderedTangent:
    """The factorised pack with all contacts closed, and points that travel.

    Raises
    ------
    NoPathError
        The contacts do not determine the petals.
    """
    pack, turned = state.pack, state.slope_rows
    linearized = pack.linearize(state.x)
    own = linearized.matrix(np.zeros(len(state.held)))
    matrix = sp.csc_array(own + turned.T @ sp.diags_array(state.travel_stiffness) @ turned)
    constraints = constrain_points(constrain(pack.G, state.held), sp.csr_array(state.points.value @ pack.G))
    if not constraints.determinate:
        raise NoPathError("contacts with friction do not determine the petals")
    factor = constraints.factor(matrix, solver, None)
    return BorderedTangent.at(Tangent(matrix, constraints, factor), no_border(len(state.reactions)), linearized)


def columns_of(state: RubbingLines, tangent: BorderedTangent) -> UnitResponses:
    """What units of openings and friction forces do; contacts on the journal slip on no petal."""
    slip, rows, count = state.law.slip, SparseRows(state.gap_rows), len(state.reactions)
    every = RubbingContacts(slip, np.arange(count), state.law.coefficient)
    own = np.flatnonzero(np.diff(slip.indptr)[:count])
    rubbing = replace(every, slip=sp.csr_array(slip[every.every_slip(own)]), gap=own)
    columns = UnitResponses.of(tangent, (rows, rows), np.arange(count), rubbing)
    return replace(columns, rubbing=every.every_slip(own))


def forces_of(
    state: RubbingLines, before: RubbingLines, columns: UnitResponses, base: tuple[Array, Array, Array]
) -> ContactForces:
    """Forces of all contacts after the change of the unknowns that `base` has first; see `UnitResponses.solved`.

    Near those known, and where none are found there, from contacts that all slip.

    Raises
    ------
    NoPathError
        None are found.
    """
    slip, count = state.law.slip, len(state.reactions)
    known = FrictionState(np.zeros(2 * count), state.force.ravel(), np.tile(state.limit, 2))
    slides, since, none = slipping(state.law, known), slip @ (state.x - before.x), np.zeros(count)
    for near in (slides, np.ones_like(slides)):
        last = KnownState(np.ones(count, dtype=np.bool_), near, none, state.reactions, known.force, since)
        found = columns.solved(base, since + slip @ base[0], last)
        if found is not None:
            return found
    raise NoPathError("no contacts, sticking or slipping, carry the friction of a step")
