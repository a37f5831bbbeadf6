"""Contact with Coulomb friction as a small dense problem: which contacts are active, and which stick or slip.

The linearised equations are known by what a unit of each opening, reaction and friction force does (`ContactSpace`).
For gaps `g`, reactions `lam`, slips `sigma` since the step began and friction forces `T`,

    0 <= g _|_ lam >= 0 ,      |T| <= mu lam ,      T = mu lam sign(sigma) where sigma != 0                  (M6)

Every state of the contacts (open; closed and sticking, slipping forward or backward) makes (M6) linear. States of wrong
sign change all at once. Where that returns to former ones, the constants are led from those that the known forces solve
to those that are asked for, and contacts change their state one after another where they must (Katzenelson 1965).

Contacts that slip in a plane have a second force across the first one, with a linear law of its own (M12): it serves
the law of a disk (`solvers/coulomb_disk.py`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

AT_ONCE = 20
"""Most changes of all wrong states at once: five to ten are typical."""

EVENTS = 120
"""Most changes of state along the way from known forces: some ten are typical, for more a shorter step is cheaper."""

ROUNDING = 1e-10
"""A quantity of wrong sign this small over the largest of its kind is zero; so is this part of the way from what is
known."""


@dataclass(frozen=True)
class ContactSpace:
    """The linearised equations as seen by `m` contacts, of which `f` rub.

    Unknowns of a contact are its opening where the factor holds it closed, and its reaction where it is open; what
    answers is its reaction or its gap.

    Attributes
    ----------
    held : (m,) bool array
        Contacts that the factor holds closed.
    answer : (m, m + f) array
        What answers, by the unknowns of all contacts and the friction forces.
    slip : (f, m + f) array
        Slips by the same.
    rubs : (f,) int array
        Contact that limits each friction force.
    coefficient : float
        `mu`.
    across : pair of (f,) arrays, or of empty ones
        `(a, b)` of the slip and the force across, of contacts that slip in a plane: `a sigma = b T` while closed. Slips
        and friction forces are then those along of all contacts, followed by those across: `f` more of each.
    """

    held: Mask
    answer: Array
    slip: Array
    rubs: Index
    coefficient: float
    across: tuple[Array, Array] = (np.zeros(0), np.zeros(0))

    @property
    def planar(self) -> bool:
        """Whether contacts slip in a plane."""
        return len(self.across[0]) > 0


@dataclass(frozen=True)
class States:
    """State of every contact and of every friction force.

    Attributes
    ----------
    closed : (m,) bool array
        Contacts that are closed.
    slips : (f,) int array
        Direction of slip, 0 where a contact sticks; of no meaning where it is open.
    """

    closed: Mask
    slips: Index

    @property
    def key(self) -> bytes:
        """The same as bytes."""
        return self.closed.tobytes() + self.slips.tobytes()


@dataclass(frozen=True)
class ContactForces:
    """A solution of (M6): unknowns and answers of the contacts (m,), friction forces and slips (f,), states.

    In a plane forces and slips along come first, then those across, (2 f,).
    """

    unknown: Array
    answer: Array
    friction: Array
    slip: Array
    states: States

    def reaction(self, space: ContactSpace) -> Array:
        """Reactions of all contacts, (m,)."""
        return np.where(self.states.closed, np.maximum(np.where(space.held, self.answer, self.unknown), 0.0), 0.0)


@dataclass(frozen=True)
class KnownForces:
    """A solution of (M6) near the one that is asked for, with constants of its own.

    Attributes
    ----------
    states : States
        Those of its contacts.
    gap, reaction : (m,) array
        One of them is zero.
    friction, slip : (f,) array, (2 f,) in a plane
        Within the limits, and against each other.
    """

    states: States
    gap: Array
    reaction: Array
    friction: Array
    slip: Array

    @classmethod
    def of(
        cls, space: ContactSpace, states: States, normal: tuple[Array, Array], tangential: tuple[Array, Array]
    ) -> KnownForces:
        """From gaps and reactions (m,), friction forces and slips (f,): what contradicts the states is left out."""
        (gap, reaction), f = normal, len(space.rubs)
        closed, touching = states.closed, states.closed[space.rubs]
        (friction, across), (slip, moved_across) = (np.split(part, [f]) for part in tangential)
        pushing = np.where(closed, np.maximum(reaction, 0.0), 0.0)
        limit = space.coefficient * pushing[space.rubs]
        slides = states.slips != 0
        force = np.where(slides, states.slips * limit, np.clip(friction, -limit, limit))
        moved = np.where(touching, np.where(slides, states.slips * np.abs(slip), 0.0), slip)
        force = np.where(touching, force, 0.0)
        if space.planar:
            a, b = space.across
            along_law = (a * across + b * moved_across) / (a * a + b * b)
            force = np.concatenate([force, np.where(touching, a * along_law, 0.0)])
            moved = np.concatenate([moved, np.where(touching, b * along_law, moved_across)])
        states = States(closed, np.where(touching, states.slips, 0))
        return cls(states, np.where(closed, 0.0, np.maximum(gap, 0.0)), pushing, force, moved)


def contact_forces(space: ContactSpace, constant: tuple[Array, Array], known: KnownForces) -> ContactForces | None:
    """Solve (M6), None if it is not found; `constant` are answers (m,) and slips (f,) without any unknowns."""
    return by_states(space, constant, known.states) or led(space, constant, known)


def led(space: ContactSpace, constant: tuple[Array, Array], known: KnownForces) -> ContactForces | None:
    """Lead the constants from those of `known` to those asked for, contact by contact; None if that does not arrive.

    Along the way the solution is linear until a contact must change its state. It goes on in the new one, where a
    contact snaps with the constants on their way back.
    """
    z = np.concatenate([np.where(space.held, known.gap, known.reaction), known.friction])
    answer = np.where(space.held, known.reaction, known.gap)
    start = answer - space.answer @ z, known.slip - space.slip @ z
    ahead = constant[0] - start[0], constant[1] - start[1]
    states, part, flipped, seen = known.states, 0.0, -1, set[bytes]()
    for _ in range(EVENTS):
        if states.key in seen:
            return None  # rounding leads round in a circle: the way passes each combination of states once
        seen.add(states.key)
        both = of_each(space, [start, ahead], states)
        if both is None:
            return None
        here, rate = both
        at, by = margins(space, here), margins(space, rate)
        way = 1.0 if flipped < 0 else float(np.sign(by[flipped]))
        falls = np.isfinite(at) & (by * way < 0.0)
        if flipped >= 0:
            falls[flipped] = False
        length = np.full(len(at), np.inf)
        length[falls] = np.maximum(-(at[falls] + part * by[falls]) / (by[falls] * way), 0.0)
        first = int(np.argmin(length))
        if way == 0.0 or (way > 0.0 and part + length[first] >= 1.0):
            break
        part += way * float(length[first])
        if part < -ROUNDING:
            return None
        states, flipped = changed(space, states, first, here.slip + part * rate.slip)
    found = of_states(space, constant, states)
    if found is None:
        return None
    bad, slips = wrong(space, found)
    return None if bad.any() or np.any(slips != states.slips) else found


def margins(space: ContactSpace, found: ContactForces) -> Array:
    """How far each contact is from another state, (m + 3 f,): its gap or reaction, both limits of friction, its slip.

    Infinite where a contact is in no such state.
    """
    closed, slips, f = found.states.closed, found.states.slips, len(space.rubs)
    reaction = np.where(space.held, found.answer, found.unknown)
    gap = np.where(space.held, found.unknown, found.answer)
    limit, touching = space.coefficient * reaction[space.rubs], closed[space.rubs]
    sticks = touching & (slips == 0)
    upper, lower = (np.where(sticks, limit - sign * found.friction[:f], np.inf) for sign in (1.0, -1.0))
    slid = np.where(touching & (slips != 0), slips * found.slip[:f], np.inf)
    return np.concatenate([np.where(closed, reaction, gap), upper, lower, slid])


def changed(space: ContactSpace, states: States, margin: int, slip: Array) -> tuple[States, int]:
    """The states after a `margin` has vanished, and the margin that grows from there."""
    m, f = len(states.closed), len(states.slips)
    closed, slips = states.closed.copy(), states.slips.copy()
    if margin < m:
        closed[margin] = not closed[margin]
        own = space.rubs == margin  # a contact that closes has slipped since the step began
        slips[own] = np.where(closed[margin], np.sign(slip[:f][own]), 0.0)
        return States(closed, slips), margin
    kind, place = divmod(margin - m, f)
    if kind < SLIP:
        slips[place] = 1 if kind == 0 else -1
        return States(closed, slips), m + SLIP * f + place
    back = 0 if slips[place] > 0 else 1
    slips[place] = 0
    return States(closed, slips), m + back * f + place


SLIP = 2
"""Place of the slips behind both limits of friction."""


def by_states(space: ContactSpace, constant: tuple[Array, Array], guess: States) -> ContactForces | None:
    """Change all wrong states at once; None where that returns to former ones."""
    states, seen = guess, set[bytes]()
    for _ in range(AT_ONCE):
        found = of_states(space, constant, states)
        if found is None:
            return None
        wrong_contacts, slips = wrong(space, found)
        wrong_slips = slips != states.slips
        if not wrong_contacts.any() and not wrong_slips.any():
            return found
        seen.add(states.key)
        states = States(states.closed ^ wrong_contacts, np.where(wrong_slips, slips, states.slips))
        if states.key in seen:
            return None
    return None


def of_states(space: ContactSpace, constant: tuple[Array, Array], states: States) -> ContactForces | None:
    """Unknowns of contacts in given states; None if these do not determine them."""
    found = of_each(space, [constant], states)
    return None if found is None else found[0]


def of_each(space: ContactSpace, constants: list[tuple[Array, Array]], states: States) -> list[ContactForces] | None:
    """The same for several constants at once."""
    m, f = len(space.held), len(space.rubs)
    moves = space.held != states.closed  # an opening of what was held, or a reaction of what was open
    touching, n = states.closed[space.rubs], space.answer.shape[1]
    sticks, slides = (np.flatnonzero(touching & part) for part in (states.slips == 0, states.slips != 0))
    at, grip = space.rubs[slides], space.coefficient * states.slips[slides]
    over = np.flatnonzero(touching) if space.planar else np.zeros(0, dtype=np.intp)
    a, b = (part[over] for part in space.across) if space.planar else (over, over)
    free = np.flatnonzero(np.concatenate([moves, touching, *([touching] if space.planar else [])]))
    place = np.zeros(n, dtype=np.intp)
    place[free] = np.arange(len(free))
    by_reaction, held = space.answer[np.ix_(at, free)], space.held[at]
    by_reaction[~held] = 0.0  # reactions are answers of held contacts, unknowns of open ones
    by_reaction[np.flatnonzero(~held), place[at[~held]]] = 1.0
    slid, crossed = -grip[:, None] * by_reaction, a[:, None] * space.slip[np.ix_(f + over, free)]
    slid[np.arange(len(slides)), place[m + slides]] += 1.0
    crossed[np.arange(len(over)), place[m + f + over]] -= b
    rows = np.concatenate([space.answer[np.ix_(moves, free)], space.slip[np.ix_(sticks, free)], slid, crossed])
    right = [
        -np.concatenate(
            [answer[moves], slip[sticks], -grip * np.where(space.held, answer, 0.0)[at], a * slip[f + over]]
        )
        for answer, slip in constants
    ]
    z = np.zeros((n, len(constants)))
    try:
        z[free] = np.linalg.solve(rows, np.column_stack(right))
    except np.linalg.LinAlgError:
        return None
    answers, slips = space.answer @ z, space.slip @ z
    return [
        ContactForces(z[:m, k], answers[:, k] + answer, z[m:, k], slips[:, k] + slip, states)
        for k, (answer, slip) in enumerate(constants)
    ]


def wrong(space: ContactSpace, found: ContactForces) -> tuple[Mask, Index]:
    """Contacts in a wrong state (m,), and the directions of slip that the friction forces ask for (f,)."""
    closed, slips = found.states.closed, found.states.slips
    reaction = np.where(space.held, found.answer, found.unknown)
    gap = np.where(space.held, found.unknown, found.answer)
    push, far = np.max(np.abs(reaction), initial=0.0), np.max(np.abs(gap[~closed]), initial=0.0)
    moved = np.max(np.abs(found.slip), initial=0.0)
    bad = np.where(closed, reaction < -ROUNDING * push, gap < -ROUNDING * max(far, 1.0))
    friction, slip = (part[: len(space.rubs)] for part in (found.friction, found.slip))
    limit = space.coefficient * np.maximum(reaction, 0.0)[space.rubs]
    over = np.where(np.abs(friction) > limit + ROUNDING * push, np.sign(friction), 0.0)
    back = slips * slip < -ROUNDING * max(moved, 1.0)
    wanted = np.where(slips == 0, over, np.where(back, 0, slips))
    touching = closed[space.rubs]
    return bad, np.where(touching, wanted, 0).astype(np.intp)
