"""Equilibria with contact lines from those on coarse grids: what is carried over, what it leads to, when it is not."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.operating_point import position_point, rate_on_few_cells
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.branches import by_short_steps, found_by_chance
from petalfoil.equilibrium.coarse_start import begins_with_lines, by_coarse_grid, coarser, doubtful, settled_early
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.line_sets import between_nodes, settled, with_lines
from petalfoil.equilibrium.line_signs import corrected_early, revised
from petalfoil.equilibrium.prolonged_lines import between, chains, prolonged
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.equilibrium.whole_length import first_attempt
from petalfoil.physics.contact import GapLines
from petalfoil.system.build import build_problem, build_tilting
from tests.cases import case

FORCE = 1e-8
"""Forces of the same equilibrium, over the largest: both are solved to a residual of 1e-8."""


def bearing(cells: int = 16, axial: int = 8, down: float = 200e-6, **changes: object) -> Case:
    grid = {"model.cells_per_pitch": cells, "model.axial_cells": axial, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **(grid | {"operation.eccentricity": (0.0, -down)} | changes))


@pytest.fixture(scope="module")
def lines() -> LineContacts:
    with running():
        found = between_nodes(solve_cold(build_problem(bearing())))
    assert found is not None
    return found


def same_force(one: LineContacts, other: LineContacts, tolerance: float = FORCE) -> None:
    assert_allclose(one.force, other.force, atol=tolerance * np.abs(other.force).max())


def test_on_the_same_grid_everything_is_carried_over_as_it_is(lines: LineContacts) -> None:
    again = prolonged(lines, build_problem(bearing()), None)
    order, own = (np.lexsort((one.points.phi, one.points.line, one.points.kind)) for one in (again, lines))
    assert_allclose(again.x, lines.x, rtol=1e-12, atol=1e-10)
    assert_allclose(again.points.phi[order], lines.points.phi[own], rtol=1e-14)
    assert_allclose(again.points.line[order], lines.points.line[own])
    assert_allclose(again.reaction[order], lines.reaction[own], rtol=1e-12)
    assert_allclose(again.held, lines.held)


def test_reactions_and_forces_of_a_finer_grid_are_near_those_of_the_coarse_one(lines: LineContacts) -> None:
    fine = build_problem(bearing(32, 16))
    ahead = prolonged(lines, fine, None)
    sizes = [one.reaction.sum() * one.problem.layout.scales.force for one in (ahead, lines)]
    forces = [one.problem.film_force(one.x) * one.problem.layout.scales.force for one in (ahead, lines)]
    assert sizes[0] == pytest.approx(sizes[1], rel=0.15)
    assert_allclose(*forces, atol=0.1 * np.abs(forces[1]).max())


@pytest.mark.slow
def test_it_leads_to_the_equilibrium_that_is_found_from_nothing() -> None:
    """With shells: those that bend only may have one contact or two next to it at their sides, 1e-4 of the force."""
    fine = build_problem(bearing(48, 16, **{"petals.theory": "shell"}))
    with running() as cold:
        own = with_lines(solve_cold(fine)).lines
    with running() as run:
        found = by_coarse_grid(fine, None)
    assert found is not None
    assert isinstance(own, LineContacts)
    assert isinstance(found.lines, LineContacts)
    same_force(found.lines, own)
    assert revised(found.lines) is None
    assert 0 < run.film.factorizations < 0.4 * cold.film.factorizations
    assert run.pack.factorizations == 0
    assert run.coarse.factorizations > 10


BLOWER = {
    "bearing.journal_radius": 17e-3,
    "bearing.bushing_radius": 17.6e-3,
    "bearing.length": 30e-3,
    "petals.count": 10,
    "petals.arc_length": 24e-3,
    "petals.thickness": 0.12e-3,
    "petals.bend_radius": 24e-3,
    "petals.theory": "shell",
    "operation.speed": 6283.0,
}
"""Ten petals whose interior point takes a step of 0.15 of Newton's on 16 x 16 cells, and which have one equilibrium."""


