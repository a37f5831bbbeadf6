"""Displacements of a leaf pack on another grid of the same petals: by cubic splines along both directions.

Deflections of a thin petal have continuous curvatures, and so have these splines.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.pack import PackMesh
from petalfoil.mesh.splines import smooth

Array = NDArray[np.float64]


def on_other_grid(displacement: Array, mesh: PackMesh, other: PackMesh) -> Array:
    """Unknowns of a pack (n,) on `mesh` at the unknowns of an `other` grid in 3-D, whose petals are the same.

    Deflections come first; of petals that stretch, displacements along themselves follow, at nodes too, and those along
    the shaft, at the middles of the cells.
    """
    size = mesh.count * (mesh.n_node - 1) * mesh.n_z
    parts = [at_nodes(displacement[:size], mesh, other)]
    if len(displacement) > size:
        parts += [at_nodes(displacement[size : 2 * size], mesh, other), at_cells(displacement[2 * size :], mesh, other)]
    return np.concatenate(parts)


def at_nodes(values: Array, mesh: PackMesh, other: PackMesh) -> Array:
    """Nodal values without the roots, where they vanish, on another grid; (nodes,) each."""
    whole = np.zeros(mesh.shape)
    whole[:, 1:] = values.reshape(mesh.count, -1, mesh.n_z)
    along = smooth(mesh.phi, whole, axis=1)(other.phi)[:, 1:]
    return np.asarray(along_shaft(along, mesh.axial, other.axial).ravel())


def at_cells(values: Array, mesh: PackMesh, other: PackMesh) -> Array:
    """Displacements along the shaft at the middles of the cells, odd about a plane of symmetry; (cells,) each."""
    along = values.reshape(mesh.count, mesh.n_node - 1, mesh.n_z - 1)
    along = smooth(middles(mesh.phi), along, axis=1)(middles(other.phi))
    if mesh.axial.half:
        along = np.concatenate([along, -along[..., ::-1]], axis=-1)
    spline = smooth(middles(mesh.axial.whole_z), along, axis=-1)
    return np.asarray(spline(middles(other.axial.z)).ravel())


def along_shaft(values: Array, axial: AxialGrid, other: AxialGrid) -> Array:
    """Values (..., station) at the stations of another grid of the same length, whole or half as this one."""
    return np.asarray(smooth(axial.whole_z, axial.whole(values), axis=-1)(other.z))


def middles(nodes: Array) -> Array:
    """Middles of the cells between nodes."""
    return 0.5 * (nodes[1:] + nodes[:-1])
