"""Petals with friction on contact lines (3-D), moved a step further along a path (M14), with or without film.

Corrections with one factor go on as long as they contract (`rubbing_line_tangent.py`). Then contacts follow by their
signs, and gaps beside them that have closed between nodes (`line_dips.py`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_signs import closed_beside, corrected_early, met, revised
from petalfoil.equilibrium.rubbing_line_tangent import NoPathError, OnPath, RubbingLineTangent
from petalfoil.equilibrium.rubbing_lines import RubbingLines, matched
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import LinearSolver

Array = NDArray[np.float64]

SETS = 12
"""Most sets of contacts of a step."""

TANGENTS = 12
"""Most factorisations with one set of contacts: two or three are typical."""

CHORD = 0.2
"""What is left after a correction over that before it, up to which the factor at hand serves another one."""

CLOSE = 1e-4
"""What is left below which the factor at hand serves at all: far away points travel to places that another would not
lead to, and contacts at these are other ones."""

PATIENCE = 2
"""Factorisations after which a point at which the gap does not curve upward is two contacts."""


def slide_on_lines(ahead: OnPath, before: RubbingLines, solver: LinearSolver, *, rubs: bool = True) -> OnPath | None:
    """The state of the equations of `ahead`, near it, after that `before`; None if there is none with contact lines.

    Friction forces stay as they are unless it `rubs`.
    """
    state = replace(ahead, lost=0.0)
    try:
        for _ in range(SETS):
            state = settled(state, before, solver, rubs=rubs)
            other = revised(state) or closed_beside(state)
            if other is None:
                return replace(state, lost=lost(state, before)) if rubs else state
            state = carrying(state, other)
        failure = f"contacts still change after {SETS} sets of them"
    except NoPathError as reason:
        failure = str(reason)
    current_run().note("friction", outcome=failure)
    return None


def carrying(then: OnPath, now: LineContacts) -> OnPath:
    """Other contacts with the friction forces of those that were there; none on others."""
    last = matched(now, then)
    return then.on(now, np.where(last >= 0, then.friction_force[:, last], 0.0))


def as_one(state: OnPath) -> OnPath:
    """The state with points that have met as one."""
    one = met(state)
    return state if one is state else carrying(state, one)


def lost(state: RubbingLines, before: RubbingLines) -> float:
    """Energy lost in a step: mean limits times slips, over the units of force and length [1]."""
    last = matched(state, before)
    then = np.where(last >= 0, before.limit[last], 0.0) if len(before.limit) else np.zeros(len(last))
    return float(0.5 * (then + state.limit) @ state.slid(before.x))


def settled(state: OnPath, before: RubbingLines, solver: LinearSolver, *, rubs: bool) -> OnPath:
    """The state with the contacts as they are, apart from those that open or meet.

    Raises
    ------
    NoPathError
        It is not found.
    """
    for count in range(TANGENTS):
        tangent, serves, left = RubbingLineTangent.about(state, solver, rubs=rubs), True, np.inf
        while serves:
            state, whole = tangent.corrected(state, before)
            state = as_one(state)
            if not whole:  # petals that come to touch would close the film before
                state = carrying(state, corrected_early(state, frees=False))
                break
            last, left = left, max(state.left, state.creep(before.x) if rubs else 0.0)
            if not np.isfinite(left):
                raise NoPathError("petals with friction go to infinity")
            if left <= RESIDUAL_TOLERANCE:
                return state
            serves = left <= min(CLOSE, CHORD * last) and tangent.serves(state)
        if count >= PATIENCE and np.any(state.doubled):
            return state
    raise NoPathError(f"petals with friction do not settle: {left:.1e} is left")
