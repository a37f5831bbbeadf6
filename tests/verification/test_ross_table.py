"""A table for ROSS tells the stability of a rigid rotor: its coefficients between the points of the table, as ROSS
interpolates them, in the equations of motion of a rotor with two degrees of freedom.

The case is a plain bearing as a user of ROSS has it, at 1.03 times its threshold speed: petalfoil's own linear response
gives a growth rate of 2.5 1/s in a whirl at 0.488 of the speed.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

import petalfoil
from petalfoil.case import Case
from petalfoil.results.ross import COARSE, ross_frequencies
from tests.cases import FAULTS

Array = NDArray[np.float64]

FASTEST = 40000.0 * math.pi / 30.0  # [rad/s], of the table
MASS = 15.0 / 9.81  # [kg]
SLOWEST = 400.0  # [rad/s], of the table


def growth(ds: xr.Dataset, frequency: float) -> complex:
    """Fastest growing eigenvalue [1/s] of the rotor, with coefficients at its own frequency; from a first guess."""
    axis, eigenvalue = ds["whirl_frequency"].values, 1j * frequency
    for _ in range(30):
        stiffness, damping = (at(ds[name].values, axis, eigenvalue.imag) for name in ("stiffness", "damping"))
        state = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / MASS, -damping / MASS]])
        whirls = [value for value in np.linalg.eigvals(state) if value.imag > 0.0]
        eigenvalue = complex(max(whirls, key=lambda value: value.real))
    return eigenvalue


def at(table: Array, axis: Array, frequency: float) -> Array:
    """A matrix of the table (frequency, row, column) at a frequency [rad/s]."""
    return np.array([[np.interp(frequency, axis, table[:, i, j]) for j in (0, 1)] for i in (0, 1)])


@pytest.fixture(scope="module")
def unstable() -> Case:
    """The bearing at 1.03 times its threshold speed."""
    changes = {"model.cells_per_pitch": 32, "model.axial_cells": 6}
    case = Case.load(FAULTS / "ross_half_speed_whirl.toml").replace(**changes)
    threshold = float(petalfoil.stability(case)["threshold_speed"])
    assert threshold == pytest.approx(895.1, rel=1e-3)
    return case.replace(**{"operation.speed": 1.03 * threshold})


@pytest.mark.slow
def test_the_default_table_tells_the_growth_rate(unstable: Case) -> None:
    speed = unstable.operation.speed
    own = petalfoil.stability(unstable)
    expected = complex(float(own["mode_growth_rate"][0]), float(own["natural_frequency"][0]))
    exact = growth(petalfoil.coefficients(unstable, speed * np.geomspace(0.45, 0.55, 40)), 0.5 * speed)
    found = growth(petalfoil.coefficients(unstable, ross_frequencies([SLOWEST, speed, FASTEST])), 0.5 * speed)
    assert found.real == pytest.approx(exact.real, rel=0.01)
    # Coefficients at real frequencies, as every such table has them, leave this much at small growth rates.
    assert abs(found - expected) < 0.01 * expected.imag
    assert 0.0 < found.real < 2.0 * expected.real


@pytest.mark.parametrize(("points", "stable"), [(12, True), (24, True), (80, False)])
def test_a_coarse_table_calls_an_unstable_rotor_stable(unstable: Case, points: int, stable: bool) -> None:
    """Equal steps up to the highest speed: 12 and 24 points are too few for a rotor that whirls at a tenth of it."""
    axis, speed = np.linspace(0.0, FASTEST, points), unstable.operation.speed
    found = growth(petalfoil.coefficients(unstable, axis), 0.5 * speed)
    assert (found.real < 0.0) is stable
    if stable:
        assert axis[1] / (0.5 * speed) > COARSE


def test_whirl_at_the_speed_tells_nothing_of_stability(unstable: Case) -> None:
    fast = unstable.replace(**{"operation.speed": FASTEST})
    assert float(petalfoil.stability(fast)["mode_growth_rate"][0]) > 400.0
    assert growth(petalfoil.coefficients(fast, [FASTEST]), FASTEST).real < -100.0
