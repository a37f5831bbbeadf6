"""The coupled system within an implicit step in time: the film stores gas, the wall has no mass.

wall   as at rest                                                          (C1)
film   net outflow + rate (m(P, H) - m_start) = 0,  m = 2 Lam_t P H dA     (O2)
gaps   as at rest                                                          (C3)

`Lam_t` is the bearing number of one radian per unit of time: speed may vary, and be zero, while the unit of time stays.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.film_rows import FilmState
from petalfoil.system.unknowns import PRESSURE

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StepProblem(CoupledProblem):
    """A coupled problem whose film rows hold a step's storage.

    Attributes
    ----------
    time_number : float
        `Lam_t`, bearing number of a radian per unit of time [1].
    rate : float
        One over the implicit part of the step [1 / unit of time].
    start_mass : (n_film,) array
        Mass that the step starts from, explicit part included [1].
    """

    time_number: float = 0.0
    rate: float = 0.0
    start_mass: Array = field(default_factory=lambda: np.zeros(0))

    def stored(self, x: Array) -> Array:
        """Mass in the cell of each pressure unknown (F5), (n_film,) [1]."""
        return self.layout.film_rows.mass(self.pressure(x), self.film(x), self.time_number)

    def linearize(self, x: Array, shift: Array | None = None, low_order: Array | None = None) -> StepLinearization:
        """Residual, tangent and row scales at `x`, storage included."""
        rows = self.layout.film_rows
        film = StoringFilm(rows, self.pressure(x), self.film(x, shift), self.bearing_number, self.time_number)
        return StepLinearization(self.layout, x, film, low_order, self.rate, self.start_mass)


@dataclass(frozen=True)
class StoringFilm(FilmState):
    """A film whose storage keeps its own bearing number, whatever the speed."""

    time_number: float = 0.0

    @cached_property
    def storage(self) -> tuple[Array, Array]:
        """Derivatives of the stored mass by pressure and film, in the order of the storage entries of `rows`."""
        return FilmState(self.rows, self.P, self.H, self.time_number).storage

    @cached_property
    def mass(self) -> Array:
        """Mass in the cell of each pressure unknown, (n_film,) [1]."""
        return self.rows.mass(self.P, self.H, self.time_number)


@dataclass(frozen=True)
class StepLinearization(Linearization):
    """The system at one state of a step."""

    film: StoringFilm
    rate: float = 0.0
    start_mass: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (O2); (n,) [1]."""
        out = super().residual.copy()
        out[self.layout.unknowns[PRESSURE]] += self.rate * (self.film.mass - self.start_mass)
        return out

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G^T diag(barrier_weight) G`, (n, n)."""
        return super().matrix(barrier_weight, self.rate + rate)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,); (n,)."""
        return super().slack_derivative(change, self.rate + rate)
