"""A measured free shape carries the load where the arc carries it from which the rows were taken."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import xarray as xr

import petalfoil
from petalfoil.case import Case
from tests.cases import FAULTS

MICRON = 1e-6


def measured() -> Case:
    return Case.load(FAULTS / "free_shape_12_points.toml")


@cache
def balanced_arc() -> xr.Dataset:
    return petalfoil.balance(measured().replace(**{"petals.free_shape": None}))


def balanced_rows(count: int, scatter: float, tolerance: float, seed: int = 0) -> xr.Dataset:
    """Equilibrium with `count` rows of the arc, their radii scattered but for the root's [m]."""
    pack = measured().replace(**{"petals.free_shape": None}).pack
    assert pack is not None
    angles = np.linspace(0.0, pack.petal_angle, count)
    deviation = scatter * np.random.default_rng(seed).standard_normal(count)
    deviation[0] = 0.0
    rows = np.column_stack([angles, pack.free_radius(angles) + deviation])
    petals = {"petals.free_shape": rows, "petals.bend_radius": None, "petals.free_shape_tolerance": tolerance}
    return petalfoil.balance(measured().replace(**petals))


@pytest.mark.parametrize(("count", "allowed"), [(12, 0.05 * MICRON), (24, 0.005 * MICRON)])
def test_few_exact_rows_are_enough(count: int, allowed: float) -> None:
    """A monotone interpolant put the journal at -100 um for -124 um with 12 rows, at -118 um with 24."""
    answer, arc = balanced_rows(count, 0.0, 0.0), balanced_arc()
    for name in ("eccentricity_x", "eccentricity_y", "min_film_thickness"):
        assert float(answer[name]) == pytest.approx(float(arc[name]), abs=allowed)


@pytest.mark.parametrize("count", [48, 200])
@pytest.mark.parametrize("seed", range(3))
def test_scatter_of_5_um_is_smoothed_by_its_tolerance(count: int, seed: int) -> None:
    """Through every row the film was 1.3 to 5.6 um thick for 6.85 um.

    What is left of 48 rows moves the journal by up to 3.7 um, on 64 and 128 cells, with contact points and at nodes.
    """
    answer, arc = balanced_rows(count, 5.0 * MICRON, 5.0 * MICRON, seed), balanced_arc()
    assert float(answer["min_film_thickness"]) == pytest.approx(float(arc["min_film_thickness"]), abs=0.6 * MICRON)
    assert float(answer["eccentricity_y"]) == pytest.approx(float(arc["eccentricity_y"]), abs=4.0 * MICRON)


@pytest.mark.slow
def test_a_stated_bend_radius_moves_nothing_beside_a_measured_shape() -> None:
    """It moved the preload from 27 to 65 N."""
    answers = [
        petalfoil.balance(measured().replace(**{"petals.bend_radius": radius})) for radius in ("39 mm", "41 mm", None)
    ]
    assert len({float(answer["min_film_thickness"]) for answer in answers}) == 1


def test_a_last_row_rounded_below_the_edge_is_solved() -> None:
    rounded = petalfoil.balance(Case.load(FAULTS / "free_shape_last_row_rounded.toml"))
    assert float(rounded["eccentricity_y"]) == pytest.approx(float(balanced_arc()["eccentricity_y"]), abs=0.05 * MICRON)
