"""Paths with friction under a load in 3-D, whose contact lines cross the stations between nodes (M7), (M14)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.balance import balance
from petalfoil.analysis.impedance import elastic_and_sliding, impedance
from petalfoil.analysis.runup import runup
from petalfoil.case import Case
from petalfoil.equilibrium import friction_under_load
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.friction_under_load import PATH, LoadedPath, path_of, sampled
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.rubbing_line_tangent import RubbingLineTangent
from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.equilibrium.sinking import Medium
from petalfoil.equilibrium.sinking_lines import SinkingLines
from petalfoil.equilibrium.small_motion import HELD_AT_NODES, ON_LINES
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of, slips
from petalfoil.system.loaded import load_of
from tests.cases import case

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
LOAD, SPEED = 5.0, 1500.0
RUBS = {"petals.theory": "shell", "surface.petal_friction": 0.1, "operation.eccentricity": (0.0, 0.0)}
KEPT = {"surface.friction_history": "assembled"}


def rubbing(**changes: object) -> Case:
    """Eight petals of the paper in 3-D with friction, on a coarse grid."""
    coarse = {"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **{**coarse, **RUBS, **KEPT, **changes})


def path_under(of: Case, load: float) -> tuple[CoupledProblem, LoadedPath]:
    """The bearing with a centred journal, and the path of a load [N]."""
    problem = build_problem(of)
    friction = friction_of(of, problem.layout)
    assert friction is not None
    return problem, LoadedPath(friction, load_of(of, (0.0, -load), problem.layout))


def lines_of(found: Solution | None) -> RubbingLines:
    """The state of a path with contact lines."""
    assert found is not None
    assert isinstance(found.lines, RubbingLines)
    return found.lines


@pytest.fixture(scope="module")
def loaded() -> Iterator[tuple[CoupledProblem, LoadedPath, Solution]]:
    """The bearing loaded at rest and run up, all along on contact lines."""
    with running() as run:
        problem, path = path_under(rubbing(), LOAD)
        down = path.set_down(problem)
        assert down is not None
        found = path.run_up(down, problem.at(bearing_number=problem.layout.bearing_number(SPEED)))
        lines_of(found)
        assert found is not None
        assert not any(row.get("outcome") == "contact points lost" for row in run.history)
        yield problem, path, found


Loaded = tuple[CoupledProblem, LoadedPath, Solution]


def test_a_balance_has_contact_lines_and_balances() -> None:
    """By the verb: residuals, force, and the petals' support of what loads them."""
    (found,) = balance.records(rubbing(), load=(0.0, -LOAD), speed=SPEED)
    scalars = found.scalars
    assert scalars["contact_model"] == ON_LINES
    assert scalars["friction_path"] == PATH
    assert float(scalars["petal_friction_work"]) > 0.0
    assert float(scalars["residual"]) <= 1e-8
    assert float(scalars["force_residual"]) <= 1e-9
    assert float(scalars["reaction_balance_error"]) <= 1e-8
    assert float(scalars["mass_balance_error"]) <= 1e-8
    assert not any("at nodes" in text for text in found.warnings)


def test_every_contact_keeps_the_law_of_the_disk(loaded: Loaded) -> None:
    """After a further step friction forces are within their limits, and where they are at them against the slip."""
    _, path, found = loaded
    start = lines_of(found)
    more = LoadedPath(path.friction, 1.05 * path.load)
    step = more.stepped(found.problem, path_of(found), Medium())
    assert step is not None
    end = step[1]
    assert isinstance(end, RubbingLines)
    slip, size = slips(end.law, end.x - start.x).reshape(2, -1), np.linalg.norm(end.friction_force, axis=0)
    most = end.limit.max()
    assert np.all(size <= end.limit + 1e-9 * most)
    slides, far = size >= (1.0 - 1e-9) * end.limit, np.linalg.norm(slip, axis=0)
    rubs = slides & (end.limit > 0.0) & (far > 1e-6)
    assert rubs.sum() > 10
    assert_allclose(end.friction_force[:, rubs], end.limit[rubs] / far[rubs] * slip[:, rubs], atol=1e-7 * float(most))
    assert far[~slides].max(initial=0.0) <= 1e-8
    assert end.reactions.min() >= 0.0


