"""Friction between petals that stretch in 3-D, along petals and along the shaft: histories and small motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.runup import runup
from petalfoil.analysis.static import static
from petalfoil.analysis.tilted_journal import free_to_tilt, whole_length
from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import FrictionCycle
from petalfoil.equilibrium.friction_history import assembled, moved
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.friction_under_load import PATH, LoadedPath
from petalfoil.equilibrium.run_context import running
from petalfoil.mesh.pack import PackMesh
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem, build_tilting
from petalfoil.system.friction import friction_of, friction_tangent, slips
from petalfoil.system.loaded import load_of
from petalfoil.walls import build_wall
from petalfoil.walls.petals import build_mesh, petal_faces
from petalfoil.walls.sliding import node_slopes
from tests.cases import case

Array = NDArray[np.float64]


def rubbing(**changes: object) -> Case:
    """Eight petals of the paper in 3-D with friction, on a coarse grid."""
    coarse = {"model.cells_per_pitch": 10, "model.axial_cells": 4, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **{"petals.theory": "shell", "surface.petal_friction": 0.1, **coarse, **changes})


PLANE = {"model.kind": "2d", "model.contacts": "nodes"}
"""The same of one station."""


@pytest.mark.slow
def test_without_lateral_contraction_friction_is_that_of_2d() -> None:
    """Loaded and unloaded: along the shaft all is alike, so that forces and energy lost are those of one station."""
    way = ["0 um", "-10 um", "-5 um"]
    changes = {"petals.poisson_ratio": 0.0, "model.axial_cells": 2}
    whole = static(rubbing(**changes, **{"model.contacts": "nodes"}), way)
    plane = static(rubbing(**changes, **PLANE), way)
    assert_allclose(whole.force_y, plane.force_y, rtol=1e-7, atol=1e-7)
    assert_allclose(whole.petal_friction_work, plane.petal_friction_work, rtol=1e-6, atol=1e-12)
    assert float(whole.petal_friction_work[-1]) > 0.0


def slip_along_shaft(mesh: PackMesh, half_thickness: float, displacement: Array) -> Array:
    """Slip along the shaft at all gaps on the bushing and between petals, from `U` and `W_z`."""
    n, m = mesh.n_node, mesh.n_z
    W, V, U = np.split(displacement, np.array([1, 2]) * mesh.count * (n - 1) * m)
    assert len(V) == len(W)
    W = np.concatenate([np.zeros((mesh.count, 1, m)), W.reshape(mesh.count, n - 1, m)], axis=1)
    turn = W @ sp.csr_array(node_slopes(mesh.axial.z)).toarray().T
    cells = U.reshape(mesh.count, n - 1, m - 1)
    around = np.pad(cells, ((0, 0), (0, 0), (1, 1)), mode="edge")
    if mesh.axial.half:  # plane of symmetry
        turn[..., -1], around[..., -1] = 0.0, -cells[..., -1]
    at_stations = 0.5 * (around[..., 1:] + around[..., :-1])
    ends = np.concatenate([-at_stations[:, :1], at_stations, at_stations[:, -1:]], axis=1)
    along = 0.5 * (ends[:, 1:] + ends[:, :-1])
    outer, inner = -along + half_thickness * turn, along + half_thickness * turn
    between = outer[:, mesh.on_neighbour] + np.roll(inner, -1, axis=0)[:, : n - mesh.cells]
    return np.concatenate([outer[:, mesh.on_bushing].ravel(), between.ravel()])


def along_petals(friction: Friction) -> Friction:
    """The same without friction along the shaft."""
    k = friction.slip.shape[0] // 2
    return replace(
        friction,
        slip=friction.slip[:k],
        reaction_share=friction.reaction_share[:k],
        stiffness=np.zeros(k),
        directions=1,
    )


def slips_of_motion(
    of: Case, motion: tuple[float, ...], law: Callable[[Friction], Friction] = lambda whole: whole
) -> tuple[float, float]:
    """Slip along petals and along the shaft, both weighted with the reactions, as the journal moves from the centre."""
    with running():
        centred = (build_problem if len(motion) == 2 else build_tilting)(of.replace(**{"model.contacts": "nodes"}))
        layout, friction = centred.layout, friction_of(of, centred.layout)
        assert friction is not None
        friction = law(friction)
        begun = assembled(friction, centred)
        assert begun is not None
        there = centred.at(displacement=np.array(motion) / layout.scales.length)
        led = moved(friction, (centred, begun.state), there)
        assert led is not None
        start, end = begun.state, led.state
        assert isinstance(start, FrictionResult)
        assert isinstance(end, FrictionResult)
    mesh, change = build_mesh(of), (end.x - start.x)[: layout.wall.n_unknown]
    across = slip_along_shaft(mesh, float(petal_faces(of).half_thickness[0]), change)
    pressed = np.minimum(start.lam, end.lam)[layout.wall.contacts.bushing.start :]
    return float(pressed @ np.abs(layout.wall.slip @ change)), float(pressed @ np.abs(across))


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.02, 0.3])
def test_petals_hardly_slip_along_the_shaft(mu: float) -> None:
    """Moved by 20 um: weighted with the reactions, below a thousandth of the slip along the petals."""
    of = rubbing(**{"surface.petal_friction": mu, "operation.eccentricity": (0.0, 0.0)})
    along, across = slips_of_motion(of, (0.0, -2e-5))
    assert 0.0 < across < 1e-3 * along


@pytest.mark.slow
def test_petals_under_a_journal_that_tilts_slip_along_the_shaft_too() -> None:
    """By 20 um at its ends, where this slip does not rub: farther than along themselves. Where it does: less far."""
    of = rubbing(**{"operation.eccentricity": (0.0, 0.0), "operation.moment": (0.0, 0.0)})
    along, across = slips_of_motion(of, (0.0, 0.0, 2e-5, 0.0), along_petals)
    assert 1.2 * along < across < 1.6 * along
    whole_along, whole_across = slips_of_motion(of, (0.0, 0.0, 2e-5, 0.0))
    assert 0.1 * whole_along < whole_across
    assert whole_across / whole_along < 0.9 * across / along


@pytest.mark.slow
def test_contacts_that_stick_are_arches() -> None:
    """Sticking petals are many times as stiff as sliding ones, and a motion far beyond their slip feels neither."""
    load = (0.0, -5.0)
    free = coefficients(rubbing(**{"surface.petal_friction": 0.0}), load=load).stiffness.values[0]
    stuck = coefficients(rubbing(), load=load).stiffness.values[0]
    far = coefficients(rubbing(), load=load, amplitude="500 um").stiffness.values[0]
    assert stuck[0, 0] > 5.0 * free[0, 0]
    assert abs(far[0, 0] / free[0, 0] - 1.0) < 0.5


def loaded_at_rest(of: Case, load: float) -> tuple[Array, float]:
    """Displacement of the journal [m] set down at rest on the assembled pack, and the energy lost to friction [J]."""
    with running():
        problem = build_problem(of.replace(**{"operation.eccentricity": (0.0, 0.0)}))
        friction, scales = friction_of(of, problem.layout), problem.layout.scales
        assert friction is not None
        found = LoadedPath(friction, load_of(of, (0.0, -load), problem.layout)).set_down(problem)
    assert found is not None
    assert found.friction is not None
    return found.position * scales.length, found.friction.lost * scales.force * scales.length


@pytest.mark.slow
def test_a_journal_set_down_without_lateral_contraction_goes_the_way_of_2d() -> None:
    """Assembled and loaded at rest, where no film flows: along the shaft all is alike."""
    changes = {"petals.poisson_ratio": 0.0, "model.axial_cells": 2}
    whole, plane = (loaded_at_rest(rubbing(**changes, **kind), 5.0) for kind in ({"model.contacts": "nodes"}, PLANE))
    assert_allclose(whole[0], plane[0], rtol=0.0, atol=1e-12)
    assert whole[1] == pytest.approx(plane[1], rel=1e-6)
    assert plane[0][1] < -2e-5


@pytest.mark.slow
def test_a_run_up_and_down_has_hysteresis() -> None:
    """The rig: every point balances, friction takes energy on the way, and the way down is another."""
    rig = case("rig", **{"model.kind": "3d", "model.cells_per_pitch": 8, "model.axial_cells": 2})
    rig = rig.replace(**{"petals.theory": "shell", "surface.petal_friction": 0.1})
    records = list(runup.records(rig, load=(0.0, -55.6), to=1000.0, points=3))
    assert [record.scalars["leg"] for record in records] == ["up"] * 3 + ["down"] * 2
    assert all(record.converged and record.scalars["friction_path"] == PATH for record in records)
    for record in records:
        assert float(record.scalars["residual"]) <= 1e-8
        assert float(record.scalars["force_residual"]) <= 1e-9
    lost, y = (
        np.array([float(record.scalars[name]) for record in records])
        for name in ("petal_friction_work", "eccentricity_y")
    )
    assert np.all(np.diff(lost) > 0.0)
    assert np.all(np.abs(y[:2] - y[:2:-1]) > 1e-8)


# ------------------------------------------------------------------------------------------ both directions of slip


@pytest.mark.parametrize("symmetry", [True, False])
def test_the_wall_knows_the_slip_along_the_shaft(symmetry: bool) -> None:
    of = rubbing(**{"model.symmetry": symmetry})
    wall, mesh = build_wall(of), build_mesh(of)
    displacement = np.random.default_rng(3).standard_normal(wall.n_unknown)
    assert wall.axial_slip is not None
    expected = slip_along_shaft(mesh, float(petal_faces(of).half_thickness[0]), displacement)
    assert_allclose(
        wall.axial_slip @ displacement, expected, rtol=0.0, atol=1e-14 * np.max(np.abs(displacement)) * 10.0
    )


def tilting_cycle(amplitude: float) -> tuple[FrictionCycle, Array]:
    """A cycle of a journal that tilts to and fro, and its slips over the tilt, along petals, then along the shaft."""
    of = rubbing(**{"model.cells_per_pitch": 8})
    with running():
        answer = free_to_tilt(of, operating_point(whole_length(of), None).answer)
        motion, sliding = elastic_and_sliding(of, answer)
        assert sliding is not None
        assert sliding.friction.directions == 2
        response = motion.frictionless.respond(0.7, LinearSolver())
        cycle = FrictionCycle(sliding, response, amplitude / answer.problem.layout.scales.length)
        slip = cycle.settled(slips(sliding.friction, response.units[:, 2]), cycle.compliance())
    return cycle, slip


@pytest.mark.slow
def test_a_journal_that_tilts_rubs_along_the_shaft_too() -> None:
    """The cycle solves the whole linear system, and takes the area of its loops beside the work of the film."""
    cycle, slip = tilting_cycle(20e-6)
    law, a = cycle.sliding.friction, cycle.amplitude
    stiffness, _ = cycle.sliding.equivalent(slip, a)
    assert np.any(stiffness.imag > 0.0)
    motion, n = cycle.response.motion, len(cycle.response.units)
    whole = replace(motion, sticking=friction_tangent(law, stiffness, n)).respond(0.7, LinearSolver())
    assert_allclose(slips(law, whole.units[:, 2]), slip, rtol=0.0, atol=1e-9 * np.max(np.abs(slip)))
    assert_allclose(cycle.force_gradient()[2, 2], whole.force_gradient[2, 2], rtol=1e-9)
    along, across = np.abs(slip.reshape(2, -1))
    limit, k = (part.reshape(2, -1)[0] for part in (cycle.sliding.limit, law.stiffness))
    size = np.hypot(along, across) * a
    loops = np.sum(4.0 * limit * np.maximum(size - limit / k, 0.0))
    work = np.pi * a**2 * np.sum(stiffness.imag * np.abs(slip) ** 2)
    assert work == pytest.approx(loops, rel=1e-9)
    assert limit @ across > 0.3 * (limit @ along)


@pytest.mark.slow
def test_newtons_step_is_the_derivative_of_slips_in_both_directions() -> None:
    """Along it the residual falls as one minus the length, but for squares of the length."""
    cycle, slip = tilting_cycle(20e-6)
    compliance, begin = cycle.compliance(), 1.05 * slip
    free = slip + compliance @ (cycle.sliding.equivalent(slip, cycle.amplitude)[0] * slip)
    left = cycle.left(begin, free, compliance)
    step = cycle.newton(begin, left, compliance)
    lengths = 2.0 ** -np.arange(8, 14)
    remainder = [
        np.linalg.norm(cycle.left(begin + t * step, free, compliance) - (1.0 - t) * left) for t in lengths.tolist()
    ]
    assert_allclose(np.log2(np.divide(remainder[:-1], remainder[1:])), 2.0, rtol=0.0, atol=0.05)
