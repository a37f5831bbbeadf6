"""Every residual of the film is told its derivative: the Taylor remainder falls with slope 2."""

from __future__ import annotations

from decimal import Decimal, localcontext

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.physics import reynolds
from petalfoil.physics.mass_balance import Entries, FilmBalance
from petalfoil.physics.reynolds import Flux, axial_flux, circumferential_flux, langevin, langevin_slope, mean_cube
from petalfoil.walls import build_wall
from tests.contract.taylor import BEARINGS, assert_tangent, bearing, taylor_slopes

Array = NDArray[np.float64]

SWITCH = 0.03
"""Where `langevin` goes over from its series to its closed form."""

# ---------------------------------------------------------------------------------------------- the fitted flux


def exact_langevin(x: float) -> tuple[float, float]:
    """`coth x - 1/x` and its derivative to 50 digits, rounded."""
    with localcontext() as context:
        context.prec = 50
        X = Decimal(x)
        decay = (-2 * X).exp()
        return float((1 + decay) / (1 - decay) - 1 / X), float(1 / X**2 - 4 * decay / (1 - decay) ** 2)


@pytest.mark.parametrize(
    "x",
    [
        1e-8,
        1e-3,
        0.02,
        0.029,
        np.nextafter(SWITCH, 0.0),
        SWITCH,
        np.nextafter(SWITCH, 1.0),
        0.031,
        0.05,
        0.3,
        3.0,
        300.0,
    ],
)
def test_langevin_and_its_slope_on_both_sides_of_the_switch(x: float) -> None:
    """To 5e-12: the closed form cancels to `eps / x^2` of its terms, the series stops at `x^5`; they meet at 0.03."""
    value, slope = langevin(np.array([x])), langevin_slope(np.array([x]))
    assert_allclose([value[0], slope[0]], exact_langevin(float(x)), rtol=5e-12)


def test_langevin_does_not_jump_at_the_switch() -> None:
    below, above = (np.array([np.nextafter(SWITCH, side)]) for side in (0.0, 1.0))
    assert abs(langevin(below)[0] - langevin(above)[0]) < 1e-12
    assert abs(langevin_slope(below)[0] - langevin_slope(above)[0]) < 5e-12


def faces(count: int, seed: int) -> tuple[Array, Array]:
    """Pressures and films on both sides of `count` faces, shape (1, 2, count)."""
    rng = np.random.default_rng(seed)
    return rng.uniform(0.5, 2.0, (1, 2, count)), rng.uniform(0.5, 2.0, (1, 2, count))


SIDES = {"P0": (0, 0), "P1": (0, 1), "H0": (1, 0), "H1": (1, 1)}
"""Which array, and which side of the face."""


SLIPS = [0.0, 0.05, 0.5]
"""Knudsen numbers: without slip, where its first order is trusted, far beyond."""


@pytest.mark.parametrize("Kn", SLIPS)
@pytest.mark.parametrize("Lam", [0.0, 1e-3, 1.0, 30.0, 1e3, 1e5])
@pytest.mark.parametrize("by", SIDES)
def test_circumferential_flux(by: str, Lam: float, Kn: float) -> None:
    """On cells of 0.1 rad: Peclet numbers of the cell from 0 to some thousands."""
    check_side(by, Lam, 0.1, faces(40, 1), Kn)


@pytest.mark.parametrize("by", SIDES)
def test_circumferential_flux_across_the_switch_of_the_fit(by: str) -> None:
    """Faces whose steps lead from the series of `langevin` over to its closed form, and back."""
    P, H = faces(4000, 2)
    dphi, mean_P, mean_H = 0.1, P.mean(axis=1), H.mean(axis=1)
    x = 0.5 * mean_H * dphi / (mean_cube(H[:, 0], H[:, 1]) * mean_P)  # for Lam = 1
    near = np.abs(x[0] - np.median(x)) < 2e-3 * np.median(x)
    assert np.count_nonzero(near) > 1
    check_side(by, SWITCH / float(np.median(x)), dphi, (P[..., near], H[..., near]))


def opening_faces(count: int, share: float) -> tuple[Array, Array]:
    """Faces behind a contact: the film opens a hundredfold within a cell; `share` of the pressure lies upstream."""
    P, H = faces(count, 6)
    return P * np.array([[[share], [1.0]]]), H * np.array([[[0.05], [5.0]]])


