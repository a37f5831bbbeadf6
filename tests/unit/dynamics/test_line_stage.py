"""A stage in time with contact lines: its equations hold at its end, and its tangent is their derivative."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.line_path import alike, line_guesses
from petalfoil.dynamics.line_stage import LineStage, LineStepContacts
from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import GAMMA, IMPLICIT, take_step
from petalfoil.equilibrium.line_stretches import Stretches
from petalfoil.equilibrium.line_tangent import LineResiduals
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.time_step import StepProblem
from tests.cases import case

Array = NDArray[np.float64]

GRID = {"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.axial_density": "uniform"}


@pytest.fixture(scope="module")
def orbit() -> Orbit:
    """The paper's 8 petals in 3-D on a coarse grid with a rotor, released at its balance."""
    bearing = case("paper_n8_spatial", rotor={"mass": 3.0}, **GRID)
    return Orbit.begin(bearing, OrbitRequest(revolutions=1.0, initial="balance"))


def first_stage(orbit: Orbit, more: tuple[float, float] = (0.0, 0.0), step: float = 0.02) -> LineStage:
    """The first stage of a step from there, under `more` load."""
    start, bearing = orbit.start, orbit.system
    base = start.moving.plus(step, (IMPLICIT, start.change))
    stage = bearing.stage(base, start.tau + GAMMA * step, step, start, StageOptions(accuracy=1e-10))
    before = Stretches.of(start.lines, len(start.active))
    return LineStage(replace(stage, outside=stage.outside + np.array(more)), before)


def begins(stage: LineStage, orbit: Orbit) -> LineStepContacts:
    """The state that a stage begins with."""
    assert orbit.start.lines is not None
    return stage.at(orbit.start.lines, None)


def test_a_correction_leaves_the_square_of_what_was_left(orbit: Orbit) -> None:
    """Newton's method with the tangent of the state: half the load asks for half, and leaves a quarter."""
    left = []
    for size in (200.0, 100.0, 50.0):
        stage = first_stage(orbit, (size, -size), step=0.3)
        state = begins(stage, orbit)
        with orbit.run.active():
            tangent = stage.tangent_at(state)
        ahead = stage.stepped(state, tangent, stage.correction(state, tangent)[0])
        left.append(max(np.max(np.abs(ahead.rows)), np.max(np.abs(ahead.unbalanced)), np.max(np.abs(ahead.closed))))
    assert left[0] > 1e-7
    assert left[1] <= 0.35 * left[0]
    assert left[2] <= 0.35 * left[1]


def test_the_equations_of_a_stage_hold_at_its_end(orbit: Orbit) -> None:
    """Film, petals, contacts, and the rotor's acceleration by the forces on it."""
    stage = first_stage(orbit, (0.2, -0.5))
    assert orbit.start.lines is not None
    with orbit.run.active():
        found = stage.solved(orbit.start.lines, None)
    assert found is not None
    assert found.residual <= RESIDUAL_TOLERANCE
    moving, inner, state = found.moving, stage.stage, found.equations
    change = moving.minus(inner.base, inner.rate)
    assert_allclose(change.e, moving.v, rtol=1e-9, atol=1e-12)
    force = state.problem.journal_force(state.x, state.lam) + inner.outside - inner.gyroscopic @ moving.v
    assert_allclose(inner.inertia @ change.v, force, atol=1e-7)
    assert state.reaction.min() > 0.0
    assert state.held_reaction.min() > 0.0
    assert_allclose(state.closed, 0.0, atol=1e-8)
    assert_allclose(change.stored, state.problem.storing(state.x, state.lam), atol=1e-7)


