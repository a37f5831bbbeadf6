"""The coupled system within an implicit step in time: the film stores gas, the wall has no mass.

wall   K w - A (P - 1) + B^T T - G^T lam = 0                  (C1), friction (D2)
film   net outflow + rate (m(P, H) - m_held) = 0,  m = 2 Lam_t P H dA      (O2)
gaps   as at rest                                             (C3)

`Lam_t` is the bearing number of one radian per unit of time: speed may vary, and be zero, while the clock stays.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.film_rows import FilmRows, FilmState
from petalfoil.system.friction import FrictionStep, held_together

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StepProblem(CoupledProblem):
    """A coupled problem whose film rows hold a step's storage.

    Attributes
    ----------
    clock : float
        `Lam_t`, bearing number of a radian per unit of time [1].
    rate : float
        One over the implicit part of the step [1 / unit of time].
    held : (n_film,) array
        Mass that the step starts from, explicit part included [1].
    rubbing : FrictionStep or None
        Friction of the petals in the step.
    """

    clock: float = 0.0
    rate: float = 0.0
    held: Array = field(default_factory=lambda: np.zeros(0))
    rubbing: FrictionStep | None = None

    def stored(self, x: Array) -> Array:
        """Mass in the cell of each pressure unknown (F5), (n_film,) [1]."""
        return masses(self.layout.film_rows, self.pressure(x), self.film(x), self.clock)

    def linearize(self, x: Array, shift: Array | None = None, fine: Array | None = None) -> StepLinearization:
        """Residual, tangent and row sizes at `x`, storage included."""
        rows = self.layout.film_rows
        film = StoringFilm(rows, self.pressure(x), self.film(x, shift), self.bearing_number, self.clock)
        return StepLinearization(self.layout, x, film, fine, self.rate, self.held, self.rubbing)


@dataclass(frozen=True)
class StoringFilm(FilmState):
    """A film whose storage keeps its own bearing number `clock`, whatever the speed."""

    clock: float = 0.0

    @cached_property
    def storage(self) -> tuple[Array, Array]:
        """Derivatives of the stored mass by pressure and film, in the order of `balance.storage_entries`."""
        return FilmState(self.rows, self.P, self.H, self.clock).storage

    @cached_property
    def mass(self) -> Array:
        """Mass in the cell of each pressure unknown, (n_film,) [1]."""
        return masses(self.rows, self.P, self.H, self.clock)


@dataclass(frozen=True)
class StepLinearization(Linearization):
    """The system at one state of a step."""

    film: StoringFilm
    rate: float = 0.0
    held: Array = field(default_factory=lambda: np.zeros(0))
    rubbing: FrictionStep | None = None

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        """Slip, friction and its derivative, none where there is no friction."""
        none = np.zeros(0)
        return (none, none, none) if self.rubbing is None else self.rubbing.law(self.x)

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (O2); (n,) [1]."""
        out, n_wall = super().residual.copy(), self.layout.n_wall
        out[n_wall:] += self.rate * (self.film.mass - self.held)
        if self.rubbing is not None:
            out[:n_wall] += self.rubbing.friction.slip.T @ self._law[1]
        return out

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G^T diag(theta) G`, (n, n)."""
        smooth = super().matrix(theta, self.rate + rate)
        if self.rubbing is None:
            return smooth
        return sp.csc_array(smooth + held_together(self.rubbing.friction, self._law[2], len(self.x)))

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the shift of the gaps, applied to `shift` (m,); (n,)."""
        return super().by_shift(shift, self.rate + rate)


def masses(rows: FilmRows, P: Array, H: Array, clock: float) -> Array:
    """Mass in the cell of each pressure unknown (F5); none where the content stands in place of a balance."""
    mass = rows.balance.storage(P, H, clock)
    if rows.content is not None:
        mass[0] = 0.0
    return mass
