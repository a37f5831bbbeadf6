"""The contact set of the linearised equations, found exactly among the gaps in doubt (T3).

Swapping all gaps of wrong sign at once advances a bending contact one node a step, and may cycle. Here the equations
are linearised once and factorised once; the gaps in doubt are kept as a small dense complementarity problem whose
matrix comes from a few solves with that factor. Its answer is the whole set at once, however far it had to travel:
Newton's method for complementarity problems (Josephy 1979).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.cone import ConeProblem, Linearized
from petalfoil.solvers.constraints import Ties, tie
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SOLVES = 1_200_000
"""Gaps in doubt times unknowns that are still a small problem: each asks for a solve, and a factorisation is worth some
tens of those."""

LEAST_MOST = 60
"""Gaps in doubt that are always few enough."""

ROUNDS = 4
"""Times that gaps which the step would close are added to those in doubt."""


def near(problem: ConeProblem, mask: Mask, matrix: sp.csc_array) -> Mask:
    """Gaps whose unknowns the equations couple to those of the gaps in `mask`, (m,)."""
    touched = abs(problem.G).T @ mask.astype(float)
    coupled = abs(matrix) @ (touched > 0.0).astype(float)
    return np.asarray(abs(problem.G) @ (coupled > 0.0).astype(float) > 0.0)


def most_doubts(problem: ConeProblem) -> int:
    """Gaps that may be in doubt in a search, so that it costs no more than a few factorisations."""
    return max(LEAST_MOST, SOLVES // max(1, int(problem.G.shape[1])))


def search(
    problem: ConeProblem, at: tuple[Array, Array, Mask, Linearized], doubt: Mask, solver: LinearSolver
) -> tuple[Array, Mask] | None:
    """One Newton step with the contact set of its linearisation; None if there is none.

    Parameters
    ----------
    at : (x, gaps, closed, line)
        Iterate, its gaps, its closed gaps and its linearisation.
    doubt : (m,) bool array
        Gaps whose state is looked for; the others stay as they are.

    Returns
    -------
    (x, closed)
        The next iterate and its closed gaps.
    """
    _, _, closed, line = at
    most = most_doubts(problem)
    if np.count_nonzero(doubt) > most:
        return None
    firm = closed & ~doubt
    ties = tie(problem.G, firm)
    if not ties.determinate:
        return None
    stiffness = np.zeros(len(doubt))
    plain = line.matrix(stiffness)
    stiffness[closed & doubt] = float(np.median(np.abs(plain.diagonal())))
    try:
        factor = solver.factor(ties.reduce(line.matrix(stiffness)), ties.rank(problem.rank))
    except SingularMatrixError:
        return None
    base = factor.solve(-ties.gather(line.residual))
    for _ in range(ROUNDS):
        doubts = np.flatnonzero(doubt)
        if len(doubts) > most:
            return None
        rows = reduced_rows(problem.G, doubts, ties)
        ways = factor.solve(rows.T.toarray())
        answer = among(problem, at, doubts, (rows, ways, base, stiffness[doubts]))
        if answer is None:
            return None
        step, pushing = ties.spread(answer[0]), answer[1]
        x, gaps, now, _ = at
        late = (gaps + problem.G @ step < -1e-9) & ~doubt & ~now
        if not late.any():
            chosen = firm.copy()
            chosen[doubts[pushing]] = True
            return x + step, chosen
        doubt = doubt | late
    return None


def reduced_rows(G: sp.csr_array, rows: NDArray[np.intp], ties: Ties) -> sp.csr_array:
    """Rows of `G` over the free unknowns of `ties`, (k, n_free)."""
    coo = sp.csr_array(G[rows]).tocoo()
    group = ties.group[coo.col]
    inside = group >= 0
    shape = (len(rows), ties.n_free)
    return sp.coo_array((coo.data[inside], (coo.row[inside], group[inside])), shape=shape).tocsr()


def among(
    problem: ConeProblem,
    at: tuple[Array, Array, Mask, Linearized],
    doubts: NDArray[np.intp],
    parts: tuple[sp.csr_array, Array, Array, Array],
) -> tuple[Array, Mask] | None:
    """Step of the free unknowns, and which of the gaps in doubt push.

    With `S = G J^-1 G^T` and stiffnesses `theta` held in the factor, the gaps change by `q = S (lam + theta q) + q0`.
    """
    rows, ways, base, theta = parts
    _, gaps, closed, _ = at
    S, q0 = rows @ ways, rows @ base
    flexible = np.eye(len(doubts)) - S * theta[None, :]
    try:
        both = np.linalg.solve(flexible, np.column_stack([S, q0]))
    except np.linalg.LinAlgError:
        return None
    M, constant = both[:, :-1], both[:, -1]
    lam = solve_lcp(M, constant + gaps[doubts], closed[doubts])
    if lam is None:
        return None
    change = M @ lam + constant
    return base + ways @ (lam + theta * change), lam > 0.0
