"""A petal as a plate, clamped at its root, free on the other three edges, under uniform pressure."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline

from petalfoil.mesh.axial import axis_3d
from tests.verification.shell_helpers import (
    GRIDS,
    Array,
    bend,
    orders,
    plate_shell,
    strip_shell,
    table,
    uniform_load,
)

QUANTITIES = ("w_tip_mid", "w_tip_corner", "w_centre", "energy*D/(q^2 a^6)")
ROWS = table("d3_plate_ritz")
BOWED = [row for row in ROWS if float(row["nu"]) > 0.0]
CELLS = (16, 32, 64)


def plate_answer(row: dict[str, str], grid: str, cells: int, *, half: bool = True, grading: float = 0.0) -> Array:
    """The table's quantities on `cells` along (pack grid: a pitch) and `cells` across, with `a = D = q = 1`."""
    b, kappa, nu = (float(row[name]) for name in ("b=L/a", "kappa=k*phi1", "nu"))
    shell = plate_shell(GRIDS[grid](1.0, cells), axis_3d(b, cells, half=half, grading=grading), kappa, nu)
    force = uniform_load(shell)
    W = bend(shell, force)
    line = W[:, -1 if half else cells // 2]
    return np.array([line[-1], W[-1, 0], CubicSpline(shell.phi, line)(0.5), 0.5 * float((force * W).sum())])


def name_of(row: dict[str, str]) -> str:
    return f"b={float(row['b=L/a']):.2f}-kappa={row['kappa=k*phi1']}"


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("row", BOWED, ids=name_of)
def test_against_ritz(row: dict[str, str], grid: str) -> None:
    """Within 0.5 % at 32 x 32 cells, second order from there.

    Where a clamped and a free edge meet, deflections go as `r^(1 + 1.07 +- 0.44 i)` at nu = 0.3, which adds errors
    like `h^2.14 cos(0.88 ln h + c)` to the `h^2` of the smooth part: between such neighbours a slope swings slowly
    about 2. On the narrow plate, where corners weigh most, it stays at 1.73 to 1.82 from 16 to 256 cells.
    """
    exact = np.array([float(row[name]) for name in QUANTITIES])
    errors = np.array([plate_answer(row, grid, cells) / exact - 1.0 for cells in CELLS])
    assert np.abs(errors[1]).max() < 5e-3
    assert np.abs(errors[2]).max() < 1.5e-3
    slowest = 1.7 if float(row["b=L/a"]) < 1.0 else 1.9
    assert orders(errors).min() > slowest


@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("row", BOWED, ids=name_of)
def test_stations_that_crowd_toward_the_ends_bend_alike(row: dict[str, str], half: bool) -> None:
    """The same limits on axial cells that shrink four-fold toward the free sides."""
    exact = np.array([float(row[name]) for name in QUANTITIES])
    errors = [plate_answer(row, next(iter(GRIDS)), cells, half=half, grading=0.6) / exact - 1.0 for cells in CELLS]
    assert np.abs(errors[1]).max() < 5e-3
    assert np.abs(errors[2]).max() < 1.5e-3
    assert orders(np.array(errors))[-1].min() > 1.7  # as slow on the narrow plate as above


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("row", [row for row in ROWS if float(row["nu"]) == 0.0], ids=name_of)
def test_without_lateral_contraction_it_is_the_strip(row: dict[str, str], grid: str) -> None:
    cells = 32
    b, kappa = float(row["b=L/a"]), float(row["kappa=k*phi1"])
    phi = GRIDS[grid](1.0, cells)
    plate, strip = plate_shell(phi, axis_3d(b, 16, half=True), kappa, 0.0), strip_shell(phi, kappa)
    W, line = bend(plate, uniform_load(plate)), bend(strip, uniform_load(strip))
    rounding = np.finfo(float).eps * len(phi) ** 4  # what the condition of bending leaves of the last digit
    assert_allclose(W, np.broadcast_to(line, W.shape), rtol=rounding)
    exact = np.array([float(row[name]) for name in QUANTITIES])
    assert_allclose(plate_answer(row, grid, cells), exact, rtol=2e-3)


@pytest.mark.parametrize("clamped", [False, True], ids=["hinged", "rigid"])
def test_half_a_plate_is_half_of_the_whole(clamped: bool) -> None:
    """Under a load that is symmetric but not uniform; a spring along the tip holds the hinged one."""
    phi, cells = GRIDS["pack"](1.0, 16), 16
    answers = []
    for half in (True, False):
        shell = plate_shell(phi, axis_3d(1.3, cells, half=half), 0.7, 0.3, clamped=clamped)
        n_z = len(shell.axial.z)
        force = uniform_load(shell) * (1.0 + np.cos(2.0 * np.pi * shell.axial.z / 1.3)) * (1.0 + shell.phi[:, None])
        K = shell.stiffness.toarray()[n_z:, n_z:]
        K[-n_z:, -n_z:] += 10.0 * np.diag(shell.axial.weight)
        W = np.linalg.solve(K, force[1:].ravel()).reshape(-1, n_z)
        answers.append(shell.axial.whole(W))
    assert_allclose(answers[0], answers[1], rtol=1e-10)


@pytest.mark.parametrize("half", [True, False], ids=["half", "whole"])
@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("clamped", [False, True], ids=["hinged", "rigid"])
def test_anticlastic_patch(clamped: bool, grid: str, half: bool) -> None:
    """`w = M (x^2 - nu y^2) / (2 D (1 - nu^2))`, bent by edge moments `M` alone, is an exact answer of the grid."""
    M, nu, b, cells = 2.5, 0.3, 0.8, 12
    shell = plate_shell(GRIDS[grid](1.0, cells), axis_3d(b, 8, half=half), 0.0, nu, clamped=clamped)
    x, y = shell.phi[:, None], shell.axial.z[None, :] - 0.5 * b
    W = M * (x**2 - nu * y**2) / (2.0 * (1.0 - nu**2))
    chi_x, chi_y = shell.curvatures(W)
    inner = slice(0 if clamped else 1, -1)  # a hinged root and the free edge carry no moment, this field does
    assert_allclose((chi_x + nu * chi_y)[inner], M, rtol=1e-12)
    assert_allclose((chi_y + nu * chi_x)[inner], 0.0, atol=1e-12 * M)

    twist = (shell.strain @ (shell.difference @ W.ravel()))[2 * W.size :]
    assert_allclose(twist, 0.0, atol=1e-12 * M)

    residual = (shell.stiffness @ W.ravel()).reshape(W.shape)
    cell = shell.phi[-1] - shell.phi[-2]
    free = slice(0 if clamped else 2, -2)  # away from the edges that M loads; a clamped root mirrors the patch
    assert_allclose(residual[free], 0.0, atol=1e-10 * M / cell)
    assert_allclose(residual[-2:].sum(axis=1), [-M * b / cell, M * b / cell], rtol=1e-11)
