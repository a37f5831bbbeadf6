"""Deflections of the pack at a given pressure: projected gradient descent on the energy (45)-(50), (Q2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.classic.columns import ContactColumns, columns
from petalfoil.classic.kernels import Bands, DescentSettings, KernelBackend, kernels
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.classic.numpy_kernels import project
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

CLOSED = 1e-9
"""A gap below this, over the reference film thickness, is in contact [1].

The projection closes gaps to rounding, far below this value. Open gaps are far above it.
"""


@dataclass
class PackDescent:
    """Descent of the pack of one bearing at one journal position.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing.
    options : ClassicOptions
        Step length and acceleration.
    engine : KernelBackend or None
        Inner loops; None takes the fastest installed.
    steps : int
        Number of gradient steps so far.
    """

    problem: CoupledProblem
    options: ClassicOptions
    engine: KernelBackend | None = None
    steps: int = field(default=0, init=False)

    @cached_property
    def columns(self) -> ContactColumns:
        """The constraints."""
        return columns(self.problem)

    @cached_property
    def shell(self) -> Bands:
        """Stiffness matrix of one petal by diagonals."""
        return bands(self.problem.layout.stiffness, len(self.problem.layout.wall.film.theta))

    @cached_property
    def step(self) -> float:
        """Step length: a fraction of `1 / max_i sum_j |K_ij|`, a bound of the largest eigenvalue of `K` [1]."""
        fraction = self.options.descent_step_fraction
        if self.options.momentum:
            fraction = min(fraction, 1.0)
        return fraction / float(abs(self.problem.layout.stiffness).sum(axis=1).max())

    def load(self, P: Array) -> Array:
        """Nodal forces of the pressure unknowns `P` (40), (n_wall,) [1]."""
        out: Array = self.problem.layout.push @ (P - 1.0)
        return out

    def projected(self, W: Array) -> Array:
        """The nearest deflections to `W` (n_wall,) that satisfy the constraints (18)-(20) at this journal position."""
        return project(W, self.columns) if len(W) else W.copy()

    def advance(self, W: Array, load: Array, tolerance: float, max_steps: int) -> bool:
        """Descend from `W` (n_wall,) in place; whether the largest nodal force imbalance is within `tolerance`."""
        settings = DescentSettings(self.step, self.options.momentum, tolerance, max_steps)
        steps, left = kernels(self.engine).descend(W, load, self.shell, self.columns, settings)
        self.steps += steps
        return left <= tolerance

    def reactions(self, W: Array, load: Array) -> Array:
        """Contact reactions from the equilibrium of the pack, `G^T lam = K W - f` on the active contacts, (m,) [1].

        The active contacts are the gaps that the last projection closed. Negative values are set to zero.
        """
        problem = self.problem
        gap = problem.gaps(np.concatenate([W, np.ones(problem.layout.n - len(W))]))
        closed = np.flatnonzero(gap <= CLOSED)
        lam = np.zeros(len(gap))
        if len(closed):
            G = problem.layout.wall.contacts.G[closed]
            imbalance = G @ (problem.layout.elastic_force(W) - load)
            lam[closed] = np.maximum(sp.linalg.spsolve(sp.csc_array(G @ G.T), imbalance), 0.0)
        return lam


def bands(stiffness: sp.csr_array, petals: int) -> Bands:
    """Diagonals of the stiffness matrix of the first petal; all petals have the same."""
    n = stiffness.shape[0] // petals
    block = sp.coo_array(stiffness[:n, :n])
    offset = np.unique(block.col - block.row).astype(np.int64)
    values = np.zeros((len(offset), n))
    values[np.searchsorted(offset, block.col - block.row), block.row] = block.data
    return Bands(values, offset)
