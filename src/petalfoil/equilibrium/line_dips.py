"""Where gaps on contact lines are below zero between nodes beside a contact: it is two, and the other one is there.

A contact that spreads splits: the gap curves down at it less and less, and closes anew beside it, within a cell or two.
In each cell (K15) is a cubic with one minimum at most.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import StateOnLines
from petalfoil.equilibrium.line_signs import PENETRATION, covered
from petalfoil.mesh import hermite
from petalfoil.physics.contact import GapLines
from petalfoil.physics.line_points import LinePoints

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def closed_beside(state: StateOnLines) -> StateOnLines | None:
    """The state with points where gaps are below zero in cells beside those of its contacts; None if there are none.

    A cell that has a contact has no other minimum.
    """
    points, near, every = state.points, covered(state), []
    for kind, lines in enumerate(points.lines):
        place, depth = lowest_in_cells(lines, state.gaps)
        free = near[lines.number[:, :-1]] | near[lines.number[:, 1:]]
        free &= ~(state.held[lines.number[:, :-1]] | state.held[lines.number[:, 1:]])
        own = points.kind == kind
        free[points.line[own], hermite.located(points.phi[own], lines.phi)[0]] = False
        line, cell = np.nonzero(free & (depth < -PENETRATION))
        phi = lines.phi[cell] + place[line, cell] * np.diff(lines.phi)[cell]
        every.append(LinePoints(points.lines, points.gaps, np.full(len(line), kind), line, phi))
    if not any(len(found.phi) for found in every):
        return None
    for found in every:
        points = points.joined(found)
    none_yet = np.zeros(len(points.phi) - len(state.reaction))
    return replace(state, points=points, reaction=np.concatenate([state.reaction, none_yet]))


def lowest_in_cells(lines: GapLines, gaps: Array) -> tuple[Array, Array]:
    """Place `t` of the minimum of (K15) within each cell of some lines, and the gap there; (lines, cells) each.

    Where there is none the gap is infinite.
    """
    at, (node, weight), length = gaps[lines.number], lines.slope_weights, np.diff(lines.phi)
    slopes = np.einsum("lnk,nk->ln", at[:, node], weight)
    nodal = np.stack([at[:, :-1], length * slopes[:, :-1], at[:, 1:], length * slopes[:, 1:]], axis=-1)
    powers = nodal @ hermite.COEFFICIENTS
    c, b, a = powers[..., 1], 2.0 * powers[..., 2], 3.0 * powers[..., 3]
    bent = np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))  # p'' = b + 2 a t at the minimum, where c + b t + a t^2 = 0
    above, below = np.where(b < 0.0, bent - b, -2.0 * c), np.where(b < 0.0, 2.0 * a, b + bent)
    place = np.divide(above, below, out=np.zeros_like(above), where=(bent > 0.0) & (below > 0.0))
    inside = (place > 0.0) & (place < 1.0)
    place = np.where(inside, place, 0.0)
    depth = np.sum(powers * place[..., None] ** np.arange(4), axis=-1)
    return place, np.where(inside, depth, np.inf)