@pytest.mark.parametrize("Kn", [0.0, 0.05])
@pytest.mark.parametrize("by", SIDES)
def test_circumferential_flux_where_the_upstream_node_limits_it(
    by: str, Kn: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    P, H = opening_faces(40, 2e-3 if Kn == 0.0 else 1e-5)
    check_side(by, 3.0, 0.05, (P, H), Kn)
    limited = circumferential_flux(P, H, 3.0, np.array([[0.05]]), Kn).value
    monkeypatch.setattr(reynolds, "DRAIN", np.inf)
    assert np.all(limited < circumferential_flux(P, H, 3.0, np.array([[0.05]]), Kn).value)


def test_no_face_drains_a_node_without_pressure() -> None:
    """What leaves a node vanishes with its pressure, whatever lies downstream: no film needs a negative one."""
    few, fewer = (circumferential_flux(*opening_faces(40, share), 3.0, np.array([[0.05]])).value
                  for share in (1e-4, 1e-7))  # fmt: skip
    assert np.all(fewer > 0.0)
    assert_allclose(fewer / few, 1e-3, rtol=0.05)


def check_side(by: str, Lam: float, dphi: float, state: tuple[Array, Array], Kn: float = 0.0) -> None:
    which, side = SIDES[by]
    direction = np.random.default_rng(3).uniform(-1.0, 1.0, state[0].shape[2])

    def flux(t: float) -> Flux:
        moved = [state[0].copy(), state[1].copy()]
        moved[which][0, side] += t * direction
        return circumferential_flux(moved[0], moved[1], Lam, np.array([[dphi]]), Kn)

    derivative = getattr(flux(0.0).derivatives, f"by_{by}")
    assert_tangent(lambda t: flux(t).value, derivative * direction, largest=2.0**-6)


@pytest.mark.parametrize("Kn", SLIPS)
@pytest.mark.parametrize("by", SIDES)
def test_axial_flux(by: str, Kn: float) -> None:
    which, side = SIDES[by]
    rng = np.random.default_rng(4)
    state = [rng.uniform(0.5, 2.0, (1, 40, 2)) for _ in range(2)]
    direction = rng.uniform(-1.0, 1.0, 40)

    def flux(t: float) -> Flux:
        moved = [field.copy() for field in state]
        moved[which][0, :, side] += t * direction
        return axial_flux(moved[0], moved[1], np.array([0.2]), Kn)

    assert_tangent(lambda t: flux(t).value, getattr(flux(0.0).derivatives, f"by_{by}") * direction[:, None])


def test_a_wrong_derivative_shows() -> None:
    """The slope is 1 where a derivative is off by a hundredth: the tests of this file can fail."""
    P, H = faces(40, 1)

    def flux(t: float) -> Flux:
        return circumferential_flux(P + t * np.array([1.0, 0.0])[:, None], H, 1.0, np.array([[0.1]]))

    slopes = taylor_slopes(lambda t: flux(t).value, 1.01 * flux(0.0).derivatives.by_P0)
    assert slopes[-1] < 1.1


# ---------------------------------------------------------------------------------------------- the balance


def applied(entries: Entries, values: Array, n: int, direction: Array) -> Array:
    """Sparse derivative times a direction, shape (n,)."""
    shape = (n, direction.size)
    return np.asarray(sp.coo_array((values, (entries.rows, entries.cols)), shape=shape) @ direction.ravel())


def film(name: str, seed: int) -> tuple[FilmBalance, Array, Array, np.random.Generator]:
    """(balance, pressure unknowns, H, rng) of one of the bearings' films."""
    problem, rng = bearing(name), np.random.default_rng(seed)
    balance = FilmBalance(build_wall(problem).film, problem.bearing.journal_radius, problem.slip_length / 1e-5)
    mesh = balance.mesh
    return balance, rng.uniform(0.5, 2.0, mesh.n_unknown), rng.uniform(0.5, 2.0, mesh.shape), rng


@pytest.mark.parametrize("Lam", [0.0, 2.0, 500.0])
@pytest.mark.parametrize("name", BEARINGS)
def test_film_balance_by_pressure(name: str, Lam: float) -> None:
    balance, x, H, rng = film(name, 5)
    direction = rng.uniform(-1.0, 1.0, x.shape)
    by_P, _ = balance.tangent(balance.fluxes(balance.nodal_pressure(x), H, Lam))
    change = applied(balance.by_pressure, by_P, len(x), direction)
    assert_tangent(
        lambda t: balance.residual(balance.fluxes(balance.nodal_pressure(x + t * direction), H, Lam)), change
    )


@pytest.mark.parametrize("Lam", [0.0, 2.0, 500.0])
@pytest.mark.parametrize("name", BEARINGS)
def test_film_balance_by_film_thickness(name: str, Lam: float) -> None:
    balance, x, H, rng = film(name, 6)
    P, direction = balance.nodal_pressure(x), rng.uniform(-1.0, 1.0, H.shape)
    _, by_H = balance.tangent(balance.fluxes(P, H, Lam))
    change = applied(balance.by_film, by_H, len(x), direction)
    assert_tangent(lambda t: balance.residual(balance.fluxes(P, H + t * direction, Lam)), change)


@pytest.mark.parametrize("name", BEARINGS)
def test_stored_mass(name: str) -> None:
    """`P H` is a product: along both at once the remainder is a pure square, along one alone there is none."""
    balance, x, H, rng = film(name, 7)
    dx, dH = rng.uniform(-1.0, 1.0, x.shape), rng.uniform(-1.0, 1.0, H.shape)
    P, places = balance.nodal_pressure(x), balance.storage_entries
    by_P, by_H = balance.storage_tangent(P, H, 3.0)
    change_P = applied(Entries(places.rows, places.rows), by_P, len(x), dx)
    change_H = applied(places, by_H, len(x), dH)
    moved_P, moved_H = balance.nodal_pressure(x + dx), H + dH
    assert_allclose(balance.storage(moved_P, H, 3.0), balance.storage(P, H, 3.0) + change_P, rtol=1e-12)
    assert_allclose(balance.storage(P, moved_H, 3.0), balance.storage(P, H, 3.0) + change_H, rtol=1e-12)
    assert_tangent(lambda t: balance.storage(balance.nodal_pressure(x + t * dx), H + t * dH, 3.0), change_P + change_H)
