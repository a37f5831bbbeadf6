"""Explicit time steps of the film: balances of the coupled system, conservation of mass, stability."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.classic import numpy_kernels
from petalfoil.classic.film_cells import FilmCells, film_cells
from petalfoil.classic.film_march import FilmMarch
from petalfoil.classic.kernels import MarchSettings
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.system.coupled import CoupledProblem
from tests.unit.classic.bearings import KINDS, bearing

Array = NDArray[np.float64]


def drawn(problem: CoupledProblem) -> tuple[Array, Array]:
    """A film and pressures that go with nothing, ambient where they must be; (strip, node, axial)."""
    rng = np.random.default_rng(1)
    balance = problem.layout.balance
    H = rng.uniform(0.5, 3.0, balance.mesh.shape)
    return H, balance.nodal_pressure(rng.uniform(0.7, 2.0, balance.mesh.n_unknown))


def cells_of(problem: CoupledProblem, H: Array) -> FilmCells:
    return film_cells(problem.layout.balance, H, problem.bearing_number)


@pytest.mark.parametrize("kind", KINDS)
def test_the_flow_into_the_cells_is_that_of_the_coupled_system(kind: str) -> None:
    problem = bearing(kind)
    H, P = drawn(problem)
    cells, balance = cells_of(problem, H), problem.layout.balance
    inflow = numpy_kernels.inflow(P.ravel(), cells, numpy_kernels.exponential_fit(P.ravel(), cells)).reshape(H.shape)
    outflow = balance.residual(balance.fluxes(P, H, problem.bearing_number))
    assert_allclose(balance.mesh.at_unknowns(inflow), -outflow, rtol=1e-11, atol=1e-11 * np.max(np.abs(outflow)))
    assert np.all(inflow[balance.mesh.unknown < 0] == 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_an_explicit_step_conserves_mass(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numpy_kernels, "REFRESH", 1)
    problem = bearing(kind)
    H, P = drawn(problem)
    cells, balance = cells_of(problem, H), problem.layout.balance
    # without the correction of the gas inventory, which does not conserve mass
    cells = cells._replace(inventory=np.zeros(0), inventory_slip=np.zeros(0))
    held = [balance.storage(P, H, 0.5)]
    given = balance.outflow(balance.fluxes(P, H, problem.bearing_number))[balance.mesh.unknown < 0].sum()
    dt = 0.9 / numpy_kernels.largest_rate(P.ravel(), cells)
    numpy_kernels.march(P.reshape(-1), cells, MarchSettings(0.9, 1.0, -1.0, 1))
    held.append(balance.storage(P, H, 0.5))
    gained = float(np.sum(held[1] - held[0]))
    assert_allclose(gained, dt * given, rtol=0.0, atol=1e-13 * float(np.sum(held[0])))


@pytest.mark.parametrize("kind", ["2d", "half", "whole, continuous", "plain", "plain, 2d"])
def test_the_film_alone_marches_to_newton_s_pressure(kind: str) -> None:
    problem = bearing(kind)
    answer = solve_cold(problem)
    P, wanted = np.ones(problem.layout.balance.mesh.shape), problem.pressure(answer.x)
    film = FilmMarch(problem, ClassicOptions())
    assert film.advance(P, problem.film(answer.x), 1e-6, 2_000_000)
    assert_allclose(P, wanted, rtol=1e-5)
    assert film.steps > 500


def test_the_time_step_is_within_a_factor_two_of_the_largest_that_is_stable() -> None:
    problem = bearing("2d")
    H = problem.film(solve_cold(problem).x)
    settles = {
        share: FilmMarch(problem, ClassicOptions(time_step_fraction=share)).advance(np.ones(H.shape), H, 1e-6, 20_000)
        for share in (0.95, 2.2)
    }
    assert settles == {0.95: True, 2.2: False}


def test_the_bound_is_the_paper_s_on_a_uniform_film() -> None:
    problem = bearing("half", **{"operation.speed": 0.0})
    balance = problem.layout.balance
    H, P = np.full(balance.mesh.shape, 2.0), np.full(balance.mesh.shape, 1.5)
    mesh, dZ = balance.mesh, float(balance.dZ[0])
    dphi = float(np.diff(mesh.phi).min())
    bound = 0.5 / (1.5 * 2.0**2 * (1.0 / dphi**2 + 1.0 / dZ**2))  # (59)
    assert_allclose(1.0 / numpy_kernels.largest_rate(P.ravel(), cells_of(problem, H)), bound, rtol=1e-12)


def test_a_film_without_ambient_nodes_has_the_gas_inventory_of_a_long_bearing() -> None:
    problem = bearing("plain, 2d")
    H = problem.film(np.ones(problem.layout.n))
    P = np.full(H.shape, 1.3)
    assert FilmMarch(problem, ClassicOptions()).advance(P, H, 1e-8, 2_000_000)
    inventory = problem.layout.film_rows.inventory
    assert inventory is not None
    assert abs(inventory.value(P, H)) < 1e-7 * inventory.row_scale(P, H)
