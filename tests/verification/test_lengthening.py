"""A 2-D film without ends as the limit of ever longer bearings leads to the equilibrium of that film."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from petalfoil.case import Case
from petalfoil.equilibrium import lengthening
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.lengthening import lengthened
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.build import build_problem
from petalfoil.system.leaking_film import LeakingFilm
from tests import fuzz
from tests.cases import case


@pytest.fixture
def closed() -> Case:
    """Petals whose film is continuous over their edges."""
    return case("paper_n8", **{"model.edges": "continuous", "model.cells_per_pitch": 8})


def test_a_bearing_that_grows_longer_ends_in_the_equilibrium_without_ends(closed: Case) -> None:
    problem = build_problem(closed)
    found, cold = lengthened(problem), solve_cold(problem)
    assert not isinstance(found.problem, LeakingFilm)
    assert "finite length" in found.solution_path
    assert_allclose(found.x, cold.x, rtol=0.0, atol=1e-7)


def test_a_length_beyond_which_nothing_is_found_is_told(closed: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """An equilibrium that every search loses beyond a length of ten journal radii."""
    follow = lengthening.follow

    def lost(known: Solution, problem: LeakingFilm, *rest: object) -> Solution | None:
        return follow(known, problem, *rest) if getattr(problem, "leakage", 0.0) > 0.06 else None

    monkeypatch.setattr(lengthening, "follow", lost)
    monkeypatch.setattr(lengthening, "other_branches", lambda *_: iter(()))
    with pytest.raises(ConvergenceError, match=r"up to a length of 0\.2\d* m") as failure:
        lengthened(build_problem(closed))
    assert 'model.kind = "3d"' in failure.value.advice
    assert "0.05 m" in failure.value.advice


@pytest.mark.long
@pytest.mark.parametrize("number", [193, 533])
def test_a_bearing_that_nothing_else_answers(number: int) -> None:
    """Neither cold starts nor marches nor central paths lead to its equilibrium."""
    found = lengthened(build_problem(fuzz.bearing(number)))
    assert found.residual <= RESIDUAL_TOLERANCE
