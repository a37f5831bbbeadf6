"""Displacements of a pack on other grids: splines are exact for cubics, odd displacements stay odd."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.case import Case
from petalfoil.mesh.pack import PackMesh
from petalfoil.system.build import build_problem
from petalfoil.walls import wall_kind
from petalfoil.walls.between_grids import middles, on_other_grid
from petalfoil.walls.petals import build_mesh
from tests.cases import case


def bearing(cells: int, axial: int, *, half: bool = True, theory: str = "shell") -> Case:
    grid = {"model.cells_per_pitch": cells, "model.axial_cells": axial, "model.axial_density": "uniform"}
    return case("paper_n8_spatial", **grid, **{"petals.theory": theory, "model.symmetry": half})


def even(phi: np.ndarray, z: np.ndarray) -> np.ndarray:
    """A cubic of both, which vanishes at the root and is even about the middle of the bearing, (node, station)."""
    return (2.0 * phi - phi**3)[:, None] * (1.0 + z**2)


def displacements(mesh: PackMesh) -> np.ndarray:
    """Unknowns of petals that stretch: petal by petal larger, those along the shaft odd about the middle."""
    z = mesh.axial.z / mesh.axial.length - 0.5
    sizes = 1.0 + np.arange(mesh.count)
    at_nodes = np.multiply.outer(sizes, even(mesh.phi, z)[1:])
    along_shaft = (1.0 + middles(mesh.phi) ** 2)[:, None] * (middles(z) - 2.0 * middles(z) ** 3)
    return np.concatenate([at_nodes.ravel(), -3.0 * at_nodes.ravel(), np.multiply.outer(sizes, along_shaft).ravel()])


@pytest.mark.parametrize("half", [True, False])
def test_cubics_are_exact(half: bool) -> None:
    mesh, other = (build_mesh(bearing(*grid, half=half)) for grid in ((12, 10), (20, 16)))
    expected = displacements(other)
    assert_allclose(on_other_grid(displacements(mesh), mesh, other), expected, atol=1e-12 * np.abs(expected).max())


def test_petals_that_bend_only_have_deflections_alone() -> None:
    coarse, fine = bearing(12, 8, theory="inextensible"), bearing(16, 12, theory="inextensible")
    mesh, other = build_mesh(coarse), build_mesh(fine)
    values = [displacements(one)[: one.count * (one.n_node - 1) * one.n_z] for one in (mesh, other)]
    carried = wall_kind(coarse).prolonged(coarse, fine, values[0])
    assert len(carried) == build_problem(fine).layout.n_wall
    assert_allclose(carried, values[1], atol=1e-12 * np.abs(values[1]).max())


def test_other_walls_have_none_on_other_grids() -> None:
    plain = case("plain_journal")
    with pytest.raises(ValueError, match="not carried over"):
        wall_kind(plain).prolonged(plain, plain, np.zeros(0))
