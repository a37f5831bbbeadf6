"""What openings, reactions and friction forces of a few contacts do to linearised equations: columns of one factor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.constraints import places_among
from petalfoil.solvers.coulomb import ContactForces, ContactSpace, KnownForces, States, contact_forces
from petalfoil.solvers.coulomb_disk import disk_forces
from petalfoil.solvers.problem import Border
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
class Follower:
    """What bordered unknowns do in answer to forces.

    Attributes
    ----------
    border : Border
        How they enter.
    units : (n, d) array
        Change of the unknowns by a unit of each.
    pushed : (m, d) array
        Change of all reactions by the same.
    stiffness : (d, d) array
        What resists them.
    """

    border: Border
    units: Array
    pushed: Array
    stiffness: Array

    def moved(self, change: Array, reactions: Array) -> Array:
        """Their change, (d, k), by changes of the unknowns (n, k) and of all reactions (m, k)."""
        return np.linalg.solve(self.stiffness, self.border.rows(change, reactions))


@dataclass(frozen=True)
class Units:
    """Changes by a unit of each of `k` openings, reactions and friction forces.

    Attributes
    ----------
    change : (n, k) array
        Of the unknowns.
    reactions : (h, k) array
        Of the reactions that the factor holds.
    moved : (d, k) array
        Of the bordered unknowns.
    """

    change: Array
    reactions: Array
    moved: Array

    @classmethod
    def of(
        cls, tangent: BorderedTangent, forces: sp.csr_array, openings: Index, own: Index, follower: Follower | None
    ) -> Units:
        """Of `k` rows of forces (k, n), in each of which a held gap opens, or an open one has a unit reaction.

        `openings` are their places among the held gaps and `own` their numbers among all, -1 for none, (k,).
        """
        held, none = tangent.constraints.held, Units.none(tangent, follower)
        parts = [none]
        for start in range(0, forces.shape[0], TOGETHER):
            some = slice(start, start + TOGETHER)
            pushes = forces[some].toarray().T
            change, reactions = tangent.tangent.respond_each(pushes, openings[some])
            moved = np.zeros((len(none.moved), change.shape[1]))
            if follower is not None:
                every = np.zeros((len(held), change.shape[1]))
                every[held] = reactions
                pushed = np.flatnonzero(own[some] >= 0)
                every[own[some][pushed], pushed] = 1.0  # the unit itself, which bordered unknowns feel too
                moved = follower.moved(change, every)
                change, reactions = change + follower.units @ moved, reactions + follower.pushed[held] @ moved
            parts.append(cls(change, reactions, moved))
        return cls.joined(parts)

    @classmethod
    def none(cls, tangent: BorderedTangent, follower: Follower | None) -> Units:
        """Of nothing."""
        rows = tangent.tangent.matrix.shape[0], np.count_nonzero(tangent.constraints.held)
        return cls(*(np.zeros((count, 0)) for count in (*rows, 0 if follower is None else follower.border.size)))

    @classmethod
    def joined(cls, parts: Sequence[Units]) -> Units:
        """Those of several sets, one after another."""
        names = ("change", "reactions", "moved")
        return cls(*(np.concatenate([getattr(part, name) for part in parts], axis=1) for name in names))

    def at(self, places: Index) -> Units:
        """Some of them."""
        return Units(self.change[:, places], self.reactions[:, places], self.moved[:, places])


TOGETHER = 64
"""Units found at once: their reactions are of all gaps."""


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


@dataclass(frozen=True)
class UnitResponses:
    """What units of openings, reactions and friction forces do to linearised equations, for some of the contacts.

    Attributes
    ----------
    contacts : (m,) int array
        Gaps that may open or close.
    rubbing : (f,) int array
        Places among the slips of those that rub; in a plane those across follow, (2 f,).
    units : Units
        Of the contacts, then of the friction forces, (m + f,).
    space : ContactSpace
        The same as seen by the contacts.
    """

    contacts: Index
    rubbing: Index
    units: Units
    space: ContactSpace

    @property
    def change(self) -> Array:
        """Changes of the unknowns, (n, m + f)."""
        return self.units.change

    @classmethod
    def of(
        cls,
        tangent: BorderedTangent,
        gap_rows: GapRows,
        contacts: Index,
        rubbing: RubbingContacts,
        follower: Follower | None = None,
    ) -> UnitResponses:
        """A solve for each; `follower` adds what bordered unknowns do in answer to a unit."""
        sliding = rubbing.every_slip(rubbing.at(contacts))
        units = unit_responses(tangent, gap_rows, (contacts, sliding), rubbing, follower)
        return cls.seen((tangent, gap_rows, follower), (contacts, sliding), units, rubbing)

    def with_more(
        self,
        tangent: BorderedTangent,
        gap_rows: GapRows,
        more: Index,
        rubbing: RubbingContacts,
        follower: Follower | None = None,
    ) -> UnitResponses:
        """The same with more contacts, at a solve for each of them."""
        own = rubbing.every_slip(rubbing.at(more))
        added = unit_responses(tangent, gap_rows, (more, own), rubbing, follower)
        contacts = np.concatenate([self.contacts, more])
        sliding, both = rubbing.every_slip(rubbing.at(contacts)), Units.joined([self.units, added])
        behind = len(tangent.constraints.held)  # slips are numbered behind all gaps
        found = np.concatenate([self.contacts, behind + self.rubbing, more, behind + own])
        order = np.argsort(found)
        wanted = np.concatenate([contacts, behind + sliding])
        units = both.at(order[np.searchsorted(found, wanted, sorter=order)])
        return self.seen((tangent, gap_rows, follower), (contacts, sliding), units, rubbing)

    @classmethod
    def seen(
        cls,
        at: tuple[BorderedTangent, GapRows, Follower | None],
        numbers: tuple[Index, Index],
        units: Units,
        rubbing: RubbingContacts,
    ) -> UnitResponses:
        """Units of contacts and slips of given `numbers` as seen by the contacts."""
        (tangent, (G, _), follower), (contacts, sliding) = at, numbers
        held, along = tangent.constraints.held, rubbing.at(contacts)
        gaps = sp.csr_array(G[contacts]) @ units.change
        if follower is not None:
            gaps = gaps + follower.border.gap_derivative[contacts] @ units.moved
        closed = held[contacts]
        gaps[closed] = units.reactions[places_among(held)[contacts[closed]]]
        place_of = np.full(len(held), -1)
        place_of[contacts] = np.arange(len(contacts))
        stuck = np.ones(len(sliding) - len(along)), np.zeros(len(sliding) - len(along))
        slips = sp.csr_array(rubbing.slip[sliding]) @ units.change
        space = ContactSpace(closed, gaps, slips, place_of[rubbing.gap[along]], rubbing.coefficient, stuck)
        return cls(contacts, sliding, units, space)

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


def unit_responses(
    tangent: BorderedTangent,
    gap_rows: GapRows,
    numbers: tuple[Index, Index],
    rubbing: RubbingContacts,
    follower: Follower | None,
) -> Units:
    """Units of the contacts and slips of given `numbers`: openings of those held, reactions of the others, forces."""
    (contacts, sliding), held = numbers, tangent.constraints.held
    opens = held[contacts]
    pushes = sp.diags_array(np.where(opens, 0.0, -1.0)) @ sp.csr_array(gap_rows[1][contacts])
    forces = sp.csr_array(sp.vstack([pushes, rubbing.slip[sliding]]))
    none = np.full(len(sliding), -1)
    openings = np.concatenate([places_among(held)[contacts], none])
    own = np.concatenate([np.where(opens, -1, contacts), none])
    return Units.of(tangent, forces, openings, own, follower)
