"""The restrictions (18)-(22): at each angle the petals lie layer upon layer between journal and bushing.

Node to node, `W_q` from the journal outward, with the gaps of the free shapes `c_q` between layers:

    W_0 >= W_-                       journal    (18), (21)
    W_q+1 >= W_q - c_q               petals     (19)
    W_last <= W_+                    bushing    (18), (22)

With `Z_q = W_q + c_0 + ... + c_q-1` a column is an ascending sequence between two bounds (Q3).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class Columns(NamedTuple):
    """Columns of touching nodes; lengths over `h_ref`.

    Attributes
    ----------
    node : (layer, column) int array
        Deflection unknowns from the journal outward; -1 above the outermost.
    shift : (layer, column) array
        `c_0 + ... + c_q-1` [1]; infinite above the outermost.
    low, high : (column,) arrays
        Bounds of the ascending sequence [1].
    layers : (column,) int array
        Layers of each column.
    """

    node: Index
    shift: Array
    low: Array
    high: Array
    layers: Index


def columns(problem: CoupledProblem) -> Columns:
    """Columns of the wall of `problem`, from its gaps."""
    contacts, n = problem.layout.wall.contacts, problem.layout.n_wall
    gap = problem.gaps(np.zeros(problem.layout.n))  # of the free shapes
    above, between, low, high = np.full(n, -1), np.zeros(n), np.full(n, -np.inf), np.full(n, np.inf)
    inner, outer = _touching(problem)
    low[inner[contacts.journal]] = -gap[contacts.journal]
    high[inner[contacts.bushing]] = gap[contacts.bushing]
    pairs = np.arange(contacts.petals.start, contacts.petals.stop)
    on_root = outer[pairs] < 0  # a root does not move: a bound like the bushing
    high[inner[pairs[on_root]]] = gap[pairs[on_root]]
    on_petal = pairs[~on_root]
    above[inner[on_petal]], between[inner[on_petal]] = outer[on_petal], gap[on_petal]
    innermost = np.setdiff1d(np.arange(n), outer[on_petal])
    return _stacked(innermost, above, between, (low, high))


def _touching(problem: CoupledProblem) -> tuple[Index, Index]:
    """Deflection unknowns of every gap: of the only or the inner petal, and of the outer one (-1: none)."""
    G = problem.layout.wall.contacts.G
    rows = np.repeat(np.arange(G.shape[0]), np.diff(G.indptr))
    inner, outer = (np.full(G.shape[0], -1, dtype=np.int64) for _ in range(2))
    petals = rows >= problem.layout.wall.contacts.petals.start
    is_outer = petals & (G.data > 0.0)
    inner[rows[~is_outer]] = G.indices[~is_outer]
    outer[rows[is_outer]] = G.indices[is_outer]
    return inner, outer


def _stacked(innermost: Index, above: Index, between: Array, bounds: tuple[Array, Array]) -> Columns:
    """Climb from the innermost nodes outward, all columns at once."""
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
    return Columns(np.array(node, dtype=np.int64), np.array(shift), low, high, layers)