def test_a_load_more_moves_the_journal_as_the_tangent_foretells(orbit: Orbit) -> None:
    stage, pushed = first_stage(orbit), first_stage(orbit, (1e-3, -3e-3))
    assert orbit.start.lines is not None
    with orbit.run.active():
        found, then = (one.solved(orbit.start.lines, None) for one in (stage, pushed))
        assert found is not None
        assert then is not None
        tangent = stage.tangent_at(found.equations)
    state = replace(found.equations, load=pushed.load)
    foretold = tangent.correction(state, LineResiduals.of(state), None).displacement
    assert_allclose(then.moving.e - found.moving.e, foretold, rtol=0.0, atol=1e-4 * np.linalg.norm(foretold))


def test_a_motion_from_a_balance_stays_there(orbit: Orbit) -> None:
    """To rounding, and within one factorisation."""
    start, before = orbit.start, orbit.run.film.factorizations
    options = MarchOptions(first=0.05, longest=0.05, fixed=True)
    last: list[Instant] = [step.end for step in orbit.run.during(march(orbit.system, start, 0.2, options))]
    assert last[-1].lines is not None
    assert_allclose(last[-1].e, start.e, rtol=0.0, atol=1e-8)
    assert_allclose(last[-1].x, start.x, rtol=0.0, atol=1e-7)
    assert orbit.run.film.factorizations - before == 1


def test_a_tangent_serves_both_stages_and_the_next_step(orbit: Orbit) -> None:
    moving = replace(orbit.start.moving, v=np.array([0.02, 0.01]))
    start = replace(orbit.start, moving=moving, change=replace(orbit.start.change, e=moving.v))
    before, options = orbit.run.film.factorizations, StageOptions(accuracy=1e-5)
    with orbit.run.active():
        first = take_step(orbit.system, [start], 1e-3, None, options)
        assert first is not None
        again = take_step(orbit.system, [start, first.inner, first.end], 1e-3, first.tangent, options)
    assert again is not None
    assert orbit.run.film.factorizations - before == 1


def test_a_closed_film_is_no_start_of_a_stage(orbit: Orbit) -> None:
    """As one foretold from the states before may have."""
    assert orbit.start.lines is not None
    lines, stage = orbit.start.lines, first_stage(orbit)
    far = lines.problem.at(displacement=lines.problem.displacement + np.array([0.0, -1e3]))
    with orbit.run.active():
        assert stage.solved(replace(lines, problem=far), None) is None
    assert "the film closes" in str(list(orbit.run.history)[-1])


def test_guesses_go_on_along_the_path(orbit: Orbit) -> None:
    """Places, reactions and unknowns on a parabola are foretold; of other contacts the unknowns alone."""
    start, problem = orbit.start, orbit.system.problem
    assert start.lines is not None
    assert isinstance(problem, StepProblem)
    size = np.linspace(0.0, 1.0, len(start.lines.reaction))

    def at(tau: float) -> Instant:
        assert start.lines is not None
        bent = tau + tau**2
        points = start.lines.points.moved(1e-4 * bent * size)
        lines = replace(start.lines, x=start.x + 1e-3 * bent, points=points, reaction=start.lines.reaction + bent)
        return replace(start, tau=tau, lines=lines)

    path = [at(tau) for tau in (0.0, 0.1, 0.25, 0.3, 0.45)]
    ahead, still = line_guesses(problem, path, 0.5)
    expected = at(0.5).lines
    assert expected is not None
    assert_allclose(ahead.x, expected.x, rtol=1e-12)
    assert_allclose(ahead.points.phi, expected.points.phi, rtol=1e-12)
    assert_allclose(ahead.reaction, expected.reaction, rtol=1e-12)
    assert still is path[-1].lines
    last = path[-1].lines
    assert last is not None
    fewer = replace(last, points=last.points.kept(size > 0.0), reaction=last.reaction[size > 0.0])
    assert not alike(fewer, last)
    ahead, still = line_guesses(problem, [*path[:-1], replace(path[-1], lines=fewer)], 0.5)
    assert_allclose(ahead.x, expected.x, rtol=1e-12)
    assert_allclose(ahead.reaction, fewer.reaction)
