"""One strip of a petal against closed forms: `reference/d1_petal_strip.csv`. Bending is second order."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from petalfoil.physics.shell import PetalShell, bending_stress
from petalfoil.solvers.contact_newton import ActiveContacts
from tests.verification.shell_helpers import (
    GRIDS,
    UNIT,
    Array,
    bend,
    orders,
    polish,
    rows_of,
    strip_shell,
    strips_problem,
    table,
    uniform_grid,
    uniform_load,
)

CELLS = (16, 32, 64)
BOUND = 5e-4
"""Relative error at 64 cells: a strip (uniform), a pitch (pack)."""
BOUNDS = {"w_tip_moment*D/(m0 r^2)": 1.2e-3}
"""The moment bends the last half cell, which carries no energy, and turns it most where `k` is large."""
ROWS = table("d1_petal_strip")
POISSON = 0.3  # of `strip_shell`

# `r = D = q = F = m0 = 1`, so that the columns of the table are deflections, moments and forces themselves.


def pressed(phi: Array, k: float) -> Array:
    shell = strip_shell(phi, k)
    return bend(shell, uniform_load(shell))[:, 0]


def pulled(phi: Array, k: float) -> Array:
    force = np.zeros((len(phi), 1))
    force[-1] = 1.0
    return bend(strip_shell(phi, k), force)[:, 0]


def turned(phi: Array, k: float) -> Array:
    """A tip moment does its work on the tip's rotation, here the one-sided difference of second order.

    (A couple on the last two nodes turns the strip half a cell short of its tip: first order.)
    """
    force = np.zeros((len(phi), 1))
    force[-3:, 0] = np.array([0.5, -2.0, 1.5]) / (phi[-1] - phi[-2])
    return bend(strip_shell(phi, k), force)[:, 0]


def propped(phi: Array, k: float, *, clamped: bool) -> ActiveContacts:
    """The tip held by a contact whose gap is zero: the active set alone knows that."""
    shell = strip_shell(phi, k, clamped=clamped)
    n = len(phi) - 1
    G = rows_of(n, ([n - 1], -1.0))
    problem = strips_problem([shell], [uniform_load(shell)[1:, 0]], G, np.zeros(1))
    answer, outcome, _ = polish(problem, np.zeros(n), np.array([True]))
    assert answer is not None, outcome.value
    return answer


def middle(phi: Array, W: Array) -> float:
    return float(CubicSpline(phi, W)(0.5 * phi[-1]))


def root_moment(phi: Array, k: float) -> float:
    return float(strip_shell(phi, k).curvatures(pressed(phi, k)[:, None])[0][0, 0])


def prop_reaction(phi: Array, k: float) -> float:
    return float(propped(phi, k, clamped=True).lam[0] * phi[-1] / (len(phi) - 1))


def hinged_middle(phi: Array, k: float) -> float:
    W = np.append(0.0, propped(phi, k, clamped=False).x) * UNIT
    return middle(phi, W)


QUANTITIES: dict[str, Callable[[Array, float], float]] = {
    "w_tip_uniform*D/(q r^4)": lambda phi, k: pressed(phi, k)[-1],
    "w_mid_uniform*D/(q r^4)": lambda phi, k: middle(phi, pressed(phi, k)),
    "M_root/(q r^2)": root_moment,
    "w_tip_lineload*D/(F r^3)": lambda phi, k: pulled(phi, k)[-1],
    "w_mid_tipload*D/(F r^3)": lambda phi, k: middle(phi, pulled(phi, k)),
    "w_tip_moment*D/(m0 r^2)": lambda phi, k: turned(phi, k)[-1],
    "prop_reaction/(q r)": prop_reaction,
    "hinged_propped_mid*D/(q r^4)": hinged_middle,
}


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_every_row_of_the_table(quantity: str, grid: str) -> None:
    for row in ROWS:
        k, phi1, exact = float(row["k=r/Rp"]), float(row["phi1"]), float(row[quantity])
        errors = [QUANTITIES[quantity](GRIDS[grid](phi1, cells), k) / exact - 1.0 for cells in CELLS]
        where = f"k = {k}, phi1 = {phi1}"
        assert abs(errors[-1]) < BOUNDS.get(quantity, BOUND), where
        rounding = abs(errors[0]) < 1e-8  # a straight strip's moments are statics alone: exact on any grid
        assert rounding or orders(errors).min() > 1.9, f"{where}: {errors}"


@pytest.mark.parametrize("grid", GRIDS)
def test_deflection_and_moment_along_the_strip(grid: str) -> None:
    k, phi1 = 0.64, 1.8
    errors = []
    for cells in CELLS:
        phi = GRIDS[grid](phi1, cells)
        shell, W = strip_shell(phi, k), pressed(phi, k)
        w = 1.0 - np.cos(k * phi) + 0.5 * k * phi * np.sin(k * (phi1 - phi))
        w = (w - 0.5 * np.sin(k * phi1) * np.sin(k * phi)) / k**4
        M = (1.0 - np.cos(k * (phi1 - phi))) / k**2
        chi = shell.curvatures(W[:, None])[0][:, 0]
        errors.append([np.abs(W - w).max() / w.max(), np.abs(chi - M).max() / M.max()])
    assert max(errors[-1]) < BOUND
    assert orders(np.array(errors)).min() > 1.9


@pytest.mark.parametrize("grid", GRIDS)
def test_moment_along_a_propped_hinged_strip(grid: str) -> None:
    k, phi1 = 0.64, 1.8
    errors = []
    for cells in CELLS:
        phi = GRIDS[grid](phi1, cells)
        shell = strip_shell(phi, k, clamped=False)
        W = np.append(0.0, propped(phi, k, clamped=False).x) * UNIT
        M = (1.0 - np.cos(k * phi) - np.tan(0.5 * k * phi1) * np.sin(k * phi)) / k**2
        chi = shell.curvatures(W[:, None])[0][:, 0]
        errors.append(np.abs(chi - M).max() / np.abs(M).max())
    assert errors[-1] < 1e-3
    assert orders(errors).min() > 1.9


def test_root_stress_is_six_times_the_moment_over_the_thickness_squared() -> None:
    """`sigma = E / (1 - nu^2) delta0 / 2 chi = 6 M / delta0^2`, an SI petal under 1 kPa."""
    row = next(r for r in ROWS if (float(r["k=r/Rp"]), float(r["phi1"])) == (0.64, 1.8))
    E, delta, r, q = 200e9, 0.176e-3, 26e-3, 1e3
    D = E * delta**3 / 12.0 / (1.0 - POISSON**2)
    unit = strip_shell(uniform_grid(1.8, 64), 0.64)
    shell = PetalShell(unit.phi, unit.axial, r, r / 0.64, D, POISSON, clamped=True)
    W = bend(shell, q * uniform_load(shell))
    stress = bending_stress(shell, W, E, delta)
    assert_allclose(stress[0, 0], 6.0 * float(row["M_root/(q r^2)"]) * q * r**2 / delta**2, rtol=5e-5)
    assert_allclose(stress[-1, 0], 0.0, atol=0.0)
