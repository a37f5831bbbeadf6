"""Friction between petals in the units of the problem, and a contact problem with friction.

F(x) + B^T T = H^T lam,  gaps as without friction       (C1) with (D2)

The reactions that limit friction are those of a correction before; the solver goes on until they agree.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case, PetalTheory
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.problem import Linearized, WithMoreForces
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.pack_slip import slip_compliance, slip_rows

Array = NDArray[np.float64]


SLIDES = 1e-9
"""Part of the limit by which the force of a slipping contact may miss it."""


@dataclass(frozen=True)
class FrictionState:
    """Slip, friction force and its limit on the sliding gaps, (k,), as they were last."""

    slip: Array
    force: Array
    limit: Array

    @classmethod
    def fresh(cls, friction: Friction, x: Array, lam: Array) -> FrictionState:
        """No force yet, wherever the petals are."""
        slip = slips(friction, x)
        return cls(slip, np.zeros(len(slip)), friction.coefficient * friction.normal(lam))


def slipping(friction: Friction, state: FrictionState) -> NDArray[np.intp]:
    """Direction of slip, 0 where a contact sticks or is open, (k,).

    Of contacts that slip in two directions 1 where they slip, once for each direction.
    """
    if friction.directions == 1:
        return slips_forward(state.force, state.limit)
    return np.abs(slips_forward(friction.magnitude(state.force), state.limit))


def slips_forward(force: NDArray[np.float64], limit: NDArray[np.float64]) -> NDArray[np.intp]:
    """Direction of slip by friction forces along a line and their limits, 0 where a contact sticks or is open, (k,)."""
    slides = (limit > 0.0) & (np.abs(force) >= (1.0 - SLIDES) * limit)
    return np.where(slides, np.sign(force), 0.0).astype(np.intp)


def slips(friction: Friction, x: NDArray[Any]) -> NDArray[Any]:
    """Slip `B w` of the deflections, the first of the unknowns `x`; (k,) or (k, j)."""
    out: NDArray[Any] = friction.slip @ x[: friction.slip.shape[1]]
    return out


def against_slip(friction: Friction, force: NDArray[Any], n: int) -> NDArray[Any]:
    """`B^T T` among all `n` unknowns."""
    out = np.zeros(n, dtype=force.dtype)
    out[: friction.slip.shape[1]] = friction.slip.T @ force
    return out


def friction_tangent(friction: Friction, stiffness: NDArray[Any], n: int) -> sp.csc_array:
    """`B^T diag(stiffness) B` among all `n` unknowns."""
    B = friction.slip
    held = sp.coo_array(B.T @ (sp.diags_array(stiffness) @ B))
    return sp.coo_array((held.data, (held.row, held.col)), shape=(n, n)).tocsc()


def energy_lost(friction: Friction, before: FrictionState, after: FrictionState) -> float:
    """Energy lost in a step: the mean of the limits times what has slipped and does not spring back (D3)."""
    if friction.exact:
        limits = 0.5 * (before.limit + after.limit) / friction.directions  # each has the size of the whole slip
        return float(limits @ friction.magnitude(after.slip - before.slip))
    sticks = friction.stiffness > 0.0  # none in the step that a contact closes in
    sprung = np.divide(after.force - before.force, friction.stiffness, out=np.zeros_like(after.force), where=sticks)
    for_good = np.where(sticks, np.abs(after.slip - before.slip - sprung), 0.0)
    return float(0.5 * (before.limit + after.limit) @ for_good)


ROUNDING = 1e-11
"""Slips that differ by less do not determine a slope."""


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
        Stiffness in place of the law's own derivative: where contacts stick and slip in turns from one iterate to the
        next, neither derivative leads on.
    """

    friction: Friction
    before: FrictionState
    normal: Array
    secant: Array | None = None

    @classmethod
    def beginning(cls, friction: Friction, before: FrictionState, lam: Array) -> FrictionStep:
        """A step that starts with the reactions `lam` (m,)."""
        return cls(friction.in_step(lam), before, friction.normal(lam))

    def law(self, x: Array) -> tuple[Array, Array, Array]:
        """Slip, force and its derivative by the slip at `x`, (k,)."""
        slip = slips(self.friction, x)
        force, stiffness = self.friction.force(slip, (self.before.slip, self.before.force), self.normal)
        return slip, force, stiffness if self.secant is None else self.secant

    def limited(self, lam: Array) -> FrictionStep:
        """The same with friction limited by the reactions `lam` (m,)."""
        return replace(self, normal=self.friction.normal(lam), secant=None)

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


