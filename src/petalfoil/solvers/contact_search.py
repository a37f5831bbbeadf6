"""The active contacts of the linearised equations, found exactly among the gaps in doubt (T3).

Changing all contacts of wrong sign at once advances a bending contact by one node a step, and may cycle. Here the
equations are linearised once and factorised once; the gaps in doubt form a small dense complementarity problem whose
matrix comes from a few solves with that factor. Its solution is the whole set at once, however far it has to travel:
Newton's method for complementarity problems (Josephy 1979).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints, constrain
from petalfoil.solvers.contact_equations import ContactState
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.problem import ContactProblem
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SOLVES = 1_200_000
"""Gaps in doubt times unknowns that are still a small problem: each asks for a solve, and a factorisation is worth some
tens of those."""

ALWAYS_FEW = 60
"""Gaps in doubt that are always few enough."""

ROUNDS = 4
"""Times that gaps which the step would close are added to those in doubt."""

CLOSES = 1e-9
"""A gap that the step takes this far below zero is one of them."""


def neighbours(problem: ContactProblem, gaps: Mask, matrix: sp.csc_array) -> Mask:
    """Gaps whose unknowns the equations couple to those of the gaps given, (m,)."""
    touched = abs(problem.G).T @ gaps.astype(float)
    coupled = abs(matrix) @ (touched > 0.0).astype(float)
    return np.asarray(abs(problem.G) @ (coupled > 0.0).astype(float) > 0.0)


def search(
    problem: ContactProblem, state: ContactState, doubt: Mask, solver: LinearSolver
) -> tuple[Array, Mask] | None:
    """One Newton step from `state` with the active contacts of its linearisation; None if there are none.

    Parameters
    ----------
    doubt : (m,) bool array
        Gaps whose state is searched for, with their neighbours if these are few enough; the others stay as they are.

    Returns
    -------
    (x, active)
        The next iterate and its active contacts.
    """
    bare = state.linearized.matrix(np.zeros(len(doubt)))
    most = max(ALWAYS_FEW, SOLVES // max(1, int(problem.G.shape[1])))  # a search costs as much as a few factorisations
    wide = neighbours(problem, doubt, bare)
    doubt = doubt if np.count_nonzero(wide) > most else wide
    kept = state.active & ~doubt
    constraints = constrain(problem.G, kept, acting=problem.acting)
    if np.count_nonzero(doubt) > most or not constraints.determinate:
        return None
    stiffness = np.zeros(len(doubt))
    stiffness[state.active & doubt] = float(np.median(np.abs(bare.diagonal())))
    try:
        factor = constraints.factor(state.linearized.matrix(stiffness), solver, problem.elimination_key)
    except SingularMatrixError:
        return None
    base, plain = factor.solve(-constraints.balanced(state.linearized.residual)), problem.acting is problem.G
    for _ in range(ROUNDS):
        doubts = np.flatnonzero(doubt)
        if len(doubts) > most:
            return None
        rows = reduced_rows(problem.G, doubts, constraints)
        pushes = rows.T.toarray() if plain else balanced_columns(problem.acting, doubts, constraints)
        reduced = ReducedContacts(rows, factor.solve(pushes), base, stiffness[doubts])
        found = reduced.solved(state.gaps[doubts], state.active[doubts])
        if found is None:
            return None
        step, pushing = constraints.spread(found[0]), found[1]
        closing = (state.gaps + problem.G @ step < -CLOSES) & ~doubt & ~state.active
        if not closing.any():
            active = kept.copy()
            active[doubts[pushing]] = True
            return state.x + step, active
        doubt = doubt | closing
    return None


def reduced_rows(G: sp.csr_array, rows: NDArray[np.intp], constraints: ContactConstraints) -> sp.csr_array:
    """Rows of `G` over the free unknowns, (k, n_free)."""
    coo = sp.csr_array(G[rows]).tocoo()
    group = constraints.group[coo.col]
    inside = group >= 0
    shape = (len(rows), constraints.n_free)
    return sp.coo_array((coo.data[inside], (coo.row[inside], group[inside])), shape=shape).tocsr()


def balanced_columns(acting: sp.csr_array, rows: NDArray[np.intp], constraints: ContactConstraints) -> Array:
    """Forces of unit reactions on the equations of the free unknowns, (n_free, k)."""
    return np.column_stack([constraints.balanced(row) for row in acting[rows].toarray()])


@dataclass(frozen=True)
class ReducedContacts:
    """The linearised equations as seen by the gaps in doubt.

    Attributes
    ----------
    rows : (k, n_free) sparse
        `G` on these gaps.
    responses : (n_free, k) array
        Change of the free unknowns by a unit reaction of each.
    base : (n_free,) array
        Their change without reactions.
    stiffness : (k,) array
        Stiffness that the factor holds in each gap.
    """

    rows: sp.csr_array
    responses: Array
    base: Array
    stiffness: Array

    def solved(self, gaps: Array, active: Mask) -> tuple[Array, Mask] | None:
        """Step of the free unknowns, and which of the gaps push, from `gaps` (k,) of which `active` were closed.

        With `S = G J^-1 H^T` and the stiffness `k` held in the factor, the gaps change by `q = S (lam + k q) + q0`.
        """
        S, q0 = self.rows @ self.responses, self.rows @ self.base
        flexible = np.eye(len(gaps)) - S * self.stiffness[None, :]
        try:
            both = np.linalg.solve(flexible, np.column_stack([S, q0]))
        except np.linalg.LinAlgError:
            return None
        M, constant = both[:, :-1], both[:, -1]
        lam = solve_lcp(M, constant + gaps, active)
        if lam is None:
            return None
        change = M @ lam + constant
        return self.base + self.responses @ (lam + self.stiffness * change), lam > 0.0
