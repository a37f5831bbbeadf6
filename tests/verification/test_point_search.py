"""When a search for contact points is given up, and that it is not where there are some."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from petalfoil.analysis.operating_point import at_position
from petalfoil.equilibrium.element_contacts import start_at
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.point_contacts import with_points
from petalfoil.equilibrium.point_prospects import SearchedSets, are_same, turned_points
from petalfoil.equilibrium.run_context import running
from petalfoil.physics.gap_curves import ContactPoints
from tests.random_packs import random_case
from tests.verification.random_answers import answer_of


@pytest.mark.slow
@pytest.mark.parametrize(("number", "most"), [(159, 24), (177, 24)])
def test_a_search_that_creeps_takes_a_whole_step(number: int, most: int) -> None:
    """42 and 36 factorisations where every step was halved until the residual fell; 20 when this was written."""
    whole, answer = answer_of(number)
    with running() as run:
        found = with_points(whole, answer.problem, start_at(whole, answer))
    assert found.residual <= 1e-8
    assert run.film.factorizations <= most


@pytest.mark.slow
def test_a_search_that_creeps_to_its_end_begins_again() -> None:
    """A pack on 128 cells whose first search took 23 factorisations or more than 48 by the order of a sum."""
    pack = random_case(np.random.default_rng(1), **{"model.cells_per_pitch": 128})
    with running() as run:
        answer = at_position(pack).answer
        whole, before = answer.problem.layout.elements, run.film.factorizations
        assert whole is not None
        found = with_points(whole, answer.problem, start_at(whole, answer))
    assert found.residual <= 1e-8
    assert run.film.factorizations - before <= 72


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "why"), [(21, "reactions pull"), (118, "bend the other way"), (88, "sets of contacts recur")]
)
def test_a_search_for_contact_points_is_given_up(number: int, why: str) -> None:
    """Where it took 48 factorisations in vain."""
    whole, answer = answer_of(number)
    with running() as run, pytest.raises(NoPointsError, match=why):
        with_points(whole, answer.problem, start_at(whole, answer))
    assert run.film.factorizations <= 30


def test_points_at_which_gaps_bend_the_other_way_are_counted() -> None:
    """None in an equilibrium; of points without reactions all along the curves those where these bend so."""
    whole, answer = answer_of(5)
    with running():
        found = with_points(whole, answer.problem, start_at(whole, answer))
    assert turned_points(found.equations) == 0
    curve, position, *_ = whole.curves.samples(1)
    none = np.zeros(len(curve), dtype=np.intp)
    everywhere = ContactPoints(curve, position, none, np.zeros(len(curve)))
    state = replace(found.equations.state, points=everywhere)
    wanted = int(np.count_nonzero(whole.curves.rows(curve, position, 2) @ found.equations.nodal_gaps < 0.0))
    assert 0 < wanted < len(curve)
    assert turned_points(replace(found.equations, state=state)) == wanted


def test_sets_of_contacts_that_recur_are_known_again() -> None:
    whole, answer = answer_of(5)
    with running():
        found = with_points(whole, answer.problem, start_at(whole, answer))
    points, seen = found.points, SearchedSets()
    elsewhere = replace(points, position=points.position + 1e-3)
    assert are_same(points, replace(points, position=points.position + 1e-9))
    assert not are_same(points, elsewhere)
    seen.check(found.equations, points)
    seen.check(found.equations, elsewhere)
    with pytest.raises(NoPointsError, match="recur"):
        seen.check(found.equations, points)
