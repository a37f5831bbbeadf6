"""What openings, reactions and friction forces of a few contacts do to linearised equations: columns of one factor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.coulomb import ContactForces, ContactSpace, KnownForces, States, contact_forces
from petalfoil.solvers.coulomb_disk import disk_forces
from petalfoil.solvers.tangent import BorderedTangent, GapRows

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class RubbingContacts:
    """Gaps that rub.

    Attributes
    ----------
    slip : (k, n) sparse
        Slip of each, from the unknowns. Where they slip in a plane it is followed by that across, (2 k, n).
    gap : (k,) int array
        Gap whose reaction limits it.
    coefficient : float
        `mu`.
    """

    slip: sp.csr_array
    gap: Index
    coefficient: float

    @property
    def directions(self) -> int:
        """Directions of slip, 1 or 2."""
        return int(self.slip.shape[0] // max(len(self.gap), 1))

    def at(self, contacts: Index) -> Index:
        """Those among some gaps."""
        return np.flatnonzero(np.isin(self.gap, contacts))

    def every_slip(self, at: Index) -> Index:
        """Rows of `slip` of some that rub."""
        return np.concatenate([at + direction * len(self.gap) for direction in range(self.directions)])


@dataclass(frozen=True)
class Unit:
    """Change of the unknowns (n,) and of all reactions (m,), and of all gaps (m,) by bordered unknowns."""

    change: Array
    reactions: Array
    gaps: Array | float


@dataclass(frozen=True)
class KnownState:
    """A state of all contacts near the one that is asked for.

    Attributes
    ----------
    closed : (m,) bool array
        Contacts that are closed.
    slips : (k,) int array
        Directions of slip, 0 where a contact sticks. In a plane 1 where it slips, once for each direction, (2 k,).
    gap, reaction : (m,) array
        Of all gaps.
    friction, slip : (k,) array
        Friction forces, and slips since the step began; in a plane (2 k,).
    """

    closed: Mask
    slips: Index
    gap: Array
    reaction: Array
    friction: Array
    slip: Array


def columns(vectors: Sequence[Array], length: int) -> Array:
    """The matrix with these columns, (length, number of vectors): also of none, where no contact is near."""
    return np.column_stack(vectors) if vectors else np.zeros((length, 0))


@dataclass(frozen=True)
class UnitResponses:
    """Changes of the unknowns by a unit of each opening, reaction and friction force.

    Attributes
    ----------
    contacts : (m,) int array
        Gaps that may open or close.
    rubbing : (f,) int array
        Places among the slips of those that rub; in a plane those across follow, (2 f,).
    change : (n, m + f) array
        Changes of the unknowns.
    space : ContactSpace
        The same as seen by the contacts.
    """

    contacts: Index
    rubbing: Index
    change: Array
    space: ContactSpace

    @classmethod
    def of(
        cls,
        tangent: BorderedTangent,
        gap_rows: GapRows,
        contacts: Index,
        rubbing: RubbingContacts,
        answered: Callable[[Unit], Unit] = lambda unit: unit,
    ) -> UnitResponses:
        """A solve for each; `answered` adds what bordered unknowns do in answer to a unit."""
        (G, acting), held, at = gap_rows, tangent.constraints.held, rubbing.at(contacts)
        sliding = rubbing.every_slip(at)
        rows, slips, none = sp.csr_array(G[contacts]), sp.csr_array(rubbing.slip[sliding]), np.zeros(G.shape[1])
        pushes = sp.csr_array(acting[contacts])
        units = []
        for place, gap in enumerate(contacts):
            if held[gap]:
                opening = np.zeros(len(held))
                opening[gap] = -1.0
                units.append(tangent.respond(none, opening))
            else:
                change, reactions = tangent.respond(-pushes[[place]].toarray()[0])
                reactions[gap] = 1.0  # the unit itself, which bordered unknowns feel too
                units.append((change, reactions))
        units += [tangent.respond(slips[[place]].toarray()[0]) for place in range(len(sliding))]
        moved = [answered(Unit(change, reactions, 0.0)) for change, reactions in units]
        change = columns([unit.change for unit in moved], G.shape[1])
        reactions = columns([unit.reactions[contacts] for unit in moved], len(contacts))
        own = columns([np.broadcast_to(unit.gaps, len(held))[contacts] for unit in moved], len(contacts))
        gaps = rows @ change + own
        place_of = np.full(len(held), -1)
        place_of[contacts] = np.arange(len(contacts))
        answer = np.where(held[contacts][:, None], reactions, gaps)
        stuck = np.ones(len(sliding) - len(at)), np.zeros(len(sliding) - len(at))
        rubs = place_of[rubbing.gap[at]]
        space = ContactSpace(held[contacts], answer, slips @ change, rubs, rubbing.coefficient, stuck)
        return cls(contacts, sliding, change, space)

    def solved(self, base: tuple[Array, Array, Array], slip: Array, known: KnownState) -> ContactForces | None:
        """Forces from what the factor gives alone: unknowns' change (n,), reactions and gaps (m,), slips (k,)."""
        _, reactions, gaps = base
        contacts, rubbing = self.contacts, self.rubbing
        answer = np.where(self.space.held, reactions[contacts], gaps[contacts])
        states = States(known.closed[contacts], known.slips[rubbing[: len(self.space.rubs)]])
        normal, tangential = (
            (known.gap[contacts], known.reaction[contacts]),
            (known.friction[rubbing], known.slip[rubbing]),
        )
        if self.space.planar:
            return disk_forces(self.space, (answer, slip[rubbing]), KnownForces(states, *normal, *tangential))
        forces = KnownForces.of(self.space, states, normal, tangential)
        return contact_forces(self.space, (answer, slip[rubbing]), forces)
