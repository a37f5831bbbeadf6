"""Film, petals with contact points and friction, and journal in a viscous medium without inertia (M7).

F_film + F_contact + load = c (e - e_before) ,      K w - ... = - c_w (w - w_before)        (M7)
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.point_friction import RubbingEquations

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SinkingPoints(RubbingEquations):
    """The equations with friction in a medium that holds journal and petals back from where they were.

    Attributes
    ----------
    journal, petals : float
        `c` and `c_w`, force by displacement over the units of both [1].
    place : (d,) array
        `e_before` [1].
    before : (n_wall,) array
        `w_before` [1].
    """

    journal: float = 0.0
    petals: float = 0.0
    place: Array = field(default_factory=lambda: np.zeros(2))
    before: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """The rows of the wall with `c_w (w - w_before)`, all others as they are."""
        wall, film, value, slope = super().residual
        return wall + self.petals * (self.state.w - self.before), film, value, slope

    @cached_property
    def steady(self) -> sp.csc_array:
        """The tangent, with `c_w` on the diagonal of the wall."""
        held = np.zeros(self.n)
        held[: self.whole.n_wall] = self.petals
        return sp.csc_array(super().steady + sp.diags_array(held))

    @property
    def force(self) -> Array:
        """Force of film and contacts on the journal less that of the medium, over the unit of force, (d,)."""
        return np.asarray(self.journal_force - self.journal * (self.problem.displacement - self.place))

    @property
    def force_direct(self) -> Array:
        """Derivative of the force by the displacement, unknowns held, (d, d): `-c`."""
        return -self.journal * np.eye(len(self.place))
