"""What varies: levels, intervals and scatter from texts with units."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.errors import DefinitionError, PetalfoilError, UnitError, UsageError
from petalfoil.studies.plan import grid, names_of, read_sample, sample, unit_sample
from petalfoil.studies.variation import Interval, read_levels, read_range, read_scatter
from tests.cases import case

PAPER = case("paper_n8")
MIDDLES = (np.arange(2000) + 0.5) / 2000


def test_levels_are_a_range_a_list_or_numbers() -> None:
    assert_allclose(read_levels(PAPER, "petals.thickness", "0.1 mm : 0.2 mm : 3").values, [1e-4, 1.5e-4, 2e-4])
    assert read_levels(PAPER, "petals.count", "6, 8,10").values == (6, 8, 10)
    assert read_levels(PAPER, "petals.count", [6, 8]).values == (6, 8)
    assert read_levels(PAPER, "petals.thickness", np.array([1e-4, 2e-4])).values == (1e-4, 2e-4)
    assert read_levels(PAPER, "operation.load.y", "-10 N : -20 N : 2").values == (-10.0, -20.0)


def test_an_interval_of_a_count_has_whole_numbers() -> None:
    count = read_range(PAPER, "petals.count", "6 : 8")
    assert isinstance(count, Interval)
    assert count.at(np.array([0.0, 0.4, 0.999])) == [6, 7, 8]
    assert_allclose(read_range(PAPER, "petals.thickness", "0.1 mm : 0.2 mm").at(np.array([0.25])), [1.25e-4])


@pytest.mark.parametrize(
    ("text", "kind", "width", "deviation"),
    [
        ("± 5 um", "uniform", 5e-6, 5e-6 / 3**0.5),
        ("+- 5 um", "uniform", 5e-6, 5e-6 / 3**0.5),
        ("normal 2 %", "normal", 3.52e-6, 3.52e-6),
        ("normal ± 2 um", "normal", 2e-6, 2e-6),
        ("triangular 6 um", "triangular", 6e-6, 6e-6 / 6**0.5),
    ],
)
def test_scatter_has_its_mean_and_standard_deviation(text: str, kind: str, width: float, deviation: float) -> None:
    (found,) = read_scatter(PAPER, "petals.thickness", text)
    assert (found.kind, found.nominal) == (kind, 176e-6)
    assert found.width == pytest.approx(width, rel=1e-12)
    values = np.array(found.at(MIDDLES))
    assert values.mean() == pytest.approx(176e-6, rel=1e-9)
    assert values.std() == pytest.approx(deviation, rel=3e-3)
    assert found.standard_deviation == pytest.approx(deviation, rel=1e-12)


@pytest.mark.parametrize(
    ("path", "text", "kind", "words"),
    [
        ("petals.thicknes", "± 5 um", DefinitionError, "Did you mean 'petals.thickness'?"),
        ("petals.thickness", "5 um", UsageError, "is no scatter"),
        ("petals.thickness", "± 5 N", UnitError, "measures something else"),
        ("petals.thickness", "± 0 um", DefinitionError, "greater than 0"),
        ("petals.count", "± 1", DefinitionError, "a count does not scatter"),
        ("petals.root_tilt", "± 1 deg", DefinitionError, "gives no number to scatter about"),
        ("bearing.length", "± 1 mm each", DefinitionError, "one value a petal"),
    ],
)
def test_scatter_that_cannot_be_is_refused(path: str, text: str, kind: type[PetalfoilError], words: str) -> None:
    with pytest.raises(kind) as refused:
        read_scatter(PAPER, path, text)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("path", "text", "words"),
    [
        ("petals.thickness", "1 mm : 2 m : 3", "petals.thickness: 1 m of '1 mm : 2 m : 3' is outside its range"),
        ("petals.thickness", "3 N, 4 N", "petals.thickness: '3 N' measures something else"),
        ("petals.thickness", "0.1 mm, 0.1 mm", "a value twice"),
        ("petals.thickness", "0.2 mm : 0.1 mm", "is empty"),
        ("petals.count", "6.5", "is not a whole number"),
        ("petals.count", "6, 80", "allowed: a whole number, at least 2 and at most 64"),
    ],
)
def test_values_that_cannot_be_are_refused(path: str, text: str, words: str) -> None:
    with pytest.raises(PetalfoilError) as refused:
        read_range(PAPER, path, text)
    assert words in str(refused.value)


def test_a_grid_has_all_combinations_the_last_fastest() -> None:
    plan = grid([read_levels(PAPER, "petals.count", "6,8"), read_levels(PAPER, "petals.thickness", "1e-4, 2e-4, 3e-4")])
    assert (plan.shape, plan.dims, len(plan.points)) == ((2, 3), ("count", "thickness"), 6)
    assert list(plan.points) == [plan.points[number] for number in range(6)]
    assert plan.points[1] == {"petals.count": 6, "petals.thickness": 2e-4}


def test_parameters_of_one_name_get_that_of_their_table() -> None:
    both = [read_levels(PAPER, f"{table}.{name}", "0.01, 0.02") for table, name in (("bearing", "length"),)]
    assert names_of(both) == ("length",)
    assert names_of([*both, *both]) == ("bearing_length", "bearing_length")


def test_a_sample_is_the_same_for_the_same_seed() -> None:
    lengths = [read_range(PAPER, "petals.thickness", "0.1 mm : 0.2 mm"), read_range(PAPER, "petals.count", "6 : 10")]
    first, again = sample(lengths, "sobol 20, seed 3"), sample(lengths, "sobol 20, seed 3")
    assert first.points == again.points
    assert first.points != sample(lengths, "sobol 20").points
    assert (first.dims, len(first.points)) == (("case",), 20)
    assert all(
        1e-4 <= point["petals.thickness"] <= 2e-4 and point["petals.count"] in range(6, 11) for point in first.points
    )


@pytest.mark.parametrize("kind", ["lhs", "sobol", "halton", "random"])
def test_a_sample_fills_the_unit_square(kind: str) -> None:
    points = unit_sample(kind, 256, 2, seed=1)
    assert points.shape == (256, 2)
    quarter = np.count_nonzero((points < 0.5).all(axis=1))
    assert 40 <= quarter <= 88
    if kind == "sobol":
        assert quarter == 64


@pytest.mark.parametrize("text", ["lhs", "200", "cube 20", "lhs 0", "lhs 2000000", "lhs 20 seed"])
def test_a_sample_that_cannot_be_is_refused(text: str) -> None:
    with pytest.raises(UsageError, match="sample"):
        read_sample(text)
