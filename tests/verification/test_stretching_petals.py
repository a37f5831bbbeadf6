"""Petals in 3-D as thin shells that bend and stretch (M8)-(M10): exact cases, rigid motions, thin limits, packs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.balance import balance
from petalfoil.analysis.sensitivity import sensitivity
from petalfoil.analysis.solve import solve
from petalfoil.analysis.static import static
from petalfoil.mesh.axial import AxialGrid, axis_2d, axis_3d
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.physics.shell import PetalShell
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.cases import case
from tests.verification.film_helpers import table
from tests.verification.shell_helpers import uniform_load

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Leaf:
    """A petal of radius 1 and rigidity 1, of an angle, a length along the shaft, `R / t` and Poisson's ratio."""

    angle: float
    axial: AxialGrid
    slenderness: float
    nu: float
    cells: int
    clamped: bool = True

    @property
    def petal(self) -> StretchingPetal:
        """The petal on its grid."""
        phi = np.linspace(0.0, self.angle, self.cells + 1)
        shell = PetalShell(phi, self.axial, 1.0, 1.0, 1.0, self.nu, self.clamped)
        return StretchingPetal(shell, 12.0 * self.slenderness**2)


def stiffness(petal: StretchingPetal) -> sp.csr_array:
    """`K` of all displacements, the root included."""
    S = petal.strain @ petal.difference
    return sp.csr_array(S.T @ petal.rigidity_matrix @ S)


def parts(petal: StretchingPetal, x: Array) -> tuple[Array, Array, Array]:
    """`W`, `V` (node, axial) and `U` (cell, cell)."""
    W, V, U = np.split(x, np.cumsum(petal.sizes)[:-1])
    return W.reshape(-1, petal.n_z), V.reshape(-1, petal.n_z), U.reshape(-1, max(petal.n_z - 1, 1))


def bent(petal: StretchingPetal, on_W: Array, on_V: Array | None = None, propped: bool = False) -> Array:
    """Displacements of a petal held at its root, and at its free edge where it is propped, under nodal forces."""
    force = np.zeros(sum(petal.sizes))
    force[: on_W.size] = on_W.ravel()
    if on_V is not None:
        force[on_W.size : 2 * on_W.size] = on_V.ravel()
    free = petal.free.copy()
    if propped:
        free[on_W.size - petal.n_z : on_W.size] = False
    x = np.zeros_like(force)
    K = stiffness(petal)[free][:, free]
    x[free] = LinearSolver().factor(sp.csc_array(K)).solve(force[free])
    return x


# ------------------------------------------------------------------------------------------ motions without energy


@pytest.mark.parametrize("clamped", [True, False])
def test_a_petal_turns_about_its_root_without_energy(clamped: bool) -> None:
    """In these motions it moves along itself, and loads are balanced by the force of the root (S4)."""
    petal = Leaf(1.7, axis_3d(2.0, 8, half=True), 230.0, 0.3, 24, clamped).petal
    motions, support = petal.free_motions()
    strains = petal.strain @ (petal.difference @ motions)
    released = petal.difference.T @ (petal.strain.T @ (petal.rigidity_matrix @ strains))
    assert np.max(np.abs(released[2 * petal.n_z : petal.sizes[0]])) < 1e-6 * np.max(np.abs(stiffness(petal)))
    assert motions.shape[1] == 1 + (not clamped)
    load = np.random.default_rng(1).uniform(-1.0, 1.0, (25, petal.n_z))
    x = bent(petal, load, propped=not clamped)
    loads = (stiffness(petal) @ x)[petal.n_z : load.size]  # with those of the prop
    work = motions[petal.n_z : load.size].T @ loads
    assert_allclose(work + support @ x, 0.0, atol=1e-8 * np.abs(loads).sum())


def test_a_turn_across_the_shaft_bends_nothing_in_the_limit() -> None:
    """A rigid turn about an axis through the root: strains vanish with the square of the cells, twist among them."""
    largest = []
    for cells in (12, 24):
        axial = axis_3d(2.0, cells, half=False)
        petal = Leaf(1.2, axial, 1.0, 0.3, cells, clamped=False).petal
        phi, z = petal.shell.phi[:, None], axial.z - 1.0
        centre = 0.5 * (petal.shell.phi[1:] + petal.shell.phi[:-1])[:, None]
        U = np.sin(centre) * np.ones(petal.n_z - 1)
        x = np.concatenate([(-z * np.sin(phi)).ravel(), (-z * np.cos(phi)).ravel(), U.ravel()])
        largest.append(np.max(np.abs(petal.strain @ (petal.difference @ x))))
    assert largest[0] < 2e-2
    assert largest[1] < 0.3 * largest[0]


