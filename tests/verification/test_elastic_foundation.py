"""A bore on independent springs, `H = 1 + eps cos(theta) + alpha (P - 1)`: its exact limits.

As `Lambda` grows, `P H` becomes the same all round. With `alpha = 1`, `P (P + eps cos(theta)) = const` then makes

    W / (p_a L D) = pi eps / 4,   attitude angle 0

whatever the constant. A 2-D film is at the distance `1 / Lambda`; the ends of a 3-D one keep boundary layers of the
thickness `Lambda^(-1/2)`.
"""

from __future__ import annotations

import math

import pytest
import xarray as xr

import petalfoil
from petalfoil.case import Case
from tests.cases import case


def at(bearing: Case, number: float, relative: float = 0.4) -> Case:
    """`bearing` at a bearing number (by speed and viscosity) and a relative eccentricity."""
    viscosity = 1.85e-5 * max(1.0, number / 1e3)
    c, R_j = bearing.bearing.clearance, bearing.bearing.journal_radius
    speed = number * bearing.gas.ambient_pressure * c**2 / (6.0 * viscosity * R_j**2)
    changes = {"gas.viscosity": viscosity, "operation.speed": speed, "operation.eccentricity": (0.0, -relative * c)}
    return bearing.replace(**changes)


def load(of: Case) -> float:
    """`W / (p_a L D)` [1]."""
    area = 2.0 * of.bearing.journal_radius * of.bearing.length
    return float(petalfoil.solve(of)["bearing_force"]) / (of.gas.ambient_pressure * area)


def missing(of: Case, relative: float = 0.4) -> float:
    """Share of the limit that the load is short of [1]."""
    return 1.0 - load(of) / (math.pi * relative / 4.0)


def test_the_case_is_the_one_of_the_closed_form(foundation: Case) -> None:
    stiffness = foundation.wall.stiffness
    assert foundation.gas.ambient_pressure / (stiffness * foundation.bearing.clearance) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("relative", [0.1, 0.4, 0.9])
def test_load_and_attitude_at_a_bearing_number_of_a_million(foundation: Case, relative: float) -> None:
    fast = at(foundation, 1e6, relative)
    assert missing(fast, relative) == pytest.approx(0.0, abs=3e-7)
    assert float(petalfoil.solve(fast)["attitude_angle"]) == pytest.approx(0.0, abs=1e-6)


def test_a_2d_film_comes_nearer_as_one_over_the_bearing_number(foundation: Case) -> None:
    assert missing(at(foundation, 1e4)) / missing(at(foundation, 1e5)) == pytest.approx(10.0, rel=2e-3)


def test_a_3d_film_comes_nearer_as_the_root_of_one_over_the_bearing_number(foundation: Case) -> None:
    spatial = foundation.replace(**{"model.kind": "3d", "model.cells_per_pitch": 32, "model.axial_cells": 64})
    assert missing(at(spatial, 1e2)) / missing(at(spatial, 1e3)) == pytest.approx(math.sqrt(10.0), rel=0.03)


def test_the_springs_obey_their_law(foundation: Case) -> None:
    answer: xr.Dataset = petalfoil.solve(foundation)
    excess = answer["pressure"].to_numpy() - foundation.gas.ambient_pressure
    assert answer["deflection"].to_numpy() == pytest.approx(excess / foundation.wall.stiffness, rel=1e-9, abs=1e-15)


def test_a_stiff_foundation_is_a_plain_bearing(foundation: Case) -> None:
    plain = load(case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 24}))
    soft, stiff = (load(foundation.replace(**{"elastic_foundation.stiffness": k})) / plain - 1.0 for k in (4e13, 4e15))
    assert abs(stiff) < 2e-6
    assert soft / stiff == pytest.approx(100.0, rel=1e-2)  # the springs give way by alpha (P - 1)
