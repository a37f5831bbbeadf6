"""Two unequal bearings on one shaft: numbers, tangent, and forces by virtual work."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil import Case
from petalfoil.errors import UsageError
from petalfoil.physics.forces import node_area
from petalfoil.system.build import build_pair
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.shaft_layout import apart, friction_on_shaft
from tests.cases import case
from tests.contract.taylor import assert_tangent, open_state

PLAIN = {"bearing": {"journal_radius": 0.02, "bushing_radius": 0.020025, "length": 0.03}, "plain": True}
ROTOR = {"mass": 1.0, "span": 0.2, "centre": 0.02}
GRID = {"model.kind": "3d", "model.cells_per_pitch": 6, "model.axial_cells": 4, "operation.tilt": (1e-5, -2e-5)}


def unequal(**changes: object) -> Case:
    """Petals in the first bearing, a plain bore with another gas in the second."""
    gas = {"viscosity": 2.2e-5, "ambient_pressure": 1.3e5}
    return case("paper_n8", **GRID, rotor={**ROTOR, "second": {**PLAIN, "gas": gas, **changes}})


def in_a_step(rng: np.random.Generator) -> tuple[ShaftStep, np.ndarray]:
    """The bearings in a step, and an open state."""
    pair = build_pair(unequal())
    x = np.empty(pair.layout.unknowns.n)
    for part, numbers in zip(pair.parts, pair.layout.numbers, strict=True):
        x[numbers] = open_state(part, rng)
    start = np.full(len(pair.stored(x)), 0.1)
    return ShaftStep(pair.layout, 2.0, np.array([0.1, -0.2, 0.03, 0.07]), 3.0, 0.7, start), x


def test_blocks_of_a_kind_follow_each_other() -> None:
    first, second = apart([[2, 1], [0, 3]])
    assert first.tolist() == [0, 1, 2]
    assert second.tolist() == [3, 4, 5]
    first, second = apart([[1, 2], [3, 1]])
    assert first.tolist() == [0, 4, 5]
    assert second.tolist() == [1, 2, 3, 6]


def test_the_tangent_of_two_bearings() -> None:
    rng = np.random.default_rng(3)
    problem, x = in_a_step(rng)
    direction, rows = rng.uniform(-1.0, 1.0, len(x)), problem.positive
    change = problem.linearize(x).matrix(np.zeros(len(problem.weight))) @ direction
    assert_tangent(lambda t: problem.linearize(x + t * direction).residual[rows], change[rows], 2.0**-14)
    barrier = rng.uniform(0.0, 2.0, len(problem.weight))
    added = (problem.linearize(x).matrix(barrier) - problem.linearize(x).matrix(0.0 * barrier)) @ direction
    expected = problem.G.T @ (barrier * (problem.G @ direction))
    assert_allclose(added, expected, atol=1e-9 * np.max(np.abs(expected)))


def test_the_position_of_the_shaft_enters_through_its_border() -> None:
    """Gaps and films move by it; forces and moments are those of virtual work, in either bearing's gas."""
    problem, x = in_a_step(np.random.default_rng(4))
    move = np.array([0.3, -0.2, 0.1, 0.4])
    there = problem.at(displacement=problem.displacement + move)
    assert_allclose(there.gaps(x), problem.gaps(x) + problem.border.gap_derivative @ move, atol=1e-12)
    length, force = problem.layout.scales.length, problem.layout.scales.force
    lam = np.zeros(len(problem.weight))
    work = 0.0  # of the films on the shaft, from pressures over areas
    for (part, own, _), (moved, _, _) in zip(problem.each(x, lam), there.each(x, lam), strict=True):
        area = node_area(part.layout.wall.film, part.layout.case.bearing.journal_radius)
        pushed = (part.pressure(own) - 1.0) * part.layout.scales.pressure * area
        work += float(np.sum(pushed * (moved.film(own) - part.film(own)))) * length
    assert_allclose(problem.journal_force(x, lam) @ move * force * length, work, rtol=1e-9)
    assert_allclose(
        problem.border.rows(np.where(np.arange(len(x)) >= problem.positive.start, x - 1.0, 0.0), lam),
        problem.journal_force(x, lam),
        rtol=1e-9,
    )


def test_each_bearing_has_its_own_speed_gas_and_slopes() -> None:
    problem, _ = in_a_step(np.random.default_rng(5))
    first, second = problem.parts
    assert_allclose(second.layout.speed(second.bearing_number), first.layout.speed(first.bearing_number), rtol=1e-12)
    assert second.layout.scales.pressure == 1.3e5
    lever, length = 0.5 * 0.03, problem.layout.scales.length
    slope = problem.displacement[2] * length / 0.1
    assert_allclose(second.displacement[2] * length / lever, slope + 1e-5, rtol=1e-12)
    assert_allclose(second.displacement[0] * length, 0.1 * length + (0.1 - 0.02) * slope, rtol=1e-12)


def test_friction_of_one_bearing_alone_and_of_two_laws() -> None:
    """A plain bore has no petals that rub."""
    rubbing = {"model.kind": "2d", "operation.tilt": None, "surface.petal_friction": 0.3}
    rubbing |= {"petals.theory": "inextensible"}
    pair = build_pair(unequal().replace(**rubbing, **{"rotor.second": {"plain": True}}))
    friction = friction_on_shaft(pair.layout)
    assert friction is not None
    x = np.random.default_rng(6).standard_normal(pair.layout.unknowns.n)
    assert friction.slip.shape[1] == pair.layout.parts[0].n_wall
    assert np.all(np.isfinite(friction.slip @ x[: friction.slip.shape[1]]))
    surface = {"contact_film_thickness": 1e-6, "petal_friction": 0.2, "friction_width": 1e-6}
    both = build_pair(unequal().replace(**rubbing, **{"rotor.second": {"surface": surface}}))
    with pytest.raises(UsageError, match="rub by different laws"):
        friction_on_shaft(both.layout)
