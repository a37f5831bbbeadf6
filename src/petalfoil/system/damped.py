"""The coupled system on a march that only serves to find an equilibrium: the wall resists its motion, not the gas (P6).

    wall   K w - A (P - 1) - G^T lam + c dw/dtau = 0
    film   net outflow of each cell = 0, at every instant
    journal, under a load:  c N de/dtau = F_film + by_e^T lam + load, N the nodes that it faces

An equilibrium may be unstable in the time of the gas, where petals and film flutter, and still attract this march.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.loaded import LoadedLinearization, LoadedProblem
from petalfoil.system.unknowns import DEFLECTION, POSITION

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DampedWall(CoupledProblem):
    """A coupled problem whose time is that of a damped wall.

    Attributes
    ----------
    damping : float
        `c`: ambient pressure over reference film and unit of time [1].
    """

    damping: float = 1.0

    @classmethod
    def of(cls, problem: CoupledProblem, damping: float) -> DampedWall:
        """The damped wall of `problem`."""
        T = problem.temperatures
        return cls(problem.layout, problem.bearing_number, problem.displacement, damping, temperatures=T)

    def linearize(self, x: Array, shift: Array | None = None, low_order: Array | None = None) -> DampedLinearization:
        """Residual, its tangent and its row scales at `x`."""
        plain = super().linearize(x, shift, low_order)
        return DampedLinearization(plain.layout, plain.x, plain.film, plain.low_order, self.damping)


@dataclass(frozen=True)
class DampedLinearization(Linearization):
    """The system at one state: at rest that of the coupled problem."""

    damping: float = 1.0

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G^T diag(barrier_weight) G`, plus `rate` times the damping of the wall; (n, n)."""
        steady = super().matrix(barrier_weight)
        damping = self.layout.unknowns.zeros()
        damping[self.layout.unknowns[DEFLECTION]] = rate * self.damping
        return sp.csc_array(steady + sp.diags_array(damping)) if rate else steady

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,): the gas stores nothing."""
        return super().slack_derivative(change)


@dataclass(frozen=True)
class DampedBalance(LoadedProblem):
    """A bearing under a load whose time is that of a damped wall and a damped journal.

    Attributes
    ----------
    damping : float
        As in `DampedWall`.
    """

    damping: float = 1.0

    @classmethod
    def of(cls, problem: CoupledProblem, load: Array, damping: float) -> DampedBalance:
        """The damped wall of `problem` and its journal under `load`."""
        return cls(DampedWall.of(problem, damping), load, damping)

    def linearize(self, z: Array, shift: Array | None = None) -> DampedBalanceLinearization:
        """Residual and tangent at `z`."""
        plain = super().linearize(z, shift)
        return DampedBalanceLinearization(plain.problem, plain.z, plain.coupled, self.damping)


@dataclass(frozen=True)
class DampedBalanceLinearization(LoadedLinearization):
    """The balance at one state: at rest that of the loaded problem."""

    damping: float = 1.0

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G_z^T diag(barrier_weight) G_z`, plus `rate` times the damping of wall and journal."""
        plain, unknowns = super().matrix(barrier_weight, rate), self.problem.unknowns
        damping = unknowns.zeros()
        damping[unknowns[POSITION]] = rate * self.damping * self.problem.coupled.layout.wall.film.unknown.size
        return sp.csc_array(plain + sp.diags_array(damping)) if rate else plain
