"""The constraints (18)-(22): at each angle the petals lie in order between journal and bushing.

`W_q` are the deflections of the nodes at one angle from the journal outward, `c_q` the gaps of the free petals:

    W_0 >= W_-                       journal    (18), (21)
    W_q+1 >= W_q - c_q               petals     (19)
    W_last <= W_+                    bushing    (18), (22)

With `Z_q = W_q + c_0 + ... + c_q-1` a column of nodes is an ascending sequence between two bounds (Q3).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class ContactColumns(NamedTuple):
    """Columns of nodes that can touch; lengths are divided by `h_ref`.

    Attributes
    ----------
    node : (layer, column) int array
        Deflection unknowns from the journal outward, -1 beyond the outermost.
    shift : (layer, column) array
        `c_0 + ... + c_q-1` [1], infinite beyond the outermost.
    low, high : (column,) arrays
        Bounds of the ascending sequence [1].
    layers : (column,) int array
        Number of layers of each column.
    """

    node: Index
    shift: Array
    low: Array
    high: Array
    layers: Index


def columns(problem: CoupledProblem) -> ContactColumns:
    """The columns of the wall of `problem`, from its gaps."""
    contacts, n = problem.layout.wall.contacts, problem.layout.n_wall
    gap = problem.gaps(np.zeros(problem.layout.n))  # gaps of the free petals
    above, between, low, high = np.full(n, -1), np.zeros(n), np.full(n, -np.inf), np.full(n, np.inf)
    inner, outer = _touching(problem)
    low[inner[contacts.journal]] = -gap[contacts.journal]
    high[inner[contacts.bushing]] = gap[contacts.bushing]
    pairs = np.arange(contacts.petals.start, contacts.petals.stop)
    on_root = outer[pairs] < 0  # a root does not move: it is a bound like the bushing
    high[inner[pairs[on_root]]] = gap[pairs[on_root]]
    on_petal = pairs[~on_root]
    above[inner[on_petal]], between[inner[on_petal]] = outer[on_petal], gap[on_petal]
    innermost = np.setdiff1d(np.arange(n), outer[on_petal])
    return _stacked(innermost, above, between, (low, high))


def _touching(problem: CoupledProblem) -> tuple[Index, Index]:
    """Deflection unknowns of every gap: on its inner petal (or only petal), and on its outer petal (-1: none)."""
    G = problem.layout.wall.contacts.G
    rows = np.repeat(np.arange(G.shape[0]), np.diff(G.indptr))
    inner, outer = (np.full(G.shape[0], -1, dtype=np.int64) for _ in range(2))
    petals = rows >= problem.layout.wall.contacts.petals.start
    is_outer = petals & (G.data > 0.0)
    inner[rows[~is_outer]] = G.indices[~is_outer]
    outer[rows[is_outer]] = G.indices[is_outer]
    return inner, outer


def _stacked(innermost: Index, above: Index, between: Array, bounds: tuple[Array, Array]) -> ContactColumns:
    """Build all columns together, layer by layer from the innermost nodes outward."""
    low, high = bounds[0][innermost], np.full(len(innermost), np.inf)
    node, shift, layers = [innermost], [np.zeros(len(innermost))], np.ones(len(innermost), dtype=np.int64)
    while True:
        here, lift = node[-1], shift[-1]
        high = np.where(here >= 0, np.minimum(high, bounds[1][here] + lift), high)
        more = np.where(here >= 0, above[here], -1)
        if np.all(more < 0):
            break
        node.append(more)
        shift.append(np.where(more >= 0, lift + between[here], np.inf))
        layers += more >= 0
    return ContactColumns(np.array(node, dtype=np.int64), np.array(shift), low, high, layers)
