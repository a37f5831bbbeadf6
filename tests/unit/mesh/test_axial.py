"""Stations along the shaft: where they lie, what length each stands for, how pressures are integrated."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.mesh.axial import axis_2d, axis_3d
from petalfoil.mesh.quadrature import cubic_weights

GRADINGS = (0.0, 0.6, 0.9)


@pytest.mark.parametrize("grading", GRADINGS)
@pytest.mark.parametrize("cells", [2, 4, 6, 24])
def test_half_a_length_is_half_of_the_whole(cells: int, grading: float) -> None:
    whole = axis_3d(1.3, cells, half=False, grading=grading)
    half = axis_3d(1.3, cells, half=True, grading=grading)
    assert_allclose(half.whole_z, whole.z, rtol=1e-14)
    for name in ("weight", "load_weight"):
        one, both = getattr(half, name), getattr(whole, name)
        assert_allclose(both.sum(), 1.3, rtol=1e-14)
        assert_allclose(one.sum(), 1.3, rtol=1e-14)
        assert_allclose(one[:-1], both[: cells // 2] + both[: cells // 2 : -1], rtol=1e-12)


def test_cells_shrink_toward_both_ends() -> None:
    cell = np.diff(axis_3d(1.0, 40, half=False, grading=0.6).z)
    assert_allclose(cell, cell[::-1], rtol=1e-12)
    assert np.all(np.diff(cell[:20]) > 0.0)
    assert_allclose(cell[19] / cell[0], 4.0, rtol=0.01)


def test_grids_of_twice_the_cells_are_nested() -> None:
    coarse, fine = (axis_3d(1.0, cells, half=True, grading=0.6).z for cells in (8, 16))
    assert_allclose(fine[::2], coarse, rtol=1e-14)


@pytest.mark.parametrize("power", range(4))
def test_cubics_are_integrated_exactly_on_any_nodes(power: int) -> None:
    z = np.sort(np.random.default_rng(5).uniform(0.0, 2.0, 9))
    exact = (z[-1] ** (power + 1) - z[0] ** (power + 1)) / (power + 1)
    assert_allclose(cubic_weights(z) @ z**power, exact, rtol=1e-12)


@pytest.mark.parametrize("grading", GRADINGS)
def test_a_pressure_that_is_steep_at_its_ends_is_integrated_with_order_four(grading: float) -> None:
    exact, errors = 2.0 - np.tanh(4.0) / 2.0, []
    for cells in (80, 160, 320):
        grid = axis_3d(2.0, cells, half=True, grading=grading)
        errors.append(grid.load_weight @ (1.0 - np.cosh(4.0 * (grid.z - 1.0)) / np.cosh(4.0)) - exact)
    assert np.all(np.log2(np.abs(np.array(errors[:-1]) / np.array(errors[1:]))) > 3.7)


def test_no_pressure_pulls_on_few_cells_that_shrink_fast() -> None:
    """A cubic's weight may be negative there: the cells' own serve instead."""
    for cells in (4, 8, 12, 16, 24):
        for grading in (0.6, 0.8, 0.9):
            grid = axis_3d(1.0, cells, half=True, grading=grading)
            assert np.all(grid.load_weight > 0.0)
            assert_allclose(grid.load_weight.sum(), 1.0, rtol=1e-14)


def test_the_2d_model_has_one_station() -> None:
    station = axis_2d(0.05)
    assert station.is_2d
    assert_allclose([station.weight, station.load_weight], 0.05)
