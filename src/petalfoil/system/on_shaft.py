"""Two bearings on one shaft that tilts: their step problems side by side, each with its own wall, gas and growth.

The shaft's axis is at `(x, y) + z (a_x, a_y)`, `z` from the mass centre. With the lever `l`, half the distance of the
bearings, its position is `q = (x, y, l a_x, l a_y)`. The journal in the bearing at `z_k` is at `(x, y) + z_k a`, with
the slopes `a` on top of those at which the bearing stands askew. Forces on the shaft follow by virtual work.

Unknowns are `(w_1, w_2, P_1, P_2)`, gaps are sorted by their kind first. Lengths and forces have the units of the first
bearing, pressures are over the ambient pressure of each.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.problem import Border
from petalfoil.sparsity import SparseRows
from petalfoil.system.shaft_layout import ShaftLayout, joined
from petalfoil.system.time_step import StepLinearization, StepProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class ShaftStep:
    """The bearings in a step in time, as `StepProblem` is one; its attributes are those of the first bearing.

    Attributes
    ----------
    layout : ShaftLayout
        What stays the same.
    bearing_number, time_number : float
        Of the first bearing [1].
    displacement : (4,) array
        Position of the shaft over the reference length [1].
    rate : float
        One over the implicit part of the step [1 / unit of time].
    start : (n_stored,) array
        What the step starts from [1].
    """

    layout: ShaftLayout
    bearing_number: float
    displacement: Array
    time_number: float = 0.0
    rate: float = 0.0
    start: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def parts(self) -> tuple[StepProblem, ...]:
        """The bearings, each at the position of its journal."""
        own = self.layout
        starts = [self.start[numbers] if len(self.start) else self.start for numbers in own.stored_numbers]
        return tuple(
            StepProblem(
                part,
                ratio * self.bearing_number,
                askew + arm @ self.displacement,
                time_number=ratio * self.time_number,
                rate=self.rate,
                start=start,
            )
            for part, arm, askew, ratio, start in zip(own.parts, own.arms, own.askew, own.rates, starts, strict=True)
        )

    def each(self, x: Array, lam: Array) -> list[tuple[StepProblem, Array, Array]]:
        """Every bearing with its unknowns and reactions."""
        places = zip(self.parts, self.layout.numbers, self.layout.gap_numbers, strict=True)
        return [(part, x[numbers], lam[gaps]) for part, numbers, gaps in places]

    @property
    def without_ends(self) -> bool:
        """Whether a film has no ends."""
        return any(part.without_ends for part in self.parts)

    def filled(self, stored: Array, rates: Array) -> Array:
        """Rates at which cells gain their parts (F6d), from what is stored and its rates, (n_stored,) each."""
        gained = np.zeros_like(stored)
        for part, numbers in zip(self.parts, self.layout.stored_numbers, strict=True):
            gained[numbers] = part.filled(stored[numbers], rates[numbers])
        return gained

    def stored_of_each(self, stored: Array) -> list[Array]:
        """What each bearing stores, or its rates."""
        return [stored[numbers] for numbers in self.layout.stored_numbers]

    def at(self, *, bearing_number: float | None = None, displacement: Array | None = None) -> Self:
        """The same at another speed or position."""
        Lam = self.bearing_number if bearing_number is None else bearing_number
        q = self.displacement if displacement is None else displacement
        return replace(self, bearing_number=Lam, displacement=q)

    @property
    def G(self) -> SparseRows:
        """Derivative of the gaps by the unknowns."""
        return self.layout.G

    @property
    def turns(self) -> bool:
        """In time a shaft at rest drags nothing along."""
        return self.bearing_number > 0.0

    @property
    def acting(self) -> SparseRows:
        """Forces of unit reactions (D6)."""
        return self.layout.acting if self.turns else self.layout.G

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.layout.weight

    @property
    def journal(self) -> slice:
        """Gaps on both journals."""
        return self.layout.journal

    @property
    def elimination_key(self) -> Hashable | None:
        """One for all speeds and positions; films alone gain nothing by remembered orders."""
        return self.layout if self.layout.unknowns.sizes[DEFLECTION] else None

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive: the pressures."""
        return self.layout.unknowns[PRESSURE]

    @property
    def border(self) -> Border:
        """How the shaft's position enters."""
        return self.layout.rubbed_border if self.turns else self.layout.border

    def gaps(self, x: Array) -> Array:
        """Gaps over the reference length, (m,) [1]."""
        own = [part.gaps(x[numbers]) for part, numbers in zip(self.parts, self.layout.numbers, strict=True)]
        return joined(self.layout.gap_numbers, own)

    def film(self, x: Array) -> Array:
        """Film thickness of both bearings, node after node, over the reference length [1]."""
        own = [part.film(x[numbers]).ravel() for part, numbers in zip(self.parts, self.layout.numbers, strict=True)]
        return np.concatenate(own)

    def admits(self, x: Array) -> bool:
        """Both films are open everywhere."""
        return bool(np.min(self.film(x)) > 0.0)

    def journal_force(self, x: Array, lam: Array) -> Array:
        """Force on the shaft and its moment about the mass centre over the lever, over the unit of force, (4,) [1]."""
        forces = (part.journal_force(own, reactions) for part, own, reactions in self.each(x, lam))
        force: Array = np.sum([arm.T @ one for arm, one in zip(self.layout.arms, forces, strict=True)], axis=0)
        return force

    def stored(self, x: Array) -> Array:
        """Gas in the cells of both, then what walls that lose energy store; (n_stored,) [1]."""
        own = [part.stored(x[numbers]) for part, numbers in zip(self.parts, self.layout.numbers, strict=True)]
        return joined(self.layout.stored_numbers, own)

    def storing(self, x: Array, lam: Array) -> Array:
        """Rates of what is stored, (n_stored,) [1 / unit of time]."""
        return joined(self.layout.stored_numbers, [part.storing(*own) for part, *own in self.each(x, lam)])

    def rows_of(self, stored: Array) -> Array:
        """What is stored, or its rate, at the rows that it belongs to; (n,) [1]."""
        pairs = zip(self.parts, self.layout.stored_numbers, strict=True)
        return joined(self.layout.numbers, [part.rows_of(stored[numbers]) for part, numbers in pairs])

    def linearize(self, x: Array, shift: Array | None = None) -> ShaftLinearization:
        """Residual, tangent and row scales at `x`, storage included."""
        places = zip(self.parts, self.layout.numbers, self.layout.gap_numbers, strict=True)
        parts = (part.linearize(x[own], None if shift is None else shift[gaps]) for part, own, gaps in places)
        return ShaftLinearization(self.layout, tuple(parts))


@dataclass(frozen=True)
class ShaftLinearization:
    """Both bearings at one state of a step."""

    layout: ShaftLayout
    parts: tuple[StepLinearization, ...]

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (O2), of both; (n,) [1]."""
        return joined(self.layout.numbers, [part.residual for part in self.parts])

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, (n,) [1]."""
        return joined(self.layout.numbers, [part.row_scale for part in self.parts])

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G^T diag(barrier_weight) G`, (n, n)."""
        pairs = zip(self.parts, self.layout.gap_numbers, strict=True)
        held = [part.matrix(barrier_weight[gaps], rate).tocoo() for part, gaps in pairs]
        rows, cols = (
            np.concatenate([own[getattr(one, of)] for own, one in zip(self.layout.numbers, held, strict=True)])
            for of in ("row", "col")
        )
        n = self.layout.unknowns.n
        return sp.coo_array((np.concatenate([one.data for one in held]), (rows, cols)), shape=(n, n)).tocsc()

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,); (n,)."""
        pairs = zip(self.parts, self.layout.gap_numbers, strict=True)
        return joined(self.layout.numbers, [part.slack_derivative(change[gaps], rate) for part, gaps in pairs])
