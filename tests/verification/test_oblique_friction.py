"""Friction in a plane, exactly: a leaf on a flat that is pulled obliquely, a block led round, a pack that tilts."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_history import assembled, moved
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.run_context import running
from petalfoil.mesh.axial import axis_3d
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_tilting
from petalfoil.system.friction import FrictionState, friction_of
from petalfoil.walls.sliding import beside_nodes, stretching
from tests.cases import case
from tests.verification.shell_helpers import ElasticProblem, plate_shell, uniform_grid, uniform_load

Array = NDArray[np.float64]

MU = 0.3
"""Friction of the flat."""


def led(problem: ElasticProblem, pull: sp.csr_array, friction: Friction, path: Array) -> list[FrictionResult]:
    """States along a `path` (steps, 2) of what pulls, from a start without friction at its first place."""
    at = [
        ElasticProblem(problem.K, problem.force + pull @ place, problem.G, problem.rest, problem.weight)
        for place in path
    ]
    m = len(problem.rest)
    found, outcome = solve_contacts(
        at[0], (np.zeros(problem.n), np.ones(m, dtype=bool)), LinearSolver(), ContactOptions(tangents=40)
    )
    assert found is not None, outcome
    fresh = FrictionState.fresh(friction, found.x, found.lam)
    states = [FrictionResult(found.x, found.lam, found.active, found.state.residual, fresh, 0.0)]
    for one in at[1:]:
        slid = slide_exactly(one, friction, states[-1], [np.arange(m)[None, :]], LinearSolver())
        assert slid is not None
        assert slid.residual < 1e-8
        states.append(slid)
    return states


# ------------------------------------------------------------------------------------------ a block on a spring

PRESS, SPRING = 2.0, 5.0
"""Force that presses a block on its flat, and the spring that pulls it along."""


def block() -> tuple[ElasticProblem, sp.csr_array, Friction]:
    """A block pulled in its plane by a spring of the same stiffness all ways: its height, its two coordinates."""
    K = sp.csr_array(sp.diags_array([1.0, SPRING, SPRING]))
    G, slip = sp.csr_array(np.eye(1, 3)), sp.csr_array(np.eye(2, 3, 1))
    pull = sp.csr_array(SPRING * np.eye(3, 2, -1))
    law = Friction(MU, np.zeros(2), slip, sp.csr_array(np.ones((2, 1))), 0.0, exact=True, directions=2)
    return ElasticProblem(K, np.array([-PRESS, 0.0, 0.0]), G, np.zeros(1), np.ones(1)), pull, law


def loss(states: list[FrictionResult]) -> float:
    """Energy lost in all steps, none of which gains any."""
    assert all(state.lost >= 0.0 for state in states)
    return sum(state.lost for state in states)


@pytest.mark.parametrize("degrees", [0.0, 31.0, 90.0, 200.0])
def test_a_block_pulled_to_and_fro_along_any_line(degrees: float) -> None:
    """It holds until the spring has `mu N`; friction is against the slip; the loop is `4 mu N (A - mu N / k)`."""
    way, A = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))]), 0.5
    states = led(*block(), np.outer([0.0, 0.1, A, -A, A, -A], way))
    assert_allclose(states[1].friction.slip, 0.0, atol=1e-12)  # 0.1 k is less than mu N
    for before, after in pairwise(states[1:]):
        slid = after.friction.slip - before.friction.slip
        assert_allclose(after.friction.force, MU * PRESS * slid / np.linalg.norm(slid), atol=1e-9)
    exact = 4.0 * MU * PRESS * (A - MU * PRESS / SPRING)
    assert loss(states[-2:]) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("steps", [24, 48])
def test_a_block_led_round_loses_its_friction_times_its_own_circle(steps: int) -> None:
    """Led on a circle of radius `A` it goes round on one of radius `a`, and each step's friction is along its chord.

    With the turn `2 t` of a step and `f = mu N / k`, `A^2 = a^2 + f^2 + 2 f a sin t`: the law of cosines at the block.
    """
    A, f, t = 0.5, MU * PRESS / SPRING, np.pi / steps
    a = -f * np.sin(t) + np.sqrt(A**2 - (f * np.cos(t)) ** 2)
    angle = 2.0 * t * np.arange(4 * steps + 1)
    states = led(*block(), np.vstack([[0.0, 0.0], A * np.column_stack([np.cos(angle), np.sin(angle)])]))
    assert_allclose(np.linalg.norm(states[-1].x[1:]), a, rtol=1e-6)
    assert loss(states[-steps:]) == pytest.approx(MU * PRESS * steps * 2.0 * a * np.sin(t), rel=1e-6)


# ------------------------------------------------------------------------------------------ a leaf on a flat

ARC, SLENDER, STATIONS, CELLS = 0.87, 60.0, 6, 12
"""Angle, radius over thickness, axial cells and cells along a clamped leaf of radius 1 and length 1."""
STIFF, AWAY = 1e4, 2e-3
"""Spring that holds the flat, and half the way that it is pulled to and fro: both large for the leaf's tip."""


