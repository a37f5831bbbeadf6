"""2-D equilibria from those under a coarse film: what is carried over, what it leads to, when it is not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.by_coarse_film import by_coarse_film, from_nothing
from petalfoil.analysis.operating_point import at_position, operating_point, with_reported
from petalfoil.case import Case
from petalfoil.dynamics import film_stability
from petalfoil.dynamics.film_stability import eigenvalue_at_hand, leading_eigenvalue
from petalfoil.equilibrium.coarse_film import carried, coarser_film, from_coarse_film
from petalfoil.equilibrium.contact_sets import revised
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.system.build import build_problem
from tests.cases import case
from tests.random_packs import random_case


def bearing(cells: int, **changes: object) -> Case:
    """Eight petals at 200 um."""
    return case("paper_n8", **{"model.cells_per_pitch": cells, "operation.eccentricity": (0.0, -200e-6), **changes})


def force(found: PointContacts) -> np.ndarray:
    """Force on the journal [N]."""
    return found.equations.force * found.equations.problem.layout.scales.force


@pytest.fixture(scope="module")
def known() -> PointContacts:
    with running():
        found = operating_point(bearing(32), None).answer.elements
    assert isinstance(found, PointContacts)
    return found


def test_under_the_same_film_everything_is_carried_over_as_it_is(known: PointContacts) -> None:
    again = carried(known.equations, build_problem(bearing(32)))
    assert_allclose(again.pressures, known.equations.pressures, rtol=1e-13)
    assert_allclose(again.deflection, known.equations.deflection, rtol=0.0, atol=0.0)
    assert np.max(np.abs(again.scaled)) <= 1e-8


def test_reactions_keep_their_newtons(known: PointContacts) -> None:
    """Units of force are those of a cell; pressures between coarse nodes are interpolated, half a per cent off."""
    fine = carried(known.equations, build_problem(bearing(128)))
    before = known.points.reaction * known.equations.problem.layout.scales.force
    assert_allclose(fine.state.points.reaction * fine.problem.layout.scales.force, before, rtol=1e-14)
    assert np.array_equal(fine.state.points.position, known.points.position)
    ahead = fine.force * fine.problem.layout.scales.force
    assert_allclose(ahead, force(known), atol=1e-2 * np.linalg.norm(force(known)))


@pytest.mark.parametrize("load", [None, (3.0, -20.0)])
def test_it_leads_to_the_equilibrium_that_is_found_from_nothing(load: tuple[float, float] | None) -> None:
    asked = bearing(64) if load is None else bearing(64, **{"operation.eccentricity": (0.0, 0.0)})
    with running() as run:
        found = operating_point(asked, load).answer
    assert found.solution_path.startswith("from the equilibrium on 32 cells per pitch")
    assert isinstance(found.elements, PointContacts)
    assert revised(found.elements.equations, closely=True) is None
    assert run.film.factorizations <= 2
    assert run.pack.factorizations == 0
    assert run.coarse.factorizations > 10
    with running():
        if load is None:
            own = with_reported(asked, at_position(asked)).answer.elements
        else:
            there = tuple(found.operating_state.displacement)
            own = with_reported(asked, at_position(asked.replace(**{"operation.eccentricity": there}))).answer.elements
    assert isinstance(own, PointContacts)
    assert_allclose(force(found.elements), force(own), atol=1e-7 * np.linalg.norm(force(own)))


def test_results_say_so_and_count_both_grids() -> None:
    told = petalfoil.solve.record(bearing(64)).scalars
    assert str(told["solution_path"]).startswith("from the equilibrium on 32 cells per pitch: interior point")
    assert told["contact_model"] == AT_POINTS
    assert int(str(told["factorizations"])) <= 2
    assert 10 < int(str(told["coarse_factorizations"])) <= 20
    assert told["known_equilibria"] == 1
    assert told["stable"]
    assert float(str(told["residual"])) <= 1e-8
    assert float(str(told["reaction_balance_error"])) <= 1e-9


@pytest.mark.parametrize("name", ["paper_n8", "paper_n10", "rig"])
def test_the_growth_rate_follows_from_the_tangent_at_hand(name: str) -> None:
    """Without a factorisation, near enough for its sign."""
    coarse = build_problem(case(name, **{"model.cells_per_pitch": 32, "operation.eccentricity": (0.0, -10e-6)}))
    with running() as run:
        found = from_nothing(coarse, None)
        assert found is not None
        before = run.film.factorizations
        near = eigenvalue_at_hand(found)
        assert (run.film.factorizations, run.probes.factorizations) == (before, 0)
        exact = leading_eigenvalue(found)
    assert run.probes.factorizations == 1
    assert abs(near - exact) <= 0.02 * abs(exact)


def test_a_growth_rate_in_doubt_is_found_exactly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(film_stability, "DOUBT", 1e3)
    with running() as run:
        found = from_nothing(build_problem(bearing(32)), None)
        assert found is not None
        assert eigenvalue_at_hand(found) == leading_eigenvalue(found)
    assert run.probes.factorizations == 2


def test_a_force_far_from_that_under_the_coarse_film_is_another_equilibrium(known: PointContacts) -> None:
    elsewhere = build_problem(bearing(64, **{"operation.eccentricity": (0.0, -150e-6)}))
    with running():
        assert from_coarse_film(known, elsewhere, None) is None


def test_where_it_saves_little_or_does_not_serve_the_case_begins_on_its_own_grid() -> None:
    assert coarser_film(bearing(63)) is None
    coarse = coarser_film(bearing(64))
    assert coarse is not None
    assert coarse.cells_per_pitch == 32
    assert coarser_film(bearing(64, **{"model.contacts": "nodes"})) is None
    assert coarser_film(bearing(64, **{"operation.speed": 0.0})) is None
    assert coarser_film(bearing(64, **{"surface.petal_friction": 0.1})) is None
    assert coarser_film(case("paper_n8_spatial")) is None
    with running() as run:
        assert by_coarse_film(build_problem(bearing(48)), None) is None
    assert run.coarse.factorizations == 0


@pytest.mark.slow
def test_a_bearing_with_several_equilibria_begins_on_its_own_grid() -> None:
    """Pack 67 of the random ones has two, which are found under the coarse film."""
    rng = np.random.default_rng(2024)
    packs = [random_case(rng, **{"model.cells_per_pitch": 64}) for _ in range(68)]
    with running() as run:
        assert by_coarse_film(build_problem(packs[67]), None) is None
    assert run.film.factorizations == 0
    assert run.coarse.factorizations > 30
