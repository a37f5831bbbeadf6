"""Other contacts on contact lines with the factor of a state before: what has begun, ended or become stiffer since.

Contacts of the factor are eliminated. One that has ended is a motion of unit opening whose reaction vanishes; one that
has begun is a unit reaction under which the gap there stays closed (O4); where `lam / p''` has changed by `d`, a moment
`d t` with `t = n' dx + n'_e de` adds to the rows (C16). Each asks for a solve, all of them together.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.tangent import WORST_CONDITION, Tangent

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class CurveRows(NamedTuple):
    """Derivatives of some gaps or slopes by the unknowns (b, n) and by the position of the journal (b, d)."""

    by_x: sp.csr_array
    by_e: Array


@dataclass(frozen=True)
class LineExchange:
    """What differs from the contacts of a factor.

    Attributes
    ----------
    opened : (a,) int array
        Places among the contacts of the factor.
    added : CurveRows
        Gaps that have closed, `b` of them.
    turning : CurveRows
        Slopes at points whose travel stiffness is another, `c` of them.
    stiffer : (c,) array
        Change of their stiffness.
    changes, reactions : (n, a + b + c), (k, a + b + c) array
        Changes of the unknowns and of the reactions of the factor by a unit of each.
    lu : tuple
        Factors of the conditions.
    """

    opened: Index
    added: CurveRows
    turning: CurveRows
    stiffer: Array
    changes: Array
    reactions: Array
    lu: tuple[Array, Array]

    @classmethod
    def of(
        cls, tangent: Tangent, opened: Index, added: CurveRows, turning: CurveRows, stiffer: Array
    ) -> LineExchange | None:
        """The exchange, all its solves together; None where the contacts do not determine the petals."""
        no_force = np.zeros((len(opened), tangent.matrix.shape[0]))
        forces = np.vstack([no_force, -added.by_x.toarray(), stiffer[:, None] * turning.by_x.toarray()])
        openings = np.append(opened, np.full(len(forces) - len(opened), -1))
        changes, reactions = tangent.respond_each(forces.T, openings)
        conditions = np.vstack([reactions[opened], added.by_x @ changes, turning.by_x @ changes])
        at = len(opened) + added.by_x.shape[0] + np.arange(len(stiffer))
        conditions[at, at] -= 1.0
        if not np.all(np.isfinite(conditions)) or np.linalg.cond(conditions) > WORST_CONDITION:
            return None
        return cls(opened, added, turning, stiffer, changes, reactions, la.lu_factor(conditions))

    def amend(self, change: Array, reactions: Array, closed: Array, turned: Array) -> tuple[Array, Array, Array, Array]:
        """Unknowns, reactions of the factor and of the gaps added, and moments at points, from what the factor gave.

        `closed` (b,) and `turned` (c,) are what else changes the gaps added and the slopes.
        """
        violation = [reactions[self.opened], self.added.by_x @ change + closed, self.turning.by_x @ change + turned]
        amounts = la.lu_solve(self.lu, -np.concatenate(violation))
        reactions = reactions + self.reactions @ amounts
        reactions[self.opened] = 0.0
        first = len(self.opened)
        last = first + len(closed)
        return change + self.changes @ amounts, reactions, amounts[first:last], self.stiffer * amounts[last:]
