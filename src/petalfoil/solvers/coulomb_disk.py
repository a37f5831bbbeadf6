"""Coulomb friction of contacts that slip in a plane: the law of a disk, by lines that turn.

    |T| <= mu lam ,      T = mu lam sigma / |sigma| where sigma != 0                                        (M11)

is the one equation `T = P(y)` with `y = T + rho sigma`, where `P` is the nearest point of the disk and `rho` any
positive number of each contact. Newton's method for it, at a state whose `y` has the direction `d`, reads for a contact
that slips

    T_d = mu lam ,      a sigma_c = b T_c ,      a = mu lam / |y| ,      b = (1 - a) / rho                  (M12)

along `d` and across it, and `sigma = 0` for one that sticks (`a` = 1). Along `d` the first equation is replaced by the
law of a line (M6), of which it is one state: the dense problem of `solvers/coulomb.py` then finds contacts, sticking
and slipping to and fro together, however far they are from those known, and Newton's method only turns directions.

Some friction forces move nothing: those along the shaft that alternate from node to node, as petals have their
displacements along the shaft at the cells between. Of all forces that solve (M11) those nearest to the known ones are
taken (`GIVE`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.coulomb import ContactForces, ContactSpace, KnownForces, States, contact_forces

Array = NDArray[np.float64]
Index = NDArray[np.intp]

TURNS = 30
"""Most corrections of the directions: five to twelve are typical."""

AGREE = 1e-10
"""Part of the largest limit of friction by which a force may miss the disk."""


GIVE, TIMES = 1e-9, 2
"""Part of the slip by a unit of its own force that a contact gives besides, counted from the force known: it determines
forces that move nothing, which would otherwise be rounding. Times that the forces found are taken as known: a contact
that sticks has then slipped by 1e-18 of what it would slip without friction."""

SETTLED = 1e-3
"""Change of friction forces, over the largest, that does not ask for a second time: contacts that stick have slipped by
1e-12 of what they would slip without friction."""


@dataclass(frozen=True)
class SlipLines:
    """Directions along which contacts slip, and what is known across them.

    Attributes
    ----------
    way : (2, f) array
        Unit vector `d` of each contact.
    across : pair of (f,) arrays
        `(a, b)` of (M12).
    """

    way: Array
    across: tuple[Array, Array]

    @classmethod
    def along(cls, y: Array, limit: Array, rho: Array) -> SlipLines:
        """Those of `y` (2, f); a contact without any direction has the first axis.

        Contacts that nothing moves across, as those in a plane of symmetry, have no force there.
        """
        size = np.linalg.norm(y, axis=0)
        somewhere = size > 0.0
        way = np.where(somewhere, y / np.where(somewhere, size, 1.0), np.array([[1.0], [0.0]]))
        a = np.divide(limit, size, out=np.ones_like(size), where=size > limit)
        return cls(way, (a, (1.0 - a) / rho))

    def only(self, touching: NDArray[np.bool_], rho: Array) -> SlipLines:
        """The same without force across where nothing touches: a contact that closes begins without any."""
        a, b = self.across
        return replace(self, across=(np.where(touching, a, 0.0), np.where(touching, b, 1.0 / rho)))

    def turned(self, vectors: Array) -> Array:
        """Components along and across, (..., 2 f), of vectors (..., 2 f) in the axes of the petals."""
        (x, z), (first, second) = self.way, np.split(vectors, 2, axis=-1)
        return np.concatenate([x * first + z * second, x * second - z * first], axis=-1)

    def turned_rows(self, vectors: Array) -> Array:
        """The same of columns of vectors, (2 f, j)."""
        (x, z), (first, second) = self.way[:, :, None], np.split(vectors, 2)
        return np.concatenate([x * first + z * second, x * second - z * first])

    def back(self, vectors: Array) -> Array:
        """Vectors in the axes of the petals from their components, (2 f,)."""
        (x, z), (along, across) = self.way, np.split(vectors, 2)
        return np.concatenate([x * along - z * across, z * along + x * across])

    def seen(self, space: ContactSpace) -> ContactSpace:
        """The contacts with friction along and across these directions."""
        m, f = len(space.held), len(space.rubs)
        answer, slip = space.answer.copy(), self.turned_rows(space.slip)
        answer[:, m:], slip[:, m:] = self.turned(answer[:, m:]), self.turned(slip[:, m:])
        a, b = self.across
        still = np.all(slip[f:] == 0.0, axis=1)
        return replace(space, answer=answer, slip=slip, across=(np.where(still, 0.0, a), np.where(still, 1.0, b)))


def disk_forces(space: ContactSpace, constant: tuple[Array, Array], known: KnownForces) -> ContactForces | None:
    """Solve (K4) and (M11), None if it is not found.

    `constant` are answers (m,) and slips (2 f,) without any unknowns. States that slip have the number 1.
    """
    found = None
    for _ in range(TIMES):
        found = turned_from(*giving(space, constant, known.friction), known)
        if found is None:
            return None
        changed, known = np.max(np.abs(found.friction - known.friction), initial=0.0), known_from(space, found)
        if changed <= SETTLED * np.max(np.abs(found.friction), initial=0.0):
            break
    return found


def turned_from(space: ContactSpace, constant: tuple[Array, Array], known: KnownForces) -> ContactForces | None:
    """The same of contacts that give a little.

    Directions begin as those known, and where no contacts are found with them, without friction across them.
    """
    rho = slip_resistance(space)
    limit = space.coefficient * known.reaction[space.rubs]
    moved = np.where(known.states.slips != 0, rho, 0.0) * known.slip.reshape(2, -1)
    lines = SlipLines.along(known.friction.reshape(2, -1) + moved, limit, rho)
    touching = known.states.closed[space.rubs]
    for rough in (lines.only(touching, rho), lines.only(np.zeros_like(touching), rho)):
        found = turning(space, constant, known, rough)
        if found is not None:
            return found
    return None


def giving(
    space: ContactSpace, constant: tuple[Array, Array], force: Array
) -> tuple[ContactSpace, tuple[Array, Array]]:
    """The problem of contacts that give a little with the change of their friction from `force` (2 f,)."""
    give, slip = np.tile(GIVE / slip_resistance(space), 2), space.slip.copy()
    slip[:, len(space.held) :] -= np.diag(give)
    return replace(space, slip=slip), (constant[0], constant[1] + give * force)


def turning(
    space: ContactSpace, constant: tuple[Array, Array], known: KnownForces, lines: SlipLines
) -> ContactForces | None:
    """The same from directions given, which Newton's method turns."""
    rho = slip_resistance(space)
    for _ in range(TURNS):
        turned = lines.seen(space)
        tangential = lines.turned(known.friction), lines.turned(known.slip)
        near = KnownForces.of(turned, known.states, (known.gap, known.reaction), tangential)
        found = contact_forces(turned, (constant[0], lines.turned(constant[1])), near)
        if found is None:
            return None
        force, slip, reaction = lines.back(found.friction), lines.back(found.slip), found.reaction(space)
        limit, touching = space.coefficient * reaction[space.rubs], found.states.closed[space.rubs]
        y = force.reshape(2, -1) + rho * slip.reshape(2, -1)
        missed, slides = off_disk(force.reshape(2, -1), y, limit)
        states = States(found.states.closed, np.where(touching & slides, 1, 0))
        if np.max(missed[touching], initial=0.0) <= AGREE * np.max(limit, initial=0.0):
            return replace(found, friction=force, slip=slip, states=states)
        known = known_from(space, replace(found, friction=force, slip=slip, states=states))
        lines = SlipLines.along(y, limit, rho)
    return None


def known_from(space: ContactSpace, found: ContactForces) -> KnownForces:
    """What is known once forces are found."""
    gap = np.where(found.states.closed, 0.0, np.where(space.held, found.unknown, found.answer))
    return KnownForces(found.states, gap, found.reaction(space), found.friction, found.slip)


def slip_resistance(space: ContactSpace) -> Array:
    """`rho`, the friction force that takes a unit of slip back at each contact, (f,)."""
    f = len(space.rubs)
    own = -np.diagonal(space.slip[:, len(space.held) :]).reshape(2, f)
    give = np.max(own, axis=0, initial=0.0)
    resistance: Array = 1.0 / np.where(give > 0.0, give, np.max(give, initial=1e-300))
    return resistance


def off_disk(force: Array, y: Array, limit: Array) -> tuple[Array, NDArray[np.bool_]]:
    """How far `T` is from `P(y)`, and whether `y` is outside the disk: the contact slips; (f,) each."""
    size = np.linalg.norm(y, axis=0)
    outside = size > limit
    nearest = y * np.divide(limit, size, out=np.ones_like(size), where=outside)
    return np.linalg.norm(force - nearest, axis=0), outside
