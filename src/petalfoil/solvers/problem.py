"""What the solvers ask of a problem with one-sided gaps: `F(x) = H^T lam`, `0 <= g(x)` complementary to `lam >= 0`.

`G` is the derivative of the gaps, `H` has the forces of unit reactions. Without a journal that rubs `H` is `G`.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import SparseRows

Array = NDArray[np.float64]

RESIDUAL_TOLERANCE = 1e-8
"""Largest scaled residual of a solution. Gaps and reactions that miss zero by less count as zero."""

POSITIVE_FRACTION = 0.8
"""Fraction of the way to zero that a step may take unknowns that must stay positive: the equations are steep there."""


class Linearized(Protocol):
    """The equations at one point."""

    @property
    def residual(self) -> Array:
        """`F(x)` without reactions, (n,)."""

    @property
    def row_scale(self) -> Array:
        """Magnitude of each row that its residual is compared with, (n,)."""

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """`dF/dx + H^T diag(barrier_weight) G` plus `rate` times the derivative of what F's rows store, (n, n)."""

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of F, and `rate` times that of what it stores, by the slacks that it reads, times `change`; (n,).

        `change` is (m,).
        """


class ContactProblem(Protocol):
    """Equations with gaps. A row of `G` holds one unknown (+-1) or the difference of two."""

    @property
    def G(self) -> SparseRows:
        """Derivative of the gaps, (m, n)."""

    @property
    def acting(self) -> SparseRows:
        """`H`, forces on the equations by unit reactions, (m, n): `G` itself where these act along the gaps alone."""

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,): `lam / weight` is comparable between nodes."""

    @property
    def elimination_key(self) -> Hashable | None:
        """Problems with equal keys share their elimination orders; None where remembering them gains nothing."""

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive."""

    def gaps(self, x: Array) -> Array:
        """`g(x)`, (m,)."""

    def admits(self, x: Array) -> bool:
        """Whether the equations can be evaluated at `x` with slacks equal to the gaps."""

    def linearize(self, x: Array, shift: Array | None = None) -> Linearized:
        """The equations at `x`. Where F reads gaps, it reads the slacks `g(x) + shift`."""


@dataclass(frozen=True)
class WithMoreForces:
    """A contact problem whose unknowns feel further forces: gaps, their weights and the bounds stay those of `base`.

    Attributes
    ----------
    base : ContactProblem
        The problem without these forces.
    """

    base: ContactProblem

    @property
    def G(self) -> SparseRows:
        """Derivative of the gaps, (m, n)."""
        return self.base.G

    @property
    def acting(self) -> SparseRows:
        """Forces of unit reactions, (m, n)."""
        return self.base.acting

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,)."""
        return self.base.weight

    @property
    def elimination_key(self) -> Hashable | None:
        """That of the base, whose elimination order serves."""
        return self.base.elimination_key

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive."""
        return self.base.positive

    def gaps(self, x: Array) -> Array:
        """Gaps at `x`, (m,)."""
        return self.base.gaps(x)

    def admits(self, x: Array) -> bool:
        """The equations can be evaluated at `x`."""
        return self.base.admits(x)


@dataclass(frozen=True)
class Border:
    """How `d` unknowns `b` beside `x` enter: the gaps read `A b`, and the rows of `b` read `R x` and `A^T lam`.

    Attributes
    ----------
    gap_derivative : (m, d) array
        `A`.
    row_derivative : (d, k) array
        `R` by the unknowns in `columns`.
    columns : slice
        These unknowns.
    reaction_derivative : (d, m) array or None
        What the rows of `b` read of the reactions in place of `A^T lam`.
    forcing : (n, d) array or None
        Derivative of the equations by `b` beside that through the gaps.
    """

    gap_derivative: Array
    row_derivative: Array
    columns: slice
    reaction_derivative: Array | None = None
    forcing: Array | None = None

    @property
    def size(self) -> int:
        """Number of bordered unknowns, `d`."""
        return int(self.gap_derivative.shape[1])

    @property
    def by_reactions(self) -> Array:
        """What the rows of `b` read of the reactions, (d, m)."""
        return self.gap_derivative.T if self.reaction_derivative is None else self.reaction_derivative

    def rows(self, change: NDArray[Any], reactions: NDArray[Any]) -> NDArray[Any]:
        """`R dx + A^T dlam`, (d,), from changes of the unknowns (n,) and of all reactions (m,)."""
        out: NDArray[Any] = self.row_derivative @ change[self.columns] + self.by_reactions @ reactions
        return out


def no_border(m: int) -> Border:
    """No bordered unknowns."""
    return Border(np.zeros((m, 0)), np.zeros((0, 0)), slice(0, 0))


@dataclass(frozen=True)
class PrimalDualPoint:
    """A point of the interior-point method.

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


def scaled_residual(linearized: Linearized, reaction: Array) -> float:
    """Largest residual of `F - H^T lam` over its row scale; `reaction` is `H^T lam`."""
    return float(np.max(np.abs(linearized.residual - reaction) / linearized.row_scale, initial=0.0))


def fraction_to_boundary(value: Array, change: Array) -> float:
    """Step length at which the first of `value + length change` reaches zero; infinite if none does."""
    falling = change < 0.0
    return float(np.min(value[falling] / -change[falling], initial=np.inf))


def positive_step(problem: ContactProblem, x: Array, change: Array) -> float:
    """Largest step length, at most 1, that keeps unknowns that must stay positive off zero."""
    kept = problem.positive
    return min(1.0, POSITIVE_FRACTION * fraction_to_boundary(x[kept], change[kept]))
