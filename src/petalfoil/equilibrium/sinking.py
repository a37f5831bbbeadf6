"""Journal and petals in a viscous medium without inertia: where no balance is near, they sink to one.

F_film + F_contact + load = c (e - e_before) ,      K w - ... = - c_w (w - w_before)        (M7)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.under_load import LoadedEquations
from petalfoil.solvers.problem import ContactProblem, Linearized, WithMoreForces
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Medium:
    """What a journal and petals sink in: force by displacement, over the units of both [1]."""

    journal: float = 0.0
    petals: float = 0.0


@dataclass(frozen=True)
class PetalsInMedium(WithMoreForces):
    """Film and wall whose deflections are held back from where they were (M7).

    Attributes
    ----------
    base : CoupledProblem
        Film and wall.
    start : (n,) array
        Unknowns of the state before.
    resistance : float
        Of each unknown of the wall [1].
    """

    base: CoupledProblem
    start: Array
    resistance: float

    def linearize(self, x: Array, shift: Array | None = None) -> LinearizedInMedium:
        """Residual and tangent at `x`."""
        return LinearizedInMedium(self, x, self.base.linearize(x, shift))


@dataclass(frozen=True)
class LinearizedInMedium:
    """The equations of petals in a medium at one state."""

    problem: PetalsInMedium
    x: Array
    base: Linearized

    @cached_property
    def _resistance(self) -> Array:
        out = self.problem.base.layout.unknowns.zeros()
        out[self.problem.base.layout.unknowns[DEFLECTION]] = self.problem.resistance
        return out

    @property
    def residual(self) -> Array:
        """Residual with `c (w - w_before)` (M7), (n,)."""
        return np.asarray(self.base.residual + self._resistance * (self.x - self.problem.start))

    @property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, (n,)."""
        return self.base.row_scale

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent with `c` on its diagonal, (n, n)."""
        return sp.csc_array(self.base.matrix(barrier_weight, rate) + sp.diags_array(self._resistance))

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """The medium does not read the gaps."""
        return self.base.slack_derivative(change, rate)


@dataclass(frozen=True)
class SinkingEquations(LoadedEquations):
    """The variant in which a medium holds the journal back from where `problem` has it, petals from `start` (n,)."""

    start: Array
    medium: Medium

    @property
    def border_stiffness(self) -> Array:
        """The medium resists the journal."""
        return self.medium.journal * np.eye(len(self.load))

    @property
    def stops(self) -> slice:
        """The journal alone can open contacts that close a chain between journal and bushing."""
        return self.problem.layout.wall.contacts.journal

    def at(self, b: Array) -> ContactProblem:
        """The coupled system at a displacement, petals in the medium."""
        there = self.problem.at(displacement=b)
        return PetalsInMedium(there, self.start, self.medium.petals) if self.medium.petals else there

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Force of film, contacts, load and medium on the journal."""
        return super().imbalance(x, lam, b) - self.medium.journal * (b - self.problem.displacement)
