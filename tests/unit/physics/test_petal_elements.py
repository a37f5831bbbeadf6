"""Petals of cubic elements against closed forms: `reference/d1_petal_strip.csv` at fourth order, loads within them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.petal_elements import (
    PetalElements,
    clamped_beam,
    clamped_beam_bend,
    clamped_beam_own,
    clamped_beam_slope,
    clamped_beam_twist,
)
from tests.verification.shell_helpers import table

Array = NDArray[np.float64]

ROWS = table("d1_petal_strip")
ELEMENTS = (4, 8, 16)


def strip(angle: float, elements: int, k: float, *, clamped: bool = True) -> PetalElements:
    """A strip of unit width, metric radius and rigidity, `R_p = 1/k`."""
    bend_radius = 1.0 / k if k else math.inf
    return PetalElements(np.linspace(0.0, angle, elements + 1), 1.0, 1.0, bend_radius, 1.0, clamped)


def unit_pressure(one: PetalElements) -> Array:
    """Generalised forces of a unit pressure, integrated exactly."""
    h, full = one.element_angle, np.zeros(2 * len(one.phi))
    for element, length in enumerate(h):
        full[2 * element : 2 * element + 4] += length * np.array([0.5, length / 12.0, 0.5, -length / 12.0])
    return np.asarray(one.nodal.T @ full)


def tip(one: PetalElements, force: Array) -> float:
    """Deflection of the free edge under generalised forces."""
    return float(np.linalg.solve(one.stiffness.toarray(), force)[-2])


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"k={row['k=r/Rp']}, {row['phi1']} rad")
def test_strips_converge_at_fourth_order(row: dict[str, str]) -> None:
    angle, k = float(row["phi1"]), float(row["k=r/Rp"])
    errors = []
    for elements in ELEMENTS:
        one = strip(angle, elements, k)
        pulled = np.zeros(one.nodal.shape[1])
        pulled[-2] = 1.0
        found = np.array([tip(one, unit_pressure(one)), tip(one, pulled)])
        exact = np.array([float(row["w_tip_uniform*D/(q r^4)"]), float(row["w_tip_lineload*D/(F r^3)"])])
        errors.append(np.abs(found / exact - 1.0))
    assert np.all(errors[-1] <= 1e-5)
    for coarse, fine in pairwise(errors):
        assert np.all((fine <= coarse / 12.0) | (fine <= 1e-10))


@pytest.mark.parametrize(
    ("derivative", "of", "by_load"),
    [(clamped_beam_slope, clamped_beam, False), (clamped_beam_bend, clamped_beam_slope, False),
     (clamped_beam_twist, clamped_beam_slope, True)],
)  # fmt: skip
def test_derivatives_of_a_clamped_beam(derivative: object, of: object, by_load: bool) -> None:
    """Central differences on both sides of the load."""
    assert callable(derivative)
    assert callable(of)
    step, s, t = 1e-6, np.array([0.1, 0.3, 0.7, 0.9]), np.array([0.6, 0.5, 0.4, 0.2])
    up, down = ((s, t + step), (s, t - step)) if by_load else ((s + step, t), (s - step, t))
    assert_allclose(derivative(s, t), (of(*up) - of(*down)) / (2.0 * step), rtol=1e-7, atol=1e-12)


def test_a_clamped_beam_is_symmetric_and_bends_under_its_own_load() -> None:
    """`b(t, t) = u^3 / 3` with `u = t (1 - t)`."""
    s, t = np.array([0.2, 0.5, 0.8]), np.array([0.4, 0.5, 0.1])
    assert_allclose(clamped_beam(s, t), clamped_beam(t, s), rtol=1e-14)
    assert_allclose(clamped_beam(t, t), (t * (1.0 - t)) ** 3 / 3.0, rtol=1e-14)
    assert_allclose(clamped_beam_own(t), (clamped_beam(t, t), clamped_beam_slope(t, t)), rtol=1e-14, atol=1e-18)


def test_values_and_slopes_of_an_element_at_once() -> None:
    """The same weights as those of curve and slope one by one."""
    element, t, length = np.array([2, 0, 1]), np.array([0.3, 0.0, 1.0]), np.array([0.5, 0.7, 0.2])
    columns, weights = hermite.entries_with_slopes(element, t, length)
    for k in range(2):
        own, alone = hermite.entries(element, t, length, k)
        assert_allclose(columns, own, rtol=0.0)
        assert_allclose(weights[:, k], alone, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("place", [0.13, 0.5, 0.77])
def test_a_load_inside_an_element_is_carried_exactly(place: float) -> None:
    """Straight cantilever: `w(x) = x^2 (3 l - x) / 6` under a unit load at `l`, here at the load itself."""
    one = strip(1.0, 3, 0.0)
    element, t = hermite.located(np.array([place]), one.phi)
    row = hermite.rows(element, t, one.element_angle) @ one.nodal
    w = np.linalg.solve(one.stiffness.toarray(), row.toarray()[0])
    whole = (row @ w)[0] + one.point_compliance[element[0]] * clamped_beam(t, t)[0]
    assert_allclose(whole, place**3 / 3.0, rtol=1e-12)
