"""The film's rows of the coupled system: cell balances, and the gas inventory of a film without ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.gas_inventory import GasInventory
from petalfoil.physics.mass_balance import Entries, FilmBalance
from petalfoil.physics.reynolds import Flux
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]


ALONE = 0.1
"""Most that one cell gains or loses for all others in a unit of time, over its gas: as little as its neighbours make up
for. Small motions are below it; their linear response has all of it in this cell."""


@dataclass(frozen=True)
class FilmRows:
    """One equation for each pressure unknown, its derivatives and their places."""

    balance: FilmBalance

    @cached_property
    def inventory(self) -> GasInventory | None:
        """The condition that replaces the first balance; None where the film has ends."""
        balance = self.balance
        slenderness = balance.mesh.axial.length / balance.radius
        inventory = GasInventory(balance.mesh, balance.area, slenderness, balance.knudsen)
        return inventory if inventory.needed else None

    @cached_property
    def by_pressure(self) -> Entries:
        """Places of the derivatives by the pressure unknowns."""
        return _joined(self.balance.by_pressure, None if self.inventory is None else self.inventory.by_pressure)

    @cached_property
    def by_film(self) -> Entries:
        """Places of the derivatives by the film thickness at every film node (flat number)."""
        return _joined(self.balance.by_film, None if self.inventory is None else self.inventory.by_film)

    @cached_property
    def storage_by_pressure(self) -> Entries:
        """Places of the derivatives of the stored mass by the pressure unknowns."""
        rows = self.balance.storage_entries.rows
        cell = Entries(rows, rows)
        return _joined(cell, None if self.inventory is None else Entries(np.zeros_like(rows), rows))

    @cached_property
    def storage_by_film(self) -> Entries:
        """Places of the derivatives of the stored mass by the film thickness at every film node (flat number)."""
        cell = self.balance.storage_entries
        return _joined(cell, None if self.inventory is None else Entries(np.zeros_like(cell.rows), cell.cols))

    def mass(self, P: Array, H: Array, Lam: float) -> Array:
        """Mass whose rate joins each row (F5), (n_unknown,) [1]; that of all gas in the row of the inventory (F6b)."""
        mass = self.balance.storage(P, H, Lam)
        if self.inventory is not None:
            mass[0] = self.inventory.filling * mass.sum()
        return mass

    def total(self, rows: Array) -> float:
        """Gas in the whole film, or what of it leaves, from the masses or the residuals of all rows [1]."""
        return float(rows.sum() if self.inventory is None else rows[0] / self.inventory.filling)

    def shared(self, stored: Array, rates: Array) -> Array:
        """Parts of the cells in what all gas gains (F6d), from masses and rates of all rows, (n_unknown,) each [1].

        None as long as the cell whose balance the inventory replaces has enough gas for all of it (`ALONE`). Beyond
        that all share it by their gas.
        """
        if self.inventory is None or not rates[0]:
            return np.zeros_like(stored)
        filling = self.inventory.filling
        own = stored[0] / filling - float(stored[1:].sum())
        beyond = max(0.0, 1.0 - ALONE * max(own, 0.0) * filling / abs(float(rates[0])))
        gained: Array = stored * (beyond * rates[0] / stored[0])
        gained[0] = 0.0
        return gained

    def at(self, P: Array, H: Array, Lam: float) -> FilmState:
        """The rows at one state."""
        return FilmState(self, P, H, Lam)

    def without_first(self, values: Array, places: Entries) -> Array:
        """Drop the balance that the gas inventory replaces, if it does."""
        return values if self.inventory is None else np.where(places.rows == 0, 0.0, values)


@dataclass(frozen=True)
class FilmState:
    """The film's rows at one state: pressures and film thicknesses at all nodes, bearing number."""

    rows: FilmRows
    P: Array
    H: Array
    Lam: float

    @cached_property
    def fluxes(self) -> tuple[Flux, Flux]:
        """Flows through all faces."""
        return self.rows.balance.fluxes(self.P, self.H, self.Lam)

    @cached_property
    def residual(self) -> Array:
        """Net outflow of every cell, (n_unknown,) [1]."""
        residual = self.rows.balance.residual(self.fluxes)
        if self.rows.inventory is not None:
            residual[0] = self.rows.inventory.value(self.P, self.H)
        return residual

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, (n_unknown,) [1]."""
        scale = self.rows.balance.row_scale(self.fluxes)
        if self.rows.inventory is not None:
            scale[0] = self.rows.inventory.row_scale(self.P, self.H)
        return scale

    @cached_property
    def tangent(self) -> tuple[Array, Array]:
        """Derivatives in the order of `by_pressure` and `by_film`."""
        balance, inventory = self.rows.balance, self.rows.inventory
        by_P, by_H = balance.tangent(self.fluxes)
        if inventory is None:
            return by_P, by_H
        more_P, more_H = inventory.tangent(self.P, self.H)
        by_P, by_H = self.rows.without_first(by_P, balance.by_pressure), self.rows.without_first(by_H, balance.by_film)
        return np.concatenate([by_P, more_P]), np.concatenate([by_H, more_H])

    @cached_property
    def storage(self) -> tuple[Array, Array]:
        """Derivatives of the stored mass in the order of `storage_by_pressure` and `storage_by_film`."""
        balance, inventory = self.rows.balance, self.rows.inventory
        by_P, by_H = balance.storage_tangent(self.P, self.H, self.Lam)
        if inventory is None:
            return by_P, by_H
        cells = balance.storage_entries
        own_P, own_H = self.rows.without_first(by_P, cells), self.rows.without_first(by_H, cells)
        return np.concatenate([own_P, inventory.filling * by_P]), np.concatenate([own_H, inventory.filling * by_H])

    def moved(self, change: Array, rate: float) -> Array:
        """Derivative of the rows (and of `rate` times the storage) by the film, applied to `change` (flat nodes)."""
        steady, held, n = self.rows.by_film, self.rows.storage_by_film, self.rows.balance.mesh.n_unknown
        moved = add_up(steady.rows, self.tangent[1] * change[steady.cols], n)
        if not rate:
            return moved
        return moved + rate * add_up(held.rows, self.storage[1] * change[held.cols], n)


def _joined(first: Entries, second: Entries | None) -> Entries:
    if second is None:
        return first
    return Entries(np.concatenate([first.rows, second.rows]), np.concatenate([first.cols, second.cols]))
