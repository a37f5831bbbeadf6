"""Other contacts on contact lines with the factor of a state before: what has begun, ended or become stiffer since.

Contacts of the factor are eliminated. One that has ended is a motion of unit opening whose reaction vanishes; one that
has begun is a unit reaction under which the gap there stays closed (O4); where `lam / p''` has changed by `d`, a moment
`d t` with `t = n' dx + n'_e de` adds to the rows (C16). Each asks for a solve, all of them together; what the factor
has been asked for once is remembered.
"""

from __future__ import annotations

from dataclasses import dataclass, field
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


class Turning(NamedTuple):
    """Points whose travel stiffness is another: those `of_factor` (a,) by their numbers there, then others.

    `slopes` are derivatives of all `c` of them, and `stiffer` (c,) is the change of their stiffness.
    """

    of_factor: Index
    slopes: CurveRows
    stiffer: Array


@dataclass(frozen=True)
class FactorAnswers:
    """What a factor answers to an opening of one of its contacts, and to a moment at one of its points.

    Attributes
    ----------
    tangent : Tangent
        The factor.
    slopes : (k, n) sparse
        Derivatives of the slopes at its points.
    known : dict
        Changes of the unknowns (n,) and of its reactions, by the place of a contact, or behind them the number of a
        point.
    """

    tangent: Tangent
    slopes: sp.csr_array
    known: dict[int, tuple[Array, Array]] = field(default_factory=dict)

    def each(self, opened: Index, turned: Index, forces: sp.csr_array) -> tuple[Array, Array]:
        """By unit openings `opened` (a,), unit moments at points `turned` (b,) and `forces` (c, n): columns of each.

        Shapes (n, a + b + c) and (k, a + b + c).
        """
        contacts = self.tangent.constraints.G.shape[0]
        asked = [*opened.tolist(), *(contacts + turned).tolist()]
        fresh = np.array([key for key in asked if key not in self.known], dtype=np.intp)
        moments = self.slopes[fresh[fresh >= contacts] - contacts].toarray()
        none = np.zeros((np.count_nonzero(fresh < contacts), self.tangent.matrix.shape[0]))
        pushes = np.vstack([none, moments, forces.toarray()]).T
        openings = np.concatenate([fresh, np.full(forces.shape[0], -1)])
        answers = self.tangent.respond_each(pushes, np.where(openings < contacts, openings, -1))
        columns = list(zip(*(part.T for part in answers), strict=True))
        self.known.update(zip(fresh.tolist(), columns[: len(fresh)], strict=True))
        own = [self.known[key] for key in asked] + columns[len(fresh) :]
        changes, reactions = (np.column_stack(part) for part in zip(*own, strict=True))
        return changes, reactions


@dataclass(frozen=True)
class LineExchange:
    """What differs from the contacts of a factor.

    Attributes
    ----------
    opened : (a,) int array
        Places among the contacts of the factor.
    added : CurveRows
        Gaps that have closed, `b` of them.
    turning : Turning
        Points whose travel stiffness is another, `c` of them.
    changes, reactions : (n, a + b + c), (k, a + b + c) array
        Changes of the unknowns and of the reactions of the factor by a unit of each.
    lu : tuple
        Factors of the conditions.
    """

    opened: Index
    added: CurveRows
    turning: Turning
    changes: Array
    reactions: Array
    lu: tuple[Array, Array]

    @classmethod
    def of(cls, answers: FactorAnswers, opened: Index, added: CurveRows, turning: Turning) -> LineExchange | None:
        """The exchange, all its solves together; None where the contacts do not determine the petals."""
        a, b, c, own = len(opened), added.by_x.shape[0], len(turning.stiffer), len(turning.of_factor)
        forces = sp.csr_array(sp.vstack([-added.by_x, turning.slopes.by_x[own:]], format="csr"))
        changes, reactions = answers.each(opened, turning.of_factor, forces)
        ordered = np.concatenate(
            [np.arange(a), a + own + np.arange(b), a + np.arange(own), a + own + b + np.arange(c - own)]
        )
        size = np.concatenate([np.ones(a + b), turning.stiffer])
        changes, reactions = changes[:, ordered] * size, reactions[:, ordered] * size
        conditions = np.vstack([reactions[opened], added.by_x @ changes, turning.slopes.by_x @ changes])
        at = a + b + np.arange(c)
        conditions[at, at] -= 1.0
        if not np.all(np.isfinite(conditions)) or np.linalg.cond(conditions) > WORST_CONDITION:
            return None
        return cls(opened, added, turning, changes, reactions, la.lu_factor(conditions))

    def amend(self, change: Array, reactions: Array, closed: Array, turned: Array) -> tuple[Array, Array, Array, Array]:
        """Unknowns, reactions of the factor and of the gaps added, and moments at points, from what the factor gave.

        `closed` (b,) and `turned` (c,) are what else changes the gaps added and the slopes.
        """
        violation = [
            reactions[self.opened],
            self.added.by_x @ change + closed,
            self.turning.slopes.by_x @ change + turned,
        ]
        amounts = la.lu_solve(self.lu, -np.concatenate(violation))
        reactions = reactions + self.reactions @ amounts
        reactions[self.opened] = 0.0
        first = len(self.opened)
        last = first + len(closed)
        return change + self.changes @ amounts, reactions, amounts[first:last], self.turning.stiffer * amounts[last:]
