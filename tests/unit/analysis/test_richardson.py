"""Limits, orders and bars of sequences whose answers are known."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.richardson import (
    FITTED,
    LARGEST_ORDER,
    LEAST_ORDER,
    SAFETY,
    SUSPICION,
    cautious,
    fitted,
    observed_order,
    richardson,
)


def power(limit: float, coefficient: float, order: float, count: int = 3, ratio: float = 2.0) -> list[float]:
    """Values with an error of exactly one power of the cell size."""
    return [limit + coefficient * ratio ** (-order * level) for level in range(count)]


@pytest.mark.parametrize("ratio", [1.5, 2.0, 4.0])
@pytest.mark.parametrize("order", [1.6, 2.0, 2.4])
@pytest.mark.parametrize(("limit", "coefficient"), [(3.0, 1.0), (-3.0, 1.0), (0.0, -2.0), (1e-6, 1e-8)])
def test_one_power_of_the_cell_size_is_exact(limit: float, coefficient: float, order: float, ratio: float) -> None:
    values = power(limit, coefficient, order, ratio=ratio)
    found = richardson(values, ratio)
    assert_allclose(found.limit, limit, rtol=1e-12, atol=1e-12 * abs(coefficient))
    assert_allclose(found.order, order, rtol=1e-8)
    assert_allclose(found.error, SAFETY * abs(limit - values[-1]), rtol=1e-6)
    assert found.trusted


def test_the_last_three_values_count() -> None:
    assert richardson([17.0, -5.0, *power(3.0, 1.0, 2.0)]) == richardson(power(3.0, 1.0, 2.0))


@pytest.mark.parametrize("order", [0.5, 1.0, 1.4, 2.6, 3.0, 6.0])
def test_an_odd_order_is_told_and_not_trusted(order: float) -> None:
    values = power(3.0, 1.0, order)
    found = richardson(values)
    assert_allclose(found.order, order, rtol=1e-8)
    assert not found.trusted
    if LEAST_ORDER <= order <= LARGEST_ORDER:
        assert_allclose(found.limit, 3.0, rtol=1e-12)
    assert found.error > SUSPICION * abs(3.0 - values[-1]) * (0.4 if order < LEAST_ORDER else 0.999)
    assert found.error > abs(3.0 - values[-1])


def test_a_difference_that_is_small_by_accident_makes_no_small_bar() -> None:
    found = richardson([1.0, 2.0, 2.0001])  # order 13: extrapolated no more than order 4 does
    assert_allclose(found.limit, 2.0001 + 0.0001 / 15.0, rtol=1e-12)
    assert_allclose(found.error, SUSPICION * (1.0 / 4.0) / 3.0, rtol=1e-12)  # as if 1.0 had shrunk by 4
    assert not found.trusted


def test_a_low_order_is_limited_in_the_limit_and_paid_for_in_the_bar() -> None:
    found = richardson(power(0.0, 1.0, 0.1))
    last = 2.0**-0.2
    step = last - 2.0**-0.1
    assert_allclose(found.limit, last + step / (2.0**LEAST_ORDER - 1.0), rtol=1e-12)
    assert_allclose(found.error, SUSPICION * abs(step) / (2.0**LEAST_ORDER - 1.0), rtol=1e-12)


@pytest.mark.parametrize(
    ("values", "largest"),
    [
        ([1.0, 2.0, 1.5], 1.0),  # turns back
        ([1.0, 1.1, 0.5], 0.6),
        ([1.0, 1.1, 1.3], 0.2),  # runs away
        ([1.0, 1.0, 1.25], 0.25),
        ([1.25, 1.0, 1.0], 0.25),  # stands still by accident
        ([1.0, 1.5], 0.5),  # too few
    ],
)
def test_without_an_order_the_finest_value_and_thrice_the_largest_difference(
    values: list[float], largest: float
) -> None:
    found = richardson(values)
    assert found.limit == values[-1]
    assert math.isnan(found.order)
    assert_allclose(found.error, SUSPICION * largest, rtol=1e-12)
    assert not found.trusted


def test_equal_values_have_no_error() -> None:
    found = richardson([2.5, 2.5, 2.5])
    assert (found.limit, found.error, found.trusted) == (2.5, 0.0, True)
    assert math.isnan(found.order)


def test_values_that_agree_to_the_residual_are_trusted_no_further() -> None:
    found = richardson([2.0, 2.0 + 1e-9, 2.0 - 1e-9])
    assert (found.limit, found.trusted) == (2.0 - 1e-9, True)
    assert_allclose(found.error, 2e-8, rtol=1e-6)


def test_a_resolution_tells_rounding_from_convergence() -> None:
    rounding = [3e-13, -2e-13, 5e-13]
    assert not richardson(rounding).trusted
    found = richardson(rounding, resolution=1e-9)
    assert (found.limit, found.error, found.trusted) == (5e-13, 1e-9, True)


@pytest.mark.parametrize(
    ("values", "ratio", "reason"),
    [
        ([1.0], 2.0, "two values"),
        ([], 2.0, "two values"),
        ([1.0, math.nan, 2.0], 2.0, "finite"),
        ([1.0, math.inf], 2.0, "finite"),
        ([1.0, 2.0, 3.0], 1.0, "above 1"),
        ([1.0, 2.0, 3.0], math.nan, "above 1"),
    ],
)
def test_what_cannot_be_extrapolated_is_refused(values: list[float], ratio: float, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        richardson(values, ratio)


def test_order_of_two_differences() -> None:
    assert_allclose(observed_order([-8.0, -1.0], 2.0), 3.0, rtol=1e-14)
    assert math.isnan(observed_order([1.0], 2.0))
    assert math.isnan(observed_order([1.0, -0.5], 2.0))


def test_caution_takes_the_larger_of_what_is_and_what_should_be() -> None:
    assert cautious([4.0, 0.5], 2.0, 3.0) == 1.0 / 3.0
    assert cautious([4.0, 2.0], 2.0, 1.0) == 2.0


def test_where_contacts_are_described_otherwise_no_order_is_believed() -> None:
    """A jump between descriptions does not shrink with the cells."""
    values = [-15664.9, -15422.0, -15384.0]  # points, points, asperities; on a finer grid -15525 with points
    believed, cautious = richardson(values), richardson(values, alike=False)
    assert believed.error < abs(-15525.0 - values[-1]) < cautious.error
    assert (cautious.limit, cautious.trusted) == (values[-1], False)
    assert cautious.error == pytest.approx(values[1] - values[0])


GRIDS = (48, 64, 96, 128)


@pytest.mark.parametrize("cells", [GRIDS, (32, 40, 72, 80, 200)])
@pytest.mark.parametrize(("limit", "slope"), [(3.0, 1.0), (-3.0, 0.1), (1e-6, 1e-4)])
def test_a_fit_of_second_order_values_is_exact(cells: tuple[int, ...], limit: float, slope: float) -> None:
    values = [limit + slope / n**2 for n in cells]
    found = fitted(values, cells)
    assert_allclose(found.limit, limit, rtol=1e-10)
    assert_allclose(found.error, FITTED * abs(values[-1] - limit), rtol=1e-4)
    assert found.trusted


@pytest.mark.parametrize("slope", [0.0, 1.0])
@pytest.mark.parametrize("cells", [GRIDS, (64, 72, 80, 88, 96, 112, 128)])
def test_bars_of_a_fit_hold_where_values_scatter(cells: tuple[int, ...], slope: float) -> None:
    """Normal scatter of a size up to that of the error, and scatter alone: 95 % and more of the bars hold."""
    found = [fitted(values, cells) for values in scattered(cells, slope)]
    held = sum(abs(one.limit - 10.0) <= one.error for one in found)
    assert 0.945 * len(found) <= held < len(found)
    assert all(
        one.error >= FITTED * abs(one.limit - values[-1])
        for one, values in zip(found, scattered(cells, slope), strict=True)
    )


def test_more_grids_make_the_bar_of_scattering_values_narrower() -> None:
    few, many = (
        np.median([fitted(values, cells).error for values in scattered(cells, 0.0)])
        for cells in ((64, 80, 96, 128), (64, 72, 80, 88, 96, 112, 128))
    )
    assert many < 0.7 * few


def test_a_fit_tells_whether_values_change_with_the_grid() -> None:
    seen = [sum(fitted(values, GRIDS).trusted for values in scattered(GRIDS, slope)) for slope in (0.0, 1.0)]
    assert seen[0] < 0.08 * 2000  # 5 % by chance
    assert seen[1] > 0.4 * 2000


def scattered(cells: Sequence[int], slope: float) -> list[list[float]]:
    """2000 sequences that tend to 10, with normal scatter of a standard deviation of up to 1 each."""
    rng = np.random.default_rng(5)
    sizes = rng.uniform(0.0, 1.0, 2000)
    return [[10.0 + slope * (128.0 / n) ** 2 + rng.normal(scale=size) for n in cells] for size in sizes]


def test_a_fit_of_equal_values_is_that_value() -> None:
    assert fitted([2.0, 2.0, 2.0, 2.0], GRIDS).limit == 2.0
    assert fitted([2.0, 2.0, 2.0, 2.0 + 1e-9], GRIDS).error == pytest.approx(2e-8, rel=1e-6)


@pytest.mark.parametrize("values", [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0, math.nan]])
def test_a_fit_needs_four_finite_values(values: list[float]) -> None:
    with pytest.raises(ValueError, match="four finite values"):
        fitted(values, GRIDS)
