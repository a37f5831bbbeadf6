"""One factor of contact lines serves other contacts: against the tangent of these contacts themselves."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.equilibrium import line_tangent
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.line_chords import by_chords
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.line_sets import between_nodes, newton, settled, start_at
from petalfoil.equilibrium.line_signs import gaining, revised, without
from petalfoil.equilibrium.line_tangent import LineResiduals, LineTangent
from petalfoil.equilibrium.run_context import running
from petalfoil.system.build import build_problem
from tests.cases import case
from tests.random_packs import random_case


@pytest.fixture(scope="module")
def lines() -> LineContacts:
    grid = {"model.cells_per_pitch": 16, "model.axial_cells": 8, "model.axial_density": "uniform"}
    there = {"operation.eccentricity": (0.0, -200e-6)}
    with running():
        found = between_nodes(solve_cold(build_problem(case("paper_n8_spatial", **(grid | there)))))
    assert found is not None
    return found


def own_tangent(state: LineContacts) -> LineTangent:
    with running() as run:
        return LineTangent.of(state, state.motion.growing(0.0, run.film_solver))


def marked(state: LineContacts) -> LineContacts:
    """The state with its own tangent, from which contacts are numbered."""
    points = replace(state.points, before=np.arange(len(state.reaction)))
    return replace(state, points=points, tangent=own_tangent(state))


def others(state: LineContacts) -> LineContacts:
    """Without a node and three points, with two points more, one of which carries load, and a larger reaction."""
    k = len(state.reaction)
    left = without(state, np.arange(len(state.held_reaction)) == 1, np.isin(np.arange(k), [2, 5, 7]))
    more = gaining(left, np.flatnonzero((left.gaps > 0.5) & (left.gaps < 1.0))[:2])
    reaction = more.reaction.copy()
    reaction[4] *= 2.0
    reaction[-1] = 0.7
    return replace(more, reaction=reaction)


@pytest.mark.parametrize("load", [None, np.array([0.1, -3.0])])
def test_a_factor_serves_other_contacts_as_their_own_would(lines: LineContacts, load: np.ndarray | None) -> None:
    """At a position and under a load: contacts end and begin, reactions change (E12), (E13)."""
    state = others(marked(replace(lines, load=load)))
    assert state.tangent is not None
    served = state.tangent.on(state, stiffer=1e-12)
    assert served is not None
    assert served.exchange is not None
    assert served.serves(state)
    assert not state.tangent.serves(state)
    rng = np.random.default_rng(3)
    left = LineResiduals(*(rng.standard_normal(np.shape(part)) for part in vars(LineResiduals.of(state)).values()))
    way = rng.standard_normal(2) if load is None else None
    one, other = (tangent.correction(state, left, way) for tangent in (served, own_tangent(state)))
    for name in ("x", "reaction", "displacement", "phi"):
        expected = getattr(other, name)
        assert_allclose(getattr(one, name), expected, rtol=0.0, atol=1e-10 * np.abs(expected).max())


def test_the_same_contacts_need_no_exchange(lines: LineContacts) -> None:
    state = marked(lines)
    assert state.tangent is not None
    served = state.tangent.on(state)
    assert served is not None
    assert served.exchange is None
    assert served.serves(state)
    stiffer = replace(state, reaction=np.where(np.arange(len(state.reaction)) < 2, 3.0, 1.0) * state.reaction)
    assert not served.serves(stiffer)
    amended = served.on(stiffer)
    assert amended is not None
    assert amended.serves(stiffer)


def test_what_a_factor_has_answered_once_is_not_solved_for_again(lines: LineContacts) -> None:
    """A node and three points have ended, two have begun, reactions are others: of these those that have begun are."""
    state = others(marked(lines))
    assert state.tangent is not None
    solves = [state.tangent.linear.factorised.factor.counter.solves]
    for _ in range(2):
        served = state.tangent.on(state, stiffer=1e-12)
        assert served is not None
        assert served.exchange is not None
        solves.append(state.tangent.linear.factorised.factor.counter.solves)
    first, again = np.diff(solves)
    exchange = served.exchange
    carries = len(exchange.turning.stiffer) - len(exchange.turning.of_factor)
    assert first == len(exchange.changes.T)
    assert again == exchange.added.by_x.shape[0] + carries


def test_too_many_others_ask_for_a_factor(lines: LineContacts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(line_tangent, "MOST_CHANGES", 5)
    state = others(marked(lines))
    assert state.tangent is not None
    assert state.tangent.on(state) is None
    assert by_chords(state) is state


def test_of_other_contacts_none_is_numbered(lines: LineContacts) -> None:
    state = marked(lines)
    assert state.tangent is not None
    unknown = replace(state, points=replace(state.points, before=None))
    assert state.tangent.on(unknown) is None


def test_a_contact_that_has_ended_is_solved_for_without_a_factorisation(lines: LineContacts) -> None:
    """By steps with the factor at hand the same state is found as with a factor of its own."""
    state = without(marked(lines), np.zeros(len(lines.held_reaction), bool), np.arange(len(lines.reaction)) == 3)
    with running() as run:
        by_factor = newton(state, 5)
    assert run.film.factorizations == 0
    with running():
        by_own = newton(replace(state, tangent=None), 5)
    assert by_factor.residual < 1e-8
    assert_allclose(by_factor.x, by_own.x, atol=1e-7)
    assert_allclose(by_factor.force, by_own.force, atol=1e-8 * np.abs(by_own.force).max())


def test_the_position_of_the_journal_costs_solves_only_where_it_is_asked_for(lines: LineContacts) -> None:
    with running() as run:
        response = lines.motion.growing(0.0, run.film_solver)
        assert run.film.solves == 0
        assert response.force_gradient.shape == (2, 2)
        assert run.film.solves == 2


@pytest.mark.slow
def test_where_steps_with_one_factor_creep_each_set_has_its_own() -> None:
    """The thirteenth of these random packs: sets of contacts that one factor serves end in a residual of 2e-3."""
    rng = np.random.default_rng(77)
    cases = [random_case(rng) for _ in range(13)]
    grid = {"model.kind": "3d", "petals.theory": "inextensible", "model.cells_per_pitch": 24, "model.axial_cells": 16}
    with running():
        nodal = solve_cold(build_problem(with_stations(cases[12].replace(**grid))))
        with pytest.raises(NoLinesError, match="residual"):
            settled(start_at(nodal))
        found = between_nodes(nodal)
    assert found is not None
    assert found.residual < 1e-8
    assert revised(found) is None
