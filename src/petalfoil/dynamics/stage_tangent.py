"""The factorised system of a stage, the rotor bordered; and the same with a few gaps opened or closed since.

A change of the contact set asks for no new factorisation while it is small: with the factor at hand, a gap that opens
is a motion of unit opening whose reaction must vanish, a gap that closes a unit reaction under which it must not open
(O4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.linear_response import Motion, Response
from petalfoil.solvers.constraints import Ties, tie
from petalfoil.solvers.spanning import determining
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.system.loaded import FilmForce
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

MOST_EXCHANGED = 16
"""Gaps that may change before a factorisation is cheaper: each asks for a solve, a fortieth of one."""


@dataclass(frozen=True)
class Exchange:
    """Gaps that have opened and closed since the factorisation.

    Attributes
    ----------
    opened : (a,) int array
        Places among the ties of the factor.
    added : (b,) int array
        Numbers of the gaps that have closed.
    rows : (b, n) sparse
        Derivatives of these.
    changes, reactions : (n, a + b), (k, a + b) array
        Changes of the unknowns and of the factor's reactions by a unit opening or a unit reaction of each.
    lu : tuple
        Factors of the conditions that openings carry no load and closed gaps stay closed.
    """

    opened: Index
    added: Index
    rows: sp.csr_array
    changes: Array
    reactions: Array
    lu: tuple[Array, Array]

    def amend(self, change: Array, reactions: Array, moved: Array) -> tuple[Array, Array, Array]:
        """Unknowns, reactions of the factor's ties and of the gaps added, from what the factor alone gave.

        `moved` (b,) is what the journal does to the gaps added.
        """
        wrong = np.concatenate([reactions[self.opened], self.rows @ change + moved])
        share = la.lu_solve(self.lu, -wrong)
        reactions = reactions + self.reactions @ share
        reactions[self.opened] = 0.0
        return change + self.changes @ share, reactions, share[len(self.opened) :]


def exchange_of(response: Response, closed: Mask) -> Exchange | None:
    """Open and close gaps of a factor until `closed` are; None if the rest does not hold the petals."""
    motion = response.motion
    G, ties, firm = motion.problem.G, motion.ties, np.flatnonzero(motion.closed)
    opened, added = np.flatnonzero(~closed[firm]), np.flatnonzero(closed & ~motion.closed)
    rows, columns, reactions = sp.csr_array(G[added]), [], []
    for place in opened:
        open_one = np.zeros(len(firm))
        open_one[place] = -1.0
        follow = ties.close(open_one)
        change = follow + ties.spread(response.factor.solve(-ties.gather(response.apply(follow))))
        columns.append(change)
        reactions.append(ties.reactions(response.apply(change)))
    for row in range(len(added)):
        push = rows[[row]].toarray()[0]
        change = ties.spread(response.factor.solve(ties.gather(push)))
        columns.append(change)
        reactions.append(ties.reactions(response.apply(change) - push))
    changes, pushed = np.column_stack(columns), np.column_stack(reactions)
    conditions = np.vstack([pushed[opened], rows @ changes])
    if not np.all(np.isfinite(conditions)) or np.linalg.cond(conditions) > WORST:
        return None
    return Exchange(opened, added, rows, changes, pushed, la.lu_factor(conditions))


WORST = 1e12
"""Condition of an exchange past which a factorisation is safer (openings and reactions have units of their own)."""


@dataclass(frozen=True)
class Tangent:
    """The factorised system of a stage, rotor bordered.

    Attributes
    ----------
    rate : float
        Its `rate` [1 / unit of time].
    response : Response
        Factor, its ties, and products.
    closed : (m,) bool array
        Gaps that are kept closed.
    ties : Ties
        The same as ties.
    stops : (k,) int array
        Gaps that close a chain of closed ones between journal and bushing: only the journal can open them.
    exchange : Exchange or None
        How `closed` differs from what the factor keeps closed.
    units : (n, 2) array
        Change of the unknowns by a unit displacement along x and y.
    gradient : (2, 2) array
        Change of the bearing's force on the journal by them.
    """

    rate: float
    response: Response
    closed: Mask
    ties: Ties
    stops: Index
    exchange: Exchange | None
    units: Array
    gradient: Array

    def serves(self, closed: Mask) -> bool:
        """The gaps `closed` are those that it keeps closed, or stops."""
        mine = self.closed.copy()
        mine[self.stops] = closed[self.stops]
        return bool(np.array_equal(mine, closed))

    def settle(self, residual: Array) -> tuple[Array, Array]:
        """Change of the unknowns (n,) against `residual` at a journal that stays, and all reactions after it (m,)."""
        response = self.response
        firm = response.motion.ties
        change = firm.spread(response.factor.solve(-firm.gather(residual)))
        reactions = firm.reactions(residual + response.apply(change))
        return everything(response, self.exchange, (change, reactions), np.zeros(len(self.closed)))

    def exchanged(self, closed: Mask) -> Tangent | None:
        """The same factor for other closed gaps; None where they differ by too many, or need a factor of their own."""
        motion = self.response.motion
        if len(self.stops) or np.count_nonzero(closed != motion.closed) > MOST_EXCHANGED:
            return None
        ties = tie(motion.problem.G, closed)
        if not ties.determinate:
            return None
        gaps = (closed, ties, self.stops)
        if np.array_equal(closed, motion.closed):
            return bordered(self.rate, self.response, gaps, None)
        exchange = exchange_of(self.response, closed)
        return None if exchange is None else bordered(self.rate, self.response, gaps, exchange)


def tangent_of(problem: StepProblem, x: Array, closed: Mask, solver: LinearSolver) -> Tangent | None:
    """Factorise a stage at `x` with the gaps `closed`; None if the system has no solution."""
    held = determining(problem.G, closed, problem.layout.wall.contacts.journal)
    ties, stops = tie(problem.G, held), np.flatnonzero(closed & ~held)
    try:
        response = Motion(problem, problem.linearize(x), held, ties).respond(0.0, solver)
    except SingularMatrixError:
        return None
    return bordered(problem.rate, response, (held, ties, stops), None)


def everything(
    response: Response, exchange: Exchange | None, found: tuple[Array, Array], moved: Array
) -> tuple[Array, Array]:
    """Unknowns (n,) and all reactions (m,) from what the factor gave; `moved` (m,) is what the journal does to gaps."""
    lam = np.zeros(len(response.motion.closed))
    change, reactions = found
    if exchange is not None:
        change, reactions, lam[exchange.added] = exchange.amend(change, reactions, moved[exchange.added])
    lam[response.motion.closed] = reactions
    return change, lam


def bordered(rate: float, response: Response, gaps: tuple[Mask, Ties, Index], exchange: Exchange | None) -> Tangent:
    """The factor with both displacements of the journal."""
    problem = response.motion.problem
    by_e, film = problem.layout.wall.contacts.by_e, FilmForce.of(problem)
    both = [everything(response, exchange, response.unit(k), by_e[:, k]) for k in range(by_e.shape[1])]
    gradient = [film.by_P @ change[problem.positive] + by_e.T @ lam for change, lam in both]
    units = np.column_stack([change for change, _ in both])
    return Tangent(rate, response, *gaps, exchange, units, np.column_stack(gradient))
