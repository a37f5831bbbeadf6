"""Which contacts there are on contact lines: corrected by the signs of reactions, gaps and curvatures.

A reaction that pulls leaves. Of gaps that have closed side by side the lowest gains a point, which often opens the
others. A point at which the gap does not curve upward becomes contacts at the two nodes beside it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE

Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

PENETRATION = 1e-4
"""A gap this far below zero gains a contact, in units of the reference film (1 nm)."""


def parted(state: LineContacts) -> LineContacts:
    """With the nodes beside each point at which the gap does not curve upward in its place."""
    held = state.held.copy()
    held[state.points.beside[state.doubled].ravel()] = True
    shared = state.points.shares.T @ np.where(state.doubled, state.reaction, 0.0)
    shared[state.held] += state.held_reaction
    points, reaction = state.points.kept(~state.doubled), state.reaction[~state.doubled]
    return replace(state, points=points, reaction=reaction, held=held, held_reaction=shared[held])


def revised(state: LineContacts) -> LineContacts | None:
    """Other contacts, where the signs ask for them; None where they are right.

    Reactions that pull leave. A point at which the gap does not curve upward is two contacts within a cell, at the
    nodes beside it. Of nodes whose gaps are below zero the lowest of each run gains a point, unless there is one beside
    it: all of them would be more contacts than the petal has freedom to meet.
    """
    if np.any(state.doubled):
        return parted(state)
    bears = state.held_reaction > -RESIDUAL_TOLERANCE * state.problem.weight[state.held]
    pushes = state.reaction > -RESIDUAL_TOLERANCE
    fresh = lowest_of_runs(state, (state.gaps < -PENETRATION) & ~covered(state))
    if bears.all() and pushes.all() and not len(fresh):
        return None
    held = state.held.copy()
    held[np.flatnonzero(held)] = bears
    points = state.points.kept(pushes).with_nodes(fresh)
    reaction = np.concatenate([state.reaction[pushes], np.zeros(len(fresh))])
    return replace(state, points=points, reaction=reaction, held=held, held_reaction=state.held_reaction[bears])


def covered(state: LineContacts) -> Mask:
    """Nodes that are contacts, or have a contact point in a cell beside them, (m,)."""
    out = state.held.copy()
    out[state.points.beside.ravel()] = True
    return out


def lowest_of_runs(state: LineContacts, below: Mask) -> Index:
    """Numbers of the lowest gaps of the runs of gaps `below` (m,) on their lines."""
    lowest = np.zeros(len(below), dtype=np.bool_)
    for lines in state.points.lines:
        gaps = np.where(below[lines.number], state.gaps[lines.number], np.inf)
        beside = np.pad(gaps, ((0, 0), (1, 1)), constant_values=np.inf)
        lowest[lines.number] = np.isfinite(gaps) & (gaps <= beside[:, :-2]) & (gaps < beside[:, 2:])
    return np.flatnonzero(lowest)
