"""Points at which friction acts in place of the contact pressure of an element (K18)."""

from __future__ import annotations

import numpy as np
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.physics.lumped_pressure import SPREAD, two_points

Array = NDArray[np.float64]

PLACE = (np.arange(48) + 0.5) / 48


def test_two_points_have_the_moments_of_the_pressure() -> None:
    """Up to the third, of pressures of every skewness, and lie within the samples that carry."""
    reaction = np.random.default_rng(3).uniform(0.0, 1.0, (7, 48)) ** np.arange(1, 8)[:, None] * PLACE**2
    element, place, part = two_points(PLACE, reaction)
    assert np.array_equal(np.bincount(element), np.full(7, 2))
    for power in range(4):
        assert_allclose(np.bincount(element, part * place**power), reaction @ PLACE**power, rtol=1e-12)


def test_even_pressure_has_the_points_of_gauss_and_legendre() -> None:
    """With 48 samples to their second order."""
    _, place, part = two_points(PLACE, np.ones((1, 48)))
    assert_allclose(place, 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0), atol=1e-4)
    assert_allclose(part, 24.0)


def beside_a_single_sample(spread: float) -> Array:
    """Reactions of one in all, an even pressure that makes up `spread`, and one sample with the rest, (2, 48)."""
    reaction = np.zeros((2, 48))
    reaction[0] = spread / (48 * np.var(PLACE))
    reaction[1, 7] = 1.0 - reaction[0].sum()
    return reaction


def test_light_pressures_and_single_samples_are_one_point() -> None:
    """At the centroid, with the whole reaction."""
    reaction = beside_a_single_sample(0.99 * SPREAD)
    element, place, part = two_points(PLACE, reaction)
    assert element.tolist() == [0, 1]
    assert_allclose(place, [0.5, PLACE[7]], rtol=1e-14)
    assert_allclose(part, reaction.sum(axis=1), rtol=1e-14)


def test_points_part_smoothly_as_a_pressure_gains_weight() -> None:
    """Half their distance over the standard deviation: from nothing, at first slowly, to one at twice the spread."""
    half = []
    for times in np.linspace(1.02, 2.2, 60):
        element, place, _ = two_points(PLACE, beside_a_single_sample(times * SPREAD))
        half.append(0.5 * np.ptp(place[element == 0]) / np.std(PLACE))
    steps = np.diff(half)
    assert 0.0 < half[0] < 5e-3
    assert steps[0] < 0.25 * np.max(steps)
    assert np.all(steps > -1e-12)
    assert_allclose(half[-1], 1.0, rtol=1e-12)


def test_without_contact_there_are_no_points() -> None:
    assert all(len(values) == 0 for values in two_points(PLACE, np.zeros((0, 48))))
