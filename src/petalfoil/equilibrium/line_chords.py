"""Newton steps along contact lines with one factor: that of the state, or of one before it with a few other contacts.

A step with the factor at hand costs a solve. Those after the first are bettered by what they have shown (C15).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import TRUST, LineContacts, NoLinesError, changed, step_of
from petalfoil.equilibrium.line_tangent import LineChange, LineTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.secants import Secants
from petalfoil.solvers.sparse_lu import SingularMatrixError

Array = NDArray[np.float64]

CHORDS = 12
"""Most steps with one factor: a step costs a tenth to a twentieth of another."""

GAIN = 0.5
"""Residual after a step over the least so far, up to which the factor at hand serves well."""

PLAIN_GAIN = 0.3
"""The same of steps without secants, none of which leaves more."""

PATIENCE = 2
"""Steps in turn that may leave more: with none, four of six starts from coarse grids take more tangents."""

ASTRAY = 10.0
"""Residual over the least so far at which a factor leads astray."""

POLISHED = 0.1
"""Residual over that of a solution below which another step changes no printed digit: forces stay within 1e-10."""


def by_tangent(state: LineContacts, *, plain: bool = False) -> LineContacts:
    """The state after a step with its own tangent, and further ones as long as they gain; one factorisation.

    Steps are bettered by secants, or `plain` ones that all gain.

    Raises
    ------
    NoLinesError
        The film has closed, or the contacts do not determine the petals.
    """
    if not state.contacts.constraints.determinate:
        raise NoLinesError("contacts repeat each other")
    try:
        tangent = LineTangent.of(state, state.motion.growing(0.0, current_run().film_solver))
    except SingularMatrixError:
        raise NoLinesError("the contacts do not determine the petals") from None
    secants = Secants()
    after = stepped(state, tangent, secants)
    after = plain_chords(after, tangent) if plain else chords(after, tangent, secants)
    current_run().note("contact lines", left=after.residual)
    return after


def by_chords(state: LineContacts) -> LineContacts:
    """The state after steps with the factor that led to it, as long as they gain; no factorisation.

    The state itself where that factor does not serve its contacts or leads nowhere: it is one of others.
    """
    tangent = None if state.tangent is None else state.tangent.on(state)
    return state if tangent is None else chords(state, tangent, Secants())


def chords(state: LineContacts, tangent: LineTangent, secants: Secants) -> LineContacts:
    """The state of least residual after further steps with a tangent that serves its contacts.

    Some may leave more than the one before: where points travel the first one does so, and secants learn from it.
    """
    best, poor = state, 0
    for _ in range(CHORDS):
        if best.balanced and best.residual <= POLISHED * RESIDUAL_TOLERANCE:
            break
        try:
            ahead = stepped(state, tangent, secants)
        except NoLinesError:  # with a factor of its own it need not close
            break
        poor = poor + 1 if ahead.residual > GAIN * best.residual else 0
        if ahead.residual < best.residual:
            best = ahead
        if poor > PATIENCE or ahead.residual > ASTRAY * best.residual:
            break
        state = ahead
    return best


def plain_chords(state: LineContacts, tangent: LineTangent) -> LineContacts:
    """The state after further steps with a tangent of its own, as long as each takes `PLAIN_GAIN` off the residual."""
    for _ in range(CHORDS):
        if state.balanced:
            break
        ahead = stepped(state, tangent, Secants())
        if not ahead.residual <= PLAIN_GAIN * state.residual:
            break
        state = ahead
    return state


def stepped(state: LineContacts, tangent: LineTangent, secants: Secants) -> LineContacts:
    """The state after a step with a tangent, bettered by those before it (C15).

    Raises
    ------
    NoLinesError
        The film has closed, or the step is no number.
    """
    asked, cell = step_of(state, tangent), state.points.mean_cell
    parts = asked.x, asked.reaction, asked.displacement, asked.phi / cell
    ends = np.cumsum([len(part) for part in parts])[:-1]
    x, reaction, move, cells = np.split(secants.bettered(all_unknowns(state), np.concatenate(parts)), ends)
    return changed(state, tangent, LineChange(x, reaction, move, cell * cells), TRUST)


def all_unknowns(state: LineContacts) -> Array:
    """Unknowns, reactions at nodes and points, position, and angles in cells, (n + j + k + n_position + k,) [1]."""
    points = state.points
    reactions = state.held_reaction, state.reaction
    return np.concatenate([state.x, *reactions, state.problem.displacement, points.phi / points.mean_cell])
