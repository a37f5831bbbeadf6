"""Which closed gaps determine unknowns, and which only repeat what others say.

Closed gaps tie unknowns to each other and to the ground. Where they form a closed chain, or hold no unknown at all,
one of the chain is a stop: it holds what moves the chain as a whole.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


def determining(G: sp.csr_array, closed: Mask, last: slice) -> Mask:
    """The closed rows of `G` that tie unknowns without a closed chain, (m,); those in `last` are taken last.

    A spanning forest of the chains: rows that close one are left out.
    """
    rows = np.flatnonzero(closed)
    held = np.diff(G.indptr)[rows]
    rows = rows[held > 0]
    ground = G.shape[1]
    one = G.indices[G.indptr[rows]]
    both = np.diff(G.indptr)[rows] == 2
    other = np.where(both, G.indices[np.minimum(G.indptr[rows] + 1, len(G.indices) - 1)], ground)
    late = np.zeros(G.shape[0], dtype=bool)
    late[last] = True
    order = np.lexsort((rows, late[rows]))
    low, high = np.minimum(one, other)[order], np.maximum(one, other)[order]
    _, first = np.unique(low.astype(np.int64) * (ground + 1) + high, return_index=True)  # of parallel rows the earliest
    low, high, kept = low[first], high[first], order[first]
    graph = sp.coo_array((1.0 + first, (low, high)), shape=(ground + 1, ground + 1)).tocsr()
    forest = sp.csgraph.minimum_spanning_tree(graph).tocoo()
    place = {(int(a), int(b)): int(k) for a, b, k in zip(low, high, kept, strict=True)}
    mask = np.zeros(len(closed), dtype=bool)
    for a, b in zip(forest.row, forest.col, strict=True):
        mask[rows[place[min(int(a), int(b)), max(int(a), int(b))]]] = True
    return mask
