"""Contact points between the nodes of gap lines: the curve through the gaps, its derivatives, shares of reactions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.physics.contact import GapLines
from petalfoil.physics.line_points import LinePoints

PHI = np.array([0.0, 0.1, 0.25, 0.3, 0.45, 0.6])
LINES = (GapLines(np.arange(12).reshape(2, 6), PHI, 2), GapLines(12 + np.arange(5).reshape(1, 5), PHI[:5], 1))


def points(kind: list[int], line: list[int], phi: list[float]) -> LinePoints:
    return LinePoints(LINES, 17, np.array(kind, dtype=np.intp), np.array(line, dtype=np.intp), np.array(phi))


@pytest.fixture
def some() -> LinePoints:
    return points([0, 0, 1], [1, 0, 0], [0.27, 0.18, 0.299])


def gaps_of(function: np.polynomial.Polynomial) -> np.ndarray:
    return np.concatenate([function(PHI), 2.0 * function(PHI), function(PHI[:5])])


def test_parabolas_are_met_between_nodes_at_unequal_distances(some: LinePoints) -> None:
    parabola = np.polynomial.Polynomial([0.3, -1.0, 2.5])
    gaps, factor = gaps_of(parabola), np.array([2.0, 1.0, 1.0])
    assert_allclose(some.value @ gaps, factor * parabola(some.phi), rtol=1e-13)
    assert_allclose(some.slope @ gaps, factor * parabola.deriv()(some.phi), rtol=1e-12)
    assert_allclose(some.curvature @ gaps, factor * parabola.deriv(2)(some.phi), rtol=1e-11)


@pytest.mark.parametrize(("one", "other"), [("value", "slope"), ("slope", "curvature")])
def test_derivatives_by_place(some: LinePoints, one: str, other: str) -> None:
    gaps, step = np.random.default_rng(1).normal(size=17), 1e-6
    ahead, behind = some.moved(np.full(3, step)), some.moved(np.full(3, -step))
    difference = (getattr(ahead, one) @ gaps - getattr(behind, one) @ gaps) / (2.0 * step)
    assert_allclose(getattr(some, other) @ gaps, difference, rtol=1e-7)


def test_value_and_slope_are_continuous_at_nodes() -> None:
    gaps = np.random.default_rng(2).normal(size=17)
    before, behind = (points([0], [0], [PHI[2] + side]) for side in (-1e-12, 1e-12))
    assert_allclose(before.value @ gaps, behind.value @ gaps, atol=1e-9)
    assert_allclose(before.slope @ gaps, behind.slope @ gaps, atol=1e-8)


def test_shares_keep_force_and_place_of_a_reaction(some: LinePoints) -> None:
    angle = gaps_of(np.polynomial.Polynomial([0.0, 1.0])) / np.repeat([1.0, 2.0, 1.0], [6, 6, 5])
    assert_allclose(some.shares.sum(axis=1), 1.0)
    assert_allclose(some.shares @ angle, some.phi, rtol=1e-13)
    assert some.shares.min() >= 0.0
    assert_allclose(some.value.sum(axis=1), 1.0)


def test_points_at_nodes_are_added_and_points_are_left_out(some: LinePoints) -> None:
    more = some.kept(np.array([True, False, False])).with_nodes(np.array([8, 14]))
    assert more.kind.tolist() == [0, 0, 1]
    assert more.line.tolist() == [1, 1, 0]
    assert_allclose(more.phi, [0.27, PHI[2], PHI[2]])
    assert more.beside.tolist() == [[8, 9], [8, 9], [14, 15]]
    assert_allclose(more.cell_length, 0.05)


def test_points_stay_on_their_lines(some: LinePoints) -> None:
    assert_allclose(some.moved(np.full(3, 9.0)).phi, [0.6, 0.6, 0.45])


def test_no_points() -> None:
    none = points([], [], [])
    assert none.value.shape == (0, 17)
    assert none.shares.shape == (0, 17)


def test_slopes_at_the_ends_are_those_of_chords() -> None:
    node, weight = LINES[0].slope_weights
    slopes = np.sum(weight * (PHI**2)[node], axis=1)
    assert_allclose(slopes[[0, -1]], [0.1, 1.05])
    assert_allclose(slopes[1:-1], 2.0 * PHI[1:-1])


def test_sums_over_gaps_are_those_of_the_matrices(some: LinePoints) -> None:
    gaps, reaction = np.random.default_rng(5).standard_normal(17), np.arange(1.0, 1.0 + len(some.phi))
    expected = [matrix @ gaps for matrix in (some.value, some.slope, some.curvature)]
    assert_allclose(some.along(gaps), expected, rtol=1e-12, atol=1e-12)
    assert_allclose(some.pushes(reaction), some.value.T @ reaction, rtol=1e-12, atol=1e-12)


def test_points_descend_to_where_the_gap_is_least(some: LinePoints) -> None:
    gaps = np.zeros(17)
    for lines in LINES:
        gaps[lines.number] = (lines.phi - lines.phi.mean()) ** 2
    near = some
    for _ in range(8):
        near = near.lowest(gaps)
    _, slope, curvature = near.along(gaps)
    assert_allclose(slope, 0.0, atol=1e-9)
    assert np.all(curvature > 0.0)


def test_numbers_of_an_earlier_state_are_kept(some: LinePoints) -> None:
    numbered = replace(some, before=np.arange(len(some.phi)))
    left = numbered.kept(np.arange(len(some.phi)) != 0)
    fresh = left.with_nodes(np.array([LINES[0].number[0, 3]]))
    assert fresh.before is not None
    assert fresh.before.tolist() == [*range(1, len(some.phi)), -1]
