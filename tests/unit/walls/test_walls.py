"""Discretised walls: their position, their units, and the fields of the first of two bearings."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.case import Case
from petalfoil.walls import WallState, build_wall, wall_kind
from petalfoil.walls.two_bearings import paired
from tests.cases import case

PETALS = case("paper_n8", **{"model.cells_per_pitch": 6})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.symmetry": False})


@pytest.mark.parametrize("bearing", [PETALS, PLAIN])
def test_a_shaft_in_two_bearings_has_a_position_of_four_coordinates(bearing: Case) -> None:
    wall = build_wall(bearing)
    pair = paired((wall, wall), (-0.15, 0.15))
    assert (wall.n_position, wall.n_bearings) == (2, 1)
    assert (pair.n_position, pair.n_bearings, pair.n_unknown) == (4, 2, 2 * wall.n_unknown)
    assert pair.reference_film == wall.reference_film


@pytest.mark.parametrize("bearing", [PETALS, PLAIN])
def test_without_tilt_both_bearings_see_the_film_of_one(bearing: Case) -> None:
    wall = build_wall(bearing)
    pair, e = paired((wall, wall), (-0.15, 0.15)), np.array([3e-6, -4e-6])
    W = np.linspace(0.0, 1e-5, wall.n_unknown)
    one = wall.film_thickness(W, e)
    both = pair.film_thickness(np.concatenate([W, W]), np.concatenate([e, [0.0, 0.0]]))
    np.testing.assert_allclose(both, np.concatenate([one, one]), rtol=1e-13)


def test_films_are_measured_by_the_clearance_or_by_ten_micrometres() -> None:
    assert build_wall(PLAIN).reference_film == PLAIN.bearing.clearance
    assert build_wall(PETALS).reference_film == 1e-5


def test_the_fields_of_a_simple_wall_that_moves_lie_on_the_film(foundation: Case) -> None:
    wall, kind = build_wall(foundation), wall_kind(foundation)
    W, pressure = np.arange(wall.n_unknown, dtype=float), np.ones(len(wall.contacts.rest))
    fields, coordinates = kind.fields(foundation, wall, WallState(W, pressure)), kind.coordinates(foundation, wall)
    assert set(fields) == {"deflection", "journal_contact_pressure"}
    np.testing.assert_array_equal(fields["deflection"].ravel(), W)
    assert fields["deflection"].shape == (len(wall.film.theta), len(coordinates["phi"]), len(wall.film.axial.z))
    assert kind.cross_section(foundation, W) == {}
