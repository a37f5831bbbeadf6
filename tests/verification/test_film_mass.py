"""Mass in = mass out over any film, whatever the pressures and thicknesses: nothing is lost between the cells."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.mesh.axial import axis_3d
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.walls import build_wall
from tests.cases import case
from tests.verification.film_helpers import slider, stepped_slider

Array = NDArray[np.float64]

ROUNDING = 1e-14
"""Of the sum of the magnitudes of all flows."""


def petal_film(kind: str, edges: str, symmetry: bool) -> FilmBalance:
    """Film of the paper's eight petals on a coarse grid."""
    changes: dict[str, object] = {
        "model.kind": kind,
        "model.edges": edges,
        "model.symmetry": symmetry,
        "model.cells_per_pitch": 6,
        "model.axial_cells": 4,
    }
    bearing = case("paper_n8", **changes)
    return FilmBalance(build_wall(bearing).film, bearing.bearing.journal_radius)


def plain_film(kind: str, symmetry: bool) -> FilmBalance:
    """Film of a plain bearing, closed on itself, on a coarse grid."""
    changes: dict[str, object] = {
        "model.kind": kind,
        "model.symmetry": symmetry,
        "model.cells_per_pitch": 12,
        "model.axial_cells": 4,
    }
    bearing = case("plain_journal", **changes)
    return FilmBalance(build_wall(bearing).film, bearing.bearing.journal_radius)


FILMS: dict[str, Callable[[], FilmBalance]] = {
    "strip": lambda: slider(9),
    "strip with ends": lambda: slider(7, axis_3d(1.3, 6, half=False)),
    "half strip with ends": lambda: slider(7, axis_3d(1.3, 6, half=True)),
    "circle": lambda: plain_film("2d", True),
    "circle with ends": lambda: plain_film("3d", False),
    "half circle with ends": lambda: plain_film("3d", True),
    "petals": lambda: petal_film("2d", "ambient", True),
    "petals with ends": lambda: petal_film("3d", "ambient", False),
    "half petals with ends": lambda: petal_film("3d", "ambient", True),
    "stepped petals": lambda: petal_film("2d", "continuous", True),
    "stepped petals with ends": lambda: petal_film("3d", "continuous", False),
    "half stepped petals with ends": lambda: petal_film("3d", "continuous", True),
}


@cache
def film_of(name: str) -> FilmBalance:
    """One of the films, built once."""
    return FILMS[name]()


def random_film(balance: FilmBalance, seed: int, spread: float) -> tuple[Array, Array]:
    """Random pressures, ambient where they must be, and random film thicknesses; both within `exp(± spread)`."""
    rng = np.random.default_rng(seed)
    P = balance.nodal_pressure(np.exp(spread * rng.uniform(-1.0, 1.0, balance.mesh.n_unknown)))
    return P, np.exp(spread * rng.uniform(-1.0, 1.0, balance.mesh.shape))


def outflow(balance: FilmBalance, P: Array, H: Array, Lam: float) -> float:
    """Mass that leaves through the edges and ends of the film, told from its shape alone."""
    along, across = balance.fluxes(P, H, Lam)
    closed, axial = bool(np.any(balance.mesh.unknown[:, -1] >= 0)), balance.mesh.axial
    inner = slice(None) if axial.is_2d else slice(1, None) if axial.half else slice(1, -1)
    total = 0.0 if closed else float(np.sum(along.value[:, -1, inner]) - np.sum(along.value[:, 0, inner]))
    if axial.is_2d:
        return total
    nodes = slice(None) if closed else slice(1, -1)
    total -= float(np.sum(across.value[:, nodes, 0]))
    return total if axial.half else total + float(np.sum(across.value[:, nodes, -1]))


@pytest.mark.parametrize("film", FILMS)
@given(seed=st.integers(0, 2**32 - 1), Lam=st.floats(0.0, 1e4), spread=st.floats(0.01, 2.0))
def test_what_the_cells_lose_leaves_through_the_boundary(film: str, seed: int, Lam: float, spread: float) -> None:
    balance = film_of(film)
    P, H = random_film(balance, seed, spread)
    fluxes = balance.fluxes(P, H, Lam)
    lost, size = np.sum(balance.residual(fluxes)), np.sum(balance.row_scale(fluxes))
    assert abs(lost - outflow(balance, P, H, Lam)) <= ROUNDING * size


@pytest.mark.parametrize("film", ["circle", "stepped petals"])
@given(seed=st.integers(0, 2**32 - 1), Lam=st.floats(0.0, 1e4), spread=st.floats(0.01, 2.0))
def test_a_closed_film_loses_nothing(film: str, seed: int, Lam: float, spread: float) -> None:
    balance = film_of(film)
    fluxes = balance.fluxes(*random_film(balance, seed, spread), Lam)
    assert abs(np.sum(balance.residual(fluxes))) <= ROUNDING * np.sum(balance.row_scale(fluxes))


@given(seed=st.integers(0, 2**32 - 1), Lam=st.floats(0.0, 1e4), spread=st.floats(0.01, 2.0))
def test_nothing_is_lost_over_a_step(seed: int, Lam: float, spread: float) -> None:
    """Two strips that share the pressure at a step: what enters the first leaves the second or stays in a cell."""
    balance, end = stepped_slider(0.7, 20), 6
    P, H = random_film(balance, seed, spread)
    fluxes = balance.fluxes(P, H, Lam)
    lost, size = np.sum(balance.residual(fluxes)), np.sum(balance.row_scale(fluxes))
    along = fluxes[0].value[..., 0]
    assert abs(lost - (along[1, end - 1] - along[0, 0])) <= ROUNDING * size


@pytest.mark.parametrize(
    "film", ["strip with ends", "circle with ends", "petals with ends", "stepped petals with ends"]
)
def test_half_a_film_holds_and_leaks_as_much_as_the_whole(film: str) -> None:
    """A film symmetric about the middle of the shaft: the results of the half model are those of both halves."""
    whole, half = film_of(film), film_of(f"half {film}")
    P, H = random_film(half, 7, 0.5)
    mirror = half.mesh.axial.whole
    figures = []
    for balance, (pressure, thickness) in ((half, (P, H)), (whole, (mirror(P), mirror(H)))):
        held = np.sum(balance.storage(pressure, thickness, 3.0))
        figures.append([held, outflow(balance, pressure, thickness, 3.0)])
    assert_allclose(figures[0], figures[1], rtol=1e-12)
