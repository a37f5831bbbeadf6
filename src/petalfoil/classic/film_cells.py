"""The film's cells as a march sees them: deflections frozen, what depends on the film thickness computed once.

All arrays are nodal and flat, in the order (strip, node, axial). A node keeps the coefficients of the face ahead of it
along the rotation and of the one ahead of it along the shaft; where there is none they are zero.
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
        Stations along the shaft: the step from a node to the next one along the rotation.
    along, across : arrays
        `mean(h^3)` over the distance of the nodes, times the face's width.
    slip, slip_across : arrays
        Pressure that would let as much pass as slip does (F7), on the same faces.
    carried, carried_on : arrays
        `Lam h / 2` times the width, at the node behind the face and at the node ahead of it.
    peclet : array
        Half the cell's Peclet number times `mean(p)` (F2).
    hold : array
        `h` times the cell's area; what a pressure unknown holds where two nodes share it.
    moves : array
        1 where the pressure is unknown, 0 where it is ambient.
    first, last : int arrays
        Pairs of nodes that share one pressure: the first of a strip, the last of the strip before it.
    spread, spread_slip : arrays
        `h^3` and `12 Kn h^2` times the area (F6) of a film without ends; empty where it has any.
    """

    n_z: int
    along: Array
    across: Array
    slip: Array
    slip_across: Array
    carried: Array
    carried_on: Array
    peclet: Array
    hold: Array
    moves: Array
    first: Index
    last: Index
    spread: Array
    spread_slip: Array


def film_cells(balance: FilmBalance, H: Array, Lam: float) -> FilmCells:
    """Coefficients for a march at film thickness `H` (strip, node, axial) and bearing number `Lam` [1]."""
    mesh, Kn = balance.mesh, balance.knudsen
    ahead, beside = (H[:, :-1], H[:, 1:]), (H[..., :-1], H[..., 1:])
    cube, cube_across = (mean_cube(*sides)[0] for sides in (ahead, beside))
    width, width_across = balance.width_Z, mesh.arc_weight[:, None] * mesh.axial.copies
    first, last = shared(mesh.unknown)
    hold = (H * balance.area).ravel()
    hold[first] = hold[last] = hold[first] + hold[last]
    endless = bool(np.all(mesh.unknown >= 0))
    return FilmCells(
        n_z=mesh.shape[2],
        along=_at_nodes(cube / balance.dphi * width, H.shape),
        across=_at_nodes(cube_across / balance.dZ * width_across, H.shape),
        slip=_at_nodes(slip_pressure(*ahead, Kn)[0], H.shape),
        slip_across=_at_nodes(slip_pressure(*beside, Kn)[0], H.shape),
        carried=_at_nodes(0.5 * Lam * ahead[0] * width, H.shape),
        carried_on=_at_nodes(0.5 * Lam * ahead[1] * width, H.shape),
        peclet=_at_nodes(0.25 * Lam * (ahead[0] + ahead[1]) * balance.dphi / cube, H.shape),
        hold=hold,
        moves=(mesh.unknown >= 0).ravel().astype(np.float64),
        first=first,
        last=last,
        spread=(H**3 * balance.area).ravel() if endless else np.zeros(0),
        spread_slip=(12.0 * Kn * H**2 * balance.area).ravel() if endless else np.zeros(0),
    )


def shared(unknown: NDArray[np.intp]) -> tuple[Index, Index]:
    """Flat numbers of the nodes that share one pressure unknown: first of a strip, last of the strip before it."""
    nodes = np.arange(unknown.size).reshape(unknown.shape)
    first, last = nodes[:, 0], np.roll(nodes[:, -1], 1, axis=0)
    both = unknown[:, 0] >= 0
    return first[both].astype(np.int64), last[both].astype(np.int64)


def _at_nodes(faces: Array, shape: tuple[int, ...]) -> Array:
    """Values of faces at the nodes behind them, zero where nothing is ahead; flat."""
    out = np.zeros(shape)
    out[tuple(slice(0, count) for count in faces.shape)] = faces
    return out.ravel()
