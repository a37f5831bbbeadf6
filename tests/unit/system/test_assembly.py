"""What a case becomes: blocks and tangents of the coupled problem, under a load, with friction, in a time step."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.physics.forces import film_force
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.build import build_problem, build_tilting
from petalfoil.system.coupled import CoupledProblem, wall_scale
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionProblem, FrictionState, FrictionStep, friction_of
from petalfoil.system.loaded import LoadedProblem
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import DEFLECTION, POSITION, PRESSURE
from tests.cases import case
from tests.contract.taylor import assert_tangent, open_state

Array = NDArray[np.float64]
PETALS = case("paper_n8", **{"model.cells_per_pitch": 8, "surface.petal_friction": 0.3})
TILTING = PETALS.replace(**{"model.kind": "3d", "model.axial_cells": 4, "surface.petal_friction": 0.0})


def state(problem: CoupledProblem, seed: int = 1) -> tuple[Array, Array]:
    """An open state, and reactions."""
    rng = np.random.default_rng(seed)
    return open_state(problem, rng), rng.uniform(0.0, 1.0, len(problem.weight))


@pytest.mark.parametrize(("case_of", "dimension"), [(build_problem, 2), (build_tilting, 4)])
def test_the_journal_has_as_many_coordinates_as_its_wall_says(case_of: object, dimension: int) -> None:
    problem = case_of(TILTING)
    assert problem.layout.n_position == dimension
    assert len(problem.displacement) == dimension
    loaded = LoadedProblem(problem, np.zeros(dimension))
    assert loaded.unknowns.n == problem.layout.n + dimension
    x, lam = state(problem)
    z = np.append(x, 0.1 * np.arange(dimension))
    moved, same = loaded.split(z)
    assert np.array_equal(same, x)
    assert np.array_equal(moved.displacement, z[loaded.unknowns[POSITION]])
    assert_allclose(loaded.gaps(z), moved.gaps(x), atol=0.0)
    assert loaded.linearize(z).matrix(lam).shape == (len(z), len(z))


def test_a_problem_knows_the_case_it_belongs_to() -> None:
    problem = build_problem(PETALS)
    assert problem.layout.case is PETALS
    assert problem.layout.unknowns.sizes == {
        DEFLECTION: problem.layout.wall.n_unknown,
        PRESSURE: problem.layout.wall.film.n_unknown,
    }


def test_the_force_on_the_journal_is_that_of_the_pressures() -> None:
    problem = build_problem(PETALS)
    x, lam = state(problem)
    film, scales = problem.layout.wall.film, problem.layout.scales
    whole = film_force(film, PETALS.bearing.journal_radius, (problem.pressure(x) - 1.0) * scales.pressure)
    assert_allclose(problem.film_force(x) * scales.force, whole, rtol=1e-12)
    by_contact = problem.journal_force(x, lam) - problem.film_force(x)
    assert_allclose(by_contact, problem.layout.wall.contacts.by_e.T @ lam, rtol=1e-12)


def test_the_tangent_under_a_load() -> None:
    """Rows of film and journal by all unknowns, the position included; `G^T lam` with the extended `G`."""
    problem = build_problem(PETALS)
    loaded = LoadedProblem(problem, np.array([1.0, -3.0]))
    x, _ = state(problem)
    z, rng = np.append(x, problem.displacement), np.random.default_rng(2)
    direction = rng.uniform(-1.0, 1.0, len(z))
    linearized = loaded.linearize(z)
    change = linearized.matrix(np.zeros(len(problem.weight))) @ direction
    rows = problem.positive
    assert_tangent(lambda t: loaded.linearize(z + t * direction).residual[rows], change[rows], 2.0**-8)
    journal = loaded.unknowns[POSITION]
    moved = loaded.linearize(z + direction).residual[journal]  # the force is linear in the pressures
    assert_allclose(moved, linearized.residual[journal] + change[journal], rtol=1e-10)
    assert_allclose(loaded.gaps(z + direction), loaded.gaps(z) + loaded.G @ direction, atol=1e-12)
    barrier = rng.uniform(0.0, 2.0, len(problem.weight))
    added = (linearized.matrix(barrier) - linearized.matrix(0.0 * barrier)) @ direction
    expected = loaded.G.T @ (barrier * (loaded.G @ direction))
    assert_allclose(added, expected, atol=1e-9 * np.max(np.abs(linearized.matrix(barrier).data)))


def test_the_tangent_of_a_time_step() -> None:
    """What is stored counts with its own bearing number, and `rate` is that of the step."""
    coupled = build_problem(PETALS)
    x, _ = state(coupled)
    start = np.full(coupled.layout.wall.film.n_unknown, 0.1)
    problem = StepProblem(coupled.layout, coupled.bearing_number, coupled.displacement, 3.0, 0.7, start)
    steady = coupled.linearize(x).residual[coupled.positive]
    expected = steady + 0.7 * (problem.stored(x) - start)
    assert_allclose(problem.linearize(x).residual[problem.positive], expected, rtol=1e-12)
    direction = np.random.default_rng(4).uniform(-1.0, 1.0, len(x))
    change = problem.linearize(x).matrix(np.zeros(len(problem.weight))) @ direction
    rows = problem.positive
    assert_tangent(lambda t: problem.linearize(x + t * direction).residual[rows], change[rows], 2.0**-8)


def test_friction_adds_its_force_and_its_stiffness() -> None:
    """Where every contact slips the force is the limit; where all stick its derivative is their stiffness."""
    coupled = build_problem(PETALS)
    friction = friction_of(PETALS, coupled.layout)
    assert friction is not None
    x, lam = state(coupled)
    fresh = FrictionState.fresh(friction, x, lam)
    step = FrictionStep.beginning(friction, fresh, lam)
    problem = FrictionProblem(coupled, step)
    wall = coupled.layout.unknowns[DEFLECTION]
    assert_allclose(problem.linearize(x).residual, coupled.linearize(x).residual, atol=0.0)  # no slip yet
    tiny = np.zeros(len(x))
    tiny[wall] = 1e-1 * step.friction.width * np.random.default_rng(6).uniform(-1.0, 1.0, coupled.layout.n_wall)
    none = np.zeros(len(lam))
    force = problem.linearize(x + tiny).residual[wall] - coupled.linearize(x + tiny).residual[wall]
    by_tangent = (problem.linearize(x).matrix(none) - coupled.linearize(x).matrix(none)) @ tiny
    assert_allclose(by_tangent[wall], force, atol=1e-6 * np.max(np.abs(force)))
    far = np.zeros(len(x))
    far[wall] = 1e3 * np.random.default_rng(7).uniform(-1.0, 1.0, coupled.layout.n_wall)
    slipped = step.after(x + far)
    assert_allclose(np.abs(slipped.force), slipped.limit, rtol=1e-12)
    assert_allclose(slipped.limit, 0.3 * friction.normal(lam), rtol=1e-12)


def test_rows_of_a_pack_are_those_of_the_coupled_problem() -> None:
    coupled = build_problem(PETALS)
    x, lam = state(coupled)
    w = x[coupled.layout.unknowns[DEFLECTION]]
    pack = FoilPackProblem(coupled, coupled.layout.push @ (x[coupled.positive] - 1.0))
    n = len(w)
    assert_allclose(pack.linearize(w).residual, coupled.linearize(x).residual[:n], atol=1e-9)
    both = pack.linearize(w).matrix(lam).toarray(), coupled.linearize(x).matrix(lam).toarray()[:n, :n]
    assert_allclose(both[0], both[1], atol=1e-12 * np.max(np.abs(both[1])))


def test_rows_of_the_wall_are_compared_with_their_rounding_where_that_is_more() -> None:
    layout = build_problem(PETALS).layout
    small, large = (wall_scale(layout, np.full(layout.n_wall, size)) for size in (1e-9, 1e9))
    assert_allclose(small, 1.0)
    assert large.max() > 1.0
    rounding = layout.stiffness_size @ np.full(layout.n_wall, 1e9) * np.finfo(float).eps
    assert np.all(large * RESIDUAL_TOLERANCE >= rounding)
