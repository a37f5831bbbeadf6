"""A stage in time with contact points: its equations hold at its end, and its tangent is their derivative."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.dynamics.adaptive_steps import HELD, LOST, MarchOptions, NextStep, march, without_points
from petalfoil.dynamics.point_path import KNOTS
from petalfoil.dynamics.point_stage import PointStage
from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import GAMMA, IMPLICIT, take_step
from petalfoil.equilibrium.element_tangent import ElementTangent, unbalanced
from petalfoil.equilibrium.run_context import RunContext
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_step import PointStepEquations
from tests.cases import case
from tests.contract.taylor import assert_tangent

Array = NDArray[np.float64]


def begun(**changes: object) -> Orbit:
    """The paper's 8 petals on a coarse grid with a rotor, released at its balance."""
    bearing = case("paper_n8", rotor={"mass": 3.0}, **{"model.cells_per_pitch": 16}, **changes)
    return Orbit.begin(bearing, OrbitRequest(revolutions=1.0, initial="balance"))


def first_stage(orbit: Orbit, step: float = 0.02) -> tuple[PointStage, PointState]:
    """The first stage of a step from there, and the state that it begins with."""
    start, bearing = orbit.start, orbit.system
    assert start.points is not None
    assert bearing.points is not None
    base = start.moving.plus(step, (IMPLICIT, start.change))
    stage = bearing.stage(base, start.tau + GAMMA * step, step, start, StageOptions(accuracy=1e-10))
    return PointStage(bearing.points, stage), start.points


def moved(equations: PointStepEquations, change: Array, move: Array) -> PointStepEquations:
    """The same at other unknowns, places among them, and another displacement."""
    state, whole = equations.state, equations.whole
    dw, dP, dlam, dt = np.split(change, np.cumsum([whole.n_wall, whole.n_film, len(state.points.reaction)]))
    points = replace(
        state.points,
        position=state.points.position + equations.travels * dt,
        reaction=state.points.reaction + (1.0 - equations.idle) * dlam,
    )
    problem = equations.problem.at(displacement=equations.problem.displacement + move)
    return replace(equations, problem=problem, state=PointState(state.w + dw, state.P + dP, points))


def test_tangent_of_rows_and_force_in_all_unknowns() -> None:
    """Taylor's test: films that store gas, points that travel, a journal with mass."""
    stage, state = first_stage(begun())
    equations = stage.at(state, stage.stage.base.e)
    rng = np.random.default_rng(5)
    change, move = rng.uniform(-1.0, 1.0, equations.n), np.array([0.7, -0.4])
    count = len(state.points.position)
    change[: equations.whole.n_wall] *= 0.1
    change[equations.n - count :] *= 0.1 * equations.travels
    fixed = equations.idle > 0.0
    change[equations.n - count - len(fixed) : equations.n - count][fixed] = 0.0

    def rows(t: float) -> Array:
        there = moved(equations, t * change, t * move)
        return np.concatenate([there.newton_residual, there.force])

    by_rows = equations.steady @ change + equations.forcing() @ move
    by_force = equations.force_rows @ change + equations.force_direct @ move
    assert_tangent(rows, np.concatenate([by_rows, by_force]), largest=2.0**-10)


def test_the_equations_of_a_stage_hold_at_its_end() -> None:
    """Film, petals, contacts, and the rotor's acceleration by the forces on it."""
    orbit = begun()
    stage, state = first_stage(orbit)
    pushed = replace(stage, stage=replace(stage.stage, outside=stage.stage.outside + np.array([0.2, -0.5])))
    with orbit.run.active():
        found = pushed.solved((state, orbit.start.e), None)
    assert found is not None
    assert found.residual < 1e-7
    moving, inner = found.moving, pushed.stage
    change = moving.minus(inner.base, inner.rate)
    assert_allclose(change.e, moving.v, rtol=1e-9, atol=1e-12)
    force = found.equations.force + found.equations.resists @ moving.e + inner.outside - inner.gyroscopic @ moving.v
    assert_allclose(inner.inertia @ change.v, force, atol=1e-7)
    assert found.equations.state.points.reaction.min() > 0.0
    assert_allclose(found.equations.gaps.value, 0.0, atol=1e-8)


def test_a_closed_film_is_no_start_of_a_stage() -> None:
    """As one foretold from the states before may have."""
    orbit = begun()
    stage, state = first_stage(orbit)
    equations = stage.at(state, orbit.start.e)
    thin = int(np.argmin(equations.film_thickness))
    toward = equations.whole.film_by_e[thin]
    closed = orbit.start.e - equations.film_thickness.ravel()[thin] * toward / (toward @ toward)
    before = orbit.run.film.factorizations
    with orbit.run.active():
        assert stage.solved((state, closed), None) is None
    assert orbit.run.film.factorizations == before
    assert "the film closes" in str(orbit.run.history)


