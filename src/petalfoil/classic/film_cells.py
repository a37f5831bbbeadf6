"""Coefficients of the film's cells at given film thickness, computed once for all time steps of a march.

All arrays are nodal and flattened from (strip, node, axial). A node has the coefficients of the face after it in the
circumferential direction and of the face after it in the axial direction. They are zero where there is no such face.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.physics.reynolds import mean_cube, slip_pressure

Array = NDArray[np.float64]
Index = NDArray[np.int64]


class FilmCells(NamedTuple):
    """Coefficients of the flows (56), (57) and of the storage (55), (n_node,) each [1].

    Attributes
    ----------
    n_z : int
        Number of axial stations, which is the index step to the next node in the circumferential direction.
    along, across : arrays
        `mean(h^3)` over the distance of the nodes, times the width of the face: circumferential, axial.
    slip, slip_across : arrays
        Pressure with the same effect on the flow as slip (F7), on the same faces.
    advection, advection_ahead : arrays
        `Lam h / 2` times the width, at the node before the face and at the node after it.
    peclet : array
        Half the cell Peclet number times `mean(p)` (F2).
    capacity : array
        `h` times the area of the cell: gas in the cell over its pressure. Nodes that share a pressure have their sum.
    is_unknown : array
        1 where the pressure is unknown, 0 where it is ambient.
    first, last : int arrays
        Pairs of nodes that share one pressure: the first of a strip, the last of the previous strip.
    inventory, inventory_slip : arrays
        `h^3` and `12 Kn h^2` times the area (F6) of a film without ambient nodes; otherwise empty.
    """

    n_z: int
    along: Array
    across: Array
    slip: Array
    slip_across: Array
    advection: Array
    advection_ahead: Array
    peclet: Array
    capacity: Array
    is_unknown: Array
    first: Index
    last: Index
    inventory: Array
    inventory_slip: Array


def film_cells(balance: FilmBalance, H: Array, Lam: float) -> FilmCells:
    """Coefficients at film thickness `H` (strip, node, axial) and bearing number `Lam` [1]."""
    mesh, Kn = balance.mesh, balance.knudsen
    ahead, beside = (H[:, :-1], H[:, 1:]), (H[..., :-1], H[..., 1:])
    cube, cube_across = (mean_cube(*sides) for sides in (ahead, beside))
    width, width_across = balance.width_Z, mesh.arc_weight[:, None] * mesh.axial.copies
    first, last = shared(mesh.unknown)
    capacity = (H * balance.area).ravel()
    capacity[first] = capacity[last] = capacity[first] + capacity[last]
    closed = bool(np.all(mesh.unknown >= 0))
    return FilmCells(
        n_z=mesh.shape[2],
        along=_at_nodes(cube / balance.dphi * width, H.shape),
        across=_at_nodes(cube_across / balance.dZ * width_across, H.shape),
        slip=_at_nodes(slip_pressure(*ahead, Kn), H.shape),
        slip_across=_at_nodes(slip_pressure(*beside, Kn), H.shape),
        advection=_at_nodes(0.5 * Lam * ahead[0] * width, H.shape),
        advection_ahead=_at_nodes(0.5 * Lam * ahead[1] * width, H.shape),
        peclet=_at_nodes(0.25 * Lam * (ahead[0] + ahead[1]) * balance.dphi / cube, H.shape),
        capacity=capacity,
        is_unknown=(mesh.unknown >= 0).ravel().astype(np.float64),
        first=first,
        last=last,
        inventory=(H**3 * balance.area).ravel() if closed else np.zeros(0),
        inventory_slip=(12.0 * Kn * H**2 * balance.area).ravel() if closed else np.zeros(0),
    )


def shared(unknown: NDArray[np.intp]) -> tuple[Index, Index]:
    """Flattened indices of nodes that share one pressure: first of a strip, last of the previous strip."""
    nodes = np.arange(unknown.size).reshape(unknown.shape)
    first, last = nodes[:, 0], np.roll(nodes[:, -1], 1, axis=0)
    both = unknown[:, 0] >= 0
    return first[both].astype(np.int64), last[both].astype(np.int64)


def _at_nodes(faces: Array, shape: tuple[int, ...]) -> Array:
    """Values of faces at the nodes before them, flattened; zero where there is no face."""
    out = np.zeros(shape)
    out[tuple(slice(0, count) for count in faces.shape)] = faces
    return out.ravel()
