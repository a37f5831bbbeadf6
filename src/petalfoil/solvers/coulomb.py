"""Contact with Coulomb friction as a small dense problem: which contacts are active, and which stick or slip.

The linearised equations are known by what a unit of each opening, reaction and friction force does (`ContactSpace`).
For gaps `g`, reactions `lam`, slips `sigma` since the step began and friction forces `T`,

    0 <= g _|_ lam >= 0 ,      |T| <= mu lam ,      T = mu lam sign(sigma) where sigma != 0                  (M6)

Every state of the contacts (open; closed and sticking, slipping forward or backward) makes (M6) linear. States of wrong
sign change all at once, then one by one (Murty 1974). Where that returns to former ones, the limits of friction follow
the reactions: with given limits the problem is monotone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.solvers.lcp import solve_lcp

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

AT_ONCE, ONE_BY_ONE = 20, 60
"""Most changes of all wrong states at once, and of single ones: five to ten are typical."""

FOLLOWED = 12
"""Times that the friction's limits follow the reactions where the states do not settle."""

ROUNDING = 1e-10
"""A quantity of wrong sign this small over the largest of its kind is zero."""


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
    """

    held: Mask
    answer: Array
    slip: Array
    rubs: Index
    coefficient: float


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
    """A solution of (M6): unknowns and answers of the contacts (m,), friction forces and slips (f,), states."""

    unknown: Array
    answer: Array
    friction: Array
    slip: Array
    states: States

    def reaction(self, space: ContactSpace) -> Array:
        """Reactions of all contacts, (m,)."""
        return np.where(self.states.closed, np.maximum(np.where(space.held, self.answer, self.unknown), 0.0), 0.0)


def contact_forces(space: ContactSpace, constant: tuple[Array, Array], guess: States) -> ContactForces | None:
    """Solve (M6), None if it is not found; `constant` are answers (m,) and slips (f,) without any unknowns."""
    found = by_states(space, constant, guess)
    if found is not None:
        return found
    # limits that follow the reactions: each is a convex problem, whose states are a better guess
    limit = np.zeros(len(space.rubs))
    for _ in range(FOLLOWED):
        z = with_limits(space, constant, limit)
        if z is None:
            return None
        answer, slip = space.answer @ z + constant[0], space.slip @ z + constant[1]
        m = len(space.held)
        reaction = np.where(space.held, answer, z[:m])
        touching = reaction > ROUNDING * np.max(reaction, initial=0.0)
        slides = np.abs(z[m:]) >= (1.0 - ROUNDING) * limit
        states = States(touching, np.where(slides, np.sign(slip), 0.0).astype(np.intp))
        found = by_states(space, constant, states)
        if found is not None:
            return found
        limit = 0.5 * (limit + space.coefficient * np.maximum(reaction, 0.0)[space.rubs])
    return None


def with_limits(space: ContactSpace, constant: tuple[Array, Array], limit: Array) -> Array | None:
    """Unknowns and friction forces (m + f,) where the friction's limits are given: a monotone problem.

    answer >= 0 _|_ unknown ,      c - sigma >= 0 _|_ T + limit ,      limit - T >= 0 _|_ c
    """
    m, f = len(space.held), len(limit)
    M = np.block([
        [space.answer, np.zeros((m, f))],
        [-space.slip, np.eye(f)],
        [np.zeros((f, m)), -np.eye(f), np.zeros((f, f))],
    ])  # fmt: skip
    least = np.concatenate([np.zeros(m), -limit])
    q = np.concatenate([constant[0] + space.answer @ least, -constant[1] - space.slip @ least, 2.0 * limit])
    z = solve_lcp(M, q, np.zeros(m + 2 * f, dtype=bool))
    return None if z is None else z[: m + f] + least


def by_states(space: ContactSpace, constant: tuple[Array, Array], guess: States) -> ContactForces | None:
    """Change all wrong states at once, where that returns to former ones the first of them; None after many."""
    states, seen = guess, set[bytes]()
    for count in range(AT_ONCE + ONE_BY_ONE):
        found = of_states(space, constant, states)
        if found is None:
            return None
        wrong_contacts, slips = wrong(space, found)
        wrong_slips = slips != states.slips
        if not wrong_contacts.any() and not wrong_slips.any():
            return found
        if count >= AT_ONCE or states.key in seen:
            wrong_contacts, wrong_slips = first_of(wrong_contacts, wrong_slips)
        seen.add(states.key)
        states = States(states.closed ^ wrong_contacts, np.where(wrong_slips, slips, states.slips))
    return None


def first_of(wrong_contacts: Mask, wrong_slips: Mask) -> tuple[Mask, Mask]:
    """The first wrong state alone."""
    both = np.concatenate([wrong_contacts, wrong_slips])
    first = np.zeros_like(both)
    first[np.argmax(both)] = True
    return first[: len(wrong_contacts)], first[len(wrong_contacts) :]


def of_states(space: ContactSpace, constant: tuple[Array, Array], states: States) -> ContactForces | None:
    """Unknowns of contacts in given states; None if these do not determine them."""
    m, f = len(space.held), len(space.rubs)
    moves = space.held != states.closed  # an opening of what was held, or a reaction of what was open
    touching = states.closed[space.rubs]
    sticks, slides = touching & (states.slips == 0), touching & (states.slips != 0)
    # reactions in terms of all unknowns: an answer of a held contact, an unknown of an open one
    by_unknowns = np.where(space.held[:, None], space.answer, np.eye(m, m + f))
    limit = (space.coefficient * states.slips)[:, None] * by_unknowns[space.rubs]
    limit_0 = space.coefficient * states.slips * np.where(space.held, constant[0], 0.0)[space.rubs]
    rows = np.vstack([
        space.answer[moves], space.slip[sticks], (np.eye(f, m + f, m) - limit)[slides]
    ])  # fmt: skip
    right = -np.concatenate([constant[0][moves], constant[1][sticks], -limit_0[slides]])
    free = np.concatenate([moves, touching])
    z = np.zeros(m + f)
    try:
        z[free] = np.linalg.solve(rows[:, free], right)
    except np.linalg.LinAlgError:
        return None
    answer, slip = space.answer @ z + constant[0], space.slip @ z + constant[1]
    return ContactForces(z[:m], answer, z[m:], slip, states)


def wrong(space: ContactSpace, found: ContactForces) -> tuple[Mask, Index]:
    """Contacts in a wrong state (m,), and the directions of slip that the friction forces ask for (f,)."""
    closed, slips = found.states.closed, found.states.slips
    reaction = np.where(space.held, found.answer, found.unknown)
    gap = np.where(space.held, found.unknown, found.answer)
    push, far = np.max(np.abs(reaction), initial=0.0), np.max(np.abs(gap[~closed]), initial=0.0)
    moved = np.max(np.abs(found.slip), initial=0.0)
    bad = np.where(closed, reaction < -ROUNDING * push, gap < -ROUNDING * max(far, 1.0))
    limit = space.coefficient * np.maximum(reaction, 0.0)[space.rubs]
    over = np.where(np.abs(found.friction) > limit + ROUNDING * push, np.sign(found.friction), 0.0)
    back = slips * found.slip < -ROUNDING * max(moved, 1.0)
    wanted = np.where(slips == 0, over, np.where(back, 0, slips))
    touching = closed[space.rubs]
    return bad, np.where(touching, wanted, 0).astype(np.intp)
