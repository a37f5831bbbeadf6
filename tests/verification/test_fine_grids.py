"""Fine grids lose digits in `K w`, and answers are refined below the last one: up to the largest grid allowed."""

import numpy as np
import pytest

from petalfoil.analysis.solve import solve
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.solution import Solution, evenly_rounded
from petalfoil.system.build import build_problem
from tests.cases import case

DIGITS = 1e-9
"""A tenth of the tolerance: at 4096 cells per pitch 8e-10 was found, whatever the processor, at 1024 2e-11."""


def bearing(cells: int) -> Case:
    return case("paper_n8", **{"model.cells_per_pitch": cells})


def at_rest_and_at_speed(cells: int) -> list[Solution | None]:
    problem = build_problem(bearing(cells))
    return [rest(problem), solve_cold(problem)]


@pytest.mark.slow
@pytest.mark.parametrize("cells", [896, 1024, 2048, 4096])
def test_answers_with_digits_to_spare(cells: int) -> None:
    for answer in at_rest_and_at_speed(cells):
        assert answer is not None
        assert answer.residual <= DIGITS


@pytest.mark.slow
@pytest.mark.parametrize("cells", [896, 1024, 2048, 4096])
def test_solve_far_from_the_centre(cells: int) -> None:
    found = solve.record(bearing(cells), eccentricity="0 um, -200 um").scalars
    assert found["residual"] <= 1e-8  # type: ignore[operator]
    assert found["factorizations"] <= 20  # type: ignore[operator]


def test_differences_of_evenly_rounded_neighbours_are_exact() -> None:
    """Also where deflections change sign: there the difference of doubles loses what the smaller one has more."""
    w = np.cumsum(np.random.default_rng(5).uniform(-1.0, 1.0, 1000))
    w *= 100.0 / np.max(np.abs(w))
    even = evenly_rounded(w)
    assert np.max(np.abs(even - w)) <= 0.5 * np.spacing(100.0)
    digit = np.spacing(100.0)
    whole = (even / digit).astype(np.int64)
    assert np.array_equal(np.diff(even), np.diff(whole) * digit)
