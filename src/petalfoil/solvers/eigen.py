"""Rightmost eigenvalue of `J u = -s M u` (E1) with a singular `M`: does a disturbance die out?

Algebraic rows (a wall without mass) make `M` singular and put eigenvalues at infinity. The pencil is therefore seen
through one step of an L-stable Runge-Kutta method (SDIRK of order 2, `gamma = 1 - 1/sqrt 2`), which maps the left half
plane into the unit circle and infinity to zero: the eigenvalue of largest magnitude is the one that grows fastest, or
dies out last. One factorisation serves all steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.solvers.linear import Factor, LinearSolver
from petalfoil.solvers.ties import apart
from petalfoil.sparsity import Order

Array = NDArray[np.float64]

GAMMA = 1.0 - 1.0 / np.sqrt(2.0)
DENSE = 60
"""Pencils with fewer differential rows are solved densely."""
SURVIVAL_STEPS = 100
"""Steps after which the leading disturbance alone is left."""


@dataclass(frozen=True)
class Pencil:
    """`J` and `M`, (n, n); rows from `first` on are differential, those before are algebraic."""

    J: sp.csc_array
    M: sp.csc_array
    first: int
    rank: Order | None = None


def rightmost(pencil: Pencil, step: float, solver: LinearSolver) -> complex:
    """Eigenvalue `s` with the largest real part among those that a time step `step` resolves.

    Raises
    ------
    SingularMatrixError
        A constrained state without tangent.
    """
    n, first = pencil.J.shape[0], pencil.first
    factor = solver.factor(sp.csc_array(pencil.M + GAMMA * step * pencil.J), pencil.rank)
    count = n - first

    mass_rows = sp.csr_array(pencil.M[first:])

    def advance(mass: Array) -> Array:
        stored: Array = mass_rows @ sdirk(mass_rows, factor, mass)
        return stored

    if count <= DENSE:
        values, vectors = la.eig(np.column_stack([advance(column) for column in np.eye(count)]))
    else:
        operator = spla.LinearOperator((count, count), matvec=advance, dtype=float)
        values, vectors = leading(operator, count)
    best = int(np.argmax(np.abs(values)))
    return rayleigh(pencil, sdirk(mass_rows, factor, vectors[:, best]))


def leading(operator: spla.LinearOperator, count: int) -> tuple[Array, Array]:
    """The eigenvalue of largest magnitude; where several crowd, the state that many steps leave over."""
    start = np.random.default_rng(0).standard_normal(count)
    try:
        return spla.eigs(operator, k=1, which="LM", v0=start, ncv=min(20, count - 1), tol=1e-2, maxiter=4)  # type: ignore[no-any-return]
    except spla.ArpackNoConvergence as failure:
        if len(failure.eigenvalues):
            return failure.eigenvalues, failure.eigenvectors
    return survivor(operator, start)


def survivor(operator: spla.LinearOperator, state: Array) -> tuple[Array, Array]:
    """What is left of `state` after many steps, as if it were an eigenvector: its growth is the leading one's."""
    growth = 1.0
    for _ in range(SURVIVAL_STEPS):
        ahead = operator.matvec(state)
        growth = float(np.linalg.norm(ahead) / np.linalg.norm(state))
        state = ahead / np.linalg.norm(ahead)
    return np.array([growth]), state[:, None]


def sdirk(mass_rows: sp.csr_array, factor: Factor, mass: Array) -> Array:
    """State after one step (E2) from the stored mass `mass`, (n,); `mass_rows` are the differential rows of `M`."""
    algebraic = np.zeros(mass_rows.shape[1] - len(mass))

    def stage(stored: Array) -> Array:
        return apart(factor.solve, np.concatenate([algebraic, stored]))

    rate = (mass_rows @ stage(mass) - mass) / GAMMA
    return stage(mass + (1.0 - GAMMA) * rate)


def rayleigh(pencil: Pencil, u: Array) -> complex:
    """`s` of the eigenvector `u` (E3), from the differential rows."""
    mass = (pencil.M @ u)[pencil.first :]
    force = (pencil.J @ u)[pencil.first :]
    return complex(-np.vdot(mass, force) / np.vdot(mass, mass))
