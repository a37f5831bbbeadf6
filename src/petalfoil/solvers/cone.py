"""A problem with one-sided gaps: `F(x) = G^T lam`, `0 <= g(x)` complementary to `lam >= 0`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import Elimination

Array = NDArray[np.float64]


class Linearized(Protocol):
    """The equations at one point."""

    @property
    def residual(self) -> Array:
        """`F(x)`, reactions apart, (n,)."""

    @property
    def size(self) -> Array:
        """What each row's residual is measured by, (n,)."""

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """`dF/dx + G^T diag(theta) G`, plus `rate` times the derivative of what F's rows store; (n, n)."""

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Derivative of F (and of what is stored) by a shift of the gaps it reads, applied to `shift` (m,); (n,)."""


class ConeProblem(Protocol):
    """What the solvers ask of a problem. A row of `G` holds one unknown (+-1) or the difference of two."""

    @property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps, (m, n)."""

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,): `lam / weight` is comparable between nodes."""

    @property
    def rank(self) -> Elimination | None:
        """Orders of elimination that like problems left; None to leave them to the solver."""

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive."""

    def gaps(self, x: Array) -> Array:
        """`g(x)`, (m,)."""

    def admits(self, x: Array) -> bool:
        """The equations can be evaluated at `x` without a shift."""

    def linearize(self, x: Array, shift: Array | None = None) -> Linearized:
        """The equations at `x`; where F reads gaps it reads `g(x) + shift`."""


@dataclass(frozen=True)
class ConePoint:
    """A point of an interior-point method.

    Attributes
    ----------
    x : (n,) array
        Unknowns.
    s, lam : (m,) array
        Slacks of the gaps and reactions, both positive.
    """

    x: Array
    s: Array
    lam: Array

    def barrier(self, weight: Array) -> float:
        """Mean of `lam s` over the gaps' weights; zero without gaps."""
        return float(self.lam @ self.s / weight.sum()) if len(self.s) else 0.0


def scaled_residual(line: Linearized, reaction: Array) -> float:
    """Largest residual of `F - G^T lam` over its row's size."""
    return float(np.max(np.abs(line.residual - reaction) / line.size, initial=0.0))
