"""Small dense linear complementarity problems: `w = M z + q`, `0 <= w` complementary to `z >= 0`."""

from __future__ import annotations

import warnings

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from petalfoil.solvers.problem import fraction_to_boundary

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

SWAPS = 30
"""Set changes that principal pivoting may take before an interior point looks for the set instead."""

INTERIOR_STEPS = 60
"""An interior point takes 10 to 20."""


def solve_lcp(M: Array, q: Array, guess: Mask) -> Array | None:
    """`z` (k,), or None if neither way finds one.

    Parameters
    ----------
    M : (k, k) array
        The matrix; positive semi-definite or close to it.
    q : (k,) array
        The constant part of `w`.
    guess : (k,) bool array
        Where `z` is thought to be positive.
    """
    z = swap(M, q, guess)
    return swap(M, q, interior_set(M, q)) if z is None else z


def swap(M: Array, q: Array, guess: Mask) -> Array | None:
    """Principal pivoting by whole sets: fast near the answer, None where the sets return."""
    basic, seen = guess.copy(), set[bytes]()
    for _ in range(SWAPS):
        z = np.zeros_like(q)
        if basic.any():
            pivot = _solve(M[np.ix_(basic, basic)], -q[basic])
            if pivot is None:
                return None
            z[basic] = pivot
        w = M @ z + q
        wanted = np.where(basic, z > -_tiny(z), w < -_tiny(q))
        if np.array_equal(wanted, basic):
            return np.maximum(z, 0.0)
        key = np.packbits(wanted).tobytes()
        if key in seen:
            return None
        seen.add(key)
        basic = wanted
    return None


def _solve(block: Array, rhs: Array) -> Array | None:
    """Solve with a principal block, the shortest solution where it is singular; None where there is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", la.LinAlgWarning)
        try:
            solution: Array = la.solve(block, rhs)
            return solution
        except (la.LinAlgError, la.LinAlgWarning):
            pass
    shortest: Array = la.lstsq(block, rhs)[0]
    return shortest if np.max(np.abs(block @ shortest - rhs)) <= 1e-9 * np.max(np.abs(rhs)) else None


def _tiny(values: Array) -> float:
    return 1e-12 * max(float(np.max(np.abs(values), initial=0.0)), 1e-300)


def interior_set(M: Array, q: Array) -> Mask:
    """Where `z` is positive in the answer, from an interior point: no set travels, whatever the guess."""
    k = len(q)
    size = max(float(np.max(np.abs(q))), 1e-300)
    z, w = np.full(k, size / max(float(np.max(np.abs(M))), 1e-300)), np.full(k, size)
    for _ in range(INTERIOR_STEPS):
        mu = float(z @ w) / k
        off = M @ z + q - w
        if mu < 1e-12 * size * float(z.max()) and float(np.max(np.abs(off))) < 1e-9 * size:
            break
        step = _interior_step(M, (z, w, off), mu)
        if step is None:
            break  # there is no answer to follow: any set will do, and swapping will refuse it
        (dz, dw), reach = step
        z, w = z + reach * dz, w + reach * dw
    return z > w


def _interior_step(M: Array, at: tuple[Array, Array, Array], mu: float) -> tuple[tuple[Array, Array], float] | None:
    """Predictor and corrector with one factorisation, and how far they reach; None where they lead nowhere."""
    z, w, off = at
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", la.LinAlgWarning)  # the step below is looked at instead
        factor = la.lu_factor(M + np.diag(w / z), check_finite=False)
    aim = np.zeros_like(z)
    for corrector in (False, True):
        dz = la.lu_solve(factor, -off + (aim - z * w) / z, check_finite=False)
        if not np.all(np.isfinite(dz)):
            return None
        dw = M @ dz + off
        reach = min(1.0, 0.99 * fraction_to_boundary(z, dz), 0.99 * fraction_to_boundary(w, dw))
        if not corrector:
            share = float((z + reach * dz) @ (w + reach * dw)) / len(z) / mu
            aim = share**3 * mu - dz * dw
    return (dz, dw), reach
