"""What the film verification tests share: reference tables, films made by hand, a plain Newton, orders.

The Newton here is no part of petalfoil: it asks `FilmBalance` for residual and tangent and nothing else, so that
these tests say whether the film's equations are right, whoever solves them.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.mesh.axial import AxialGrid, axis_2d
from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.forces import film_force
from petalfoil.physics.mass_balance import Entries, FilmBalance
from tests.cases import case

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

REFERENCE = Path(__file__).parent / "reference"


DIAGONAL: dict[str, Any] = {"diag_pivot_thresh": 1e-3, "options": {"SymmetricMode": True}}
"""The film's matrix has a symmetric pattern and a strong diagonal: ordered for it, it fills in a tenth as much."""


def table(name: str) -> list[dict[str, str]]:
    """Rows of a reference table by column name."""
    with (REFERENCE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def orders(errors: Sequence[float] | Array) -> Array:
    """Observed order between successive grids, each with half the cells' size of the one before."""
    sizes = np.abs(np.asarray(errors))
    return np.asarray(np.log2(sizes[:-1] / sizes[1:]))


# ---------------------------------------------------------------------------------------------- films made by hand


def slider(cells: int, axial: AxialGrid | None = None) -> FilmBalance:
    """One strip `0 <= X <= 1` with ambient edges and, where `axial` has more stations than one, ambient ends."""
    axis = axis_2d(1.0) if axial is None else axial
    phi = np.linspace(0.0, 1.0, cells + 1)
    inside = np.ones((1, len(phi), len(axis.z)), dtype=bool)
    inside[:, [0, -1]] = False
    if not axis.is_2d:
        inside[..., 0] = False
        inside[..., -1] &= axis.half
    unknown = np.full(inside.shape, -1)
    unknown[inside] = np.arange(int(inside.sum()))
    return FilmBalance(FilmMesh(phi, phi[None, :], axis, unknown), 1.0)


def stepped_slider(step: float, cells: int, refine: int = 1) -> FilmBalance:
    """Strip 0 from `X = 0` to the step, strip 1 from there to `X = 1`; they share the pressure at the step.

    All strips of a mesh have the same local nodes. So both are as long as the longer first one (`step >= 1/2`), and
    the nodes of strip 1 past `X = 1` lie outside, at ambient pressure: nothing is balanced or added up there. The
    division of `cells` cells, each cut in `refine`, makes grids nested.
    """
    second = round((1.0 - step) * cells) * refine
    rest = cells * refine - 2 * second
    phi = np.concatenate([np.linspace(0.0, 1.0 - step, second + 1), np.linspace(1.0 - step, step, rest + 1)[1:]])
    unknown = np.full((2, len(phi), 1), -1)
    unknown[0, 1:, 0] = np.arange(len(phi) - 1)
    unknown[1, 0, 0] = unknown[0, -1, 0]
    unknown[1, 1:second, 0] = len(phi) - 1 + np.arange(second - 1)
    return FilmBalance(FilmMesh(phi, np.stack([phi, step + phi]), axis_2d(1.0), unknown), 1.0)


# ---------------------------------------------------------------------------------------------- solving


def matrix(entries: Entries, values: NDArray[np.inexact], shape: tuple[int, int]) -> sp.csc_array:
    """Sparse matrix of `values` at `entries`."""
    return sp.csc_array(sp.coo_array((values, (entries.rows, entries.cols)), shape=shape))


def solve_film(balance: FilmBalance, H: Array, Lam: float) -> Array:
    """Pressure at every node of a film of thickness `H`, by Newton from ambient pressure.

    Ends with the first step below 1e-9 of the pressure: Newton squares it, and what is left is rounding.
    """
    n = balance.mesh.n_unknown
    x = np.ones(n)
    for _ in range(60):
        fluxes = balance.fluxes(balance.nodal_pressure(x), H, Lam)
        tangent = matrix(balance.by_pressure, balance.tangent(fluxes)[0], (n, n))
        step = spla.spsolve(sp.csc_array(tangent), -balance.residual(fluxes), permc_spec="MMD_AT_PLUS_A")
        fall = float(np.max(-step / x))
        x = x + step * min(1.0, 0.7 / max(fall, 0.7))  # pressures stay positive
        if np.max(np.abs(step / x)) < 1e-9:
            return balance.nodal_pressure(x)
    raise AssertionError("Newton did not converge in 60 steps")


@dataclass(frozen=True)
class RestingFilm:
    """The film `P = H = 1`, linearised: `J dP + i nu S dP = -(J_H + i nu S_H) dH` for changes `~ exp(i nu tau)`.

    Parameters
    ----------
    balance : FilmBalance
        The film.
    flow : float
        Bearing number of the steady flow, `6 mu omega R^2 / (p_a h^2)`; zero without sliding [1].
    storage : float
        The same number in the storage term `2 Lam d_tau(P H)`: another one where `tau` is not the shaft's [1].
    """

    balance: FilmBalance
    flow: float
    storage: float

    def response(self, dH: Array, nu: float) -> Complex:
        """Change of pressure at every node for the changes `dH` (k, strip, node, axial) of the film."""
        balance, n = self.balance, self.balance.mesh.n_unknown
        one = np.ones(balance.mesh.shape)
        by_P, by_H = balance.tangent(balance.fluxes(one, one, self.flow))
        held_P, held_H = balance.storage_tangent(one, one, self.storage)
        held = balance.storage_entries
        pressure = matrix(balance.by_pressure, by_P.astype(complex), (n, n))
        pressure += 1j * nu * matrix(Entries(held.rows, held.rows), held_P, (n, n))
        film = matrix(balance.by_film, by_H, (n, one.size)) + 1j * nu * matrix(held, held_H, (n, one.size))
        source = -(film @ dH.reshape(len(dH), -1).T)
        dP = spla.splu(sp.csc_array(pressure), permc_spec="MMD_AT_PLUS_A", **DIAGONAL).solve(source)
        return np.asarray(np.stack([np.append(column, 0.0)[balance.mesh.unknown] for column in dP.T]))


# ---------------------------------------------------------------------------------------------- plain journal bearings


def journal(slenderness: float, Lam: float, eccentricity: Array, grid: tuple[int, int]) -> Case:
    """A plain journal bearing of `L/D` and `Lam` on the clearance, displaced by `eccentricity` clearances.

    `grid`: cells round the circle, and over the whole length.
    """
    plain = case("plain_journal")
    radius, clearance, gas = plain.bearing.journal_radius, plain.bearing.clearance, plain.gas
    changes: dict[str, object] = {
        "bearing.length": 2.0 * slenderness * radius,
        "operation.speed": Lam * gas.ambient_pressure * clearance**2 / (6.0 * gas.viscosity * radius**2),
        "operation.eccentricity": (float(eccentricity[0]) * clearance, float(eccentricity[1]) * clearance),
        "model.cells_per_pitch": grid[0],
        "model.axial_cells": grid[1],
    }
    return plain.replace(**changes)


def load_number(mesh: FilmMesh, dP: Array) -> Array:
    """Force on the journal over `p_a L D`, (2,), from the excess pressure over `p_a`."""
    return film_force(mesh, 1.0, dP) / (2.0 * mesh.axial.length)


def along_and_across(force: Array, direction: Array) -> Array:
    """(Wr, Wt): the load `-force` along the displacement and across it, against the sense of rotation."""
    e = direction / np.hypot(*direction)
    return -np.array([force @ e, force @ np.array([e[1], -e[0]])])