def test_little_friction_is_the_equilibrium_without() -> None:
    """On contact lines: the journal's position differs in proportion to the friction."""
    none = {"surface.petal_friction": 0.0, "surface.friction_history": "relaxed"}
    (free,) = balance.records(rubbing(**none), load=(0.0, -LOAD), speed=SPEED)
    assert free.scalars["contact_model"] == ON_LINES
    away = []
    for mu in (2e-4, 1e-4):
        (found,) = balance.records(rubbing(**{"surface.petal_friction": mu}), load=(0.0, -LOAD), speed=SPEED)
        assert found.scalars["contact_model"] == ON_LINES
        away.append(float(found.scalars["eccentricity_y"]) - float(free.scalars["eccentricity_y"]))
    assert abs(away[0]) < 1e-7
    assert away[0] == pytest.approx(2.0 * away[1], rel=0.1)


def test_a_long_strip_is_set_down_as_in_2d() -> None:
    """Without lateral contraction, at rest: position and energy lost of contact points in 2-D."""
    found = []
    for kind in ({"model.axial_cells": 2}, {"model.kind": "2d"}):
        of = rubbing(**{"petals.poisson_ratio": 0.0, "model.cells_per_pitch": 24, **kind})
        with running():
            problem, path = path_under(of, LOAD)
            down = path.set_down(problem)
        assert down is not None
        assert down.contact_model != HELD_AT_NODES
        assert down.friction is not None
        scales = problem.layout.scales
        found.append((down.position * scales.length, down.friction.lost * scales.force * scales.length))
    (strip, strip_lost), (plane, plane_lost) = found
    assert plane[1] < -2e-5
    assert_allclose(strip, plane, rtol=0.0, atol=0.005 * abs(plane[1]))
    assert strip_lost == pytest.approx(plane_lost, rel=0.02)


def test_what_the_load_does_is_stored_or_lost() -> None:
    """Set down at rest: work against the pack is the change of elastic energy and what friction takes, over steps."""
    with running():
        problem, path = path_under(rubbing(), LOAD)
        states: list[RubbingLines] = []

        class Told(LoadedPath):
            """The path, with its states kept."""

            def stepped(self, *at: object) -> object:  # type: ignore[override]
                found = super().stepped(*at)  # type: ignore[arg-type]
                if found is not None and isinstance(found[1], RubbingLines):
                    states.append(found[1])
                return found

        lines_of(Told(path.friction, path.load).set_down(problem))
    petals = slice(0, problem.layout.n_wall)
    missed, lost = 0.0, states[-1].lost - states[0].lost
    for before, after in pairwise(states):
        way = after.problem.displacement - before.problem.displacement
        work = -0.5 * float((before.force + after.force) @ way)
        stored = [0.5 * float(one.x[petals] @ problem.layout.elastic_force(one.x[petals])) for one in (before, after)]
        missed += work - (after.lost - before.lost) - (stored[1] - stored[0])
    assert len(states) >= 6
    assert lost > 0.0
    assert abs(missed) < 0.03 * lost


def test_corrections_converge_quadratically_under_a_film(loaded: Loaded) -> None:
    """The tangent of film, petals, gaps and journal is exact: half as far away, a quarter is left."""
    _, _, found = loaded
    solved, left = lines_of(found), []
    for part in (1.0, 0.5):
        aside = solved.shifted(np.zeros(len(solved.x)), 1e-3 * part * np.array([0.3, -1.0]))
        tangent = RubbingLineTangent.about(aside, current_run().film_solver, rubs=False)
        after, whole = tangent.corrected(aside, aside)
        assert whole
        left.append(after.left)
    assert left[0] > 1e-8
    assert left[1] == pytest.approx(0.25 * left[0], rel=0.1)


