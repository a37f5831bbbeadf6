"""Stiffness of a petal: symmetric, never negative, and blind to exactly those motions that bend nothing."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.mesh.axial import AxialGrid, axis_2d, axis_3d
from petalfoil.physics.shell import PetalShell
from tests.verification.shell_helpers import GRIDS, Array, bend, orders, pack_grid, plate_shell, uniform_load

ANGLE, K_ARC = 1.8, 0.64
AXES = {
    "2d": axis_2d(1.0),
    "half": axis_3d(2.0, 8, half=True),
    "whole": axis_3d(2.0, 8, half=False),
}


def shell_on(axis: AxialGrid, k: float, *, clamped: bool, cells: int = 8) -> PetalShell:
    return plate_shell(pack_grid(ANGLE, cells), axis, k, 0.3, clamped=clamped)


def spectrum(K: Array) -> Array:
    """Eigenvalues over the largest, smallest first."""
    values = np.linalg.eigvalsh(K)
    out: Array = values / values[-1]
    return out


@pytest.mark.parametrize("clamped", [False, True], ids=["hinged", "rigid"])
@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("k", [0.0, K_ARC])
def test_symmetric_and_never_negative(k: float, axis: str, clamped: bool) -> None:
    K = shell_on(AXES[axis], k, clamped=clamped).stiffness.toarray()
    assert_allclose(K, K.T, rtol=0.0, atol=1e-14 * np.abs(K).max())
    assert spectrum(K)[0] > -1e-13


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("k", [0.0, K_ARC])
def test_a_hinged_petal_turns_freely_and_does_nothing_else(k: float, axis: str) -> None:
    n_z = len(AXES[axis].z)
    hinged = spectrum(shell_on(AXES[axis], k, clamped=False).stiffness.toarray()[n_z:, n_z:])
    assert abs(hinged[0]) < 1e-13
    assert hinged[1] > 1e-7
    rigid = spectrum(shell_on(AXES[axis], k, clamped=True).stiffness.toarray()[n_z:, n_z:])
    assert rigid[0] > 1e-8


@pytest.mark.parametrize("grid", GRIDS)
def test_the_free_turn_is_the_sine(grid: str) -> None:
    errors = []
    for cells in (16, 32, 64):
        phi = GRIDS[grid](ANGLE, cells)
        K = plate_shell(phi, AXES["2d"], K_ARC, 0.3, clamped=False).stiffness.toarray()
        mode = np.append(0.0, np.linalg.eigh(K[1:, 1:])[1][:, 0])
        errors.append(float(np.abs(mode / mode[-1] - np.sin(K_ARC * phi) / np.sin(K_ARC * ANGLE)).max()))
    assert errors[-1] < 1e-5
    assert orders(errors).min() > 1.9


@pytest.mark.parametrize("clamped", [False, True], ids=["hinged", "rigid"])
@pytest.mark.parametrize("grid", GRIDS)
def test_free_motions_with_the_root_released(grid: str, clamped: bool) -> None:
    """Discrete `cos(k s)`, and `sin(k s)` where the root may turn: no energy at all, second order to the functions."""
    errors = []
    for cells in (16, 32, 64):
        phi = GRIDS[grid](ANGLE, cells)
        shell = plate_shell(phi, AXES["2d"], K_ARC, 0.3, clamped=clamped)
        motions, _ = shell.free_motions()
        K = shell.stiffness
        energy = np.einsum("ik,ik->k", motions, K @ motions)
        scale = np.einsum("ik,ik->k", np.abs(motions), abs(K) @ np.abs(motions))
        assert motions.shape[1] == (1 if clamped else 2)
        assert_allclose(energy / scale, 0.0, atol=1e-15)
        cosine, sine = np.cos(K_ARC * phi), np.sin(K_ARC * phi)
        basis = cosine[:, None] if clamped else np.stack([cosine, sine], axis=1)
        at = [0] if clamped else [0, len(phi) - 1]  # where the combination is matched: root, tip
        match = basis @ np.linalg.solve(basis[at], motions[at])
        errors.append(float(np.abs(motions - match).max() / np.abs(match).max()))
    assert errors[-1] < 2e-5
    assert orders(errors).min() > 1.9


@pytest.mark.parametrize("axis", AXES)
def test_the_root_bears_what_the_loads_do_in_free_motions(axis: str) -> None:
    shell = shell_on(AXES[axis], K_ARC, clamped=True, cells=16)
    force = uniform_load(shell) * (1.0 + np.sin(3.0 * shell.phi))[:, None]
    force[0] = 0.0  # what presses on the root itself bends nothing
    W = bend(shell, force)
    motions, support = shell.free_motions()
    assert_allclose(motions.T @ force.ravel(), -(support @ W.ravel()), rtol=1e-8)
