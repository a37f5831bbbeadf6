"""Discretised walls: their units and fields."""

from __future__ import annotations

import numpy as np

from petalfoil.case import Case
from petalfoil.walls import WallState, build_wall, wall_kind
from tests.cases import case

PETALS = case("paper_n8", **{"model.cells_per_pitch": 6})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.symmetry": False})


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