# ------------------------------------------------------------------------------------------ exact cases


ANTICLASTIC = [{key: float(value) for key, value in row.items()} for row in table("r6a_anticlastic.csv")]


@pytest.mark.parametrize("row", ANTICLASTIC, ids=lambda row: f"L={row['L_mm']:g}")
def test_a_leaf_with_free_sides_curves_anticlastically(row: dict[str, float]) -> None:
    """Half way up an arc of 2 rad that a couple at its free edge bends, on 48 by 24 cells.

    Moment over curvature within 0.03 %; the sides' bow within 2 %, where the leaf is short enough beside the arc that
    root and edge are not felt.
    """
    R, t, L, nu = (row[name] for name in ("R_mm", "t_mm", "L_mm", "nu"))
    axial = axis_3d(L / R, 24, half=True, grading=0.9)
    petal = Leaf(2.0, axial, R / t, nu, 48).petal
    couple = np.zeros((49, petal.n_z))
    couple[-1], couple[-2] = axial.weight, -axial.weight
    W, _, _ = parts(petal, bent(petal, couple))
    along, across = (chi[24] for chi in petal.shell.curvatures(W))
    part = axial.weight / axial.length
    curvature = along @ part
    assert (along + nu * across) @ part / curvature == pytest.approx(row["B_eff/D"], rel=3e-4)
    if row["L_mm"] <= 25.0:
        bow = (W[24, 0] - W[24] @ part) / (nu * curvature * axial.length**2)
        assert bow == pytest.approx(row["edge bow w_e/(nu kappa L^2) check"], rel=2e-2)


HELD = [{key: float(value) for key, value in row.items()} for row in table("r6b_held_arch.csv")]


def area_of_a_held_arch(leaf: Leaf) -> float:
    """Area that half an arch sweeps under a pressure of 1 that its foot carries, the foot sliding nowhere."""
    petal, t0 = leaf.petal, leaf.angle
    weight, c, s = leaf.axial.weight, math.cos(t0), math.sin(t0)
    pressure, foot = uniform_load(petal.shell), np.zeros((leaf.cells + 1, petal.n_z))
    foot[-1] = weight
    lifted, pushed = bent(petal, c * s * foot - pressure, -s * s * foot), bent(petal, s * foot, c * foot)

    def out(x: Array) -> float:
        W, V, _ = parts(petal, x)
        return float((s * W[-1] + c * V[-1]) @ weight)

    x = lifted - out(lifted) / out(pushed) * pushed
    W, V, _ = parts(petal, x)
    up = (c * W[-1] - s * V[-1]) @ weight
    return float(-np.sum(pressure * W) + s * up) / leaf.axial.length


@pytest.mark.parametrize("row", HELD, ids=lambda row: f"{row['t0']}-{row['R/t']:g}")
def test_a_held_arch_is_that_of_2d_without_lateral_contraction(row: dict[str, float]) -> None:
    """Within 0.5 % of the frame with membrane on 96 cells at every slenderness; in 3-D with free sides the same."""
    name = "swept half area/(q R^5/D), held, frame with EA = 12 D/t^2"
    plane = area_of_a_held_arch(Leaf(row["t0"], axis_2d(0.5), row["R/t"], 0.0, 96))
    assert plane == pytest.approx(row[name], rel=5e-3)
    whole = area_of_a_held_arch(Leaf(row["t0"], axis_3d(0.5, 6, half=False), row["R/t"], 0.0, 96))
    assert whole == pytest.approx(plane, rel=1e-6)


