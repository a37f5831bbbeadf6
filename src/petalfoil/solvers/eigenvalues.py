"""Rightmost eigenvalue of `J u = -s M u` (E1) with a singular `M`: whether a disturbance dies out.

Algebraic rows (a wall without mass) make `M` singular and put eigenvalues at infinity. The pencil is therefore seen
through `J^-1`, `theta = -1 / s` (E2), (E3): infinity goes to zero, and what grows or decays slowest becomes largest.
Arnoldi's method finds those first, one solve a step with one factorisation; it goes on until the rightmost of what it
sees has settled. Where that of a neighbour is known, the pencil is seen from a point between it and zero, from which
eigenvalues that lie close together stand farther apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.sparsity import Order, SparseRows

Array = NDArray[np.float64]

LEAST, MOST, EVERY = 16, 80, 8
"""Steps before the first test of convergence, at most, and between tests. Random bearings need 16 to 64 of them, 30 in
the mean."""

LEAST_NEAR, EVERY_NEAR = 12, 4
"""The same seen from near a neighbour's eigenvalue."""

CLOSER = 0.85
"""Place from which the pencil is seen, over the real part of a neighbour's eigenvalue. Eight petals in 3-D, points
20 um apart: 55 steps from zero, 32, 24 and 18 from 0.7, 0.85 and 0.95; the nearer, the easier the rightmost comes to
lie on its other side, and all is to be done again from zero."""

SETTLED = 1e-6
"""Relative residual in `theta` of a settled eigenvalue. Those of petals lie close together: with 1e-3 the second was
taken for the rightmost in one random bearing of six."""

UNSEEN = 1e-7
"""Eigenvalues `theta` below this are those at infinity, rounded: growth rates below -1e7 are given as that."""

EXHAUSTED = 1e-12
"""Part of a step outside the space, over the step, below which it is rounding: the space is invariant."""


@dataclass(frozen=True)
class Pencil:
    """`J` and `M`, (n, n); the rows `stores` are differential, the others algebraic."""

    J: sp.csc_array
    M: sp.csc_array
    stores: slice
    order: Order | None = None


def rightmost(pencil: Pencil, solver: LinearSolver, near: float = 0.0) -> complex:
    """Eigenvalue `s` with the largest real part.

    `near` is the real part of a neighbour's, 0 where none is known.

    Raises
    ------
    SingularMatrixError
        A constrained state without tangent.
    """
    place = CLOSER * min(near, 0.0)
    if place:
        found = seen_from(place, pencil, solver)
        if found.real <= place:
            return found
    return seen_from(0.0, pencil, solver)


def seen_from(place: float, pencil: Pencil, solver: LinearSolver) -> complex:
    """The same by Krylov spaces of the inverse of `J + place M`; of those near this `place`."""
    matrix = sp.csc_array(pencil.J + place * pencil.M) if place else pencil.J
    return seen_through(solver.factor(matrix, pencil.order).solve, pencil, place)


def seen_through(solve: Callable[[Array], NDArray[Any]], pencil: Pencil, place: float = 0.0) -> complex:
    """The same by what solves with `J + place M`, or nearly: then the pencil is that of the matrix it solves with."""
    mass_rows = SparseRows(sp.csr_array(pencil.M)[pencil.stores])

    def held(mass: Array) -> Array:
        whole = np.zeros(mass_rows.shape[1])
        whole[pencil.stores] = mass
        stored: Array = mass_rows @ solve(whole)
        return stored

    return arnoldi(held, np.random.default_rng(0).standard_normal(mass_rows.shape[0]), place)


def arnoldi(held: Callable[[Array], Array], start: Array, place: float = 0.0) -> complex:
    """The rightmost `s`, from Krylov spaces of `start`; `held` maps what leaves the film to what it then stores."""
    count = len(start)
    most = min(MOST, count)
    least, every = (LEAST_NEAR, EVERY_NEAR) if place else (LEAST, EVERY)
    space, H = np.zeros((count, most + 1), order="F"), np.zeros((most + 1, most))
    space[:, 0] = start / np.linalg.norm(start)
    for size in range(1, most + 1):
        seen, ahead = space[:, :size], held(space[:, size - 1])
        whole = float(np.linalg.norm(ahead))
        for _ in range(2):  # Gram-Schmidt, again for what rounding left
            share = seen.T @ ahead
            ahead = ahead - seen @ share
            H[:size, size - 1] += share
        H[size, size - 1] = rest = float(np.linalg.norm(ahead))
        ended = size == most or rest <= EXHAUSTED * whole
        if ended or (size >= least and (size - least) % every == 0):
            s, residual = leading(H[:size, :size], rest, place)
            if ended or residual <= SETTLED:
                return s
        space[:, size] = ahead / rest
    raise AssertionError("the last step returns")


def leading(H: Array, rest: float, place: float = 0.0) -> tuple[complex, float]:
    """Rightmost eigenvalue that the Krylov space of `H` sees from a `place`, and its relative residual.

    That is the residual in `theta` where the place is zero, and as much of `s` where it is not.
    """
    theta, vectors = la.eig(H)
    theta = np.where(np.abs(theta) > UNSEEN, theta, UNSEEN)
    s = place - 1.0 / theta
    best = int(np.argmax(s.real))
    relative = rest * abs(vectors[-1, best]) / abs(theta[best])
    return complex(s[best]), relative * abs(s[best] - place) / abs(s[best]) if place else relative
