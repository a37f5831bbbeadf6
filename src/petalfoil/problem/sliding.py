"""Any problem with gaps, and friction on some of them: `F(x) + B^T T = G^T lam`.

The reactions that limit the friction are those of a step before; whoever solves repeats until they agree.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.physics.friction import Friction
from petalfoil.problem.coupled import Layout

Array = NDArray[np.float64]


class Line(Protocol):
    """Equations at one point."""

    @property
    def residual(self) -> Array:
        """`F(x)`, (n,)."""

    @property
    def size(self) -> Array:
        """What each row's residual is measured by, (n,)."""

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """`dF/dx + G^T diag(theta) G`, (n, n)."""

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Derivative by a shift of the gaps, applied to it, (n,)."""


class Gapped(Protocol):
    """Equations with gaps."""

    @property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps, (m, n)."""

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,)."""

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive."""

    def gaps(self, x: Array) -> Array:
        """Gaps at `x`, (m,)."""

    def admits(self, x: Array) -> bool:
        """The equations can be evaluated at `x`."""

    def linearize(self, x: Array, shift: Array | None = None) -> Line:
        """The equations at `x`."""


@dataclass(frozen=True)
class Rubbed:
    """Slip, friction force and its limit on the sliding gaps, (k,), as they were last."""

    slip: Array
    force: Array
    limit: Array

    @classmethod
    def fresh(cls, friction: Friction, x: Array, lam: Array) -> Rubbed:
        """No force yet, wherever the petals are."""
        slip = friction.slip @ x[: friction.slip.shape[1]]
        return cls(slip, np.zeros(len(slip)), friction.coefficient * friction.normal(lam))


def energy_lost(friction: Friction, before: Rubbed, after: Rubbed) -> float:
    """Energy lost in a step: the mean of the limits times what has slipped and does not spring back (D3)."""
    sticks = friction.stiffness > 0.0  # none in the step that a contact closes in
    sprung = np.divide(after.force - before.force, friction.stiffness, out=np.zeros_like(after.force), where=sticks)
    for_good = np.where(sticks, np.abs(after.slip - before.slip - sprung), 0.0)
    return float(0.5 * (before.limit + after.limit) @ for_good)


ROUNDING = 1e-11
"""Slips that differ by less do not tell a slope."""


@dataclass(frozen=True)
class Rubbing:
    """Friction within a step.

    Attributes
    ----------
    friction : Friction
        The law.
    before : Rubbed
        Slip and force that the step starts from.
    normal : (k,) array
        Reactions that limit the friction.
    secant : (k,) array or None
        Stiffness that stands for the law's own derivative: where contacts stick and slip in turns from one iterate to
        the next, neither derivative leads on.
    """

    friction: Friction
    before: Rubbed
    normal: Array
    secant: Array | None = None

    def law(self, x: Array) -> tuple[Array, Array, Array]:
        """Slip, force and its derivative by the slip at `x`, (k,)."""
        slip = self.friction.slip @ x[: self.friction.slip.shape[1]]
        force, stiffness = self.friction.force(slip, (self.before.slip, self.before.force), self.normal)
        return slip, force, stiffness if self.secant is None else self.secant

    def between(self, x: Array, other: Array) -> Rubbing:
        """The same with secants between the iterates `x` and `other`."""
        (slip, force, stiffness), (slip_1, force_1, _) = replace(self, secant=None).law(x), self.law(other)
        apart = slip - slip_1
        moved = np.abs(apart) > ROUNDING * (1.0 + np.abs(slip))
        slope = np.divide(force - force_1, apart, out=stiffness.copy(), where=moved)
        return replace(self, secant=np.clip(slope, 0.0, self.friction.stiffness))

    def after(self, x: Array) -> Rubbed:
        """Slip and force at `x`."""
        slip, force, _ = self.law(x)
        return Rubbed(slip, force, self.friction.coefficient * self.normal)


@dataclass(frozen=True)
class SlidingProblem:
    """A problem with friction on some of its gaps.

    Attributes
    ----------
    base : Gapped
        The problem without friction; its first unknowns are the deflections.
    rubbing : Rubbing
        Friction in this step.
    """

    base: Gapped
    rubbing: Rubbing
    rank: None = field(default=None, init=False)

    @property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps, (m, n)."""
        return self.base.G

    @property
    def weight(self) -> Array:
        """Weights of the gaps, (m,)."""
        return self.base.weight

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

    def linearize(self, x: Array, shift: Array | None = None) -> SlidingLine:
        """The equations at `x`."""
        return SlidingLine(self.base.linearize(x, shift), self.rubbing, x)


@dataclass(frozen=True)
class SlidingLine:
    """The equations with friction at one point."""

    line: Line
    rubbing: Rubbing
    x: Array

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        return self.rubbing.law(self.x)

    @cached_property
    def residual(self) -> Array:
        """`F(x) + B^T T`, (n,)."""
        out, B = self.line.residual.copy(), self.rubbing.friction.slip
        out[: B.shape[1]] += B.T @ self._law[1]
        return out

    @property
    def size(self) -> Array:
        """What each row's residual is measured by, (n,)."""
        return self.line.size

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent with `B^T (dT/ds) B`, (n, n)."""
        held = held_together(self.rubbing.friction, self._law[2], len(self.x))
        return sp.csc_array(self.line.matrix(theta, rate) + held)

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Friction reads slips, not gaps."""
        return self.line.by_shift(shift, rate)


def held_together(friction: Friction, stiffness: NDArray[Any], n: int) -> sp.csc_array:
    """`B^T diag(stiffness) B` among all `n` unknowns."""
    B = friction.slip
    held = sp.coo_array(B.T @ (sp.diags_array(stiffness) @ B))
    return sp.coo_array((held.data, (held.row, held.col)), shape=(n, n)).tocsc()


def friction_of(case: Case, layout: Layout) -> Friction | None:
    """Friction between the petals of `case` in the units of the problem; None without any."""
    surface, wall = case.surface, layout.wall
    if not surface.petal_friction or not wall.slip.shape[0]:
        return None
    width, none = surface.friction_width / layout.scales.length, np.zeros(wall.slip.shape[0])
    return Friction(surface.petal_friction, none, wall.slip, wall.share, width)
