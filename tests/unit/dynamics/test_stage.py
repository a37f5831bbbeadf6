"""A stage in time: its equations hold at its end, and its tangent is their derivative."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.case import Case
from petalfoil.dynamics.point_path import KNOTS, foretelling, lagrange
from petalfoil.dynamics.stage import Stage, StageOptions, solve_stage
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import GAMMA, IMPLICIT, RotorBearing, take_step
from petalfoil.equilibrium.run_context import RunContext
from petalfoil.solvers import contact_newton
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_equations import ContactOptions, Step, StepVerdict, evaluate
from petalfoil.solvers.contact_newton import corrected, factorise
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.cases import case

ROTOR = {"mass": 3.0, "unbalance": 2e-6}
BEARINGS: dict[str, Case] = {
    "plain": case("plain_journal", rotor=ROTOR, **{"model.kind": "2d", "model.cells_per_pitch": 24}),
    "petals": case("paper_n8", rotor=ROTOR, **{"model.cells_per_pitch": 8}),
    "petals with friction": case(
        "paper_n8", rotor=ROTOR, **{"model.cells_per_pitch": 8, "surface.petal_friction": 0.2}
    ),
    "slow petals": case("paper_n8", rotor=ROTOR, **{"model.cells_per_pitch": 8, "operation.speed": 300.0}),
}


def begun(name: str) -> tuple[RotorBearing, Instant]:
    """A bearing with its rotor, and the instant it is let go at."""
    orbit = Orbit.begin(BEARINGS[name], OrbitRequest(revolutions=1.0))
    return orbit.system, orbit.start


def first_stage(name: str, step: float = 0.02) -> tuple[Stage, Instant]:
    """The first stage of a step from there."""
    bearing, start = begun(name)
    base = start.moving.plus(step, (IMPLICIT, start.change))
    return bearing.stage(base, start.tau + GAMMA * step, step, start, StageOptions(accuracy=1e-10)), start


@pytest.mark.parametrize("name", BEARINGS)
def test_the_equations_of_a_stage_hold_at_its_end(name: str) -> None:
    """Film, wall, contacts, and the rotor's acceleration by the forces on it."""
    stage, start = first_stage(name)
    found = solve_stage(stage, (start.x, start.e, start.active), None)
    assert found is not None
    state, moving = found.state, found.moving
    problem = stage.problem.at(displacement=state.b)
    assert state.residual < (1e-6 if "friction" in name else 1e-8)
    assert_allclose(moving.stored, problem.stored(state.x), rtol=1e-12)
    change = moving.minus(stage.base, stage.rate)
    assert_allclose(change.e, moving.v, rtol=1e-9, atol=1e-12)
    force = problem.journal_force(state.x, state.lam) + stage.outside - stage.gyroscopic @ moving.v
    assert_allclose(stage.inertia @ change.v, force, atol=1e-7 * max(1.0, float(np.max(np.abs(stage.outside)))))
    gaps = problem.gaps(state.x)
    assert gaps.min() > -1e-8
    assert state.lam.min() > -1e-8
    assert_allclose(np.minimum(gaps, np.maximum(state.lam, 0.0)), 0.0, atol=1e-8)


@pytest.mark.parametrize("name", ["plain", "petals", "slow petals"])
def test_the_tangent_of_a_stage_is_its_derivative(name: str) -> None:
    """A load more moves the journal by what the bordered tangent foretells."""
    stage, start = first_stage(name)
    found = solve_stage(stage, (start.x, start.e, start.active), None)
    assert found is not None
    more = 1e-4 * np.array([0.3, -1.0])
    pushed = solve_stage(
        replace(stage, outside=stage.outside + more), (found.state.x, found.state.b, found.state.active), None
    )
    assert pushed is not None
    stiffness = stage.border_stiffness - found.tangent.gradient
    foretold = np.linalg.solve(stiffness, more)
    assert_allclose(pushed.state.b - found.state.b, foretold, rtol=0.0, atol=1e-3 * np.linalg.norm(foretold))


def test_the_tangent_of_a_stage_serves_the_next(run: RunContext) -> None:
    """Both stages of a step, and a step of the same length after it, with one factorisation."""
    bearing, start = begun("petals")
    before = run.film.factorizations
    first = take_step(bearing, [start], 1e-3, None, StageOptions(accuracy=1e-5))
    assert first is not None
    assert run.film.factorizations - before == 1
    again = take_step(bearing, [start, first.inner, first.end], 1e-3, first.tangent, StageOptions(accuracy=1e-5))
    assert again is not None
    assert run.film.factorizations - before == 1


