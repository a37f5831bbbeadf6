"""The position under a load: its equations, its step, and that a solution knows its operating state."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.contact_model import ContactModel
from petalfoil.equilibrium import under_load
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.run_context import RunContext
from petalfoil.equilibrium.under_load import MOST_FILMS, LoadedEquations, balance_cold, newton, rebalance
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.contact_equations import Correction
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from tests.cases import case

PETALS = case("paper_n8", **{"model.cells_per_pitch": 12, "operation.eccentricity": (0.0, 0.0)})
PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 24})


def start(name: str) -> tuple[CoupledProblem, float]:
    """A problem, and a load [N] that it carries."""
    return (build_problem(PETALS), 15.0) if name == "petals" else (build_problem(PLAIN), 200.0)


@pytest.mark.parametrize("name", ["petals", "plain"])
def test_forces_balance_and_the_state_is_that_of_the_position(name: str) -> None:
    """Solved again at the position found, the bearing carries the load."""
    problem, newtons = start(name)
    load = np.array([0.0, -newtons]) / problem.layout.scales.force
    found = balance_cold(problem, load)
    assert found.force_residual <= 1e-9
    assert_allclose(problem.journal_force(found.x, found.lam), -load, atol=1e-8 * np.linalg.norm(load))
    again = solve_cold(found.problem)
    force = again.problem.journal_force(again.x, again.lam)
    assert_allclose(force, -load, atol=1e-6 * np.linalg.norm(load))


def test_a_pack_is_bottomed_out_where_a_chain_of_contacts_is_closed_however_it_was_solved() -> None:
    problem, newtons = start("petals")
    light, heavy = (
        balance_cold(problem, np.array([0.0, -size]) / problem.layout.scales.force) for size in (newtons, 400.0)
    )
    assert heavy.bottomed_out
    assert ContactModel.of(heavy).bottomed_out
    assert ContactModel.of(light).bottomed_out is False  # a flag that every point of a series has
    assert "bottomed out" in heavy.solution_path
    assert not light.bottomed_out
    assert np.any(light.active)
    assert not replace(light, contacts=None).bottomed_out  # the interior point had the last word
    contacts = problem.layout.wall.contacts
    for rows in (contacts.journal, contacts.petals):  # the last link is a petal on the root of the next
        lam = heavy.lam.copy()
        lam[rows] = 0.0
        assert not replace(heavy, state=replace(heavy.state, lam=lam)).bottomed_out


@pytest.mark.parametrize("name", ["petals", "plain"])
def test_a_solution_knows_its_operating_state(name: str) -> None:
    problem, newtons = start(name)
    given = problem.layout.case
    found = balance_cold(problem, np.array([0.0, -newtons]) / problem.layout.scales.force)
    at = found.operating_state
    assert found.case is given
    assert at.speed == pytest.approx(given.operation.speed, rel=1e-12)
    assert at.load is not None
    assert_allclose(at.load, [0.0, -newtons], rtol=1e-12)
    assert_allclose(at.displacement, found.problem.displacement * problem.layout.scales.length, rtol=1e-12)
    held = solve_cold(build_problem(given))
    assert held.operating_state.load is None
    assert np.isnan(held.force_residual)
    assert_allclose(held.operating_state.displacement, given.operation.eccentricity, atol=1e-18)


def test_a_step_of_newton_is_the_derivative_of_the_balance(run: RunContext) -> None:
    """From a balance, a small change of the load moves the journal by what the bordered tangent foretells."""
    problem, newtons = start("petals")
    load = np.array([0.0, -newtons]) / problem.layout.scales.force
    found = balance_cold(problem, load)
    assert found.contacts is not None
    change = 1e-5 * load
    ahead = newton(found.problem, (found.x, found.active), load + change)
    assert ahead is not None
    foretold = np.linalg.solve(found.contacts.tangent.gradient, -change)
    moved = ahead.problem.displacement - found.problem.displacement
    assert_allclose(moved, foretold, rtol=0.0, atol=1e-3 * np.linalg.norm(foretold))


def test_a_neighbouring_balance_is_warm(run: RunContext) -> None:
    problem, newtons = start("petals")
    load = np.array([0.0, -newtons]) / problem.layout.scales.force
    found, cold = balance_cold(problem, load), run.film.factorizations
    near = rebalance(found, problem, 1.05 * load)
    assert near.force_residual <= 1e-9
    assert run.film.factorizations - cold <= min(6, cold // 2)


def test_the_journal_moves_by_a_few_films_at_most() -> None:
    problem, _ = start("plain")
    equations = LoadedEquations(problem, np.zeros(2))
    state = solve_cold(problem).contacts
    assert state is not None
    far = Correction(np.zeros(problem.layout.n), np.array([30.0, 40.0]), np.zeros(0))
    assert equations.step_length(state.state, far) == pytest.approx(MOST_FILMS / 50.0)
    near = Correction(np.zeros(problem.layout.n), np.array([0.3, 0.4]), np.zeros(0))
    assert equations.step_length(state.state, near) == 1.0


@pytest.mark.parametrize("edges", ["continuous", "ambient"])
def test_advice_of_a_film_without_ends_names_its_length(edges: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only `solve` makes a bearing longer and longer."""
    for search in ("from_nothing", "loaded_gradually", "by_slower_ways", "by_other_grids"):
        monkeypatch.setattr(under_load, search, lambda *_: None)
    problem = build_problem(PETALS.replace(**{"model.edges": edges}))
    with pytest.raises(ConvergenceError) as failure:
        balance_cold(problem, np.array([0.0, -1.0]))
    assert ("`solve`" in failure.value.advice) == (edges == "continuous")
    assert ("refine the grid" in failure.value.advice) == (edges == "ambient")
