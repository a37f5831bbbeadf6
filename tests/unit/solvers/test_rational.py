"""Rational interpolation of matrix functions, and the modes of a mass on them."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.reduced_model import PRECISION, Rational

Complex = NDArray[np.complex128]

AXIS = 1j * np.concatenate([-np.linspace(0.05, 3.0, 30), np.linspace(0.05, 3.0, 30)])
STIFF = np.array([[2.0, 0.3], [-0.3, 1.0]])
DAMPED = np.array([[0.4, 0.05], [0.0, 0.2]])


def at(s: complex) -> Complex:
    """A spring and a damper, and a damper behind a spring (a pole at -0.7)."""
    return STIFF + s * DAMPED + 0.5 * s / (s + 0.7) * np.eye(2)


def test_what_is_rational_is_found_off_the_axis_too() -> None:
    R = Rational.fit(AXIS, np.array([at(s) for s in AXIS]))
    assert len(R.z) <= 5
    for s in (0.3 + 1.1j, -0.3 + 0.2j, 2.0 + 0j):
        assert_allclose(R.at(s), at(s), rtol=0.0, atol=10.0 * PRECISION)


def test_modes_are_those_of_the_companion_matrix() -> None:
    """`mass s^2 + K + s C + k s / (s + r)`: with the inner damper's position a plain eigenvalue problem."""
    mass, one, none = 1.7, np.eye(2), np.zeros((2, 2))
    found = Rational.fit(AXIS, np.array([at(s) for s in AXIS])).modes(mass)
    # s v = u,  mass s u = -(K + k) v - C u + k q,  s q = r (v - q): q follows v behind the spring k
    companion = np.block(
        [
            [none, one, none],
            [-(STIFF + 0.5 * one) / mass, -DAMPED / mass, 0.5 * one / mass],
            [0.7 * one, none, -0.7 * one],
        ]
    )
    for wanted in np.linalg.eigvals(companion):
        assert np.min(np.abs(found - wanted)) < 1e-6


def test_a_function_that_is_not_rational_is_met_on_the_axis() -> None:
    values = np.array([[[np.tanh(np.sqrt(s + 1.0))]] for s in AXIS])
    R = Rational.fit(AXIS, values)
    between = 1j * np.linspace(0.1, 2.9, 57)
    errors = [abs(R.at(s)[0, 0] - np.tanh(np.sqrt(s + 1.0))) for s in between + 1e-3]
    assert max(errors) < 1e-6
