"""Film, petals with friction on contact lines, and journal in a viscous medium without inertia (M7), in 3-D.

F_film + F_contact + load = c (e - e_before) ,      K w - ... = - c_w (w - w_before)        (M7)
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.equilibrium.sinking import Medium
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SinkingLines(RubbingLines):
    """A state in a medium that holds journal and petals back from where they were.

    Attributes
    ----------
    medium : Medium
        `c` and `c_w`.
    place : (d,) array
        `e_before` [1].
    start : (n,) array
        Unknowns of the state before.
    """

    medium: Medium = field(kw_only=True)
    place: Array = field(kw_only=True)
    start: Array = field(kw_only=True)

    @classmethod
    def of(cls, state: RubbingLines, medium: Medium, place: Array, start: Array) -> SinkingLines:
        """A state put in a medium."""
        own = {each.name: getattr(state, each.name) for each in fields(RubbingLines)}
        return cls(**own, medium=medium, place=place, start=start)

    @cached_property
    def _resistance(self) -> Array:
        """`c_w` of the petals' unknowns, (n,)."""
        out = self.problem.layout.unknowns.zeros()
        out[self.problem.layout.unknowns[DEFLECTION]] = self.medium.petals
        return out

    @cached_property
    def rows(self) -> Array:
        """Residual with `c_w (w - w_before)`, (n,)."""
        return np.asarray(super().rows + self._resistance * (self.x - self.start))

    @cached_property
    def matrix(self) -> sp.csc_array:
        """The tangent with `c_w` on its diagonal, (n, n)."""
        return sp.csc_array(super().matrix + sp.diags_array(self._resistance))

    @property
    def springs(self) -> Array:
        """Stiffness of the medium, `c`, (d, d)."""
        return self.medium.journal * np.eye(len(self.place))

    @property
    def unbalanced(self) -> Array:
        """Force of film, contacts, load and medium on the journal, (d,)."""
        return np.asarray(super().unbalanced - self.medium.journal * (self.problem.displacement - self.place))

    @property
    def still(self) -> RubbingLines:
        """The state as it is, out of the medium."""
        return RubbingLines(**{each.name: getattr(self, each.name) for each in fields(RubbingLines)})
