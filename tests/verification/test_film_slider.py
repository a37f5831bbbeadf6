"""Sliders, infinitely wide: a taper without a step, and Rayleigh's step (`reference/README.md`)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import quad

from petalfoil.physics.forces import viscous_torque
from petalfoil.physics.reynolds import axial_flux, circumferential_flux
from tests.verification.film_helpers import orders, slider, solve_film, stepped_slider, table

Array = NDArray[np.float64]

DECLARED_ORDER = 2.0
MARGIN = 0.1


def peak(P: Array) -> float:
    """Peak pressure, by the parabola through the highest node and its neighbours."""
    i = int(np.argmax(P))
    left, top, right = P[i - 1 : i + 2]
    return float(top - (right - left) ** 2 / (8.0 * (left - 2.0 * top + right)))


def taper(row: dict[str, str], cells: int) -> Array:
    """(load, peak pressure, friction) of a taper slider, each over its reference."""
    a, Lam = float(row["a=h1/h2"]), float(row["Lam"])
    balance = slider(cells)
    H = a - (a - 1.0) * balance.mesh.phi[None, :, None]
    P = solve_film(balance, H, Lam)
    load = np.sum((P - 1.0) * balance.area)
    # in units of p_a and h2, `mu U = Lam / 6`; friction is told over `mu U B / h2`
    friction = viscous_torque(balance.mesh, 1.0, (P, H), (Lam / 6.0, 1.0)) * 6.0 / Lam
    references = [float(row[name]) for name in ("W/(pa*B)", "pmax/pa", "F/(mu*U*B/h2)")]
    return np.array([load, peak(P[0, :, 0]), friction]) / references


@pytest.mark.parametrize("row", table("a1_slider_taper.csv"), ids=lambda r: f"a={r['a=h1/h2']} Lam={r['Lam']}")
def test_taper_slider(row: dict[str, str]) -> None:
    """Within 0.1 % on 256 cells (on 1024 past `Lam = 100`: the outlet layer is `1 / Lam` thick), second order."""
    coarsest = 256 if float(row["Lam"]) <= 100.0 else 1024
    errors = np.array([taper(row, coarsest * refine) for refine in (1, 2, 4)]) - 1.0
    assert_allclose(errors[0], 0.0, rtol=0.0, atol=1e-3)
    assert np.all(orders(errors[:, 0]) >= DECLARED_ORDER - MARGIN), "load"
    assert np.all(orders(errors[:, 2]) >= DECLARED_ORDER - MARGIN), "friction"
    # the peak's error changes sign with Lam, so that it has no clean order: it is bounded on the finest grid
    assert_allclose(errors[2, 1], 0.0, rtol=0.0, atol=1e-3 / 2.0 ** (2.0 * (DECLARED_ORDER - MARGIN)))


@pytest.mark.parametrize("ratio", [0.02, 0.5, 1.0, 1.7, 40.0])
def test_one_cell_lets_as_much_pass_as_a_linear_film(ratio: float) -> None:
    """Under pressure alone `(P0^2 - P1^2) / 2` over the integral of `H^-3`, whatever the thicknesses; both ways."""
    (H0, H1), (P0, P1), width = (0.7, 0.7 * ratio), (1.0, 1.6), 0.3
    resistance = quad(lambda x: (H0 + (H1 - H0) * x) ** -3, 0.0, 1.0, epsabs=0.0, epsrel=1e-12)[0] * width
    passes = 0.5 * (P0**2 - P1**2) / resistance
    P, H = np.array([P0, P1]), np.array([H0, H1])
    along = circumferential_flux(P[None, :, None], H[None, :, None], 0.0, np.array([[width]]))
    across = axial_flux(P[None, None, :], H[None, None, :], np.array([width]))
    assert_allclose([along.value.item(), across.value.item()], passes, rtol=1e-11)


def step(row: dict[str, str], refine: int) -> Array:
    """(load, pressure at the step) of a step slider, each over its reference."""
    a, edge, Lam = (float(row[name]) for name in ("a=h1/h2", "b=x_step/B", "Lam"))
    balance = stepped_slider(edge, 128, refine)
    H = np.ones(balance.mesh.shape)
    H[0] = a
    P = solve_film(balance, H, Lam)
    load = np.sum((P - 1.0) * balance.area)
    return np.array([load / float(row["W/(pa*B)"]), P[1, 0, 0] / float(row["p_step/pa"])])


@pytest.mark.parametrize(
    "row", table("a1_slider_step.csv"), ids=lambda r: f"a={r['a=h1/h2']} b={r['b=x_step/B']} Lam={r['Lam']}"
)
def test_rayleigh_step(row: dict[str, str]) -> None:
    """Within 0.05 % on 256 cells of the whole length, second order across the jump of the film."""
    errors = np.array([step(row, refine) for refine in (1, 2, 4)]) - 1.0
    assert_allclose(errors[1], 0.0, rtol=0.0, atol=5e-4)
    assert np.all(orders(errors[:, 0]) >= DECLARED_ORDER - MARGIN), "load"
    if np.abs(errors[0, 1]) > 1e-7:  # else the table's digits and rounding are all that is left
        assert np.all(orders(errors[:, 1]) >= DECLARED_ORDER - MARGIN), "pressure at the step"


def test_the_step_is_not_smeared() -> None:
    """A film that is averaged at the step's node falls to first order: what the tests above would not let pass."""
    row = next(
        r for r in table("a1_slider_step.csv") if (r["a=h1/h2"], r["b=x_step/B"], r["Lam"]) == ("2", "0.5", "10")
    )
    errors = []
    for cells in (64, 128):
        balance, smeared = slider(cells), np.where(np.arange(cells + 1) < cells // 2, 2.0, 1.0)
        smeared[cells // 2] = 1.5
        load = np.sum((solve_film(balance, smeared[None, :, None], 10.0) - 1.0) * balance.area)
        errors.append(load / float(row["W/(pa*B)"]) - 1.0)
    assert orders(errors)[0] < 1.2
    assert abs(errors[1]) > 20.0 * abs(step(row, 1)[0] - 1.0)