def leaf_on_flat() -> tuple[ElasticProblem, sp.csr_array, Friction]:
    """The leaf pressed with its tip on a flat that springs pull; unknowns are those of the leaf and two of the flat."""
    axial = axis_3d(1.0, STATIONS, half=False)
    shell = plate_shell(uniform_grid(ARC, CELLS), axial, 1.0, 0.3)
    petal, m = StretchingPetal(shell, 12.0 * SLENDER**2), STATIONS + 1
    K = sp.block_diag([stretching([petal]).stiffness, STIFF * sp.eye_array(2)], format="csr")
    n, nodes = K.shape[0], CELLS * m
    tip = np.arange(nodes - m, nodes)
    force = np.zeros(n)
    force[:nodes] = uniform_load(shell)[1:].ravel()
    G = sp.csr_array((-np.ones(m), (np.arange(m), tip)), shape=(m, n))
    along = sp.csr_array((np.ones(m), (np.arange(m), nodes + tip)), shape=(m, n))
    across = sp.lil_array((m, n))
    across[:, 2 * nodes + (CELLS - 1) * STATIONS : 2 * nodes + CELLS * STATIONS] = beside_nodes(m)
    flat = np.zeros((2 * m, n))
    flat[:m, -2] = flat[m:, -1] = 1.0
    slip = sp.csr_array(sp.vstack([along, across.tocsr()]) - sp.csr_array(flat))
    share = sp.csr_array(sp.vstack([sp.eye_array(m)] * 2))
    law = Friction(MU, np.zeros(2 * m), slip, share, 0.0, exact=True, directions=2)
    pull = sp.csr_array(STIFF * np.eye(n, 2, 2 - n))
    return ElasticProblem(K, force, G, np.full(m, 1e-3), np.ones(m)), pull, law


WAY = np.array([0.6, 0.8])
"""Direction in which the flat is pulled: along the leaf, across it."""


def pulled(steps: int) -> tuple[list[FrictionResult], float]:
    """States of a flat pulled out, back and out again in `steps` each, and the work of the pull in the closed cycle."""
    problem, pull, law = leaf_on_flat()
    legs = np.concatenate([np.linspace(a, b, steps + 1)[1:] for a, b in ((0.0, 1.0), (1.0, -1.0), (-1.0, 1.0))])
    places = np.outer(AWAY * np.concatenate([[0.0], legs]), WAY)
    states = led(problem, pull, law, places)
    flat = np.array([state.x[-2:] for state in states[steps:]])
    pulls = STIFF * (places[steps:] - flat)
    return states, float(np.sum(0.5 * (pulls[1:] + pulls[:-1]) * np.diff(flat, axis=0)))


def test_a_leaf_on_a_flat_that_is_pulled_obliquely() -> None:
    """All along the tip friction is `mu N` against the slip, and the flat feels it against its own motion."""
    states, _ = pulled(8)
    for state in (states[8], states[16], states[24]):
        assert np.all(state.active)
        assert_allclose(np.linalg.norm(state.friction.force.reshape(2, -1), axis=0), MU * state.lam, rtol=1e-9)
    before, end = states[-2:]
    slid = (end.friction.slip - before.friction.slip).reshape(2, -1)
    T = end.friction.force.reshape(2, -1)
    assert_allclose(T * np.linalg.norm(slid, axis=0), MU * end.lam * slid, atol=1e-12)
    assert np.min(np.linalg.norm(slid, axis=0)) > 1e-4
    on_flat = -T.sum(axis=1)
    assert_allclose(on_flat / np.linalg.norm(on_flat), WAY, atol=1e-3)
    assert np.linalg.norm(on_flat) == pytest.approx(MU * end.lam.sum(), rel=1e-3)


@pytest.mark.slow
def test_energy_lost_on_a_flat_is_the_loop_of_its_pull() -> None:
    """Within the trapezoidal rule of the steps, which finer steps make smaller."""
    away = []
    for steps in (8, 16):
        states, work = pulled(steps)
        away.append(abs(work / loss(states[steps + 1 :]) - 1.0))
    assert away[1] < 0.45 * away[0]
    assert away[1] < 0.03


# ------------------------------------------------------------------------------------------ a pack that tilts


def tilted(ends: Array) -> tuple[Array, Array]:
    """Forces of eight petals on a journal whose ends move to and fro by `ends` [m], and the energy lost to each [J]."""
    of = case(
        "paper_n8_spatial",
        **{"petals.theory": "shell", "surface.petal_friction": 0.1, "operation.eccentricity": (0.0, 0.0)},
        **{"model.cells_per_pitch": 8, "model.axial_cells": 4, "model.axial_density": "uniform"},
        **{"operation.moment": (0.0, 0.0), "model.contacts": "nodes"},
    )
    forces, lost = [], [0.0]
    with running():
        problem = build_tilting(of)
        friction, scales = friction_of(of, problem.layout), problem.layout.scales
        assert friction is not None
        assert friction.directions == 2
        way = assembled(friction, problem)
        for end in ends:
            there = problem.at(displacement=np.array([0.0, 0.0, end, 0.0]) / scales.length)
            assert way is not None
            way = moved(friction, (problem, way.state), there)
            assert way is not None
            state = way.state
            assert isinstance(state, FrictionResult)
            assert state.residual < 1e-8
            assert way.lost >= 0.0
            problem = there
            lost.append(lost[-1] + way.lost * scales.force * scales.length)
            x = problem.layout.ambient(state.x)
            forces.append(problem.journal_force(x, state.lam)[2] * scales.force)
    return np.array(forces), np.array(lost[1:])


@pytest.mark.long
def test_energy_lost_by_a_pack_that_tilts_is_the_area_of_its_loop() -> None:
    """Within the trapezoidal rule of its steps, which finer steps make smaller."""
    most, away = 10e-6, []
    for count in (2, 8):
        there = np.linspace(-most, most, 2 * count + 1)
        cycle = np.concatenate([there[count:-1], there[::-1], there[1:], there[-2::-1], there[1:]])
        force, lost = tilted(cycle)
        loop = slice(len(cycle) - 4 * count - 1, None)
        work = -float(np.trapezoid(force[loop], cycle[loop]))
        taken = lost[-1] - lost[loop][0]
        assert taken > 0.0
        away.append(abs(work / taken - 1.0))
    assert away[1] < 0.5 * away[0]
    assert away[1] < 0.05