def verdict(
    stage: Stage, size: float, last: float, number: int, *, length: float = 1.0, response: float = 0.0
) -> StepVerdict:
    """Of a step with corrections of such sizes, by a tangent of such a response."""
    start = np.zeros(stage.problem.layout.n_position)
    x = stage.problem.layout.ambient(np.zeros(stage.problem.layout.n_wall))
    none = np.zeros(len(stage.problem.weight), dtype=bool)
    options = ContactOptions(deepest=-np.inf)
    state = evaluate(stage, (x, start), options, constrain(stage.problem.G, none, stage.stops))
    return stage.verdict(Step(number, state, state, length, size, last, response), options)


def test_a_stage_ends_by_its_correction() -> None:
    stage, _ = first_stage("plain")
    stage = replace(stage, options=StageOptions(accuracy=1e-6))
    assert verdict(stage, 1e-3, np.inf, 0) is StepVerdict.GO_ON
    assert verdict(stage, 1e-5, 1e-3, 1) is StepVerdict.CONVERGED  # contracts by 100: the next one is 1e-7
    assert verdict(stage, 1e-4, 2e-4, 1) is StepVerdict.RENEW  # contracts too slowly
    assert verdict(stage, 3e-3, 1e-3, 1) is StepVerdict.FAIL  # grows
    assert verdict(stage, 1e-9, np.inf, 0, length=0.5) is StepVerdict.RENEW  # shortened: not where it aimed


def test_a_stage_ends_by_what_its_tangent_is_known_to_answer() -> None:
    """Ambient pressure leaves a residual, of which the tangents have answered a part."""
    stage, _ = first_stage("plain")
    stage = replace(stage, options=StageOptions(accuracy=1e-6))
    assert verdict(stage, 1e-3, np.inf, 0, response=1e-8) is StepVerdict.CONVERGED
    assert verdict(stage, 1e-3, np.inf, 0, response=1e-2) is StepVerdict.GO_ON
    assert verdict(stage, 1e-3, np.inf, 0, length=0.5, response=1e-8) is StepVerdict.RENEW


def test_the_tangent_of_other_contacts_is_factorised_on_them() -> None:
    stage, start = first_stage("slow petals")
    assert start.active.any()
    constraints = constrain(stage.problem.G, start.active, stage.stops)
    state = evaluate(stage, (start.x, start.e), ContactOptions(deepest=-np.inf), constraints)
    tangent = factorise(stage, state, (state.x, state.b), LinearSolver())
    change, lam = tangent.respond(np.zeros(len(start.x)), stage.border.gap_derivative[:, 1])
    assert_allclose((stage.problem.G @ change + stage.border.gap_derivative[:, 1])[constraints.held], 0.0, atol=1e-12)
    assert_allclose(lam[~constraints.held], 0.0, atol=0.0)


def test_weights_of_a_parabola() -> None:
    knots = [0.0, 0.5, 1.25]
    for power in (0, 1, 2):
        values = [knot**power for knot in knots]
        assert np.dot(lagrange(knots, 2.0), values) == pytest.approx(2.0**power)


def test_a_guess_is_exact_for_cubics_in_steps_of_one_length() -> None:
    """And for parabolas in any steps: the parabola of a step ago missed a cubic by as much."""
    even, uneven = [0.0, GAMMA, 1.0, 1.0 + GAMMA, 2.0], [0.0, 0.3, 1.0, 1.1, 2.0]
    for knots, most in ((even, 3), (uneven, 2), (even[:4], 2), (even[:3], 2)):
        for power in range(most + 1):
            values = np.power(knots, power)
            assert np.dot(foretelling(knots, 2.0 + GAMMA), values) == pytest.approx((2.0 + GAMMA) ** power, rel=1e-12)
    assert len(even) == KNOTS
    assert np.dot(foretelling(uneven, 3.0), np.power(uneven, 3)) != pytest.approx(27.0, rel=1e-3)


@pytest.mark.parametrize("name", ["plain", "petals"])
def test_a_known_tangent_ends_stages_where_more_corrections_do(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Most stages then take one correction; the others tell what the tangent answers."""
    corrections = []
    monkeypatch.setattr(contact_newton, "corrected", lambda *asked: corrections.append(1) or corrected(*asked))
    system, start = begun(name)
    bearing = system.at_nodes
    path, tangent = [replace(start, equations=None)], None
    for _ in range(12):
        exact = take_step(bearing, path, 0.05, None, StageOptions(accuracy=1e-11))
        before = len(corrections)
        found = take_step(bearing, path, 0.05, tangent, StageOptions(accuracy=1e-5))
        taken = len(corrections) - before
        assert exact is not None
        assert found is not None
        assert_allclose(found.end.x, exact.end.x, rtol=0.0, atol=2e-5)
        path, tangent = [*path, found.inner, found.end][-KNOTS:], found.tangent
    assert taken == 2
