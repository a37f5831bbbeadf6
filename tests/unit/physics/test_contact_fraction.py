"""The contact fraction is a share: between 0 and 1 whatever the film does (J3)."""

import numpy as np
import pytest

from petalfoil.physics.forces import contact_fraction

AREA = np.array([2e-4, 1e-4, 1e-4])  # m^2


def test_no_contact_is_no_share_even_under_suction() -> None:
    assert contact_fraction(0.0, np.array([-1e4, -1e4, -1e4]), AREA) == 0.0


def test_contact_against_a_film_that_sucks_everywhere_bears_all() -> None:
    assert contact_fraction(5.0, np.array([-1e4, -2e4, -3e4]), AREA) == 1.0


def test_suction_beside_pressure_does_not_count() -> None:
    """6 N of contact, 2 N of pressure, 3 N of suction: three quarters, not 6 / 5."""
    assert contact_fraction(6.0, np.array([1e4, -2e4, -1e4]), AREA) == pytest.approx(0.75)
