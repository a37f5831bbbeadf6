"""The pack by projected gradient: constraints, descent, reactions."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.classic.descent import PackDescent
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.classic.numpy_kernels import elastic_force, project
from petalfoil.equilibrium.continuation import rest
from petalfoil.system.coupled import CoupledProblem
from tests.unit.classic.bearings import bearing, pack

Array = NDArray[np.float64]


def gaps(problem: CoupledProblem, W: Array) -> Array:
    return problem.gaps(np.concatenate([W, np.ones(problem.layout.n - len(W))]))


# ---------------------------------------------------------------------------------------------- constraints


@pytest.mark.parametrize("count", [6, 8, 10])  # overlaps 1.7, 2.2 and 2.8: two and three layers
def test_every_deflection_stands_in_one_column_and_every_gap_is_kept(count: int) -> None:
    problem = pack(10, 50e-6, **{"petals.count": count})
    columns = PackDescent(problem, ClassicOptions()).columns
    assert sorted(columns.node[columns.node >= 0]) == list(range(problem.layout.n_wall))
    W = np.random.default_rng(4).normal(size=problem.layout.n_wall) * 10.0
    assert np.min(gaps(problem, W)) < -10.0
    assert np.min(gaps(problem, project(W, columns))) > -1e-12


def test_the_projection_is_the_nearest_point() -> None:
    problem = pack(10, 50e-6)
    columns = PackDescent(problem, ClassicOptions()).columns
    rng = np.random.default_rng(5)
    W = rng.normal(size=problem.layout.n_wall) * 10.0
    nearest = project(W, columns)
    for _ in range(200):  # (W - nearest) makes an obtuse angle with the direction to any other admissible point
        other = project(nearest + rng.normal(size=len(W)) * rng.choice([0.1, 3.0, 30.0]), columns)
        assert np.dot(W - nearest, other - nearest) <= 1e-9
    assert_allclose(project(nearest, columns), nearest, rtol=0.0, atol=1e-12)


# ---------------------------------------------------------------------------------------------- descent


@pytest.mark.parametrize("kind", ["2d", "half"])
def test_the_bands_are_the_stiffness(kind: str) -> None:
    problem = bearing(kind)
    W = np.random.default_rng(6).normal(size=problem.layout.n_wall)
    wanted = problem.layout.stiffness @ W
    assert_allclose(
        elastic_force(W, PackDescent(problem, ClassicOptions()).shell),
        wanted,
        rtol=0.0,
        atol=1e-12 * np.max(np.abs(wanted)),
    )


@pytest.mark.compiled
@pytest.mark.parametrize("mount", ["clamped", "hinged"])
@pytest.mark.parametrize("momentum", [False, True])
def test_the_pack_alone_descends_to_newton_s(mount: str, momentum: bool) -> None:
    problem = pack(8, 100e-6, **{"petals.mount": mount})
    wanted = rest(problem)
    assert wanted is not None
    W, load = np.zeros(problem.layout.n_wall), np.zeros(problem.layout.n_wall)
    descent = PackDescent(problem, ClassicOptions(momentum=momentum))
    assert descent.advance(W, load, 1e-7, 1_000_000)
    size = np.max(np.abs(wanted.x[: len(W)]))
    assert_allclose(W, wanted.x[: len(W)], rtol=0.0, atol=1e-5 * size)
    assert_allclose(descent.reactions(W, load), wanted.lam, rtol=0.0, atol=1e-5 * np.max(wanted.lam))


@pytest.mark.compiled
def test_momentum_saves_steps() -> None:
    problem, taken = pack(16), {}
    for momentum in (False, True):
        descent = PackDescent(problem, ClassicOptions(momentum=momentum))
        W = np.zeros(problem.layout.n_wall)
        assert descent.advance(W, np.zeros_like(W), 1e-6, 10_000_000)
        taken[momentum] = descent.steps
    assert taken[False] > 20 * taken[True]


# ---------------------------------------------------------------------------------------------- petal by petal


def petal_by_petal(problem: CoupledProblem, descent: PackDescent, W: Array, sweeps: int) -> Array:
    """Descend one petal after the other inside bounds (21), (22) that its neighbours make where they are now."""
    columns, n = descent.columns, problem.layout.n_wall
    petals = len(problem.layout.wall.film.theta)
    owner, top = np.arange(n) // (n // petals), columns.layers - 1
    outermost = columns.node[top, np.arange(len(top))]
    pairs = [
        (inner[outer >= 0], outer[outer >= 0], (above - below)[outer >= 0])
        for inner, outer, below, above in zip(
            columns.node[:-1], columns.node[1:], columns.shift[:-1], columns.shift[1:], strict=True
        )
    ]
    for turn in range(sweeps * petals):
        low, high = np.full(n, -np.inf), np.full(n, np.inf)
        low[columns.node[0]] = columns.low
        high[outermost] = columns.high - columns.shift[top, np.arange(len(top))]
        for inner, outer, between in pairs:
            np.maximum.at(low, outer, W[inner] - between)
            np.minimum.at(high, inner, W[outer] + between)
        moved = np.clip(W - descent.step * elastic_force(W, descent.shell), low, high)
        W = np.where(owner == turn % petals, moved, W)
    return W


@pytest.mark.slow
@pytest.mark.compiled
def test_petals_that_descend_one_by_one_stop_short_of_the_least_energy() -> None:
    """The pack is projected as a whole because a petal cannot displace a neighbour that is a fixed bound."""
    problem = pack(8, 100e-6)
    descent = PackDescent(problem, ClassicOptions())
    W, none = np.zeros(problem.layout.n_wall), np.zeros(problem.layout.n_wall)
    stuck = petal_by_petal(problem, descent, project(W, descent.columns), 4000)
    later = petal_by_petal(problem, descent, stuck, 250)
    assert_allclose(later, stuck, rtol=0.0, atol=1e-2)  # a hundred times nearer than the least energy is
    assert np.min(gaps(problem, later)) > -1e-9
    assert descent.advance(W, none, 1e-7, 1_000_000)
    assert np.max(np.abs(later - W)) > 1.0
    energy, least = (0.5 * np.dot(V, elastic_force(V, descent.shell)) for V in (later, W))
    assert energy > 1.05 * least
