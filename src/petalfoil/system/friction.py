"""Friction of the petals in the units of the problem, from one state to the next.

The reactions that limit it are those of a correction before; whoever solves goes on until they agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.coupled import Layout

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrictionState:
    """Slip, friction force and its limit on the sliding gaps, (k,), as they were last."""

    slip: Array
    force: Array
    limit: Array

    @classmethod
    def fresh(cls, friction: Friction, x: Array, lam: Array) -> FrictionState:
        """No force yet, wherever the petals are."""
        slip = friction.slip @ x[: friction.slip.shape[1]]
        return cls(slip, np.zeros(len(slip)), friction.coefficient * friction.normal(lam))


def energy_lost(friction: Friction, before: FrictionState, after: FrictionState) -> float:
    """Energy lost in a step: the mean of the limits times what has slipped and does not spring back (D3)."""
    sticks = friction.stiffness > 0.0  # none in the step that a contact closes in
    sprung = np.divide(after.force - before.force, friction.stiffness, out=np.zeros_like(after.force), where=sticks)
    for_good = np.where(sticks, np.abs(after.slip - before.slip - sprung), 0.0)
    return float(0.5 * (before.limit + after.limit) @ for_good)


ROUNDING = 1e-11
"""Slips that differ by less do not tell a slope."""


@dataclass(frozen=True)
class FrictionStep:
    """Friction within a step.

    Attributes
    ----------
    friction : Friction
        The law.
    before : FrictionState
        Slip and force that the step starts from.
    normal : (k,) array
        Reactions that limit the friction.
    secant : (k,) array or None
        Stiffness that stands for the law's own derivative: where contacts stick and slip in turns from one iterate to
        the next, neither derivative leads on.
    """

    friction: Friction
    before: FrictionState
    normal: Array
    secant: Array | None = None

    def law(self, x: Array) -> tuple[Array, Array, Array]:
        """Slip, force and its derivative by the slip at `x`, (k,)."""
        slip = self.friction.slip @ x[: self.friction.slip.shape[1]]
        force, stiffness = self.friction.force(slip, (self.before.slip, self.before.force), self.normal)
        return slip, force, stiffness if self.secant is None else self.secant

    def between(self, x: Array, other: Array) -> FrictionStep:
        """The same with secants between the iterates `x` and `other`."""
        (slip, force, stiffness), (slip_1, force_1, _) = replace(self, secant=None).law(x), self.law(other)
        apart = slip - slip_1
        moved = np.abs(apart) > ROUNDING * (1.0 + np.abs(slip))
        slope = np.divide(force - force_1, apart, out=stiffness.copy(), where=moved)
        return replace(self, secant=np.clip(slope, 0.0, self.friction.stiffness))

    def after(self, x: Array) -> FrictionState:
        """Slip and force at `x`."""
        slip, force, _ = self.law(x)
        return FrictionState(slip, force, self.friction.coefficient * self.normal)


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
    return Friction(surface.petal_friction, none, wall.slip, wall.reaction_share, width)
