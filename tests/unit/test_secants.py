"""Steps bettered by those before them (C15)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.secants import REMEMBERED, Secants

Array = NDArray[np.float64]

rng = np.random.default_rng(5)
N = 12
B = np.diag(rng.uniform(1.0, 2.0, N)) + 0.1 * rng.standard_normal((N, N))
"""The tangent at hand."""


def residuals(J: Array, b: Array, count: int, secants: Secants | None) -> list[float]:
    """Norms of `b - J x` from zero on, `count` steps with `B`."""
    x, left = np.zeros(N), []
    for _ in range(count):
        asked = np.linalg.solve(B, b - J @ x)
        x = x + (asked if secants is None else secants.bettered(x, asked))
        left.append(float(np.linalg.norm(b - J @ x)))
    return left


def test_a_tangent_that_misses_two_directions_is_learnt_in_two_steps_more() -> None:
    """`B^-1 J` is the identity but for a matrix of rank two: a space of three steps holds the solution."""
    b = rng.standard_normal(N)
    J = B + 0.4 * rng.standard_normal((N, REMEMBERED)) @ rng.standard_normal((REMEMBERED, N))
    assert residuals(J, b, 4, Secants())[-1] < 1e-9 * np.linalg.norm(b)
    assert residuals(J, b, 4, None)[-1] > 1e-3 * np.linalg.norm(b)


def test_with_the_tangent_itself_a_step_is_newtons() -> None:
    """What the factor asks for is the step, and nothing is left for the next."""
    b = rng.standard_normal(N)
    assert residuals(B, b, 2, Secants())[-1] < 1e-13 * np.linalg.norm(b)


def test_the_last_steps_are_remembered() -> None:
    """No more than `REMEMBERED`."""
    secants = Secants()
    residuals(B + 0.2 * rng.standard_normal((N, N)), rng.standard_normal(N), REMEMBERED + 4, secants)
    assert len(secants.differences) == REMEMBERED
