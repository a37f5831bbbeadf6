"""Equilibria in 3-D whose contact lines cross the axial stations between nodes.

From an equilibrium with contacts at nodes. Isolated contacts become points on the arc of each station, at places of
their own; contacts in longer runs and at edges stay at their nodes. With `n`, `n'` the derivatives of gap and slope at
a point by the unknowns,

    wall, film   F(x) - G^T lam - n^T lam_c = 0                                                        (C11)
    points       p = 0 ,  p' = 0           at each                                                     (C12)
    nodes        g = 0                     at those that carry load

Newton's method on unknowns, reactions and places has the tangent of the linear response (E12): that response is the
exact derivative of these equilibria. Under a load the journal's position is bordered.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_dips import PENETRATION, closed_between
from petalfoil.equilibrium.line_tangent import LineChange, LineResiduals, LineTangent
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ON_LINES
from petalfoil.equilibrium.travelling_contacts import TravellingContacts, travelling_contacts
from petalfoil.physics.contact_points import MARGIN
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, positive_step
from petalfoil.system.coupled import CoupledProblem, Linearization
from petalfoil.system.loaded import load_scale

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

TRUST = 0.5
"""Farthest that a point travels in a step, in cells."""

LEAST_CURVATURE = 1e-3
"""Least `p''` in a step, over the median of all points: where the gap hardly curves a point would travel far."""

CARRIED = 1e-9
"""Largest unbalanced force over the load."""


@dataclass(frozen=True)
class LineContacts:
    """A state with contact points between nodes.

    Attributes
    ----------
    problem : CoupledProblem
        Speed and position.
    x : (n,) array
        Unknowns.
    points : LinePoints
        Contact points.
    reaction : (k,) array
        Their reactions.
    held : (m,) bool array
        Contacts at nodes that carry load.
    held_reaction : (j,) array
        Their reactions.
    load : (n_position,) array or None
        Load over the unit of force; None at a fixed position.
    tangent : LineTangent or None
        The last tangent that led here; it may be of other contacts. None of states that none has led to.
    """

    problem: CoupledProblem
    x: Array
    points: LinePoints
    reaction: Array
    held: Mask
    held_reaction: Array
    load: Array | None
    tangent: LineTangent | None = field(default=None, repr=False, compare=False)

    @cached_property
    def linearized(self) -> Linearization:
        """Film and wall at the state."""
        return self.problem.linearize(self.x)

    @cached_property
    def gaps(self) -> Array:
        """Gaps at all nodes, (m,)."""
        return self.problem.gaps(self.x)

    @cached_property
    def along(self) -> Array:
        """`p`, `p'` and `p''` at the points, (3, k)."""
        return self.points.along(self.gaps)

    @cached_property
    def curvature(self) -> Array:
        """`p''` at the points, (k,)."""
        return np.asarray(self.along[2])

    @property
    def doubled(self) -> Mask:
        """Points at which the gap does not curve upward, (k,)."""
        return np.asarray(self.curvature <= 0.0)

    @property
    def slopes(self) -> Array:
        """`p'` at the points, (k,)."""
        return np.asarray(self.along[1])

    @cached_property
    def closed_between_nodes(self) -> LinePoints:
        """Places between nodes where gaps are least, and below zero."""
        return closed_between(self.points, self.gaps, PENETRATION)

    @cached_property
    def single_nodes(self) -> Mask:
        """Contacts at single nodes away from the ends of their lines and from points, (m,)."""
        alone, near = np.zeros(len(self.held), dtype=np.bool_), np.zeros(len(self.held), dtype=np.bool_)
        near[self.points.beside.ravel()] = True
        for lines in self.points.lines:
            held = np.pad(self.held[lines.number], ((0, 0), (1, 1)))
            single = held[:, 1:-1] & ~held[:, :-2] & ~held[:, 2:] & ~near[lines.number]
            single[:, :MARGIN] = single[:, len(lines.phi) - MARGIN :] = False
            alone[lines.number[single]] = True
        return alone

    @cached_property
    def slopes_at_single(self) -> Array:
        """Slopes of the gaps at contacts at single nodes, zero at all others; (m,) [1/rad]."""
        alone, slopes = np.flatnonzero(self.single_nodes), np.zeros(len(self.held))
        if len(alone):
            points = self.points.at_nodes(alone)
            slopes[points.nearest] = points.along(self.gaps)[1]
        return slopes

    @cached_property
    def closed(self) -> Array:
        """Gaps that are to vanish: at held nodes, then at points, (j + k,)."""
        return np.concatenate([self.gaps[self.held], self.along[0]])

    @cached_property
    def lam(self) -> Array:
        """Reactions at the nodes that do the same work, (m,)."""
        lam = self.points.pushes(self.reaction)
        lam[self.held] += self.held_reaction
        return lam

    @cached_property
    def shared(self) -> Array:
        """Reactions shared by the nodes beside each point, none of them below zero, (m,)."""
        lam: Array = self.points.shares.T @ self.reaction
        lam[self.held] += self.held_reaction
        return lam

    @property
    def active(self) -> Mask:
        """Contacts at nodes that are nearest to these, (m,)."""
        active = self.held.copy()
        active[self.points.nearest] = True
        return active

    @cached_property
    def rows(self) -> Array:
        """Residual of (C11), (n,)."""
        out: Array = self.linearized.residual - self.problem.G.T @ self.lam
        return out

    @cached_property
    def force(self) -> Array:
        """Force of film and contacts on the journal over the unit of force, (n_position,)."""
        return self.problem.journal_force(self.x, self.lam)

    @property
    def springs(self) -> Array:
        """Stiffness of what holds the journal beside film and contacts, (n_position, n_position): none."""
        return np.zeros((len(self.problem.displacement), len(self.problem.displacement)))

    @property
    def unbalanced(self) -> Array:
        """Force on the journal that is left under the load, (n_position,); zeros at a fixed position."""
        return np.zeros_like(self.force) if self.load is None else self.force + self.load

    @property
    def row_scale(self) -> Array:
        """What each of the rows is compared with, (n,)."""
        return self.linearized.row_scale

    @cached_property
    def residual(self) -> float:
        """Largest scaled residual of (C11), (C12) and the held gaps; a slope counts over a cell."""
        rows = float(np.max(np.abs(self.rows) / self.row_scale, initial=0.0))
        lengths = np.concatenate([self.closed, self.slopes * self.points.cell_length])
        return max(rows, float(np.max(np.abs(lengths), initial=0.0)))

    @property
    def balanced(self) -> bool:
        """Whether residual and force are within their tolerances."""
        left = 0.0 if self.load is None else float(np.linalg.norm(self.unbalanced)) / load_scale(self.load)
        return self.residual <= RESIDUAL_TOLERANCE and left <= CARRIED

    # ------------------------------------------------------------------------- as the linear response reads contacts

    @property
    def at_nodes(self) -> Mask:
        """Contacts at nodes, (m,)."""
        return self.held

    @property
    def value(self) -> sp.csr_array:
        """Weights of the gaps in the gap at the points, (k, m)."""
        return self.points.value

    @property
    def slope(self) -> sp.csr_array:
        """Weights of the gaps in its slope, (k, m)."""
        return self.points.slope

    @cached_property
    def bending(self) -> Array:
        """What divides slopes in a step: `p''`, its size where the gap curves downward, no less than a floor; (k,)."""
        size = np.abs(self.curvature)
        middle = np.partition(size, len(size) // 2)[len(size) // 2] if len(size) else 0.0
        return np.maximum(size, LEAST_CURVATURE * middle)

    @cached_property
    def travel_stiffness(self) -> Array:
        """`lam / p''` of the points (E12), (k,)."""
        return np.asarray(np.maximum(self.reaction, 0.0) / self.bending)

    @cached_property
    def contacts(self) -> TravellingContacts:
        """Contacts of the linear response: its tangent is the exact derivative of this state."""
        return travelling_contacts((self.problem.G, self.problem.G), self.problem.layout.wall.contacts.by_e, self)

    @cached_property
    def motion(self) -> SmallMotion:
        """Small motions about the state."""
        return SmallMotion(self.problem, self.linearized, self.contacts, contact_model=ON_LINES)

    def under(self, problem: CoupledProblem, load: Array | None) -> Self:
        """The same state under other equations on a grid of the same shape, under a load at its own position."""
        there = problem if load is None else problem.at(displacement=self.problem.displacement)
        points = replace(self.points, lines=there.layout.wall.contacts.lines)
        return replace(self, problem=there, points=points, load=load)

    def moved(self, change: LineChange, length: float, problem: CoupledProblem) -> Self:
        """The state after a `length` of a change, under the equations of `problem` before the journal's move."""
        j = len(self.held_reaction)
        return replace(
            self,
            problem=problem.at(displacement=problem.displacement + length * change.displacement),
            x=self.x + length * change.x,
            points=self.points.moved(length * change.phi),
            reaction=self.reaction + length * change.reaction[j:],
            held_reaction=self.held_reaction + length * change.reaction[:j],
        )

    def foretold(self, more: Array, faster: float = 0.0) -> LineContacts:
        """The state under `more` load (n_position,) and a part `faster`, by the tangent alone; one factorisation.

        Raises
        ------
        ValueError
            It is at a fixed position.
        """
        if self.load is None:
            raise ValueError("a state at a fixed position carries no load")
        problem = self.problem.at(bearing_number=self.problem.bearing_number * (1.0 + faster))
        there = replace(self, problem=problem, load=self.load + more)
        return stepped(there, LineTangent.of(self, self.motion.growing(0.0, current_run().probe_solver)))


