"""The wall alone under a frozen film pressure: `min w K w / 2 - w f` over non-negative gaps, a convex programme."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import SparseRows
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.coupled import CoupledProblem, wall_scale
from petalfoil.system.unknowns import DEFLECTION, BlockPattern, Unknowns

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FoilPackProblem:
    """Pack equilibrium at one journal position; unknowns are the deflections `w` alone.

    Attributes
    ----------
    coupled : CoupledProblem
        The bearing that it is part of.
    load : (n_wall,) array
        Nodal forces of the frozen film over the unit of force [1]; zero for a shaft at rest.
    withdrawn : float
        What the journal's radius is short of its own, over the reference length: while it is inserted [1].
    still : bool
        The journal does not turn and drags nothing along, as while it is inserted; otherwise it is about to.
    """

    coupled: CoupledProblem
    load: Array
    withdrawn: float = 0.0
    still: bool = False

    @property
    def layout(self) -> BearingLayout:
        """Mesh and constant entries."""
        return self.coupled.layout

    @property
    def G(self) -> SparseRows:
        """Derivative of the gaps by the deflections, (m, n_wall)."""
        return self.layout.wall.contacts.G

    @property
    def acting(self) -> SparseRows:
        """Forces of unit reactions (D6), (m, n_wall)."""
        return self.G if self.still else self.coupled.wall_acting

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.layout.weight

    @property
    def positive(self) -> slice:
        """No unknown is bound to stay positive."""
        return slice(0, 0)

    @property
    def elimination_key(self) -> Hashable | None:
        """One for all loads and positions."""
        return self.layout, DEFLECTION

    @cached_property
    def pattern(self) -> BlockPattern:
        """Sparsity of `K + H^T diag G`."""
        unknowns, own = Unknowns({DEFLECTION: self.layout.n_wall}), self.layout
        return BlockPattern(unknowns, [own.stiffness_entries, own.contact_entries, *own.rubbing_entries])

    def gaps(self, x: Array) -> Array:
        """Gaps over the reference length, (m,) [1]."""
        gaps = self.coupled.gaps(x)
        gaps[self.layout.wall.contacts.journal] += self.withdrawn
        return gaps

    def admits(self, x: Array) -> bool:
        """The pack alone can be evaluated anywhere."""
        return True

    def linearize(self, x: Array, shift: Array | None = None) -> FoilPackLinearization:
        """Residual and tangent; the gaps' shift does not enter them."""
        return FoilPackLinearization(self, x)


@dataclass(frozen=True)
class FoilPackLinearization:
    """The pack at one state."""

    problem: FoilPackProblem
    x: Array

    @cached_property
    def residual(self) -> Array:
        """`K w - f`, reactions apart, shape (n_wall,) [1]."""
        out: Array = self.problem.layout.elastic_force(self.x) - self.problem.load
        return out

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, as in the coupled system (C4)."""
        return wall_scale(self.problem.layout, self.x)

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """`K + H^T diag(barrier_weight) G`; nothing is stored, so `rate` adds nothing."""
        _, _, gap, factor = self.problem.layout.gap_products
        stiffness, _ = self.problem.layout.constant_entries
        values = [stiffness, barrier_weight[gap] * factor]
        if (rubbing := self.problem.layout.rubbing_products) is not None:
            _, _, gap, factor = rubbing
            values.append(barrier_weight[gap] * factor * float(not self.problem.still))
        return self.problem.pattern.assemble(values)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """The residual does not depend on the gaps."""
        return np.zeros(len(self.x))
