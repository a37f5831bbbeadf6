"""Compiled rows of a stage in time are those of NumPy; without numba the same loops run in Python."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import OVERLAP, SAMPLES, overlapping
from petalfoil.physics import reynolds
from petalfoil.physics.gap_curves import ContactPoints, sampled
from petalfoil.system.compiled_step import CompiledStepEquations
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_step import PointStepEquations
from tests.unit.dynamics.test_point_stage import begun, first_stage

Array = NDArray[np.float64]

FILMS: dict[str, dict[str, object]] = {
    "ends": {},
    "no ends": {"model.edges": "continuous"},
    "slip": {"model.edges": "continuous", "model.slip": True},
}


@pytest.fixture(scope="module", params=FILMS)
def plain(request: pytest.FixtureRequest) -> PointStepEquations:
    """A stage of eight petals, at the state that it begins with."""
    stage, state = first_stage(begun(**FILMS[request.param]))
    return stage.at(state, stage.stage.base.e)


def compiled(equations: PointStepEquations) -> CompiledStepEquations:
    """The same equations in compiled loops."""
    return CompiledStepEquations(equations.whole, equations.problem, equations.state, resists=equations.resists)


def anywhere(equations: PointStepEquations, rough: float, seed: int = 3) -> PointStepEquations:
    """The same at a state without equilibrium: pressures from 1e-4 to 3, contacts of every kind."""
    rng, state = np.random.default_rng(seed), equations.state
    curve = np.array([0, 0, 3, 9, 9, 17, 17, 20], dtype=np.intp)
    last = equations.whole.curves.elements[curve].astype(np.float64)
    position = np.array([2.2, 2.7, last[2], 0.0, 1.0, 1.3, 4.6, 2.0])  # two on an element, ends, a root, a stretch
    inner = np.array([0, 0, 0, 0, 0, 2, 0, 0], dtype=np.intp)
    points = ContactPoints(curve, position, inner, rng.uniform(-0.2, 1.0, len(curve) + 2))
    w = state.w + rough * rng.standard_normal(len(state.w))
    return replace(equations, state=PointState(w, 10.0 ** rng.uniform(-4.0, 0.5, len(state.P)), points))


def assert_alike(mine: Array, its: Array) -> None:
    """Two arrays differ by 1e-13 of their largest entry at most."""
    assert_allclose(mine, its, rtol=0.0, atol=1e-13 * float(np.max(np.abs(its), initial=0.0)))


@pytest.mark.parametrize("seed", range(3))
def test_rows_are_those_of_numpy(plain: PointStepEquations, seed: int) -> None:
    """Residuals, their scales, what each is made of, and what steps ask for."""
    there = anywhere(plain, 0.01, seed)
    fast = compiled(there)
    for mine, its in zip(fast.residual, there.residual, strict=True):
        assert_alike(mine, its)
    for mine, its in zip(fast.row_scales, there.row_scales, strict=True):
        assert_alike(mine, its)
    for name in ("nodal_gaps", "film_thickness", "gas", "travels", "idle", "end_slopes", "journal_force"):
        assert_alike(getattr(fast, name), getattr(there, name))
    for name in ("film_imbalance", "wall_imbalance", "opening"):
        assert getattr(fast, name) == pytest.approx(getattr(there, name), rel=1e-9)
    assert there.idle.any()
    assert 0.0 < there.travels.mean() < 1.0


def test_equations_at_rest_are_those_of_numpy(plain: PointStepEquations) -> None:
    """No bearing number, no rate: a shaft that stands still."""
    there = anywhere(plain, 0.01)
    there = replace(there, problem=replace(there.problem.at(bearing_number=0.0), rate=0.0))
    for mine, its in zip(compiled(there).residual, there.residual, strict=True):
        assert_alike(mine, its)


def test_tangents_are_those_of_numpy(plain: PointStepEquations) -> None:
    """They are put together from the compiled gaps, films and contacts."""
    there = anywhere(plain, 0.01)
    assert_alike(compiled(there).steady.toarray(), there.steady.toarray())
    assert_alike(compiled(there).force_rows, there.force_rows)


def test_fluxes_are_limited_alike(plain: PointStepEquations, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where films open by orders of magnitude some faces would drain the node before them (F2b)."""
    there = anywhere(plain, 0.0)
    films = 10.0 ** np.random.default_rng(4).uniform(-1.0, 2.0, there.film_thickness.size)
    opened = np.linalg.lstsq(there.whole.film_by_w.toarray(), films - there.film_thickness.ravel())[0]
    there = replace(there, state=replace(there.state, w=there.state.w + opened))
    assert np.min(there.film_thickness) > 0.0
    assert_alike(compiled(there).residual[1], there.residual[1])
    monkeypatch.setattr(reynolds, "DRAIN", 1e30)
    free = replace(there).residual[1]
    assert np.max(np.abs(free - there.residual[1])) > 1e-6 * np.max(np.abs(free))


def test_steps_are_shortened_alike(plain: PointStepEquations) -> None:
    """Falls of films and pressures, and growth of pressures."""
    there, rng = anywhere(plain, 0.01), np.random.default_rng(8)
    seen = []
    for size in (1e-5, 1e-2, 10.0):
        change, move = size * rng.standard_normal(there.n), size * np.array([0.3, -1.0])
        seen.append(there.relative_changes(change, move))
        assert compiled(there).relative_changes(change, move) == pytest.approx(seen[-1], rel=1e-12)
    assert seen[0][0] < 1.0 < seen[-1][0]
    assert seen[0][1] < 1.0 < seen[-1][1]


@pytest.mark.slow
def test_overlaps_are_those_of_numpy(plain: PointStepEquations) -> None:
    """Gaps below zero are looked for wherever samples see one, and only there."""
    looked, found = [], []
    for seed in range(12):
        rough = 10.0 ** (seed / 4.0 - 4.0)
        there = replace(plain, state=replace(plain.state, w=anywhere(plain, rough, seed).state.w))
        for depth in (OVERLAP, 0.05):
            found.append(overlapping(there, depth))
            assert overlapping(compiled(there), depth) == found[-1]
            points, curves = there.state.points, there.whole.curves
            curve, position, gap = sampled(curves, points, there.nodal_gaps, SAMPLES)
            roots = (curve // there.whole.pack.mesh.count == 1) & (position < 0.5)
            looked.append(compiled(there).may_overlap(depth, SAMPLES))
            assert looked[-1] == bool(np.any(gap[~roots] < -depth))
    assert 0 < sum(map(bool, found)) <= sum(looked) < len(looked)


def test_a_pulling_reaction_closes_gaps_between_control_points(plain: PointStepEquations) -> None:
    """It bends its element below the cubic, whose control points then bound nothing."""
    open_gaps = replace(plain, state=PointState(plain.state.w, plain.state.P, ContactPoints.none()))
    assert not compiled(open_gaps).may_overlap(0.5, SAMPLES)
    pulling = ContactPoints(np.array([17]), np.array([1.5]), np.array([0]), np.array([-1e6]))
    there = replace(open_gaps, state=replace(plain.state, points=pulling))
    assert overlapping(there, 0.5)
    assert compiled(there).may_overlap(0.5, SAMPLES)
