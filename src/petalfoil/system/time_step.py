"""The coupled system within an implicit step in time: the film stores gas, the wall has no mass.

wall   as at rest; where it loses energy, + rate (q(w) - q_start)          (C1), (B6)
film   net outflow + rate (m(P, H) - m_start) = 0,  m = 2 Lam_t P H dA     (O2)
gaps   as at rest                                                          (C3)

`q = gamma k_b w`: over a radian per unit of time, a wall that loses energy is damped as one of viscous damping `q'`.
`Lam_t` is the bearing number of one radian per unit of time: speed may vary, and be zero, while the unit of time stays.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.film_rows import FilmState
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class StepProblem(CoupledProblem):
    """A coupled problem whose film rows hold a step's storage.

    Attributes
    ----------
    time_number : float
        `Lam_t`, bearing number of a radian per unit of time [1].
    rate : float
        One over the implicit part of the step [1 / unit of time].
    start : (n_stored,) array
        What the step starts from, explicit part included, see `stored` [1].
    """

    time_number: float = 0.0
    rate: float = 0.0
    start: Array = field(default_factory=lambda: np.zeros(0))

    def stored(self, x: Array) -> Array:
        """Mass in the cell of each pressure unknown (F5), then `q` of a wall that loses energy; (n_stored,) [1]."""
        mass = self.layout.film_rows.mass(self.pressure(x), self.film(x), self.time_number)
        loss = self.layout.loss
        return mass if loss is None else np.concatenate([mass, loss @ x[self.layout.unknowns[DEFLECTION]]])

    def storing(self, x: Array, lam: Array) -> Array:
        """Rates of what is stored, (n_stored,): of a wall that loses energy what it is out of balance by."""
        rows = self.layout.film_rows.at(self.pressure(x), self.film(x), self.bearing_number)
        if self.layout.loss is None:
            return -rows.residual
        still = CoupledProblem(self.layout, self.bearing_number, self.displacement)
        wall = still.linearize(x).residual - self.acting.T @ lam
        return np.concatenate([-rows.residual, -wall[self.layout.unknowns[DEFLECTION]]])

    @property
    def without_ends(self) -> bool:
        """Whether the film has no ends: it fills and empties as a whole (F6b)."""
        return self.layout.film_rows.inventory is not None

    def filled(self, stored: Array, rates: Array) -> Array:
        """Rates at which cells gain their parts (F6d), from what is stored and its rates, (n_stored,) each."""
        gained, count = np.zeros_like(stored), self.layout.wall.film.n_unknown
        gained[:count] = self.layout.film_rows.shared(stored[:count], rates[:count])
        return gained

    def each(self, x: Array, lam: Array) -> list[tuple[StepProblem, Array, Array]]:
        """Every bearing with its unknowns and reactions: this one."""
        return [(self, x, lam)]

    def stored_of_each(self, stored: Array) -> list[Array]:
        """What each bearing stores: this one all of it."""
        return [stored]

    @property
    def turns(self) -> bool:
        """In time a journal at rest drags nothing along."""
        return self.bearing_number > 0.0

    @property
    def journal(self) -> slice:
        """Gaps on the journal."""
        return self.layout.wall.contacts.journal

    def rows_of(self, stored: Array) -> Array:
        """What is stored, or its rate, at the rows that it belongs to; (n,) [1]."""
        return at_rows(self.layout, stored)

    def linearize(self, x: Array, shift: Array | None = None, low_order: Array | None = None) -> StepLinearization:
        """Residual, tangent and row scales at `x`, storage included."""
        rows = self.layout.film_rows
        film = StoringFilm(rows, self.pressure(x), self.film(x, shift), self.bearing_number, self.time_number)
        return StepLinearization(self.layout, x, film, low_order, self.rate, self.start)


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
    start: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def turns(self) -> bool:
        """Whether the journal turns."""
        return self.film.Lam > 0.0

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (O2); (n,) [1]."""
        if not self.rate:
            return super().residual
        loss, mass = self.layout.loss, self.film.mass
        stored = mass if loss is None else np.concatenate([mass, loss @ self.x[self.layout.unknowns[DEFLECTION]]])
        return super().residual + self.rate * at_rows(self.layout, stored - self.start)

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `H^T diag(barrier_weight) G`, (n, n)."""
        loss, whole = self.layout.loss, super().matrix(barrier_weight, self.rate + rate)
        return whole if loss is None else sp.csc_array(whole + (self.rate + rate) * self.layout.among_all(loss))

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,); (n,)."""
        return super().slack_derivative(change, self.rate + rate)


def at_rows(layout: BearingLayout, stored: Array) -> Array:
    """What film and wall store, at their rows among all; (n,) [1]."""
    out, count = layout.unknowns.zeros(), layout.wall.film.n_unknown
    out[layout.unknowns[PRESSURE]] = stored[:count]
    if layout.loss is not None:
        out[layout.unknowns[DEFLECTION]] = stored[count:]
    return out
