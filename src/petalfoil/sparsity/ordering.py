"""Order of elimination, learnt from the factorisations of one problem.

SuperLU finds a minimum-degree order for a symmetric pattern, but does not follow its elimination tree: columns of equal
structure lie scattered and are treated one by one. The same order in postorder of the tree fills in the same and takes
half of the time. It is found once and serves for as long as factors do not grow: contact sets that follow each other
differ in a few unknowns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

GROWN = 1.15
"""Growth of the factors past which an order is given up: a new one costs half of a factorisation."""


FULLER = 1.02
"""Growth of the entries of a matrix past which an order found before is not taken: the first matrix of an interior
point lacks entries that all later ones have, and its order lets their factors grow by a third in 3-D."""


class Order(Protocol):
    """Where a factorisation finds its order, and leaves what it has learnt."""

    def known(self, entries: int = 0) -> Index | None:
        """Unknowns in the order of elimination of a matrix with so many entries; None if it must be found."""

    def learn(self, order: Callable[[], Index] | None, fill: float, entries: int = 0) -> None:
        """A factorisation of so many entries had `fill` factors an unknown; `order` tells the one that it had to find.

        It is asked for when another factorisation is to follow it.
        """


def postorder(matrix: sp.csc_array, order: Index) -> Index:
    """Unknowns of `matrix` in postorder of the tree of their elimination in `order`, (n,)."""
    n = matrix.shape[0]
    tree = sp.csr_array((np.ones(n), (parents(matrix, order), np.arange(n))), shape=(n + 1, n + 1))
    downward = sp.csgraph.depth_first_order(tree, n, directed=True, return_predecessors=False)
    places: Index = order[downward[:0:-1]]
    return places


def parents(matrix: sp.csc_array, order: Index) -> Index:
    """Parent of every place of `order` in the elimination tree, `n` for roots, (n,) (Liu 1986, doi:10.1145/6497.6499).

    The tree tells when parts of the graph join as unknowns come one by one; a spanning forest of the earliest edges
    joins them at the same times, and has few edges to look at.
    """
    n = matrix.shape[0]
    place = places(order).astype(np.intp)
    rows, cols = place[matrix.indices], np.repeat(place, np.diff(matrix.indptr))
    late, early = np.maximum(rows, cols), np.minimum(rows, cols)
    apart = late != early
    graph = sp.coo_array((late[apart], (late[apart], early[apart])), shape=(n, n)).tocsr()
    graph.data = np.repeat(np.arange(n, dtype=np.float64), np.diff(graph.indptr))  # both triangles may name an edge
    forest = sp.csgraph.minimum_spanning_tree(graph).tocoo()
    late, early = np.maximum(forest.row, forest.col), np.minimum(forest.row, forest.col)
    by_time = np.argsort(late, kind="stable")
    parent, root = np.full(n, n), list(range(n))
    for joining, member in zip(late[by_time].tolist(), early[by_time].tolist(), strict=True):
        top = member
        while root[top] != top:
            root[top] = root[root[top]]
            top = root[top]
        parent[top] = root[top] = joining
    return parent


@dataclass
class Learnt:
    """Places of the unknowns in an elimination that once served, and the entries an unknown it led to first.

    The postorder is found when the order is first followed: many matrices stay the only ones of their kind. Factors in
    it are compared with each other, not with those of the factorisation that found it: in postorder SuperLU joins
    columns of nearly equal structure, and stores a fifth more.
    """

    found: Callable[[], Array] | None = None
    fill: float = np.inf
    _rank: Array | None = None

    @property
    def rank(self) -> Array | None:
        """Place of every unknown, (n,); None where no order is known."""
        if self._rank is None and self.found is not None:
            self._rank, self.found = self.found(), None
        return self._rank

    def keep(self, found: Callable[[], Array]) -> None:
        """Keep a new order, `found` when it is asked for."""
        self.found, self._rank, self.fill = found, None, np.inf

    def judge(self, fill: float) -> None:
        """Give the order up where factors have grown."""
        if np.isinf(self.fill):
            self.fill = fill
        elif fill > GROWN * self.fill:
            self.found = self._rank = None


@dataclass
class Elimination:
    """Orders of one problem: of all its unknowns with every gap open to the barrier, and of those left by ties."""

    whole: Learnt = field(default_factory=Learnt)
    tied: Learnt = field(default_factory=Learnt)
    entries: int = 0

    def known(self, entries: int = 0) -> Index | None:
        """Unknowns in the order of elimination; None for a matrix with more entries than the one it was found for."""
        rank = self.whole.rank if entries <= FULLER * self.entries else None
        return None if rank is None else np.argsort(rank, kind="stable")

    def learn(self, order: Callable[[], Index] | None, fill: float, entries: int = 0) -> None:
        """Keep what a factorisation of all unknowns has found."""
        if order is None:
            self.whole.judge(fill)
        else:
            self.whole.keep(lambda: places(order()))
            self.entries = entries


@dataclass(frozen=True)
class TiedOrder:
    """Order of unknowns some of which move together: `group` (n,) of each, -1 where it is held; `count` groups."""

    learnt: Learnt
    group: Index
    count: int

    def known(self, entries: int = 0) -> Index | None:
        """Groups in the order of elimination: each comes when the last of its unknowns would."""
        rank = self.learnt.rank
        if rank is None:
            return None
        inside = self.group >= 0
        last = np.full(self.count, -np.inf)
        np.maximum.at(last, self.group[inside], rank[inside])
        return np.argsort(last, kind="stable")

    def learn(self, order: Callable[[], Index] | None, fill: float, entries: int = 0) -> None:
        """Keep what a factorisation of the groups has found, for each of their unknowns."""
        if order is None:
            self.learnt.judge(fill)
            return

        def of_each() -> Array:
            # a held unknown may move with the next contact set: it is placed by the one before it, its neighbour
            spread = np.maximum.accumulate(np.where(self.group >= 0, np.arange(len(self.group)), 0))
            return places(order())[self.group[spread]]

        self.learnt.keep(of_each)


def places(order: Index) -> Array:
    """Place of every unknown in `order`, (n,)."""
    rank = np.empty(len(order))
    rank[order] = np.arange(len(order))
    return rank
