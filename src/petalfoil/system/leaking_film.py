"""A 2-D film without ends as that of a bearing of finite length: what its pressure drives out at both ends (F6c).

    film   net outflow of each cell + a [H^3 (P^2 - 1) + 12 Kn H^2 (P - 1)] area = 0,  a = 6 (R_j / L)^2

The bracket is taken as a parabola along the length, as in (F6b). Its sum is (F6) for every `a`, and `a = 0` is the
limit of a long bearing. The wall is that of a march with a damped wall (P6); at rest it is the wall itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.gas_inventory import GasInventory
from petalfoil.sparsity import add_up
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.damped import DampedLinearization, DampedWall
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LeakingFilm(DampedWall):
    """A coupled problem whose film leaks through the ends of a bearing of finite length.

    Attributes
    ----------
    leakage : float
        `a`: six times the square of journal radius over length [1].
    """

    leakage: float = 0.0

    @classmethod
    def through_ends(cls, problem: CoupledProblem, leakage: float, damping: float = 1.0) -> LeakingFilm:
        """The film of `problem`, which has no ends, with a leakage."""
        T = problem.temperatures
        return cls(problem.layout, problem.bearing_number, problem.displacement, damping, leakage, temperatures=T)

    @property
    def length(self) -> float:
        """Length of the bearing over its journal radius [1]."""
        return math.sqrt(6.0 / self.leakage)

    def linearize(self, x: Array, shift: Array | None = None, low_order: Array | None = None) -> LeakingLinearization:
        """Residual, its tangent and its row scales at `x`."""
        closed = super().linearize(x, shift, low_order)
        return LeakingLinearization(
            closed.layout, closed.x, closed.film, closed.low_order, closed.damping, leakage=self.leakage
        )


@dataclass(frozen=True)
class LeakingLinearization(DampedLinearization):
    """The system at one state, leakage included."""

    leakage: float = 0.0

    @property
    def _inventory(self) -> GasInventory:
        inventory = self.film.rows.inventory
        if inventory is None:
            raise ValueError("a film with ends leaks through them already")
        return inventory

    def _by_cell(self, nodal: Array) -> Array:
        """Leakage of each balance from the terms of its nodes; none in the row that holds (F6)."""
        mesh = self.film.rows.balance.mesh
        leaking = self.leakage * add_up(mesh.unknown.ravel(), nodal.ravel(), mesh.n_unknown)
        leaking[0] = 0.0
        return leaking

    @cached_property
    def _derivatives(self) -> tuple[Array, Array]:
        return self._inventory.excess_derivatives(self.film.P, self.film.H)

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (C2) with what leaks; shape (n,) [1]."""
        closed = super().residual.copy()
        closed[self.layout.unknowns[PRESSURE]] += self._by_cell(self._inventory.excess(self.film.P, self.film.H))
        return closed

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, what leaks included; shape (n,) [1]."""
        closed = super().row_scale.copy()
        closed[self.layout.unknowns[PRESSURE]] += self._by_cell(self._inventory.magnitude(self.film.P, self.film.H))
        return closed

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent with that of the leakage, (n, n)."""
        closed, unknowns = super().matrix(barrier_weight, rate), self.layout.unknowns
        by_P, by_H = self._derivatives
        pressure, under = self.film.rows.balance.mesh.unknown.ravel(), self.layout.wall.film_unknown.ravel()
        moved = np.flatnonzero((under >= 0) & (pressure > 0))  # the first row holds (F6)
        rows, cols = pressure[moved] + unknowns[PRESSURE].start, under[moved] + unknowns[DEFLECTION].start
        by_wall = sp.coo_array((self.leakage * by_H.ravel()[moved], (rows, cols)), shape=closed.shape)
        own = unknowns.zeros()
        own[unknowns[PRESSURE]] = self._by_cell(by_P)
        return sp.csc_array(closed + sp.diags_array(own) + by_wall)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,); shape (n,)."""
        closed = super().slack_derivative(change, rate)
        journal = change[self.layout.wall.contacts.journal]
        if len(journal):
            closed[self.layout.unknowns[PRESSURE]] += self._by_cell(self._derivatives[1].ravel() * journal)
        return closed
