"""The coupled system with the journal's position unknown and a load given: `z = [x, e]`.

    wall, film, gaps   as in the coupled system, at displacement e       (C1)-(C3)
    journal            F_film(P) + by_e^T lam + load = 0                 (C5)

The reactions' force on the journal is the transpose of what its displacement does to the gaps, so that with
`G_z = [G, by_e]` the same `G_z^T lam` serves all rows. A journal that rubs adds to it as to `G` (D6), (D7).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.sparsity import SparseRows, Triplets, added_blocks
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.build import lever_of
from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.unknowns import POSITION, Unknowns

Array = NDArray[np.float64]

LEAST_LOAD = 1e-3
"""An unbalanced force is compared with the load; where that is less than this over the unit of force, with this."""


def load_of(case: Case, load: tuple[float, float], layout: BearingLayout) -> Array:
    """A load [N] as one bearing of `case` carries it over the unit of force, (n_position,) [1].

    Two bearings carry half of it each. Where the case gives a moment, that over the lever follows.
    """
    force = np.array(load) / case.bearings
    if case.operation.moment is not None:
        force = np.append(force, np.array(case.operation.moment) / lever_of(case))
    return np.asarray(force / layout.scales.force)


def load_scale(load: Array) -> float:
    """What an unbalanced force is compared with [1]."""
    return max(float(np.linalg.norm(load)), LEAST_LOAD)


@dataclass(frozen=True)
class LoadedProblem:
    """A bearing under a load.

    Attributes
    ----------
    coupled : CoupledProblem
        The bearing; its displacement is only the start.
    load : (n_position,) array
        Load on the journal over the unit of nodal force [1].
    """

    coupled: CoupledProblem
    load: Array

    @cached_property
    def unknowns(self) -> Unknowns:
        """Those of the coupled system, then the position."""
        layout = self.coupled.layout
        return layout.unknowns.extended(**{POSITION: layout.n_position})

    def split(self, z: Array) -> tuple[CoupledProblem, Array]:
        """The coupled system at the position of `z`, and its unknowns."""
        return self.coupled.at(displacement=z[self.unknowns[POSITION]]), z[: self.coupled.layout.n]

    @cached_property
    def G(self) -> SparseRows:
        """Derivative of the gaps by deflections, pressures and position, (m, n + n_position)."""
        by_e = sp.csr_array(self.coupled.border.gap_derivative)
        return SparseRows(sp.hstack([self.coupled.G, by_e], format="csr"))

    @cached_property
    def acting(self) -> SparseRows:
        """Forces of unit reactions on deflections, pressures and position, (m, n + n_position)."""
        coupled = self.coupled
        if coupled.acting is coupled.G:
            return self.G
        on_journal = sp.csr_array(coupled.border.by_reactions.T)
        return SparseRows(sp.hstack([coupled.acting, on_journal], format="csr"))

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.coupled.weight

    @property
    def elimination_key(self) -> Hashable | None:
        """One for all loads; the rows that reach all over the bearing come last by their degree."""
        return self.coupled.layout, POSITION

    @property
    def positive(self) -> slice:
        """The pressures."""
        return self.coupled.positive

    def gaps(self, z: Array) -> Array:
        """Gaps over the reference length, (m,)."""
        problem, x = self.split(z)
        return problem.gaps(x)

    def admits(self, z: Array) -> bool:
        """The film is open everywhere."""
        problem, x = self.split(z)
        return problem.admits(x)

    def linearize(self, z: Array, shift: Array | None = None) -> LoadedLinearization:
        """Residual and tangent at `z`."""
        problem, x = self.split(z)
        return LoadedLinearization(self, z, problem.linearize(x, shift))


@dataclass(frozen=True)
class LoadedLinearization:
    """The balance at one state."""

    problem: LoadedProblem
    z: Array
    coupled: Linearization

    @cached_property
    def residual(self) -> Array:
        """Wall and film, then minus film force and load (reactions apart), (n + n_position,)."""
        force = self.problem.coupled.film_force(self.z)
        return np.concatenate([self.coupled.residual, -(force + self.problem.load)])

    @cached_property
    def row_scale(self) -> Array:
        """Scales of wall and film rows; the load for the journal's."""
        load = self.problem.load
        return np.concatenate([self.coupled.row_scale, np.full(len(load), load_scale(load))])

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `H_z^T diag(barrier_weight) G_z`, (n + n_position, n + n_position)."""
        problem, border = self.problem, self.problem.coupled.border
        by_e = border.gap_derivative
        stiff, pull = barrier_weight[:, None] * by_e, barrier_weight[:, None] * border.by_reactions.T
        forcing = np.column_stack([self.coupled.slack_derivative(column, rate) for column in by_e.T])
        rows = (problem.coupled.G.T @ pull).T
        columns = forcing + problem.coupled.acting.T @ stiff
        rows[:, border.columns] -= border.row_derivative
        inner, direct = self.coupled.matrix(barrier_weight, rate), Triplets.of_dense(border.by_reactions @ stiff)
        n, along, across = inner.shape[0], Triplets.of_dense(columns), Triplets.of_dense(rows)
        blocks = [(0, 0, inner), (0, n, along), (n, 0, across), (n, n, direct)]
        return added_blocks(blocks, np.zeros(n + len(rows)))

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """The journal's rows do not read the gaps."""
        return np.concatenate([self.coupled.slack_derivative(change, rate), np.zeros(len(self.problem.load))])
