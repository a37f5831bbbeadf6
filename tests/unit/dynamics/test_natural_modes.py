"""A mode whose impedance is rounded is told, as far as rounding lets it be known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.dynamics.natural_modes import polished
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia

MASS, STIFFNESS, SPEED = 2.0, np.diag([1.0e6, 1.3e6]), 1800.0


class Rounded:
    """Springs whose impedance is another in its last digits every time that it is asked for."""

    motion = SimpleNamespace(loss=None)

    def __init__(self, rounding: float) -> None:
        self.noise, self.rounding = np.random.default_rng(0), rounding

    def with_derivative(self, _: complex) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Springs do not depend on the rate of change."""
        wrong = 1.0 + self.rounding * self.noise.uniform(0.5, 1.0) * self.noise.choice([-1.0, 1.0])
        return (wrong * STIFFNESS).astype(complex), np.zeros((2, 2), dtype=complex)


def frequency(rounding: float) -> float | None:
    """Natural frequency nearest to 700 rad/s on springs with a relative rounding; None where none is found."""
    mode = polished(cast(Impedance, Rounded(rounding)), (Inertia.of_mass(MASS), SPEED), 700.0j / SPEED)
    return None if mode is None else mode.s.imag * SPEED


def test_a_mode_is_told_to_the_rounding_of_its_impedance() -> None:
    assert_allclose(frequency(0.0), np.sqrt(STIFFNESS[0, 0] / MASS), rtol=1e-12)
    assert_allclose(frequency(2e-8), np.sqrt(STIFFNESS[0, 0] / MASS), rtol=2e-8)


def test_an_impedance_that_changes_visibly_has_no_mode() -> None:
    assert frequency(1e-4) is None
