"""A state of a path with friction on contact lines: displacements, contacts, and what acts at them (3-D)."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import SLIDES, friction_on_lines

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class PulledLines(LineContacts):
    """Contact lines of a pack whose petals rub, under a film at rest.

    Attributes
    ----------
    pulls : (n,) array
        `B^T T` among all unknowns.
    """

    pulls: Array = field(default_factory=lambda: np.zeros(0), kw_only=True)

    @cached_property
    def rows(self) -> Array:
        """Residual of (C11) with the friction forces, (n,)."""
        return super().rows + self.pulls


@dataclass(frozen=True)
class RubbingLines(LineContacts):
    """A state of a path without film; its unknowns are the displacements of the petals.

    Attributes
    ----------
    pack : FoilPackProblem
        The pack round its journal.
    friction : Friction
        The law between its petals, in two directions.
    force : (2, j + k) array
        Friction forces along the petals and along the shaft, of contacts at nodes, then at points.
    lost : float
        Energy lost in the step, over the units of force and length [1].
    """

    pack: FoilPackProblem = field(kw_only=True)
    friction: Friction = field(kw_only=True)
    force: Array = field(kw_only=True)
    lost: float = field(default=0.0, kw_only=True)

    @cached_property
    def gaps(self) -> Array:
        """Gaps at all nodes, (m,)."""
        return self.pack.gaps(self.x)

    @property
    def reactions(self) -> Array:
        """Reactions of all contacts, (j + k,)."""
        return np.concatenate([self.held_reaction, self.reaction])

    @cached_property
    def gap_rows(self) -> sp.csr_array:
        """Derivatives of the gaps of all contacts, (j + k, n)."""
        at_nodes = sp.csr_array(self.pack.G[np.flatnonzero(self.held)])
        return sp.csr_array(sp.vstack([at_nodes, self.points.value @ self.pack.G]))

    @cached_property
    def slope_rows(self) -> sp.csr_array:
        """Derivatives of the slopes at the points, (k, n)."""
        return sp.csr_array(self.points.slope @ self.pack.G)

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
        return np.asarray(self.law.slip.T @ self.force.ravel())

    @cached_property
    def residual(self) -> float:
        """Largest scaled residual of rows, gaps and slopes; a slope counts over a cell."""
        linearized = self.pack.linearize(self.x)
        rows = (linearized.residual - self.gap_rows.T @ self.reactions + self.pulls) / linearized.row_scale
        lengths = np.concatenate([self.closed, self.slopes * self.points.cell_length])
        return max(float(np.max(np.abs(rows))), float(np.max(np.abs(lengths), initial=0.0)))

    def slid(self, x: Array) -> Array:
        """Sizes of the slips of all contacts since displacements `x` (n,), (j + k,)."""
        return np.asarray(np.linalg.norm((self.law.slip @ (self.x - x)).reshape(2, -1), axis=0))

    def creep(self, x: Array) -> float:
        """Largest slip since displacements `x` (n,) of a contact that sticks."""
        sticks = np.linalg.norm(self.force, axis=0) < (1.0 - SLIDES) * self.limit
        return float(np.max(self.slid(x)[sticks], initial=0.0))

    def at_gaps(self, forces: Array) -> Array:
        """Forces of all contacts (j + k,) at the gaps of the nodes beside each, (m,)."""
        j = len(self.held_reaction)
        out: Array = self.points.shares.T @ forces[j:]
        out[self.held] += forces[:j]
        return out

    def on(self, contacts: LineContacts, force: Array) -> RubbingLines:
        """The state with other contacts, and their friction forces (2, j + k)."""
        return replace(
            self,
            points=contacts.points,
            reaction=contacts.reaction,
            held=contacts.held,
            held_reaction=contacts.held_reaction,
            force=force,
        )

    def in_film(self, problem: CoupledProblem) -> PulledLines:
        """The same under a film at rest, which `problem` has at ambient pressure."""
        x = problem.layout.ambient(self.x)
        pulls = np.zeros(len(x))
        pulls[: len(self.x)] = self.pulls
        own = self.points, self.reaction, self.held, self.held_reaction
        return PulledLines(problem, x, *own, load=None, pulls=pulls)


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
