"""Where gaps on contact lines are below zero between nodes: in each cell (K15) is a cubic with one minimum at most.

A gap closes so away from contacts, and beside one that spreads: the gap curves down at it less and less, and closes
anew within a cell or two.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.contact import GapLines
from petalfoil.physics.line_points import LinePoints

Array = NDArray[np.float64]
Index = NDArray[np.intp]

PENETRATION = 1e-4
"""A gap this far below zero gains a contact, in units of the reference film (1 nm)."""


def closed_between(points: LinePoints, gaps: Array, depth: float) -> LinePoints:
    """Places between nodes where gaps are least, and deeper than `depth` below zero; `gaps` (m,) at all nodes.

    The lines are those of some `points`. A cubic is no lower than its Bernstein coefficients: its minimum is looked for
    where one of the inner two is below zero.
    """
    kind, line, phi = [np.zeros(0, dtype=np.intp)], [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
    for number, lines in enumerate(points.lines):
        nodal = at_both_nodes(lines, gaps)
        inner = np.minimum(nodal[..., 0] + nodal[..., 1] / 3.0, nodal[..., 2] - nodal[..., 3] / 3.0)
        on, cell = np.nonzero(inner < -depth)
        place, lowest = lowest_in_cells(nodal[on, cell])
        deep = lowest < -depth
        kind.append(np.full(np.count_nonzero(deep), number))
        line.append(on[deep])
        phi.append((lines.phi[cell] + place * lines.cell_length[cell])[deep])
    return LinePoints(points.lines, points.gaps, np.concatenate(kind), np.concatenate(line), np.concatenate(phi))


def at_both_nodes(lines: GapLines, gaps: Array) -> Array:
    """Gap and slope over the cell at the node before and after each cell of some lines, (lines, cells, 4) [1]."""
    at, (node, weight), length = gaps[lines.number], lines.slope_weights, lines.cell_length
    slopes = np.einsum("lnk,nk->ln", at[:, node], weight)
    return np.stack([at[:, :-1], length * slopes[:, :-1], at[:, 1:], length * slopes[:, 1:]], axis=-1)


def lowest_in_cells(nodal: Array) -> tuple[Array, Array]:
    """Places `t` of the minima of cubics (K15) within their cells and the gaps there, (...) each; `nodal` (..., 4).

    Where there is none the gap is infinite.
    """
    powers = nodal @ hermite.COEFFICIENTS
    c, b, a = powers[..., 1], 2.0 * powers[..., 2], 3.0 * powers[..., 3]
    bent = np.sqrt(np.maximum(b**2 - 4.0 * a * c, 0.0))  # p'' = b + 2 a t at the minimum, where c + b t + a t^2 = 0
    above, below = np.where(b < 0.0, bent - b, -2.0 * c), np.where(b < 0.0, 2.0 * a, b + bent)
    place = np.divide(above, below, out=np.zeros_like(above), where=(bent > 0.0) & (below > 0.0))
    inside = (place > 0.0) & (place < 1.0)
    place = np.where(inside, place, 0.0)
    depth = np.sum(powers * place[..., None] ** np.arange(4), axis=-1)
    return place, np.where(inside, depth, np.inf)
