"""Paths with friction in 3-D, whose contact lines cross the stations between nodes (M14)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.equilibrium.friction_handover import at_nodes
from petalfoil.equilibrium.friction_history import PathEnd, assembled, moved
from petalfoil.equilibrium.line_dips import PENETRATION, at_both_nodes, closed_between, lowest_in_cells
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.line_handover import on_lines
from petalfoil.equilibrium.line_signs import closed_beside
from petalfoil.equilibrium.pack_at_rest import unloaded
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.rubbing_line_tangent import RubbingLineTangent
from petalfoil.equilibrium.rubbing_lines import matched
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of
from tests.cases import case

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
RUBS = {"petals.theory": "shell", "surface.petal_friction": 0.1, "operation.eccentricity": (0.0, 0.0)}
Assembled = tuple[CoupledProblem, Friction, PackOnLines]


def rubbing(**changes: object) -> Case:
    """Eight petals of the paper in 3-D with friction, on a coarse grid."""
    coarse = {"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **{**coarse, **RUBS, **changes})


def lines_of(way: PathEnd | None) -> PackOnLines:
    """The state at the end of a way, on contact lines all along."""
    assert way is not None
    assert isinstance(way.state, PackOnLines)
    assert way.at_points == way.steps
    return way.state


@pytest.fixture(scope="module")
def pack() -> Iterator[Assembled]:
    """The assembled pack."""
    with running():
        centred = build_problem(rubbing()).at(bearing_number=0.0)
        friction = friction_of(rubbing(), centred.layout)
        assert friction is not None
        yield centred, friction, lines_of(assembled(friction, centred))


def lowered(centred: CoupledProblem, way: float) -> CoupledProblem:
    """The journal `way` below the centre [m]."""
    return centred.at(displacement=np.array([0.0, -way]) / centred.layout.scales.length)


def round_journal(state: PackOnLines, problem: CoupledProblem) -> PackOnLines:
    """The state of a pack under the equations of another position of the journal."""
    return replace(state, pack=unloaded(problem, still=True))


def test_every_contact_keeps_the_law_of_the_disk(pack: Assembled) -> None:
    """Friction forces are within the limit of their contact, and where they are at it against the slip."""
    centred, _, start = pack
    end = slide_on_lines(round_journal(start, lowered(centred, 5e-6)), start, current_run().pack_solver)
    assert end is not None
    slip, size = (end.law.slip @ (end.x - start.x)).reshape(2, -1), np.linalg.norm(end.friction_force, axis=0)
    most = end.limit.max()
    assert np.all(size <= end.limit + 1e-9 * most)
    slides = size >= (1.0 - 1e-9) * end.limit
    far = np.linalg.norm(slip, axis=0)
    rubs = slides & (end.limit > 0.0) & (far > 1e-6)
    assert rubs.sum() > 20
    assert_allclose(end.friction_force[:, rubs], end.limit[rubs] / far[rubs] * slip[:, rubs], atol=1e-7 * float(most))
    assert far[~slides].max(initial=0.0) <= 1e-8
    assert end.residual <= 1e-8
    assert end.reactions.min() >= 0.0
    assert np.linalg.norm(end.friction_force[1]) > 0.0


def test_contacts_that_stick_lose_nothing_and_come_back(pack: Assembled) -> None:
    """Under a friction that nothing overcomes the pack is elastic."""
    centred, _, start = pack
    stuck = replace(start, friction=replace(start.friction, coefficient=1e4))
    there = slide_on_lines(round_journal(stuck, lowered(centred, 1e-7)), stuck, current_run().pack_solver)
    assert there is not None
    back = slide_on_lines(round_journal(there, centred), there, current_run().pack_solver)
    assert back is not None
    assert np.linalg.norm(there.x - start.x) > 1e-3
    assert_allclose(back.x, start.x, atol=1e-6 * np.linalg.norm(there.x - start.x))
    limits = there.limit @ np.ones(len(there.limit))
    assert max(there.lost, back.lost) <= 1e-8 * limits


def test_the_journal_does_the_work_that_is_stored_and_lost(pack: Assembled) -> None:
    """Down by 20 um: its work is the change of elastic energy and what friction takes, to the order of the steps."""
    centred, friction, start = pack
    missed = []
    for count in (4, 8):
        state, problem, work, lost = start, centred, 0.0, 0.0
        for way in np.linspace(0.0, 20e-6, count + 1)[1:]:
            there = lowered(centred, way)
            before = state.in_film(problem).force
            found = slide_on_lines(round_journal(state, there), state, current_run().pack_solver)
            assert found is not None
            mean = 0.5 * (before + found.in_film(there).force)
            work -= float(mean @ (there.displacement - problem.displacement))
            state, problem, lost = found, there, lost + found.lost
        energy = [0.5 * float(x @ centred.layout.elastic_force(x)) for x in (start.x, state.x)]
        missed.append(abs(work - lost - (energy[1] - energy[0])) / lost)
    assert missed[0] < 0.02
    assert missed[1] < 0.6 * missed[0]
    assert friction.directions == 2


def test_energy_closes_where_contacts_split() -> None:
    """The rig down by 7.5 um: contacts that appear beside others do so at the touch, and store nothing by that."""
    rig = case("rig", **{"model.kind": "3d", "model.cells_per_pitch": 16, "model.axial_cells": 6, **RUBS})
    with running():
        problem = build_problem(rig).at(bearing_number=0.0)
        friction = friction_of(rig, problem.layout)
        assert friction is not None
        centred, state, fresh = problem, lines_of(assembled(friction, problem)), 0
        for way in np.linspace(0.0, 7.5e-6, 13)[1:]:
            there, before = lowered(centred, way), state
            found = slide_on_lines(round_journal(before, there), before, current_run().pack_solver)
            assert found is not None
            mean = 0.5 * (before.in_film(problem).force + found.in_film(there).force)
            work = -float(mean @ (there.displacement - problem.displacement))
            stored = [0.5 * float(x @ centred.layout.elastic_force(x)) for x in (before.x, found.x)]
            assert abs(work - found.lost - (stored[1] - stored[0])) < 0.1 * found.lost
            fresh += int(np.count_nonzero(matched(found, before) < 0))
            state, problem = found, there
    assert fresh >= 8
    below = closed_between(state.points, state.gaps, 2.0 * PENETRATION)
    assert state.held[below.beside].any(axis=1).all()


def test_the_lowest_gap_of_a_cell_is_that_of_close_samples(pack: Assembled) -> None:
    state = pack[2]
    gaps = np.random.default_rng(7).normal(size=len(state.held))
    for kind, lines in enumerate(state.points.lines):
        place, depth = lowest_in_cells(at_both_nodes(lines, gaps))
        t, length = np.linspace(0.0, 1.0, 201), np.diff(lines.phi)
        phi = (lines.phi[:-1, None] + t * length[:, None]).ravel()
        one = replace(state.points, kind=np.full(len(phi), kind), line=np.full(len(phi), 1), phi=phi)
        sampled = one.along(gaps)[0].reshape(-1, len(t))[:, 1:-1]
        inside = (np.argmin(sampled, axis=1) > 0) & (np.argmin(sampled, axis=1) < sampled.shape[1] - 1)
        assert np.count_nonzero(inside) >= 1
        assert_allclose(depth[1][inside], sampled.min(axis=1)[inside], atol=1e-3)
        assert np.all(depth[1][inside] <= sampled.min(axis=1)[inside] + 1e-12)
        assert_allclose(place[1][inside], t[1 + np.argmin(sampled, axis=1)][inside], atol=0.006)


@pytest.mark.parametrize("depth", [0.01, 1e-5])
def test_a_contact_that_splits_gains_one_in_the_next_cell(pack: Assembled, depth: float) -> None:
    """A gap that the cubic of (K15) gives back in a cell beside that of a contact."""
    state = pack[2]
    lines = state.points.lines[0]
    middle = 0.3 * lines.phi[5] + 0.7 * lines.phi[6]
    vertex, length = 0.6 * lines.phi[4] + 0.4 * lines.phi[5], lines.phi[5] - lines.phi[4]
    gaps = np.ones(len(state.held))
    gaps[lines.number[2]] = 0.1 * ((lines.phi - vertex) / length) ** 2 - depth
    points = replace(state.points, kind=np.array([0]), line=np.array([2]), phi=np.array([middle]))
    one = replace(state, points=points, reaction=np.ones(1), held=np.zeros_like(state.held), held_reaction=np.zeros(0))
    vars(one)["gaps"] = gaps
    more = closed_beside(one)
    if depth < PENETRATION:
        assert more is None
        return
    assert more is not None
    assert_allclose(more.points.phi, [middle, vertex], rtol=1e-12)
    assert more.reaction.tolist() == [1.0, 0.0]
    in_its_own_cell = replace(one, points=replace(points, phi=np.array([vertex])))
    vars(in_its_own_cell)["gaps"] = gaps
    assert closed_beside(in_its_own_cell) is None


def test_corrections_without_friction_converge_quadratically(pack: Assembled) -> None:
    """The tangent of displacements and places is exact: half as far away, a quarter is left after a correction."""
    centred, _, start = pack
    solver, free = current_run().pack_solver, replace(start, friction_force=np.zeros_like(start.friction_force))
    solved = slide_on_lines(round_journal(free, centred), free, solver, rubs=False)
    assert solved is not None
    left = []
    for part in (1.0, 0.5):
        aside = replace(solved, points=solved.points.moved(0.02 * part * solved.points.cell_length))
        tangent = RubbingLineTangent.about(aside, solver, rubs=False)
        left.append(tangent.corrected(aside, aside)[0].residual)
    assert left[0] > 1e-9
    assert left[1] == pytest.approx(0.25 * left[0], rel=0.2)


def test_friction_forces_are_handed_over_to_nodes_and_back(pack: Assembled) -> None:
    centred, friction, start = pack
    nodal = at_nodes(friction, start, unloaded(centred, still=True))
    assert nodal is not None
    half = len(nodal.friction.force) // 2
    whole = start.friction_force.sum(axis=1)
    assert_allclose(nodal.friction.force.reshape(2, half).sum(axis=1), whole, rtol=1e-9, atol=1e-9)
    again = on_lines(friction, unloaded(centred, still=True), nodal)
    assert again is not None
    assert_allclose(again.friction_force.sum(axis=1), whole, rtol=1e-9, atol=1e-9)
    assert again.residual <= 1e-8


def test_without_lateral_contraction_a_path_is_near_that_of_2d() -> None:
    """Along the shaft all is alike: the strip has the moment and the force of contact points in 2-D."""
    way, changes = ["0 um", "-20 um"], {"petals.poisson_ratio": 0.0, "model.cells_per_pitch": 24}
    strip = static(rubbing(**changes, **{"model.axial_cells": 2}), way)
    plane = static(rubbing(**changes, **{"model.kind": "2d"}), way)
    assert float(np.min(strip.point_share)) == 1.0
    assert_allclose(strip.starting_torque, plane.starting_torque, rtol=0.005)
    assert_allclose(strip.force_y[1], plane.force_y[1], rtol=0.005)
    assert_allclose(strip.petal_friction_work[1], plane.petal_friction_work[1], rtol=0.02)


def test_a_path_of_points_counts_its_steps(pack: Assembled) -> None:
    centred, friction, start = pack
    way = moved(friction, (centred, start), lowered(centred, 4e-6))
    assert way is not None
    assert (way.steps, way.at_points) == (1, 1)
