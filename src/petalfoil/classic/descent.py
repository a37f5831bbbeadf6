"""The package at a given pressure: gradient descent on its energy, projected onto the restrictions (45)-(50), (Q2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.classic.columns import Columns, columns
from petalfoil.classic.kernels import Bands, Descent, Engine, kernels
from petalfoil.classic.numpy_kernels import project
from petalfoil.classic.options import ClassicOptions
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

CLOSED = 1e-9
"""A gap below this share of the reference film was closed by the projection; the rest is rounding [1]."""


@dataclass
class PackageDescent:
    """The package of one bearing at one journal position.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing.
    options : ClassicOptions
        Gradient step and acceleration.
    engine : Engine or None
        Which inner loops run; the fastest that is installed if None.
    steps : int
        Gradient steps taken so far.
    """

    problem: CoupledProblem
    options: ClassicOptions
    engine: Engine | None = None
    steps: int = field(default=0, init=False)

    @cached_property
    def columns(self) -> Columns:
        """The restrictions."""
        return columns(self.problem)

    @cached_property
    def shell(self) -> Bands:
        """Stiffness of one petal."""
        return bands(self.problem.layout.stiffness, len(self.problem.layout.wall.film.theta))

    @cached_property
    def step(self) -> float:
        """Gradient step: a share of the inverse of `max_i sum_j |K_ij|`, which no eigenvalue of `K` exceeds [1]."""
        share = min(self.options.descent_share, 1.0) if self.options.momentum else self.options.descent_share
        return share / float(abs(self.problem.layout.stiffness).sum(axis=1).max())

    def load(self, P: Array) -> Array:
        """Nodal forces of the pressure unknowns `P` (40), (n_wall,) [1]."""
        out: Array = self.problem.layout.push @ (P - 1.0)
        return out

    def admitted(self, W: Array) -> Array:
        """The nearest deflections to `W` (n_wall,) that keep the restrictions (18)-(20) at this journal position."""
        return project(W, self.columns) if len(W) else W.copy()

    def advance(self, W: Array, load: Array, tolerance: float, max_steps: int) -> bool:
        """Descend from `W` (n_wall,) in place; whether no node is out of balance by more than `tolerance`."""
        drive = Descent(self.step, self.options.momentum, tolerance, max_steps)
        steps, left = kernels(self.engine).descend(W, load, self.shell, self.columns, drive)
        self.steps += steps
        return left <= tolerance

    def reactions(self, W: Array, load: Array) -> Array:
        """Forces of the contacts on the package from its equations: `G^T lam = K W - f` on the closed gaps, (m,) [1].

        The gaps that the last projection closed; each takes what its nodes lack for balance, never a pull.
        """
        problem = self.problem
        gap = problem.gaps(np.concatenate([W, np.ones(problem.layout.n - len(W))]))
        closed = np.flatnonzero(gap <= CLOSED)
        lam = np.zeros(len(gap))
        if len(closed):
            G = problem.layout.wall.contacts.G[closed]
            lacking = G @ (problem.layout.elastic_force(W) - load)
            lam[closed] = np.maximum(sp.linalg.spsolve(sp.csc_array(G @ G.T), lacking), 0.0)
        return lam


def bands(stiffness: sp.csr_array, petals: int) -> Bands:
    """Diagonals of the first petal's block; the others are its copies."""
    n = stiffness.shape[0] // petals
    block = sp.coo_array(stiffness[:n, :n])
    offset = np.unique(block.col - block.row).astype(np.int64)
    values = np.zeros((len(offset), n))
    values[np.searchsorted(offset, block.col - block.row), block.row] = block.data
    return Bands(values, offset)
