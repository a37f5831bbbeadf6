"""Which contacts there are on contact lines: corrected by the signs of reactions, gaps and curvatures.

A reaction that pulls leaves. Of gaps that have closed side by side the lowest gains a point, which often opens the
others. A point at which the gap does not curve upward becomes contacts at the two nodes beside it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts, StateOnLines
from petalfoil.equilibrium.line_dips import PENETRATION
from petalfoil.physics.contact_points import MARGIN, POINT_NODES
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

MEETING = 0.03
"""Points this near to each other on a line become one, in cells."""

EARLY_PENETRATION = 1e-3
"""The same of a state that has not converged (10 nm)."""

EARLY_PULL = 1e-6
"""A reaction this far below zero leaves such a state, in ambient pressure on a node."""


def met(state: StateOnLines) -> StateOnLines:
    """The state with points that have met on their lines as one, at the centroid of their reactions."""
    points = state.points
    order = np.lexsort((points.phi, points.line, points.kind))
    here, ahead = order[:-1], order[1:]
    on_one = (points.kind[here] == points.kind[ahead]) & (points.line[here] == points.line[ahead])
    near = on_one & (points.phi[ahead] - points.phi[here] < MEETING * points.cell_length[here])
    if not near.any():
        return state
    phi, reaction, left = points.phi.copy(), state.reaction.copy(), np.ones(len(order), dtype=np.bool_)
    for a, b in zip(here[near], ahead[near], strict=True):
        both = reaction[a] + reaction[b]
        share = float(np.clip(reaction[b] / both, 0.0, 1.0)) if both > 0.0 else 0.5
        phi[b], reaction[b], left[a] = phi[a] + share * (phi[b] - phi[a]), both, False
    return replace(state, points=replace(points, phi=phi).kept(left), reaction=reaction[left])


def parted(state: StateOnLines) -> StateOnLines:
    """With the nodes beside each point at which the gap does not curve upward in its place."""
    held = state.held.copy()
    held[state.points.beside[state.doubled].ravel()] = True
    shared = state.points.shares.T @ np.where(state.doubled, state.reaction, 0.0)
    shared[state.held] += state.held_reaction
    points, reaction = state.points.kept(~state.doubled), state.reaction[~state.doubled]
    return replace(state, points=points, reaction=reaction, held=held, held_reaction=shared[held])


def revised(state: StateOnLines, pull: float = RESIDUAL_TOLERANCE, known: Mask | None = None) -> StateOnLines | None:
    """Other contacts, where the signs ask for them; None where they are right.

    Reactions that pull leave. A point at which the gap does not curve upward is two contacts within a cell, at the
    nodes beside it. Of nodes whose gaps are below zero the lowest of each run gains a point, unless there is one beside
    it: all of them would be more contacts than the petal has freedom to meet. A gap that is below zero between nodes
    alone gains one where it is least, but beside the nodes `known` (m,). Reactions that pull by no more than `pull`, in
    ambient pressure on a node, are rounding.
    """
    if np.any(state.doubled):
        return parted(state)
    bears = state.held_reaction > -pull * state.problem.weight[state.held]
    pushes = state.reaction > -pull
    below = (state.gaps < -PENETRATION) & ~covered(state)
    fresh, between = lowest_of_runs(state, below), dips(state, np.flatnonzero(below), known)
    if bears.all() and pushes.all() and not len(fresh) and not len(between.phi):
        return None
    return gaining_points(gaining(without(state, ~bears, ~pushes), fresh), between)


def corrected_early(state: StateOnLines, *, frees: bool) -> StateOnLines:
    """Other contacts before Newton's method has converged, where the signs ask for them; the state itself where not.

    As long as it `frees` contacts, single nodes become points, and points at which the gap does not curve upward may
    still travel to where it does.
    """
    if not frees and np.any(state.doubled):
        state = parted(state)
    nodes, points = state.held_reaction < -EARLY_PULL, state.reaction < -EARLY_PULL
    fresh = lowest_of_runs(state, (state.gaps < -EARLY_PENETRATION) & ~covered(state))
    if not (nodes.any() or points.any() or len(fresh)):
        return state
    left = without(state, nodes, points)
    return gaining(freed(left) if frees else left, fresh)


def gaining(state: StateOnLines, fresh: Index) -> StateOnLines:
    """The state with contacts at the nodes of some gaps: points, but at the ends of lines, where nothing travels."""
    ends = np.concatenate([lines.number[:, [0, -1]].ravel() for lines in state.points.lines])
    at_ends = np.isin(fresh, ends)
    held, carried = state.held.copy(), np.zeros(len(state.held))
    carried[held] = state.held_reaction
    held[fresh[at_ends]] = True
    reaction = np.concatenate([state.reaction, np.zeros(np.count_nonzero(~at_ends))])
    points = state.points.with_nodes(fresh[~at_ends])
    return replace(state, points=points, reaction=reaction, held=held, held_reaction=carried[held])


def bearing_alone(state: StateOnLines) -> StateOnLines:
    """The state without contacts whose reactions are below zero, foretold ones: they would leave a tangent later."""
    pulls, also = state.held_reaction < 0.0, state.reaction < 0.0
    return without(state, pulls, also) if pulls.any() or also.any() else state


def without(state: StateOnLines, nodes: Mask, points: Mask) -> StateOnLines:
    """The state without some of its contacts, `nodes` (j,) and `points` (k,)."""
    held = state.held.copy()
    held[np.flatnonzero(held)] = ~nodes
    return replace(
        state,
        points=state.points.kept(~points),
        reaction=state.reaction[~points],
        held=held,
        held_reaction=state.held_reaction[~nodes],
    )


def freed(state: StateOnLines) -> StateOnLines:
    """With points in place of contacts at single nodes away from the ends of their lines: they are free to travel."""
    alone = state.single_nodes
    return with_points_at(state, alone, reactions_at_nodes(state), alone)


def freed_near_ends(state: StateOnLines) -> StateOnLines:
    """With points in place of short runs of nodes beside the ends of their lines, where a petal lies near a root.

    Curvatures of the nodal gap cannot be read there on both sides, so that (K8) does not place these points: they begin
    at the node with the larger reaction, and Newton's method moves them.
    """
    carried = reactions_at_nodes(state)
    runs, begins, pushes = np.zeros_like(state.held), np.zeros_like(state.held), carried.copy()
    for lines in state.points.lines:
        last = len(lines.phi) - 1
        for end, ahead in ((0, 1), (last, -1)) if last + 1 >= 2 * (MARGIN + POINT_NODES) else ():
            at = lines.number[:, [end + k * ahead for k in range(MARGIN + POINT_NODES)]]
            held = state.held[at]
            pairs = at[held[:, 1] & ~held[:, 0] & ~(held[:, 2] & held[:, 3]), 1:3]
            runs[pairs[state.held[pairs]]] = True
            heavier = pairs[np.arange(len(pairs)), np.argmax(carried[pairs], axis=1)]
            begins[heavier], pushes[heavier] = True, carried[pairs].sum(axis=1)
    return with_points_at(state, begins, pushes, runs)


def reactions_at_nodes(state: LineContacts) -> Array:
    """Reactions of the contacts at nodes, (m,)."""
    out = np.zeros(len(state.held))
    out[state.held] = state.held_reaction
    return out


def with_points_at(state: StateOnLines, begins: Mask, reaction: Array, runs: Mask) -> StateOnLines:
    """The state with points at the nodes `begins` in place of contacts at the nodes `runs`; reactions at all (m,)."""
    if not begins.any():
        return state
    left = without(state, runs[state.held], np.zeros(len(state.reaction), dtype=np.bool_))
    points = left.points.with_nodes(np.flatnonzero(begins))
    fresh = reaction[points.nearest[len(left.reaction) :]]
    return replace(left, points=points, reaction=np.concatenate([left.reaction, fresh]))


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


def dips(state: LineContacts, below: Index, known: Mask | None = None) -> LinePoints:
    """Points where gaps are below zero between nodes alone, away from contacts and from nodes `below` zero.

    Those beside nodes `known` (m,) are not looked for.
    """
    taken = covered(state) if known is None else covered(state) | known
    taken[below] = True
    there = state.closed_between_nodes
    return there.kept(~np.any(taken[there.beside], axis=1))


def closed_beside(state: StateOnLines, known: Mask | None = None) -> StateOnLines | None:
    """The state with points where gaps are below zero in cells beside those of its points; None if there are none.

    A contact that spreads splits. A cell that has a point has no other minimum. Those beside contacts at nodes, and
    beside nodes `known` (m,), are not looked for.
    """
    there = state.closed_between_nodes
    taken = state.held if known is None else state.held | known
    own = np.isin(there.beside[:, 0], state.points.beside[:, 0])
    there = there.kept(~(own | np.any(taken[there.beside], axis=1)))
    return gaining_points(state, there) if len(there.phi) else None


def gaining_points(state: StateOnLines, there: LinePoints) -> StateOnLines:
    """The state with further points, which have no reactions yet."""
    reaction = np.concatenate([state.reaction, np.zeros(len(there.phi))])
    return replace(state, points=state.points.joined(there), reaction=reaction)