def test_a_medium_holds_journal_and_petals_back(loaded: Loaded) -> None:
    """Twice the resistance, half the way, as long as it is most of what resists."""
    _, path, found = loaded
    start, moved = lines_of(found), []
    for thick in (1e3, 2e3):
        heavier = replace(start, load=1.01 * path.load)
        ahead = SinkingLines.of(heavier, Medium(thick, thick / 100.0), start.problem.displacement, start.x)
        end = slide_on_lines(ahead, start, current_run().film_solver)
        assert end is not None
        assert end.left <= 1e-8
        moved.append(float(np.linalg.norm(end.problem.displacement - start.problem.displacement)))
    assert moved[0] == pytest.approx(2.0 * moved[1], rel=0.05)


def test_stiffness_of_a_pack_that_sticks_is_the_derivative_of_its_path(loaded: Loaded) -> None:
    """A small change of the load against the stuck limit of `coefficients`, with more friction than the path had."""
    _, path, found = loaded
    scales, places = found.problem.layout.scales, []
    sticky = replace(path.friction, coefficient=1e3)
    begin = replace(lines_of(found), friction=sticky)
    for part in (1.0 + 1e-6, 1.0 - 1e-6):
        step = LoadedPath(sticky, path.load * part).stepped(found.problem, begin, Medium())
        assert step is not None
        places.append(step[0].displacement * scales.length)
    K = impedance(elastic_and_sliding(found.case, found)[0], 0.0, SPEED)[0]
    pushed = path.load * scales.force * 2e-6
    assert_allclose(K @ (places[0] - places[1]), pushed, atol=0.01 * np.linalg.norm(pushed))


def test_lines_that_are_lost_are_nodes(loaded: Loaded, monkeypatch: pytest.MonkeyPatch) -> None:
    """No lines are found at the next speed: nodes carry friction forces and energy on, and the run log says so."""
    problem, path, found = loaded
    monkeypatch.setattr(friction_under_load, "slide_on_lines", lambda *_: None)
    history = current_run().history
    nodal = path.run_up(found, problem.at(bearing_number=1.05 * found.problem.bearing_number))
    assert nodal is not None
    assert nodal.contact_model == HELD_AT_NODES
    assert nodal.friction is not None
    assert found.friction is not None
    assert nodal.friction.lost >= found.friction.lost
    assert nodal.force_residual <= 1e-9
    assert any(row.get("outcome") == "contact points lost" for row in history)


def test_friction_forces_at_nodes_are_those_of_the_lines(loaded: Loaded) -> None:
    _, path, found = loaded
    lines = lines_of(found)
    nodal: FrictionResult = sampled(path.friction, lines)
    shared = nodal.friction.force.reshape(2, -1).sum(axis=1)
    assert_allclose(shared, lines.friction_force.sum(axis=1), rtol=1e-9, atol=1e-9)
    law: Friction = lines.law
    assert law.slip.shape[0] == lines.friction_force.size


def test_a_run_up_and_down_has_hysteresis_on_lines() -> None:
    """Up to 1500 rad/s and back: every point balances, the way down is another, and energy is lost all along."""
    records = list(runup.records(rubbing(), load=(0.0, -LOAD), to=SPEED, points=3))
    assert [record.scalars["leg"] for record in records] == ["up"] * 3 + ["down"] * 2
    assert all(record.converged and record.scalars["friction_path"] == PATH for record in records)
    assert all(record.scalars["contact_model"] == ON_LINES for record in records)
    lost, y = (
        np.array([float(record.scalars[name]) for record in records])
        for name in ("petal_friction_work", "eccentricity_y")
    )
    assert np.all(np.diff(lost) > 0.0)
    assert np.all(np.abs(y[:2] - y[:2:-1]) > 1e-8)
