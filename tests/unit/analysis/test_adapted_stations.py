"""Stations along the shaft where a coarse solution bends most."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.adapted_stations import FIRST_AXIAL, over_mean, second_derivative, with_stations
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.side_stations import LAYER
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import DefinitionError
from petalfoil.mesh.axial import axis_3d, equidistributed
from petalfoil.walls.base import axial_grid
from tests.cases import case

COARSE = {"model.cells_per_pitch": 12, "model.axial_cells": 8, "operation.eccentricity": (0.0, -2e-4)}


def test_an_even_density_gives_equal_distances() -> None:
    s = np.linspace(0.0, 1.0, 13)
    assert_allclose(equidistributed([2.0, 2.0, 2.0], s), s, atol=1e-14)


def test_equal_parts_of_the_density_lie_between_stations() -> None:
    half, s = np.linspace(0.0, 0.5, 17), np.linspace(0.0, 1.0, 81)
    z = equidistributed((2.0 - np.cos(8.0 * np.pi * half)).tolist(), s)
    assert z[0] == 0.0
    assert z[40] == 0.5
    assert np.all(np.diff(z) > 0.0)
    assert_allclose(z + z[::-1], 1.0, rtol=1e-15)
    cells = np.diff(z) * (2.0 - np.cos(4.0 * np.pi * (z[1:] + z[:-1])))
    assert_allclose(cells, cells.mean(), rtol=0.04)  # between its values the density is a monotone cubic
    assert np.ptp(np.diff(z)) > 0.5 * np.max(np.diff(z))


def test_finer_grids_are_nested_in_the_same_map() -> None:
    coarse, fine = (axis_3d(0.05, cells, half=True, density=[1.0, 4.0, 2.0, 1.0]).z for cells in (12, 24))
    assert_allclose(fine[::2], coarse, rtol=1e-12)


@pytest.mark.parametrize("half", [True, False])
def test_halves_and_wholes_have_the_same_stations(half: bool) -> None:
    grid = axis_3d(0.05, 12, half=half, density=[1.0, 4.0, 2.0, 1.0])
    whole = axis_3d(0.05, 12, half=False, density=[1.0, 4.0, 2.0, 1.0])
    assert_allclose(grid.whole_z, whole.z, rtol=1e-14)
    assert_allclose(grid.load_weight.sum(), 0.05, rtol=1e-12)


def test_second_derivatives_are_exact_for_parabolas_on_any_spacing() -> None:
    z = np.array([0.0, 0.1, 0.25, 0.6])
    assert_allclose(second_derivative((3.0 * z**2 + z)[None, None, :], z), 6.0, rtol=1e-12)
    assert_allclose(over_mean(np.zeros(3)), 0.0)


@pytest.mark.slow
def test_stations_crowd_where_the_petals_lift_off_the_film() -> None:
    bearing = case("paper_n8_spatial", **COARSE)
    adapted = with_stations(bearing)
    density = adapted.axial_density
    assert density.index(max(density)) in (2, 3)  # 6 to 9 mm from the end of 50 mm
    assert max(density) > 1.5 * density[-1]
    assert axial_grid(adapted).z[1] < 0.05 / 8.0
    assert with_stations(adapted) == adapted
    assert with_stations(bearing) == adapted


def test_stations_crowd_where_the_rig_touches_last() -> None:
    """1.4 to 2.4 mm from the ends: from a coarse solution on equal cells the first station would lie at 1.4 mm."""
    at_work = {"operation.speed": "12000 rpm", "operation.load": "46.4 N", "petals.theory": "inextensible"}
    rig = case("rig", **{"model.kind": "3d", "model.cells_per_pitch": 64, "model.axial_cells": 24, **at_work})
    z = axial_grid(with_stations(rig)).z
    assert z[1] < 1e-3
    assert np.count_nonzero((1.4e-3 < z) & (z < 2.8e-3)) == 2


@pytest.mark.parametrize("layers", [1.0, 0.25])
def test_cells_of_petals_that_stretch_grow_with_the_distance_from_their_sides(layers: float) -> None:
    """Places of the density 1 / (l + z) in closed form; petals of a quarter of the length have layers of half of it."""
    grid = {"model.kind": "3d", "model.cells_per_pitch": 12, "model.axial_cells": 24}
    changes = {} if layers == 1.0 else {"petals.thickness": 0.15e-3 * layers}
    rig = case("rig", **grid, **changes)
    layer = LAYER * np.sqrt(rig.pack.metric_radius * 0.15e-3 * layers)
    half = 0.5 * rig.bearing.length
    expected = layer * ((1.0 + half / layer) ** (np.arange(13) / 12.0) - 1.0)
    z = axial_grid(with_stations(rig)).z
    assert_allclose(z, expected, rtol=0.03)  # between its 33 values the density is a monotone cubic
    assert with_stations(rig.replace(**{"operation.speed": 500.0})).axial_density == with_stations(rig).axial_density


def test_stations_of_petals_that_stretch_are_adapted_where_asked_for() -> None:
    bearing = case("paper_n8_spatial", **COARSE, **{"petals.theory": "shell"})
    asked = with_stations(bearing.replace(**{"model.axial_density": "adapted"})).axial_density
    assert len(asked) == FIRST_AXIAL // 2 + 1
    assert asked[-2] == pytest.approx(asked[-1], rel=0.2)  # equal cells in the middle, where nothing bends
    sides = with_stations(bearing).axial_density
    assert np.all(np.diff(sides) < 0.0)


@pytest.mark.slow
def test_results_tell_their_stations() -> None:
    result = petalfoil.solve(case("paper_n8_spatial", **COARSE))
    shown = Case.from_toml(result.attrs["case"])
    assert shown.axial_density == with_stations(case("paper_n8_spatial", **COARSE)).axial_density
    assert_allclose(result["z"], axial_grid(shown).whole_z)


@pytest.mark.slow
def test_an_operating_point_has_the_stations_of_every_analysis() -> None:
    """With equal stations the force of this bearing is 0.2 % off."""
    bearing = case("paper_n8_spatial", **COARSE)
    with running():
        answer = operating_point(bearing, None).answer
    assert answer.problem.layout.case == with_stations(bearing)
    told = Evaluation.of(answer.problem.layout.case, answer).forces()
    assert_allclose(told.force_y, float(petalfoil.solve(bearing)["force_y"]), rtol=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"model.axial_cells": 6},
        {"model.axial_density": "uniform"},
        {"model.axial_grading": 0.3},
        {"model.kind": "2d"},
        {"operation.speed": 0.0},
    ],
)
def test_other_cases_stay_as_they_are(changes: dict[str, object]) -> None:
    bearing = case("paper_n8_spatial", **{**COARSE, **changes})
    assert with_stations(bearing) is bearing


def test_stations_under_a_load_are_those_of_its_balance() -> None:
    bearing = case("paper_n8_spatial", **{**COARSE, "operation.eccentricity": (0.0, 0.0), "operation.load": "15 N"})
    assert len(with_stations(bearing).axial_density) == 9


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model.axial_density": "dense"}, '"adapted" or "uniform", or a list of 3 to 65 numbers'),
        ({"model.axial_density": [1.0, 2.0]}, "list of 3 to 65 numbers"),
        ({"model.axial_density": [1.0, -2.0, 1.0]}, "entry 2, -2.0, is not allowed"),
        ({"model.axial_density": [1.0, "much", 1.0]}, "entry 2"),
        ({"model.axial_density": "adapted", "model.axial_grading": 0.3}, "allowed: one of them"),
    ],
)
def test_densities_that_make_no_sense_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(DefinitionError, match=r"model\.axial_density") as refused:
        case("paper_n8_spatial", **changes)
    assert message in str(refused.value)


def test_a_plain_bearing_has_nothing_to_adapt_to() -> None:
    with pytest.raises(DefinitionError, match="adapted to petals only"):
        case("plain_journal", **{"model.axial_density": "adapted"})
    assert case("plain_journal", **{"model.axial_density": "uniform"}).axial_grading == 0.0


def test_a_case_with_a_density_comes_back_from_its_text() -> None:
    bearing = case("paper_n8_spatial", **{"model.axial_density": [1, 2.5, 1]})
    assert bearing.axial_density == (1.0, 2.5, 1.0)
    assert Case.from_toml(bearing.to_toml()) == bearing
