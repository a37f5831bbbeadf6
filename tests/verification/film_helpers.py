"""What the film verification tests share: reference tables, films made by hand, a plain Newton, orders.

The Newton here is no part of petalfoil: it asks `FilmBalance` for residual and tangent and nothing else, so that
these tests say whether the film's equations are right, whoever solves them.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid, flat_axis
from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.balance import Entries, FilmBalance

Array = NDArray[np.float64]

REFERENCE = Path(__file__).parent / "reference"


def table(name: str) -> list[dict[str, str]]:
    """Rows of a reference table by column name."""
    with (REFERENCE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def number_inside(inside: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Number the nodes that are `inside` in order; -1 elsewhere."""
    unknown = np.full(inside.shape, -1)
    unknown[inside] = np.arange(int(inside.sum()))
    return unknown


def slider(cells: int, axial: AxialGrid | None = None) -> FilmBalance:
    """One strip `0 <= X <= 1` with ambient edges (and, where `axial` has more stations, ambient ends)."""
    axis = flat_axis(1.0) if axial is None else axial
    phi = np.linspace(0.0, 1.0, cells + 1)
    inside = np.ones((1, len(phi), len(axis.z)), dtype=bool)
    inside[:, [0, -1]] = False
    if not axis.flat:
        inside[..., 0] = False
        inside[..., -1] &= axis.half
    return FilmBalance(FilmMesh(phi, phi[None, :], axis, number_inside(inside)), 1.0)


def stepped_slider(step: float, cells: int) -> FilmBalance:
    """Strip 0 from `X = 0` to the step, strip 1 from there to `X = 1`; they share the pressure at the step.

    All strips of a mesh have the same local nodes. So both are as long as the longer first one (`step >= 1/2`), and
    the nodes of strip 1 past `X = 1` lie outside, at ambient pressure: no balance is written and no flow counted there.
    `cells` of the whole length are shared out by halves of a hundredth at most, so that doubling them nests the grids.
    """
    second = round((1.0 - step) * cells)
    rest = cells - 2 * second
    short = np.linspace(0.0, 1.0 - step, second + 1)
    phi = np.concatenate([short, np.linspace(1.0 - step, step, rest + 1)[1:]])
    unknown = np.full((2, len(phi), 1), -1)
    unknown[0, 1:, 0] = np.arange(len(phi) - 1)
    unknown[1, 0, 0] = unknown[0, -1, 0]
    unknown[1, 1:second, 0] = unknown[0, -1, 0] + 1 + np.arange(second - 1)
    theta = np.stack([phi, step + phi])
    return FilmBalance(FilmMesh(phi, theta, flat_axis(1.0), unknown), 1.0)


def matrix(entries: Entries, values: NDArray[np.inexact], shape: tuple[int, int]) -> sp.csc_array:
    """Sparse matrix of `values` at `entries`."""
    return sp.csc_array(sp.coo_array((values, (entries.rows, entries.cols)), shape=shape))


def solve_film(balance: FilmBalance, H: Array, Lam: float) -> Array:
    """Pressure at every node of a film of thickness `H`, by Newton from ambient pressure.

    The step before the last one is below 1e-9 of the pressure. Newton squares it: what is left is rounding.
    """
    n = balance.mesh.n_unknown
    x = np.ones(n)
    for _ in range(60):
        fluxes = balance.fluxes(balance.nodal_pressure(x), H, Lam)
        tangent = matrix(balance.by_pressure, balance.tangent(fluxes)[0], (n, n))
        step = spla.spsolve(tangent, -balance.residual(fluxes))
        fall = float(np.max(-step / x))
        x = x + step * min(1.0, 0.7 / max(fall, 0.7))  # pressures stay positive
        if np.max(np.abs(step / x)) < 1e-9:
            return balance.nodal_pressure(x)
    raise AssertionError("Newton did not converge in 60 steps")


def orders(errors: Sequence[float]) -> Array:
    """Observed order between successive grids, each with half the cell of the one before."""
    sizes = np.abs(np.asarray(errors))
    return np.log2(sizes[:-1] / sizes[1:])
