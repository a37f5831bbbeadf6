"""The foil pack without film with friction on contact lines (3-D), round a journal that is held where it is."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.equilibrium.travelling_contacts import TravellingContacts, travelling_contacts
from petalfoil.solvers.problem import Border, no_border
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackLinearization, FoilPackProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PackOnLines(RubbingLines):
    """A state of a path without film; its unknowns are the displacements of the petals.

    Attributes
    ----------
    pack : FoilPackProblem
        The pack round its journal.
    """

    pack: FoilPackProblem = field(kw_only=True)

    @property
    def equations(self) -> FoilPackProblem:
        """The pack alone."""
        return self.pack

    @cached_property
    def gaps(self) -> Array:
        """Gaps at all nodes, (m,)."""
        return self.pack.gaps(self.x)

    @cached_property
    def _petals(self) -> FoilPackLinearization:
        """The pack at the state."""
        return self.pack.linearize(self.x)

    @cached_property
    def rows(self) -> Array:
        """Residual of (M14), (n_wall,)."""
        out: Array = self._petals.residual - self.pack.G.T @ self.lam + self.pulls
        return out

    @property
    def row_scale(self) -> Array:
        """What each of the rows is compared with, (n_wall,)."""
        return self._petals.row_scale

    @cached_property
    def contacts(self) -> TravellingContacts:
        """Contacts of the tangent."""
        return travelling_contacts((self.pack.G, self.pack.G), self.pack.layout.wall.contacts.by_e, self)

    @cached_property
    def matrix(self) -> sp.csc_array:
        """Derivative of the rows by the unknowns, travel of the points included, (n_wall, n_wall)."""
        return sp.csc_array(self._petals.matrix(np.zeros(len(self.held))) + self.contacts.tangent)

    @property
    def border(self) -> Border:
        """The journal is held."""
        return no_border(len(self.reactions))

    @property
    def forcing(self) -> Array:
        """None of a journal that is held, (n_wall, 0)."""
        return np.zeros((len(self.x), 0))

    @property
    def border_stiffness(self) -> Array:
        """Likewise, (0, 0)."""
        return np.zeros((0, 0))

    @property
    def elimination_key(self) -> Hashable | None:
        """Contact points join unknowns that do not meet otherwise: none are shared."""
        return None

    @property
    def unbalanced(self) -> Array:
        """No force is balanced, (0,)."""
        return np.zeros(0)

    @property
    def force_left(self) -> Array:
        """Likewise, (0,)."""
        return np.zeros(0)

    def shifted(self, change: Array, way: Array) -> Self:
        """The state after a change of the unknowns (n_wall,)."""
        return replace(self, x=self.x + change)

    def in_film(self, problem: CoupledProblem, load: Array | None = None) -> RubbingLines:
        """The same under a film at rest, which `problem` has at ambient pressure; energy is counted from here on."""
        own = self.points, self.reaction, self.held, self.held_reaction
        return RubbingLines(
            problem,
            problem.layout.ambient(self.x),
            *own,
            load=load,
            friction=self.friction,
            friction_force=self.friction_force,
        )