@pytest.mark.slow
def test_a_short_step_on_the_coarse_grid_leads_on_where_few_cells_know_of_no_other(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fine = build_problem(bearing(48, 16, 100e-6, **BLOWER))
    with running():
        coarse = first_attempt(build_problem(coarser(fine.layout.case) or fine.layout.case))
        own = with_lines(solve_cold(fine)).lines
        found = by_coarse_grid(fine, None)
    assert coarse is not None
    assert by_short_steps(coarse)
    assert not found_by_chance(coarse)
    assert not doubtful(coarse)
    assert found is not None
    assert isinstance(own, LineContacts)
    assert isinstance(found.lines, LineContacts)
    same_force(found.lines, own)
    monkeypatch.setattr("petalfoil.equilibrium.coarse_start.known_on_few_cells", lambda problem: 2)
    assert doubtful(coarse)


@pytest.mark.slow
def test_growth_rates_seen_from_near_that_on_few_cells_are_those_seen_from_zero() -> None:
    """In fewer solves than from zero, which shows as a rate that differs in its last digits."""
    case = bearing(48, 16)
    found = position_point(case)
    rate = leading_eigenvalue(found.answer)
    assert found.answer.solution_path == "from the equilibrium on 16 × 16 cells"
    assert found.answer.on_few_cells is None
    assert found.branch.growth_rate == pytest.approx(rate.real * case.operation.speed, rel=1e-6)
    assert found.branch.growth_rate != rate.real * case.operation.speed
    with running() as run:
        assert rate_on_few_cells(found.answer) == 0.0
    assert run.coarse.factorizations == 0


@pytest.mark.slow
def test_a_load_is_carried_as_from_nothing() -> None:
    problem = build_problem(bearing(48, 16, 0.0))
    load = np.array([0.0, -10.0]) / problem.layout.scales.force
    with running():
        own = with_lines(balance_cold(problem, load)).lines
        found = by_coarse_grid(problem, load)
    assert found is not None
    assert found.force_residual < 1e-8
    assert own is not None
    assert_allclose(found.position, own.problem.displacement, atol=1e-3 * np.abs(own.problem.displacement).max())


@pytest.mark.slow
def test_a_tilted_journal_has_its_whole_length() -> None:
    problem = build_problem(bearing(24, 32, 100e-6, **{"operation.tilt": (4e-4, 2e-4)}))
    with running():
        found = by_coarse_grid(problem, None)
        assert found is not None
        own = settled(between_nodes(solve_cold(problem)))  # type: ignore[arg-type]
    assert isinstance(found.lines, LineContacts)
    same_force(found.lines, own, 1e-3)
    turned = problem.pressure(found.x)
    assert np.max(np.abs(turned - turned[:, :, ::-1])) > 0.01


def test_a_journal_that_is_free_to_tilt_begins_so_under_a_moment_only() -> None:
    free = build_tilting(bearing(48, 16, 100e-6))
    with running() as run:
        assert by_coarse_grid(free, None) is None
    assert run.coarse.factorizations == 0


def test_points_close_to_each_other_from_station_to_station_are_a_line() -> None:
    phi = np.array([0.1, 0.5, 0.12, 0.52, 0.9, 0.53])
    numbers = [np.array(part, dtype=np.intp) for part in ([0, 1], [2, 3, 4], [5])]
    assert chains(numbers, phi, 0.05) == [[0, 2], [1, 3, 5], [4]]


def test_contacts_at_nodes_are_carried_to_the_nodes_between_them() -> None:
    numbers = np.arange(5)[None, :]
    coarse = GapLines(numbers, np.linspace(0.0, 1.0, 5), 1)
    fine = GapLines(np.arange(9)[None, :], np.linspace(0.0, 1.0, 9), 1)
    shifted = GapLines(numbers, np.array([0.0, 0.2, 0.4, 0.6, 1.0]), 1)
    held = np.array([False, True, True, False, True])
    assert np.flatnonzero(between(held, coarse, fine)).tolist() == [2, 3, 4, 8]
    assert np.flatnonzero(between(np.arange(5) == 1, coarse, shifted)).tolist() == [1]


def test_before_it_has_converged_small_signs_are_left_alone(lines: LineContacts) -> None:
    assert corrected_early(lines, frees=True) is lines
    first = np.arange(len(lines.reaction)) == 0
    slightly = replace(lines, reaction=np.where(first, -1e-7, lines.reaction))
    assert corrected_early(slightly, frees=True) is slightly
    pulling = replace(lines, reaction=np.where(first, -1e-3, lines.reaction))
    assert len(corrected_early(pulling, frees=True).reaction) == len(lines.reaction) - 1


def test_points_that_do_not_curve_upward_may_travel_before_they_become_nodes(lines: LineContacts) -> None:
    turned = replace(lines)
    turned.__dict__["curvature"] = np.where(np.arange(len(lines.reaction)) == 3, -1.0, lines.curvature)
    assert corrected_early(turned, frees=True) is turned
    assert len(corrected_early(turned, frees=False).reaction) == len(lines.reaction) - 1


def test_from_afar_the_same_contacts_are_found(lines: LineContacts) -> None:
    """Without one of its points, and with its pressures a tenth closer to ambient."""
    x = lines.x.copy()
    x[lines.problem.positive] = 1.0 + 0.9 * (x[lines.problem.positive] - 1.0)
    others = np.arange(len(lines.reaction)) != 5
    less = replace(lines, x=x, points=lines.points.kept(others), reaction=lines.reaction[others], tangent=None)
    with running():
        found = settled_early(less)
    assert found.residual < 1e-8
    assert revised(found) is None
    same_force(found, lines, 1e-3)


def test_a_closed_film_is_no_start(lines: LineContacts) -> None:
    down = lines.problem.displacement - np.array([0.0, 100.0])
    with running() as run, pytest.raises(NoLinesError, match="the film closes"):
        settled_early(replace(lines, problem=lines.problem.at(displacement=down)))
    assert run.film.factorizations == 0


def test_grids_are_coarser_by_steps_and_only_where_it_is_worth_it() -> None:
    def grid(cells: int, axial: int) -> tuple[int, int] | None:
        found = coarser(bearing(cells, axial))
        return None if found is None else (found.cells_per_pitch, found.axial_cells)

    assert grid(64, 24) == (16, 16)
    assert grid(32, 16) is None
    assert grid(128, 24) == (64, 16)
    assert grid(64, 96) == (32, 48)
    assert grid(16, 16) is None


@pytest.mark.slow
def test_where_petals_lie_along_each_other_others_are_looked_for() -> None:
    """Ten petals at 280 um touch over a sixth of a pitch and more: `solve` finds out which equilibrium that is."""
    ten = case("paper_n10", **{"model.kind": "3d", "petals.theory": "inextensible", "model.cells_per_pitch": 48})
    ten = ten.replace(**{"model.axial_cells": 16, "operation.eccentricity": (0.0, -280e-6)})
    with running() as run:
        assert by_coarse_grid(build_problem(ten), None) is None
    assert run.film.factorizations == 0


def test_heat_friction_and_nodes_begin_on_their_own_grid() -> None:
    assert begins_with_lines(bearing(), None)
    assert not begins_with_lines(bearing(**{"model.contacts": "nodes"}), None)
    assert not begins_with_lines(bearing(**{"operation.speed": 0.0}), None)
    assert not begins_with_lines(bearing(**{"surface.petal_friction": 0.1}), None)
    assert not begins_with_lines(case("paper_n8"), None)


@pytest.mark.slow
def test_results_say_so_and_count_both_grids() -> None:
    record = petalfoil.solve.record(bearing(48, 16))
    told = record.scalars
    assert told["solution_path"] == "from the equilibrium on 16 × 16 cells"
    assert told["pack_iterations"] == 0
    assert 0 < int(told["factorizations"]) <= 10
    assert int(told["coarse_factorizations"]) > 10
    assert told["stable"]
    assert told["known_equilibria"] == 1
    assert float(told["residual"]) < 1e-8
    assert float(told["reaction_balance_error"]) < 1e-9
    assert float(told["mass_balance_error"]) < 1e-9


@pytest.mark.slow
def test_who_asks_is_told_of_every_step_and_may_end_it() -> None:
    """A page that cancels waits for the factorisation at work: steps on the coarse grid are told too."""
    told: list[str] = []
    found = petalfoil.solve.record(bearing(64, 24), progress=lambda _, text: told.append(text)).scalars
    assert len(told) > 20
    assert {"solve: pack", "solve: film", "solve: contact lines"} <= set(told)
    assert found["coarse_factorizations"] == pytest.approx(21, abs=5)

    def ended(_: float, text: str) -> None:
        if text == "solve: pack":  # on the coarse grid: the fine one has no steps of a pack
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        petalfoil.solve.record(bearing(64, 24), progress=ended)
