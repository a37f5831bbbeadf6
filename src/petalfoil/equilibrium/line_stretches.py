"""Stretches of contacts at nodes on contact lines, as they grow and recede in time.

Between the nodes of a stretch, and beside the last node that is left of one, the curve of the gap (K15) dips below
zero by an eighth of `p''` times the square of a cell. A contact point in place of that node would lift the petals by as
much, with energy from nowhere. So a stretch ends and grows at nodes, and becomes a point only where that is one.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts, StateOnLines
from petalfoil.equilibrium.line_dips import PENETRATION
from petalfoil.equilibrium.line_signs import closed_beside, reactions_at_nodes, revised, with_points_at

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

BESIDE = 1e-3
"""Distance from a node at which the gap on either side of it is looked at, in cells."""


class Stretches(NamedTuple):
    """What is left of stretches of contacts at nodes at an instant.

    Attributes
    ----------
    leaning : (m,) array
        Slopes of the gaps at contacts at single nodes, zero at others [1/rad].
    dipping : (m,) bool array
        Nodes beside gaps that are below zero between nodes.
    """

    leaning: Array
    dipping: Mask

    @classmethod
    def of(cls, state: LineContacts | None, contacts: int) -> Stretches:
        """Those of a state, among as many `contacts`; none where there is no state with contact lines."""
        dipping = np.zeros(contacts, dtype=np.bool_)
        if state is None:
            return cls(np.zeros(contacts), dipping)
        dipping[state.closed_between_nodes.beside] = True
        return cls(state.slopes_at_single, dipping)


def revised_in_time(state: StateOnLines, pull: float, before: Stretches) -> StateOnLines | None:
    """Other contacts of a state in a step in time, where the signs ask for them; None where they are right.

    They are those of `revised`, but for stretches. One recedes node by node to a single one, beside which the gap dips
    on the side that it receded from, and grows again by the nodes beside it. Once the gap no longer leans to that side,
    the node becomes a point: it is one there, so that nothing moves. Gaps that were below zero between nodes `before`
    gain no point.
    """
    turned = np.flatnonzero(before.leaning * state.slopes_at_single < 0.0)
    if len(turned) and not np.any(state.doubled):
        free = np.zeros_like(state.held)
        free[turned[rises_on_both_sides(state, turned)]] = True
        if free.any():
            return with_points_at(state, free, reactions_at_nodes(state), free)
    return stretched(state) or revised(state, pull, before.dipping) or closed_beside(state, before.dipping)


def rises_on_both_sides(state: LineContacts, nodes: Index) -> Mask:
    """Whether gaps curve upward on either side of some nodes, (j,); their second derivatives jump there."""
    rises = np.zeros(len(state.held), dtype=np.bool_)
    points = state.points.at_nodes(nodes)
    sides = [points.moved(side * points.cell_length).along(state.gaps)[2] > 0.0 for side in (-BESIDE, BESIDE)]
    rises[points.nearest] = sides[0] & sides[1]
    return np.asarray(rises[nodes])


def stretched(state: StateOnLines) -> StateOnLines | None:
    """The state with contacts at nodes beside others whose gaps have closed; None where there are none."""
    below, fresh = (state.gaps < -PENETRATION) & ~state.held, np.zeros(len(state.held), dtype=np.bool_)
    for lines in state.points.lines if below.any() else ():
        held = np.pad(state.held[lines.number], ((0, 0), (1, 1)))
        fresh[lines.number] = below[lines.number] & (held[:, :-2] | held[:, 2:])
    if not fresh.any():
        return None
    held = state.held | fresh
    return replace(state, held=held, held_reaction=reactions_at_nodes(state)[held])
