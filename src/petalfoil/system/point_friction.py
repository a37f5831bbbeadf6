"""Friction between petals at contact points within a step, whose places travel (M13): in time or along a path.

Friction forces `T` act on both faces where they touch now. A contact slips by what the material of its two faces has
moved since the step began, half way between the places of the contact then and now. With the petals `w`, `w_0` and the
forces `T`, `T_0` now and then, at the places `t`, `t_0`, and `m` half way between,

    sigma = B(m) (w - w_0) - C(m, t) T + C(m, t_0) T_0 ,     wall  ... + B(t)^T T = 0                     (M13)

What a contact remembers is thus the position of the petals' material, which travels with no contact: a new contact
begins without force, and the stretch that a released one leaves springs back.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.friction import FrictionState, slips_forward
from petalfoil.system.point_equations import PointEquations, PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.point_step import PointStepEquations
from petalfoil.walls.pack_slip import slip_by_place, slip_compliance, slip_compliance_by_place, slip_rows

Array = NDArray[np.float64]
Index = NDArray[np.intp]

NEAR = 1.0
"""Farthest that a contact is taken to have travelled in a step, in elements."""


@dataclass(frozen=True)
class PointFriction:
    """The law of a step, and where the step began.

    Attributes
    ----------
    whole : PointLayout
        The petals.
    coefficient : float
        `mu_p` [1].
    begin : PointState
        `w_0` and the contacts at `t_0`.
    force : (j_0,) array
        `T_0` [1].
    """

    whole: PointLayout
    coefficient: float
    begin: PointState
    force: Array

    def rubs(self, points: ContactPoints) -> Index:
        """Numbers of the contacts on petals and bushing: those on the journal slip on no petal."""
        return np.flatnonzero(points.every_curve >= self.whole.pack.mesh.count)

    def limit(self, points: ContactPoints) -> Array:
        """`mu_p lam`, zero on the journal, (j,) [1]."""
        out, rubs = np.zeros(len(points.reaction)), self.rubs(points)
        out[rubs] = self.coefficient * np.maximum(points.reaction[rubs], 0.0)
        return out

    def half_way(self, points: ContactPoints) -> tuple[ContactPoints, Array]:
        """Places `m` of the contacts, and their derivative by those now: 1/2, or 1 of contacts that are new; (j,)."""
        then, now = self.begin.points, points.every_position
        last = matched(points, then)
        before = np.where(last >= 0, then.every_position[last], now) if len(then.reaction) else now
        return separate(points.every_curve, 0.5 * (before + now)), np.where(last >= 0, 0.5, 1.0)

    def slip(self, state: PointState, force: Array) -> Slip:
        """Slip of all contacts at a state with friction forces `force` (j,), and its derivatives."""
        points, then, pack = state.points, self.begin.points, self.whole.pack
        middle, part = self.half_way(points)
        scales, j, moved = self.whole.layout.scales, len(points.reaction), state.w - self.begin.w
        each = [(own.every_curve, own.every_position) for own in (middle, points, then)]
        every = separate(*(np.concatenate(values) for values in zip(*each, strict=True)))
        rows, unit = slip_rows(pack, middle), scales.force / scales.length
        C, D = slip_compliance(pack, every) * unit, slip_compliance_by_place(pack, every) * unit
        now, before = slice(j, 2 * j), slice(2 * j, None)
        value = rows @ moved - C[:j, now] @ force + C[:j, before] @ self.force
        own = slip_by_place(pack, middle) @ moved - D[:j, now] @ force + D[:j, before] @ self.force
        return Slip(value, rows, np.diag(part * own) - D[now, :j].T * force, C[:j, now])

    def state(self, state: PointState, force: Array) -> FrictionState:
        """Slip since the step began, force and its limit on all contacts."""
        return FrictionState(self.slip(state, force).value, force, self.limit(state.points))

    def broken(self, after: FrictionState) -> float:
        """How far slips and friction forces are from (M6): slip that should not be, force over the limit [1]."""
        over = np.abs(after.force) - after.limit
        slides = slips_forward(after.force, after.limit)
        wrong = np.where(slides == 0, np.abs(after.slip), np.maximum(-slides * after.slip, 0.0))
        touching, most = after.limit > 0.0, np.max(after.limit, initial=0.0)
        return max(
            float(np.max(wrong[touching], initial=0.0)),
            float(np.max(over, initial=0.0)) / max(float(most), np.finfo(float).tiny),
        )

    def lost(self, after: FrictionState, points: ContactPoints) -> float:
        """Energy lost in a step that leads to a state with contacts `points`: mean limits times slips [1]."""
        then, last = self.limit(self.begin.points), matched(points, self.begin.points)
        before = np.where(last >= 0, then[last], 0.0) if len(then) else np.zeros(len(last))
        return float(0.5 * (before + after.limit) @ np.abs(after.slip))


@dataclass(frozen=True)
class Slip:
    """Slip of contacts: its value (j,), derivatives by the petals (j, n_wall) and by all places (j, j).

    `compliance` is what friction forces lessen it by, `C(m, t)`, (j, j).
    """

    value: Array
    rows: sp.csr_array
    by_place: Array
    compliance: Array


def separate(curve: Index, position: Array) -> ContactPoints:
    """Contacts at these places, each by itself, without reactions."""
    return ContactPoints(curve, position, np.zeros(len(curve), dtype=np.intp), np.zeros(len(curve)))


def matched(points: ContactPoints, then: ContactPoints) -> Index:
    """Number of each contact among those of `then`, -1 where it was none: the nearest on its curve, and that to it."""
    if not len(points.reaction) or not len(then.reaction):
        return np.full(len(points.reaction), -1)
    apart = np.abs(points.every_position[:, None] - then.every_position)
    apart[points.every_curve[:, None] != then.every_curve] = np.inf
    nearest, own = np.argmin(apart, axis=1), np.arange(len(apart))
    mutual = (np.argmin(apart, axis=0)[nearest] == own) & (apart[own, nearest] <= NEAR)
    return np.where(mutual, nearest, -1)


def carried(force: Array, then: ContactPoints, points: ContactPoints) -> Array:
    """Friction forces (j_0,) of contacts `then` on the contacts `points`, (j,): zero on those that are new."""
    last = matched(points, then)
    return np.asarray(np.where(last >= 0, force[last], 0.0)) if len(force) else np.zeros(len(last))


def stretching_energy(whole: PointLayout, points: ContactPoints, force: Array) -> float:
    """Energy of petals that friction forces stretch, `T^T C T / 2`, over units of force and length."""
    scales = whole.layout.scales
    return 0.5 * float(force @ slip_compliance(whole.pack, points) @ force) * (scales.force / scales.length)


@dataclass(frozen=True)
class RubbingEquations(PointEquations):
    """The equations with friction forces on the petals, which the law of a step holds them to.

    Attributes
    ----------
    friction_force : (j,) array
        `T` of all contacts [1].
    """

    friction_force: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def rubbed(self) -> sp.csr_array:
        """`B(t)`, (j, n_wall)."""
        return slip_rows(self.whole.pack, self.state.points)

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """The rows of the wall with `B^T T`, all others as they are."""
        wall, film, value, slope = super().residual
        return wall + self.rubbed.T @ self.friction_force, film, value, slope

    @cached_property
    def steady(self) -> sp.csc_array:
        """The tangent; friction forces are held, and travel with the contacts."""
        points, by_place = self.state.points, slip_by_place(self.whole.pack, self.state.points)
        pulled = by_place.T @ sp.diags_array(self.friction_force)
        more = sp.coo_array(pulled @ points.spread @ sp.diags_array(self.travels))
        first = self.n - len(points.position)
        block = sp.coo_array((more.data, (more.row, first + more.col)), shape=(self.n, self.n))
        return sp.csc_array(super().steady + block)

    @property
    def wall_forces(self) -> tuple[Array, Array, Array]:
        """Elastic forces, loads with `-B^T T` among them, and magnitudes of these, (n_wall,)."""
        elastic, loads, size = super().wall_forces
        pulls = self.rubbed.T @ self.friction_force
        return elastic, loads - pulls, size + abs(self.rubbed).T @ np.abs(self.friction_force)


@dataclass(frozen=True)
class RubbingStepEquations(RubbingEquations, PointStepEquations):
    """The same in a stage of a step in time."""
