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
        constraints, matrix = tangent.constraints, tangent.matrix
        openings = np.zeros((constraints.G.shape[0], len(opened)))
        openings[opened, np.arange(len(opened))] = -1.0
        follow = [constraints.close(column) for column in openings.T]
        forces = [matrix @ column for column in follow]
        forces += [-row for row in added.by_x.toarray()]
        forces += [stiffness * row for stiffness, row in zip(stiffer, turning.by_x.toarray(), strict=True)]
        pushed = np.column_stack([constraints.balanced(force) for force in forces])
        moved = [constraints.spread(column) for column in tangent.factor.solve(-pushed).T]
        reactions = np.column_stack(
            [constraints.reactions(matrix @ one + force) for one, force in zip(moved, forces, strict=True)]
        )
        changes = np.column_stack(moved)
        changes[:, : len(opened)] += np.column_stack([np.zeros((len(changes), 0)), *follow])
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
