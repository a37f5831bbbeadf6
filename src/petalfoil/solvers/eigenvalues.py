"""Rightmost eigenvalue of `J u = -s M u` (E1) with a singular `M`: whether a disturbance dies out.

Algebraic rows (a wall without mass) make `M` singular and put eigenvalues at infinity. The pencil is therefore seen
through one implicit Euler step, `theta = 1 / (1 - h s)` (E2), (E3): infinity goes to zero, and what lies nearest to
`1 / h`, on the side of growth, becomes largest. Arnoldi's method finds those first, one solve a step with one
factorisation; it goes on until the rightmost of what it sees has settled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.constraints import apply_to_parts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.sparsity import Order

Array = NDArray[np.float64]

LEAST, MOST, EVERY = 16, 80, 8
"""Steps before the first test of convergence, at most, and between tests. Random bearings need 16 to 64 of them, 29 in
the mean."""

SETTLED = 1e-3
"""Relative residual in `theta` of a settled eigenvalue."""

UNSEEN = 1e-6
"""Eigenvalues `theta` below this are those at infinity, rounded: growth rates below `-1e6 / h` are given as that."""

EXHAUSTED = 1e-12
"""Part of a step outside the space, over the step, below which it is rounding: the space is invariant."""


@dataclass(frozen=True)
class Pencil:
    """`J` and `M`, (n, n); rows from `first` on are differential, those before are algebraic."""

    J: sp.csc_array
    M: sp.csc_array
    first: int
    order: Order | None = None


def rightmost(pencil: Pencil, step: float, solver: LinearSolver) -> complex:
    """Eigenvalue `s` with the largest real part, of those that a time step `step` resolves.

    Raises
    ------
    SingularMatrixError
        A constrained state without tangent.
    """
    first = pencil.first
    factor = solver.factor(sp.csc_array(pencil.M + step * pencil.J), pencil.order)
    mass_rows, algebraic = sp.csr_array(pencil.M[first:]), np.zeros(first)

    def advance(mass: Array) -> Array:
        stored: Array = mass_rows @ apply_to_parts(factor.solve, np.concatenate([algebraic, mass]))
        return stored

    return arnoldi(advance, np.random.default_rng(0).standard_normal(mass_rows.shape[0]), step)


def arnoldi(advance: Callable[[Array], Array], start: Array, step: float) -> complex:
    """The rightmost `s` whose implicit Euler step `advance` maps mass to mass, from Krylov spaces of `start`."""
    count = len(start)
    most = min(MOST, count)
    space, H = np.zeros((count, most + 1), order="F"), np.zeros((most + 1, most))
    space[:, 0] = start / np.linalg.norm(start)
    for size in range(1, most + 1):
        seen, ahead = space[:, :size], advance(space[:, size - 1])
        whole = float(np.linalg.norm(ahead))
        for _ in range(2):  # Gram-Schmidt, again for what rounding left
            share = seen.T @ ahead
            ahead = ahead - seen @ share
            H[:size, size - 1] += share
        H[size, size - 1] = rest = float(np.linalg.norm(ahead))
        ended = size == most or rest <= EXHAUSTED * whole
        if ended or (size >= LEAST and (size - LEAST) % EVERY == 0):
            s, residual = leading(H[:size, :size], rest, step)
            if ended or residual <= SETTLED:
                return s
        space[:, size] = ahead / rest
    raise AssertionError("the last step returns")


def leading(H: Array, rest: float, step: float) -> tuple[complex, float]:
    """Rightmost eigenvalue that the Krylov space of `H` sees, and its relative residual in `theta`."""
    theta, vectors = la.eig(H)
    theta = np.where(np.abs(theta) > UNSEEN, theta, UNSEEN)
    s = (1.0 - 1.0 / theta) / step
    best = int(np.argmax(s.real))
    return complex(s[best]), rest * abs(vectors[-1, best]) / abs(theta[best])
