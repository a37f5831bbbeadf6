"""The coupled system with the journal's position unknown and a load given: `z = [x, e]`.

    wall, film, gaps   as in the coupled system, at displacement e       (C1)-(C3)
    journal            F_film(P) + by_e^T lam + load = 0                 (C5)

The reactions' force on the journal is the transpose of what its displacement does to the gaps, so that with
`G_z = [G, by_e]` the same `G_z^T lam` serves all rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.forces import node_area
from petalfoil.sparsity import Elimination, add_up
from petalfoil.system.coupled import CoupledProblem, Linearization

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FilmForce:
    """Force of the film on the journal, linear in the pressure unknowns, over the unit of nodal force.

    Attributes
    ----------
    by_P : (2, n_film) array
        Derivative by the pressure unknowns [1].
    """

    by_P: Array

    @classmethod
    def of(cls, problem: CoupledProblem) -> FilmForce:
        """The film's force in the units of `problem`: `-sum (P - 1) n R_j dphi dz` (62)."""
        layout = problem.layout
        mesh, balance = layout.wall.film, layout.balance
        area = node_area(mesh, balance.radius) * layout.scales.pressure / layout.scales.force
        numbers = np.where(mesh.unknown >= 0, mesh.unknown, mesh.n_unknown).ravel()
        normals = layout.wall.contacts.by_e[layout.wall.contacts.journal].T  # a gap narrows where the film pushes
        parts = [
            add_up(numbers, np.broadcast_to(area, mesh.shape).ravel() * n, mesh.n_unknown + 1)[:-1] for n in normals
        ]
        return cls(np.array(parts))

    def at(self, P: Array) -> Array:
        """Force at pressure unknowns `P`, (2,) [1]."""
        force: Array = self.by_P @ (P - 1.0)
        return force


@dataclass(frozen=True)
class LoadedProblem:
    """A bearing under a load.

    Attributes
    ----------
    coupled : CoupledProblem
        The bearing; its displacement is only the start.
    load : (2,) array
        Load on the journal over the unit of nodal force [1].
    """

    coupled: CoupledProblem
    load: Array

    @cached_property
    def film_force(self) -> FilmForce:
        """Force of the film on the journal."""
        return FilmForce.of(self.coupled)

    @cached_property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps by deflections, pressures and displacement, (m, n + 2)."""
        by_e = sp.csr_array(self.coupled.layout.wall.contacts.by_e)
        return sp.csr_array(sp.hstack([self.coupled.G, by_e], format="csr"))

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.coupled.weight

    @cached_property
    def rank(self) -> Elimination:
        """Orders of elimination; the two rows that reach all over the bearing come last by their degree."""
        return Elimination()

    @property
    def positive(self) -> slice:
        """The pressures."""
        return self.coupled.positive

    def at(self, z: Array) -> CoupledProblem:
        """The coupled system at the displacement of `z`."""
        return self.coupled.at(displacement=z[-2:])

    def gaps(self, z: Array) -> Array:
        """Gaps over the reference length, (m,)."""
        return self.at(z).gaps(z[:-2])

    def admits(self, z: Array) -> bool:
        """The film is open everywhere."""
        return self.at(z).admits(z[:-2])

    def linearize(self, z: Array, shift: Array | None = None) -> LoadedLinearization:
        """Residual and tangent at `z`."""
        return LoadedLinearization(self, z, self.at(z).linearize(z[:-2], shift))


@dataclass(frozen=True)
class LoadedLinearization:
    """The balance at one state."""

    problem: LoadedProblem
    z: Array
    line: Linearization

    @cached_property
    def residual(self) -> Array:
        """Wall and film, then minus film force and load (reactions apart), (n + 2,)."""
        P = self.z[self.problem.positive]
        journal = -(self.problem.film_force.at(P) + self.problem.load)
        return np.concatenate([self.line.residual, journal])

    @cached_property
    def size(self) -> Array:
        """Sizes of wall and film rows; the load for the journal's."""
        load = max(float(np.hypot(*self.problem.load)), 1e-3)
        return np.concatenate([self.line.size, [load, load]])

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G_z^T diag(theta) G_z`, (n + 2, n + 2)."""
        problem, layout = self.problem, self.problem.coupled.layout
        by_e = layout.wall.contacts.by_e
        stiff = theta[:, None] * by_e
        columns = np.column_stack([self.line.by_shift(by_e[:, k], rate) for k in (0, 1)]) + layout.G.T @ stiff
        rows = (layout.G.T @ stiff).T
        rows[:, problem.positive] -= problem.film_force.by_P
        blocks = [
            [self.line.matrix(theta, rate), sp.csc_array(columns)],
            [sp.csc_array(rows), sp.csc_array(by_e.T @ stiff)],
        ]
        return sp.csc_array(sp.block_array(blocks, format="csc"))

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """The journal's rows do not read the gaps."""
        return np.concatenate([self.line.by_shift(shift, rate), np.zeros(2)])