LOADS: dict[str, Callable[[Array], Array]] = {"uniform": np.ones_like, "sine": lambda part: np.sin(np.pi * part)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "propped"), [("uniform", False), ("sine", False), ("sine", True)], ids=["uniform", "sine", "sine, propped"]
)
def test_thin_petals_do_not_lock_in_3d(name: str, propped: bool) -> None:
    """Work of a pressure on 24 by 12 cells, `t / R` from 1e-2 to 1e-4: errors within a factor 2, below 3 %."""

    def work(slenderness: float, cells: int) -> float:
        leaf = Leaf(1.7, axis_3d(2.0, cells // 2, half=True, grading=0.8), slenderness, 0.3, cells, not propped)
        pressure = uniform_load(leaf.petal.shell) * LOADS[name](leaf.axial.z / 2.0)
        W, _, _ = parts(leaf.petal, bent(leaf.petal, pressure, propped=propped))
        return float(np.sum(pressure * W))

    errors = np.abs([work(each, 24) / work(each, 144) - 1.0 for each in (1e2, 1e3, 1e4)])
    assert errors.max() < 2.0 * errors.min()
    assert errors.max() < 3e-2


# ------------------------------------------------------------------------------------------ packs


GRID = {"model.cells_per_pitch": 10, "model.axial_cells": 6, "model.axial_density": "uniform"}


@pytest.mark.slow
def test_without_lateral_contraction_the_pack_on_the_journal_does_not_stretch() -> None:
    """Along the shaft everything is alike, so that no membrane is strained: the forces are those of bending alone."""
    same = {**GRID, "petals.poisson_ratio": 0.0}
    bend, stretch = (
        static(case("paper_n8_spatial", **same, **{"petals.theory": theory}), ["-100 um"]).force_y.item()
        for theory in ("inextensible", "shell")
    )
    assert stretch == pytest.approx(bend, rel=1e-9)


@pytest.mark.slow
def test_half_of_the_length_is_the_mirror_of_the_other() -> None:
    """Displacements along the shaft are mirrored with the other sign: half a bearing's answer starts the whole's."""
    stretch = case("paper_n8_spatial", **GRID, **{"petals.theory": "shell"})
    half, whole = solve(stretch), solve(stretch.replace(**{"model.symmetry": False}))
    assert whole.force_y.item() == pytest.approx(half.force_y.item(), rel=1e-8)
    assert "mirrored" in str(whole.solution_path.item())
    assert int(whole.factorizations) <= int(half.factorizations) + 1
    tilted = solve(stretch.replace(**{"model.symmetry": False, "operation.tilt": (1e-4, 0.0)}))
    assert abs(tilted.moment_x.item()) > 1e-4
    assert float(tilted.max_membrane_stress) > 1e6


@pytest.mark.slow
def test_derivatives_know_what_stretches() -> None:
    """By Poisson's ratio, which couples strains along and across: against equilibria that are solved again."""
    at_nodes = case("paper_n8_spatial", **GRID, **{"petals.theory": "shell", "model.contacts": "nodes"})
    told = sensitivity(at_nodes, vary=["petals.poisson_ratio"], of=["force_y"], contacts="nodes")
    step = 3e-7
    more, less = (solve(at_nodes.replace(**{"petals.poisson_ratio": 0.3 + way})) for way in (step, -step))
    by_differences = (more.force_y.item() - less.force_y.item()) / (2.0 * step)
    assert told.derivative.item() == pytest.approx(by_differences, rel=1e-5)


@pytest.mark.long
def test_contact_at_the_sides_is_that_of_a_finer_grid() -> None:
    """The rig touches in a band of 1.6 mm beside its sides: 24 stations have to be where it is."""
    at_work = {"model.kind": "3d", "operation.speed": "8800 rpm"}
    rig = case("rig", **at_work, **{"model.cells_per_pitch": 64, "model.axial_cells": 24})
    finer = rig.replace(**{"model.cells_per_pitch": 96, "model.axial_cells": 36})
    default, fine = (balance(bearing, load="46.4 N") for bearing in (rig, finer))
    assert float(default.contact_fraction) == pytest.approx(float(fine.contact_fraction), rel=0.02)
    assert float(default.friction_torque) == pytest.approx(float(fine.friction_torque), rel=0.01)
    equal = balance(rig.replace(**{"model.axial_density": "uniform"}), load="46.4 N")
    assert float(equal.contact_fraction) != pytest.approx(float(fine.contact_fraction), rel=0.05)
