"""A state of a path with friction on contact lines: film, petals, contacts, and what acts at them (3-D).

wall, film   F(x) - G^T lam - n^T lam_c + B^T T = 0                                        (C11), (M14)
points       p = 0 ,  p' = 0           at each                                                     (C12)
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import CARRIED, LineContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, Border, ContactProblem
from petalfoil.system.friction import SLIDES, against_slip, friction_on_lines, slips
from petalfoil.system.loaded import load_scale

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class RubbingLines(LineContacts):
    """A state of a path: film and petals round a journal that is held, or balances a load.

    Attributes
    ----------
    friction : Friction
        The law between its petals, in two directions.
    friction_force : (2, j + k) array
        Along the petals and along the shaft, of contacts at nodes, then at points.
    lost : float
        Energy lost in the step, over the units of force and length [1].
    """

    friction: Friction = field(kw_only=True)
    friction_force: Array = field(kw_only=True)
    lost: float = field(default=0.0, kw_only=True)

    @property
    def equations(self) -> ContactProblem:
        """Equations that the unknowns are those of."""
        return self.problem

    @cached_property
    def rows(self) -> Array:
        """Residual of (C11) with the friction forces, (n,)."""
        return super().rows + self.pulls

    @cached_property
    def matrix(self) -> sp.csc_array:
        """Derivative of the rows by the unknowns, travel of the points included (E12), (n, n)."""
        return self.motion.steady

    @property
    def border(self) -> Border:
        """How the journal's position enters."""
        return self.motion.border

    @property
    def forcing(self) -> Array:
        """Derivative of the rows by the journal's position, (n, d)."""
        return self.motion.steady_forcing

    @property
    def border_stiffness(self) -> Array:
        """What resists the journal beside what the unknowns do (E13), (d, d)."""
        return np.asarray(self.springs + self.contacts.gradient)

    @property
    def elimination_key(self) -> Hashable | None:
        """States with equal keys share their elimination orders."""
        return self.motion.elimination_key

    @property
    def force_left(self) -> Array:
        """Force on the journal that is left where points are where slopes vanish (E13), (d,)."""
        return np.asarray(self.unbalanced - self.contacts.slope_by_e.T @ (self.travel_stiffness * self.slopes))

    @property
    def left(self) -> float:
        """Largest scaled residual; of the force that is left what is over what a solution leaves counts likewise."""
        force = float(np.linalg.norm(self.unbalanced)) / (1.0 if self.load is None else load_scale(self.load))
        return max(self.residual, force * RESIDUAL_TOLERANCE / CARRIED)

    @property
    def reactions(self) -> Array:
        """Reactions of all contacts, (j + k,)."""
        return np.concatenate([self.held_reaction, self.reaction])

    @cached_property
    def law(self) -> Friction:
        """Friction at the contacts."""
        return friction_on_lines(self.friction, self.held, self.points)

    @property
    def limit(self) -> Array:
        """`mu_p lam` of all contacts, (j + k,); contacts on the journal have friction with no petal."""
        own = np.diff(self.law.slip.indptr)[: len(self.reactions)] > 0
        return np.where(own, self.friction.coefficient * np.maximum(self.reactions, 0.0), 0.0)

    @property
    def pulls(self) -> Array:
        """`B^T T`, (n,)."""
        return against_slip(self.law, self.friction_force.ravel(), len(self.x))

    def slid(self, x: Array) -> Array:
        """Sizes of the slips of all contacts since unknowns `x` (n,), (j + k,)."""
        return np.asarray(np.linalg.norm(slips(self.law, self.x - x).reshape(2, -1), axis=0))

    def creep(self, x: Array) -> float:
        """Largest slip since unknowns `x` (n,) of a contact that sticks."""
        sticks = np.linalg.norm(self.friction_force, axis=0) < (1.0 - SLIDES) * self.limit
        return float(np.max(self.slid(x)[sticks], initial=0.0))

    def at_gaps(self, forces: Array) -> Array:
        """Forces of all contacts (j + k,) at the gaps of the nodes beside each, (m,)."""
        j = len(self.held_reaction)
        out: Array = self.points.shares.T @ forces[j:]
        out[self.held] += forces[:j]
        return out

    def shifted(self, change: Array, way: Array) -> Self:
        """The state after a change of the unknowns (n,) and of the journal's position (d,), contacts as they are."""
        return replace(self, x=self.x + change, problem=self.problem.at(displacement=self.problem.displacement + way))

    def on(self, contacts: LineContacts, force: Array) -> Self:
        """The state with other contacts, and their friction forces (2, j + k)."""
        return replace(
            self,
            points=contacts.points,
            reaction=contacts.reaction,
            held=contacts.held,
            held_reaction=contacts.held_reaction,
            friction_force=force,
        )


def places(state: LineContacts) -> tuple[Index, Array]:
    """Number of the line of each contact among those of all kinds, and its angle, (j + k,)."""
    own, phi = np.zeros(len(state.held), dtype=np.intp), np.zeros(len(state.held))
    first = np.cumsum([0, *(len(lines.number) for lines in state.points.lines)])
    for start, lines in zip(first, state.points.lines, strict=False):
        own[lines.number] = start + np.arange(len(lines.number))[:, None]
        phi[lines.number] = lines.phi
    at_points = first[state.points.kind] + state.points.line
    return np.concatenate([own[state.held], at_points]), np.concatenate([phi[state.held], state.points.phi])


def distances(some: tuple[Index, Array], others: tuple[Index, Array]) -> Array:
    """Angles between contacts by their `places`, (i, j) [rad]; infinite between those on other lines."""
    (line, phi), (other, place) = some, others
    return np.where(line[:, None] == other, np.abs(phi[:, None] - place), np.inf)


def matched(now: LineContacts, then: LineContacts) -> Index:
    """Number of each contact among those of `then`, the nearest on its line, and that to it; -1: none within a cell."""
    (line, phi), (before, place) = places(now), places(then)
    if not len(line) or not len(before):
        return np.full(len(line), -1)
    apart = distances((line, phi), (before, place))
    nearest, own = np.argmin(apart, axis=1), np.arange(len(line))
    mutual = (np.argmin(apart, axis=0)[nearest] == own) & (apart[own, nearest] <= now.points.mean_cell)
    return np.where(mutual, nearest, -1)