@dataclass(frozen=True)
class FrictionProblem(WithMoreForces):
    """A contact problem with friction; the first unknowns of its base are the deflections.

    Attributes
    ----------
    step : FrictionStep
        Friction in this step.
    """

    step: FrictionStep

    def linearize(self, x: Array, shift: Array | None = None) -> FrictionLinearization:
        """The equations at `x`."""
        return FrictionLinearization(self.base.linearize(x, shift), self.step, x)


@dataclass(frozen=True)
class FrictionLinearization:
    """The equations with friction at one point."""

    smooth: Linearized
    step: FrictionStep
    x: Array

    @cached_property
    def _law(self) -> tuple[Array, Array, Array]:
        return self.step.law(self.x)

    @cached_property
    def residual(self) -> Array:
        """`F(x) + B^T T`, (n,)."""
        friction: Array = against_slip(self.step.friction, self._law[1], len(self.x))
        return self.smooth.residual + friction

    @property
    def row_scale(self) -> Array:
        """What each row's residual is compared with, (n,)."""
        return self.smooth.row_scale

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent with `B^T (dT/ds) B`, (n, n)."""
        stiffness = friction_tangent(self.step.friction, self._law[2], len(self.x))
        return sp.csc_array(self.smooth.matrix(barrier_weight, rate) + stiffness)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Friction reads slips, not gaps."""
        return self.smooth.slack_derivative(change, rate)


def friction_of(case: Case, layout: BearingLayout) -> Friction | None:
    """Friction between the petals of `case` in the units of the problem, along the shaft too where petals move there.

    None without any.
    """
    surface, wall = case.surface, layout.wall
    if not surface.petal_friction or not wall.slip.shape[0]:
        return None
    width, none = surface.friction_width / layout.scales.length, np.zeros(wall.slip.shape[0])
    exact = case.petal_theory is PetalTheory.SHELL
    along = Friction(surface.petal_friction, none, wall.slip, wall.reaction_share, width, exact=exact)
    if wall.axial_slip is None:
        return along
    slip, share = (sp.csr_array(sp.vstack(pair)) for pair in ((wall.slip, wall.axial_slip), [wall.reaction_share] * 2))
    return replace(along, slip=slip, reaction_share=share, stiffness=np.zeros(slip.shape[0]), directions=2)


def friction_at_points(friction: Friction, whole: PointLayout, points: ContactPoints) -> Friction:
    """The same friction at contact points: a gap for each, on the journal without slip."""
    pack, scales = whole.pack, whole.layout.scales
    on_petals = sp.diags_array((points.every_curve >= pack.mesh.count).astype(np.float64))
    slip, compliance = slip_rows(pack, points), None
    if pack.faces.slides:
        compliance = slip_compliance(pack, points) * (scales.force / scales.length)
    return replace(
        friction,
        stiffness=np.zeros(slip.shape[0]),
        slip=slip,
        reaction_share=sp.csr_array(on_petals),
        compliance=compliance,
    )


def friction_on_lines(friction: Friction, held: NDArray[np.bool_], points: LinePoints) -> Friction:
    """The same friction at the nodes `held` (m,) and at points between nodes, a gap for each in this order (K15).

    The slip between nodes is interpolated as the gap is; contacts on the journal have none.
    """
    every = sp.eye_array(len(held), format="csr")
    at = sp.csr_array(sp.vstack([every[np.flatnonzero(held)], points.value]))
    limits = friction.reaction_share[: friction.slip.shape[0] // friction.directions]  # a gap of its own for each
    rows = sp.csr_array(at @ limits.T)
    slip = sp.block_diag([rows] * friction.directions, format="csr") @ friction.slip
    own = sp.eye_array(at.shape[0], format="csr")
    share = sp.csr_array(sp.vstack([own] * friction.directions))
    return replace(friction, slip=sp.csr_array(slip), reaction_share=share, stiffness=np.zeros(slip.shape[0]))