StateOnLines = TypeVar("StateOnLines", bound=LineContacts)
"""A state, at rest or in a step in time."""


class NoLinesError(ArithmeticError):
    """No equilibrium with contact points between nodes was found; it says why."""


def stepped(state: LineContacts, tangent: LineTangent) -> LineContacts:
    """The state after a Newton step with a tangent that serves its contacts.

    Raises
    ------
    NoLinesError
        The film has closed, or the step is no number.
    """
    return changed(state, tangent, step_of(state, tangent), TRUST)


def step_of(state: LineContacts, tangent: LineTangent) -> LineChange:
    """The Newton step from a state, (C11) and (C12)."""
    way = np.zeros_like(state.force) if state.load is None else None
    return tangent.correction(state, LineResiduals.of(state), way)


def changed(state: StateOnLines, tangent: LineTangent, change: LineChange, trust: float) -> StateOnLines:
    """The state after a change by a tangent, shortened where pressures would vanish.

    Points travel `trust` cells at most.

    Raises
    ------
    NoLinesError
        The film has closed, or the step is no number.
    """
    farthest = trust * state.points.cell_length
    length = positive_step(state.problem, state.x, change.x)
    there = replace(change, phi=np.clip(length * change.phi, -farthest, farthest) / length)
    moved = state.moved(there, length, state.problem)
    ahead = replace(moved, points=replace(moved.points, before=tangent.numbers), tangent=tangent)
    if not np.all(np.isfinite(ahead.x)) or not ahead.problem.admits(ahead.x):
        raise NoLinesError("the film closes in a Newton step")
    return ahead
