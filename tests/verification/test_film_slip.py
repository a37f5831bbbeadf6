"""Slip at the walls of the film (F7): the slow slider by quadrature, what a closed film conserves, friction."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import scipy.sparse.linalg as spla
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import quad

from petalfoil.analysis.check import check
from petalfoil.analysis.solve import solve
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.mesh.axial import axis_3d
from petalfoil.physics.forces import viscous_torque
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.physics.reynolds import axial_flux, circumferential_flux, mean_cube
from petalfoil.system.build import build_problem
from tests.cases import case
from tests.verification.film_helpers import journal, matrix, orders, slider, solve_film

Array = NDArray[np.float64]
Film = Callable[[float], float]

ORDER, MARGIN = 2.0, 0.1
KNUDSEN = [0.0, 0.02, 0.1, 1.0]


def slipping(balance: FilmBalance, Kn: float) -> FilmBalance:
    """The same film in a gas that slips."""
    return FilmBalance(balance.mesh, balance.radius, Kn)


# ---------------------------------------------------------------------------------------------- a slow slider

TAPER: Film = lambda X: 2.0 - X  # noqa: E731
WAVY: Film = lambda X: 1.0 + 0.6 * np.cos(2.5 * X)  # noqa: E731


def slow_load(H: Film, Kn: float) -> float:
    """`W / (p_a B Lam)` of an infinitely wide slider as `Lam -> 0`.

    With `P = 1 + Lam q`, `(H^3 + 6 Kn H^2) q' = H - H_m` and `q(0) = q(1) = 0`: two quadratures for `H_m`, one for the
    load, `int q = -int X q'`.
    """

    def over_conductance(moment: Film) -> float:
        value, _ = quad(lambda X: moment(X) / (H(X) ** 3 + 6.0 * Kn * H(X) ** 2), 0.0, 1.0, epsabs=0.0, epsrel=1e-13)
        return float(value)

    mean = over_conductance(H) / over_conductance(lambda X: 1.0)
    return -over_conductance(lambda X: X * (H(X) - mean))


def solved_slow_load(H: Film, Kn: float, cells: int) -> float:
    """The same on a grid: one Newton step from ambient pressure at a bearing number whose square is nothing."""
    balance, Lam = slipping(slider(cells), Kn), 1e-9
    film = np.array([H(X) for X in balance.mesh.phi])[None, :, None]
    n = balance.mesh.n_unknown
    fluxes = balance.fluxes(np.ones(film.shape), film, Lam)
    tangent = matrix(balance.by_pressure, balance.tangent(fluxes)[0], (n, n))
    step = spla.spsolve(tangent, -balance.residual(fluxes))
    q = np.append(step, 0.0)[balance.mesh.unknown] / Lam
    return float(np.sum(q * balance.area))


def test_the_quadrature_is_the_closed_form_without_slip() -> None:
    """A taper 2 : 1 carries `6 mu U B^2 / h_2^2 (ln 2 - 2/3)` (Rayleigh 1918)."""
    assert slow_load(TAPER, 0.0) == pytest.approx(np.log(2.0) - 2.0 / 3.0, rel=1e-10)


@pytest.mark.parametrize("Kn", KNUDSEN)
@pytest.mark.parametrize("H", [TAPER, WAVY], ids=["taper", "wavy"])
def test_slow_slider(H: Film, Kn: float) -> None:
    """Second order, and within 2e-5 on 512 cells."""
    exact = slow_load(H, Kn)
    errors = [solved_slow_load(H, Kn, cells) / exact - 1.0 for cells in (128, 256, 512)]
    assert abs(errors[-1]) < 2e-5
    assert np.all(orders(errors) >= ORDER - MARGIN)


def test_slip_costs_load() -> None:
    """At `Kn = 0.1` on the outlet film a taper loses more than a fifth: the test above would see slip missing."""
    assert slow_load(TAPER, 0.1) < 0.8 * slow_load(TAPER, 0.0)


# ---------------------------------------------------------------------------------------------- driven by pressure


@pytest.mark.parametrize("Kn", KNUDSEN)
def test_pressure_drives_the_same_flow_through_every_face(Kn: float) -> None:
    """`P^2 / 2 + 6 Kn P` linear over an even film is the steady flow between two pressures, to rounding, both ways."""
    low, high = 1.0, 5.0
    content = np.linspace(low**2 / 2.0 + 6.0 * Kn * low, high**2 / 2.0 + 6.0 * Kn * high, 41)
    P = np.sqrt(36.0 * Kn**2 + 2.0 * content) - 6.0 * Kn
    one, step = np.ones(41), 1.0 / 40.0
    expected = -(content[-1] - content[0])
    along = circumferential_flux(P[None, :, None], one[None, :, None], 0.0, np.full((40, 1), step), Kn)
    across = axial_flux(P[None, None, :], one[None, None, :], np.full(40, step), Kn)
    assert_allclose(along.value, expected, rtol=1e-12)
    assert_allclose(across.value, expected, rtol=1e-12)


def test_no_slip_is_left_as_it_was() -> None:
    """With `Kn = 0` every term and derivative is the one without slip, to the last bit."""
    rng = np.random.default_rng(8)
    P, H = rng.uniform(0.5, 2.0, (2, 9, 1)), rng.uniform(0.5, 2.0, (2, 9, 1))
    dphi = np.full((8, 1), 0.1)
    off, zero = circumferential_flux(P, H, 3.0, dphi), circumferential_flux(P, H, 3.0, dphi, 0.0)
    cube, mean = mean_cube(H[:, :-1], H[:, 1:]), 0.5 * (P[:, :-1] + P[:, 1:])
    still = circumferential_flux(P, H, 0.0, dphi)
    assert np.array_equal(still.value, cube * mean / dphi * (P[:, :-1] - P[:, 1:]))
    assert np.array_equal(off.scale, zero.scale)
    for first, second in zip((off.value, *off.derivatives), (zero.value, *zero.derivatives), strict=True):
        assert np.array_equal(first, second)


# ---------------------------------------------------------------------------------------------- closed films


@pytest.mark.parametrize("Kn", [0.02, 0.3])
@pytest.mark.parametrize("Lam", [0.3, 3.0, 30.0])
def test_content_is_that_of_the_ends(Lam: float, Kn: float) -> None:
    """`sum (H^3 P^2 / 2 + 6 Kn H^2 P)` is the same at every station, to rounding."""
    problem = build_problem(journal(0.7, Lam, np.array([-0.5, 0.3]), (48, 12)))
    balance, H = slipping(problem.layout.balance, Kn), problem.film(np.ones(problem.layout.n))
    P = solve_film(balance, H, problem.bearing_number)
    weight = balance.mesh.arc_weight[None, :, None]
    assert np.max(P) > 1.01  # not the trivial film
    held = np.sum(weight * (0.5 * H**3 * P**2 + 6.0 * Kn * H**2 * P), axis=(0, 1))
    ends = np.sum(weight * (0.5 * H**3 + 6.0 * Kn * H**2), axis=(0, 1))
    assert_allclose(held, ends, rtol=1e-10)


def thin_gas(bearing: Case) -> Case:
    """The bearing at a twentieth of the pressure, where slip is a good part of the flow; the same bearing number."""
    slow = 0.05 * bearing.operation.speed
    changes = {"gas.ambient_pressure": 0.05 * bearing.gas.ambient_pressure, "operation.speed": slow}
    return bearing.replace(**changes, **{"model.slip": True})


def test_the_middle_of_a_long_bearing_is_the_2d_model() -> None:
    """Twenty diameters long: the 2-D film has the same gas inventory (F6), which includes a term of slip."""
    e = np.array([0.0, -0.5])
    long, short = thin_gas(journal(20.0, 3.0, e, (32, 80))), thin_gas(journal(20.0, 3.0, e, (32, 80)))
    answers = []
    for bearing in (long, short.replace(**{"model.kind": "2d"})):
        problem = build_problem(bearing)
        assert problem.layout.balance.knudsen == pytest.approx(bearing.gas.mean_free_path / 25e-6)
        answer = solve_cold(problem)
        answers.append((problem, problem.pressure(answer.x)[0, :, -1]))
    (_, middle), (problem, P) = answers
    assert_allclose(middle, P, rtol=1e-6)
    H = problem.film(np.ones(problem.layout.n))[0, :, 0]
    weight = problem.layout.balance.area[:, 0]
    assert abs(np.sum(weight * H**3 * (P**2 - 1.0))) > 1e-3 * np.sum(weight * H**3)


# ---------------------------------------------------------------------------------------------- friction, figures


def test_shear_between_slipping_walls() -> None:
    """`mu U / (h + 2 lambda)` with `lambda = lambda_a p_a / p`: an even film at ambient pressure and at twice that."""
    mesh = slider(8, axis_3d(1.0, 4, half=False)).mesh
    h, mu, U, slip = 2e-6, 1.8e-5, 100.0, 66e-9 * 1e5
    for p in (1e5, 2e5):
        state = (np.full(mesh.shape, p), np.full(mesh.shape, h))
        torque = viscous_torque(mesh, 1.0, state, (mu, U), slip)
        assert torque == pytest.approx(mu * U / (h + 2.0 * slip / p), rel=1e-12)
        assert viscous_torque(mesh, 1.0, state, (mu, U)) == pytest.approx(mu * U / h, rel=1e-12)


@pytest.fixture(scope="module")
def plain() -> Case:
    """A plain bearing with a minimum film thickness of 2.5 um."""
    coarse = {"model.cells_per_pitch": 48, "model.axial_cells": 12}
    return case("plain_journal", **coarse, **{"operation.eccentricity": (0.0, -22.5e-6)})


def test_answers_tell_the_knudsen_number_and_what_slip_does(plain: Case) -> None:
    """`Kn = 0.026`: up to `6 Kn = 16 %` more passes where the film is thinnest; the load falls by less than that.

    It falls by more than half of what a film as thick as the clearance would pass in addition.
    """
    off, on = solve.record(plain).scalars, solve.record(plain.replace(**{"model.slip": True})).scalars
    Kn = plain.gas.mean_free_path / 2.5e-6
    assert off["knudsen_number"] == pytest.approx(Kn, rel=1e-9)
    assert on["knudsen_number"] == pytest.approx(Kn, rel=1e-9)
    loss = 1.0 - float(on["bearing_force"]) / float(off["bearing_force"])
    assert 3.0 * plain.gas.mean_free_path / plain.bearing.clearance < loss < 6.0 * Kn
    assert float(on["friction_torque"]) < float(off["friction_torque"])
    assert float(on["residual"]) < 1e-8
    assert float(on["mass_balance_error"]) < 1e-8


def test_slip_fades_with_the_mean_free_path(plain: Case) -> None:
    """First order in the mean free path, which the gas constant sets without changing the bearing number."""
    loads = [float(solve.record(plain).scalars["bearing_force"])]
    for shrink in (1.0, 2.0, 4.0):
        gas = {"model.slip": True, "gas.gas_constant": plain.gas.gas_constant / (100.0 * shrink**2)}
        loads.append(float(solve.record(plain.replace(**gas)).scalars["bearing_force"]))
    losses = 1.0 - np.array(loads[1:]) / loads[0]
    assert_allclose(losses[:-1] / losses[1:], 2.0, rtol=0.02)


def test_check_tells_the_knudsen_number(plain: Case) -> None:
    """It is based on the clearance of a plain bearing, and on the contact film thickness of a petal bearing."""
    scalars = check.record(plain).scalars
    assert scalars["mean_free_path"] == plain.gas.mean_free_path
    assert scalars["viscosity"] == plain.gas.viscosity
    assert scalars["clearance_knudsen_number"] == pytest.approx(plain.gas.mean_free_path / 2.5e-6, rel=1e-9)
    petals = case("paper_n8", **{"model.cells_per_pitch": 8})
    on_petals = check.record(petals).scalars
    assert on_petals["contact_knudsen_number"] == pytest.approx(petals.gas.mean_free_path / 1e-6, rel=1e-12)
    assert not {"knudsen_number", "clearance_knudsen_number"} & {*on_petals}


@pytest.mark.slow
def test_petals_carry_less_with_slip() -> None:
    """Film and pack solved together, tangents and all, where the films are some micrometres."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 32, "operation.eccentricity": (0.0, -200e-6)})
    off, on = solve.record(bearing).scalars, solve.record(bearing.replace(**{"model.slip": True})).scalars
    assert on["converged"]
    assert float(on["residual"]) < 1e-8
    assert 0.9 * float(off["bearing_force"]) < float(on["bearing_force"]) < float(off["bearing_force"])
