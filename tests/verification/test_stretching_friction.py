"""Friction between petals that stretch in 3-D: on the slip along petals; that along the shaft is small."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.equilibrium.friction_history import assembled, moved
from petalfoil.equilibrium.run_context import running
from petalfoil.mesh.pack import PackMesh
from petalfoil.system.build import build_problem
from petalfoil.system.friction import friction_of
from petalfoil.walls.petals import build_mesh, petal_faces
from petalfoil.walls.sliding import node_slopes
from tests.cases import case

Array = NDArray[np.float64]


def rubbing(**changes: object) -> Case:
    """Eight petals of the paper in 3-D with friction, on a coarse grid."""
    coarse = {"model.cells_per_pitch": 10, "model.axial_cells": 4, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **{"petals.theory": "shell", "surface.petal_friction": 0.1, **coarse, **changes})


@pytest.mark.slow
def test_without_lateral_contraction_friction_is_that_of_2d() -> None:
    """Loaded and unloaded: along the shaft all is alike, so that forces and energy lost are those of one station."""
    way = ["0 um", "-10 um", "-5 um"]
    changes = {"petals.poisson_ratio": 0.0, "model.axial_cells": 2}
    whole = static(rubbing(**changes), way)
    plane = static(rubbing(**changes, **{"model.kind": "2d"}), way)
    assert_allclose(whole.force_y, plane.force_y, rtol=1e-7, atol=1e-7)
    assert_allclose(whole.petal_friction_work, plane.petal_friction_work, rtol=1e-6, atol=1e-12)
    assert float(whole.petal_friction_work[-1]) > 0.0


def slip_along_shaft(mesh: PackMesh, half_thickness: float, displacement: Array) -> Array:
    """Slip along the shaft at all gaps on the bushing and between petals, from `U` and `W_z`; half the length."""
    n, m = mesh.n_node, mesh.n_z
    W, V, U = np.split(displacement, np.array([1, 2]) * mesh.count * (n - 1) * m)
    assert len(V) == len(W)
    W = np.concatenate([np.zeros((mesh.count, 1, m)), W.reshape(mesh.count, n - 1, m)], axis=1)
    turn = W @ sp.csr_array(node_slopes(mesh.axial.z)).toarray().T
    turn[..., -1] = 0.0  # plane of symmetry
    cells = U.reshape(mesh.count, n - 1, m - 1)
    around = np.pad(cells, ((0, 0), (0, 0), (1, 0)), mode="edge")
    around = np.concatenate([around, -cells[..., -1:]], axis=-1)
    at_stations = 0.5 * (around[..., 1:] + around[..., :-1])
    ends = np.concatenate([-at_stations[:, :1], at_stations, at_stations[:, -1:]], axis=1)
    along = 0.5 * (ends[:, 1:] + ends[:, :-1])
    outer, inner = -along + half_thickness * turn, along + half_thickness * turn
    between = outer[:, mesh.on_neighbour] + np.roll(inner, -1, axis=0)[:, : n - mesh.cells]
    return np.concatenate([outer[:, mesh.on_bushing].ravel(), between.ravel()])


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.02, 0.3])
def test_petals_hardly_slip_along_the_shaft(mu: float) -> None:
    """Moved by 20 um: weighted with the reactions, below a thousandth of the slip along the petals."""
    of = rubbing(**{"surface.petal_friction": mu, "operation.eccentricity": (0.0, 0.0)})
    with running():
        centred = build_problem(of)
        layout, friction = centred.layout, friction_of(of, centred.layout)
        assert friction is not None
        start = assembled(friction, centred)
        assert start is not None
        there = centred.at(displacement=np.array([0.0, -2e-5]) / layout.scales.length)
        end = moved(friction, (centred, start), there)
        assert end is not None
    mesh, change = build_mesh(of), end.x - start.x
    along = layout.wall.slip @ change
    across = slip_along_shaft(mesh, float(petal_faces(of).half_thickness[0]), change)
    pressed = np.minimum(start.lam, end.lam)[layout.wall.contacts.bushing.start :]
    assert pressed @ np.abs(across) < 1e-3 * (pressed @ np.abs(along))
    assert pressed @ np.abs(across) > 0.0


@pytest.mark.slow
def test_contacts_that_stick_are_arches() -> None:
    """Sticking petals are many times as stiff as sliding ones, and a motion far beyond their slip feels neither."""
    load = (0.0, -5.0)
    free = coefficients(rubbing(**{"surface.petal_friction": 0.0}), load=load).stiffness.values[0]
    stuck = coefficients(rubbing(), load=load).stiffness.values[0]
    far = coefficients(rubbing(), load=load, amplitude="500 um").stiffness.values[0]
    assert stuck[0, 0] > 5.0 * free[0, 0]
    assert abs(far[0, 0] / free[0, 0] - 1.0) < 0.5