def test_a_load_more_moves_the_journal_as_the_tangent_foretells() -> None:
    orbit = begun()
    stage, state = first_stage(orbit)
    more = np.array([0.3, -1.0])
    pushed = replace(stage, stage=replace(stage.stage, outside=stage.stage.outside + more))
    with orbit.run.active():
        found, then = (one.solved((state, orbit.start.e), None) for one in (stage, pushed))
        assert found is not None
        assert then is not None
        tangent = ElementTangent.at(found.equations, stage.load, LinearSolver())
    _, foretold = tangent.correction(found.equations.newton_residual, unbalanced(found.equations, pushed.load))
    assert_allclose(then.moving.e - found.moving.e, foretold, rtol=0.0, atol=1e-4 * np.linalg.norm(foretold))


@pytest.mark.parametrize("theory", ["inextensible", "shell"])
def test_a_motion_from_a_balance_stays_there(theory: str) -> None:
    """To rounding, and within one factorisation."""
    orbit = begun(**{"petals.theory": theory})
    start, before = orbit.start, orbit.run.film.factorizations
    options = MarchOptions(first=0.05, longest=0.05, fixed=True)
    last: list[Instant] = [step.end for step in orbit.run.during(march(orbit.system, start, 0.5, options))]
    assert last[-1].points is not None
    assert_allclose(last[-1].e, start.e, rtol=0.0, atol=1e-8)
    assert_allclose(last[-1].x, start.x, rtol=0.0, atol=1e-7)
    assert orbit.run.film.factorizations - before == 1


def test_a_tangent_serves_both_stages_and_the_next_step(run: RunContext) -> None:
    orbit = begun(**{"operation.load": (0.0, -20.0)})
    moving = replace(orbit.start.moving, v=np.array([0.02, 0.01]))
    start = replace(orbit.start, moving=moving, change=replace(orbit.start.change, e=moving.v))
    before, options = run.film.factorizations, StageOptions(accuracy=1e-5)
    first = take_step(orbit.system, [start], 1e-3, None, options)
    assert first is not None
    again = take_step(orbit.system, [start, first.inner, first.end], 1e-3, first.tangent, options)
    assert again is not None
    assert run.film.factorizations - before == 1


def test_a_motion_that_loses_its_points_again_holds_nodes_for_longer() -> None:
    """Shorter steps first, then contacts at nodes with the step of before; the next time at once and twice as long."""
    ahead, held = NextStep(0.16), []
    for attempts in (LOST, 1):
        for attempt in range(attempts):
            assert ahead.step == pytest.approx(0.16 / 4.0**attempt)
            ahead = without_points(ahead, ahead.step)
        held.append(ahead.at_nodes)
        assert ahead.step == pytest.approx(0.16)
        ahead = replace(ahead, at_nodes=0)
    assert held == [HELD, 2 * HELD]


def test_a_motion_whose_balance_has_no_points_begins_where_nodes_carry_the_load() -> None:
    """Ten petals on a coarse grid have none: the journal is released without a blow."""
    bearing = case("paper_n10", rotor={"mass": 3.0}, **{"model.cells_per_pitch": 16})
    orbit = Orbit.begin(bearing, OrbitRequest(revolutions=1.0, initial="balance"))
    assert orbit.start.points is None
    assert_allclose(orbit.start.change.v, 0.0, atol=1e-9)


def test_a_known_tangent_ends_stages_where_more_corrections_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Most stages then take one correction; the others tell what the tangent answers."""
    corrections, exactly = [], ElementTangent.correction

    def counted(tangent: ElementTangent, residual: Array, force: Array) -> tuple[Array, Array]:
        corrections.append(1)
        return exactly(tangent, residual, force)

    monkeypatch.setattr(ElementTangent, "correction", counted)
    orbit = begun()
    path, tangent, taken = [orbit.start], None, 0
    with orbit.run.active():
        for _ in range(12):
            exact = take_step(orbit.system, path, 0.05, None, StageOptions(accuracy=1e-11))
            before = len(corrections)
            found = take_step(orbit.system, path, 0.05, tangent, StageOptions(accuracy=1e-5))
            taken = len(corrections) - before
            assert exact is not None
            assert found is not None
            assert exact.end.points is not None
            assert found.end.points is not None
            for name in ("w", "P"):
                assert_allclose(getattr(found.end.points, name), getattr(exact.end.points, name), rtol=0.0, atol=2e-5)
            path, tangent = [*path, found.inner, found.end][-KNOTS:], found.tangent
    assert taken == 3  # two stages, and the estimate of the error
