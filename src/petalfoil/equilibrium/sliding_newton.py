"""Newton's method for film, wall and journal with petals that slide along themselves, contacts and friction exactly.

Every correction is that of the linearised equations with openings, reactions and friction forces of all contacts in
question as further unknowns, found together from a small dense problem (M6). The factor is that of the equations
without friction; the journal's position answers to every unit of them as in (O3). It serves stages in time and balances
under a load alike.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.coulomb_path import CLOSED, rubbing_of
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_equations import ContactEquations, ContactState, Correction
from petalfoil.solvers.contact_space import Follower, KnownState, RubbingContacts, UnitResponses
from petalfoil.solvers.coulomb import ContactForces
from petalfoil.solvers.problem import ContactProblem
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, GapRows, Tangent
from petalfoil.system.friction import FrictionState, against_slip, slipping, slips

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]
Rubs = tuple[GapRows, RubbingContacts]
"""Derivative of all gaps and forces of unit reactions, and the gaps that rub."""

CORRECTIONS = 24
"""Most corrections; two or three are typical."""

MOST_OPEN = 40
"""Open contacts whose columns a tangent keeps: dense problems grow with them, and a factorisation leaves them out."""

ROUNDS = 4
"""Times that contacts which a correction would close come into question in it."""

GROWING = 2.0
"""Growth of the correction past which a tangent no longer serves."""


@dataclass(frozen=True)
class SlidingOptions:
    """Numbers of the method."""

    accuracy: float
    """Correction after which it is done [reference films, ambient pressures]."""
    first: float
    """Contraction that a first correction is taken to have."""
    slow: float
    """Contraction past which the tangent is renewed."""
    tangents: int
    """Most factorisations."""


@dataclass(frozen=True)
class SlidingTangent(BorderedTangent):
    """A tangent with the columns of the contacts in question, the bordered unknowns moving with them.

    Attributes
    ----------
    columns : UnitResponses
        Of openings, reactions and friction forces.
    follower : Follower
        What the bordered unknowns do in answer to forces.
    """

    columns: UnitResponses
    follower: Follower

    @classmethod
    def about(cls, plain: BorderedTangent, resists: Array, contacts: Index, rubs: Rubs) -> SlidingTangent:
        """A solve for each contact and friction force; `resists` (d, d) are the border's own terms."""
        border = plain.border
        both = [plain.respond(plain.forcing[:, k], border.gap_derivative[:, k]) for k in range(border.size)]
        pushed = np.column_stack([reactions for _, reactions in both])
        follower = Follower(border, plain.units, pushed, resists - plain.gradient)
        own = {field.name: getattr(plain, field.name) for field in fields(BorderedTangent)}
        return cls(**own, columns=UnitResponses.of(plain, rubs[0], contacts, rubs[1], follower), follower=follower)

    @property
    def stiffness(self) -> Array:
        """What resists the bordered unknowns, (d, d)."""
        return self.follower.stiffness

    def crowded(self, closed: Mask) -> bool:
        """Whether many contacts in question are no longer closed (m,)."""
        return len(self.columns.contacts) > MOST_OPEN + int(np.count_nonzero(closed))

    def with_contacts(self, contacts: Mask, rubs: Rubs) -> SlidingTangent:
        """The same with all `contacts` (m,) among those in question: a solve for each that is new."""
        new = contacts.copy()
        new[self.columns.contacts] = False
        if not new.any():
            return self
        return replace(self, columns=self.columns.with_more(self, rubs[0], np.flatnonzero(new), rubs[1], self.follower))


@dataclass(frozen=True)
class Iterate:
    """Unknowns, bordered unknowns, reactions, friction forces, and the states of all contacts."""

    x: Array
    b: Array
    lam: Array
    force: Array
    closed: Mask
    slips: Index


@dataclass(frozen=True)
class SlidingNewton:
    """Equations with friction, whose step began at a state.

    Attributes
    ----------
    equations : ContactEquations
        Film, wall and journal, without friction.
    friction : Friction
        The gaps that rub.
    before : FrictionState
        Slips at the start of the step.
    options : SlidingOptions
        Numbers of the method.
    """

    equations: ContactEquations
    friction: Friction
    before: FrictionState
    options: SlidingOptions

    def solved(
        self, start: tuple[Array, Array, Mask, Array, Array], tangent: BorderedTangent | None = None
    ) -> tuple[Iterate, SlidingTangent] | None:
        """The state near `start`; None if there is none.

        `start` has unknowns, bordered unknowns, active contacts, reactions and friction forces. `tangent` of a
        neighbour serves as long as corrections contract.
        """
        x, b, active, lam, force = start
        known = FrictionState(self.before.slip, force, self.friction.coefficient * self.friction.normal(lam))
        at = Iterate(x, b, lam, force, active, slipping(self.friction, known))
        sliding, last, made = tangent if isinstance(tangent, SlidingTangent) else None, np.inf, 0
        if sliding is not None and sliding.crowded(active):
            sliding = None
        for _ in range(CORRECTIONS):
            if sliding is None:
                if made == self.options.tangents or not self.equations.at(at.b).admits(at.x):
                    return None
                sliding, last, made = self.tangent_at(at), np.inf, made + 1
                if sliding is None:
                    return None
            found = self.corrected(at, sliding)
            if found is None or found[1] > GROWING * last:
                if found is None and made and not np.isfinite(last):
                    return None  # another tangent at this very state would be the same
                sliding = None
                continue
            at, size, full, sliding = found
            contraction = size / last if np.isfinite(last) else self.options.first
            error = size * min(1.0, contraction / max(1.0 - contraction, 0.1))
            if full and error <= self.options.accuracy and not np.any(self.gaps(at) < CLOSED):
                return at, sliding
            last = size
            if contraction > self.options.slow or not full:
                sliding = None
        return None

    def gaps(self, at: Iterate) -> Array:
        """All gaps, (m,)."""
        return self.equations.at(at.b).gaps(at.x)

    def in_question(self, at: Iterate) -> Mask:
        """Contacts that may open or close, (m,): those closed, and gaps below zero."""
        return at.closed | (self.gaps(at) < CLOSED)

    @cached_property
    def rubbing(self) -> RubbingContacts:
        """The gaps that rub."""
        return rubbing_of(self.friction, int(self.equations.problem.G.shape[1]))

    def rubs(self, problem: ContactProblem) -> Rubs:
        """Derivative of all gaps, forces of unit reactions, and the gaps that rub."""
        return (problem.G, problem.acting), self.rubbing

    def tangent_at(self, at: Iterate) -> SlidingTangent | None:
        """The factorised equations with the contacts of an iterate; None if they have no inverse."""
        problem, solver = self.equations.at(at.b), current_run().film_solver
        constraints = constrain(problem.G, at.closed, self.equations.stops, problem.acting)
        if not constraints.determinate:
            return None
        linearized = problem.linearize(at.x)
        matrix = linearized.matrix(np.zeros(len(at.closed)))
        try:
            factor = constraints.factor(matrix, solver, problem.elimination_key)
        except SingularMatrixError:
            return None
        plain = BorderedTangent.at(Tangent(matrix, constraints, factor), self.equations.border, linearized)
        contacts = np.flatnonzero(self.in_question(at))
        try:
            return SlidingTangent.about(plain, self.equations.border_stiffness, contacts, self.rubs(problem))
        except np.linalg.LinAlgError:  # nothing holds the journal
            return None

    def corrected(self, at: Iterate, sliding: SlidingTangent) -> tuple[Iterate, float, bool, SlidingTangent] | None:
        """The next iterate, size of the correction, whether all of it was taken, and the tangent with its contacts.

        Contacts that the correction would close come into question then; None without contact forces.
        """
        problem, known = self.equations.at(at.b), self.known(at)
        change, db, base = self.without_units(at, sliding)
        slip = slips(self.friction, at.x + change) - self.before.slip
        sliding = sliding.with_contacts(self.in_question(at), self.rubs(problem))
        for _ in range(ROUNDS):
            columns = sliding.columns
            found = columns.solved(base, slip, known)
            if found is None:
                return None
            amounts = np.concatenate([found.unknown, found.friction])
            whole = Correction(change + columns.change @ amounts, db + columns.units.moved @ amounts, np.zeros(0))
            length = self.equations.longest_step((at.x, at.b), whole)
            reached = self.stepped(at, whole, length, (columns, found))
            sliding = sliding.with_contacts(self.in_question(reached), self.rubs(problem))
            if sliding.columns is columns:
                break
        return reached, whole.size, length == 1.0, sliding

    def without_units(self, at: Iterate, sliding: SlidingTangent) -> tuple[Array, Array, tuple[Array, Array, Array]]:
        """What the factor gives alone: changes of unknowns and border; of the former again, all reactions and gaps."""
        problem, follower, border = self.equations.at(at.b), sliding.follower, sliding.border
        gaps = problem.gaps(at.x)
        settled, reactions = sliding.respond(problem.linearize(at.x).residual, gaps)
        db = np.linalg.solve(follower.stiffness, self.equations.imbalance(at.x + settled, reactions, at.b))
        change, reactions = settled + follower.units @ db, reactions + follower.pushed @ db
        moved: Array = problem.G @ change + border.gap_derivative @ db
        return change, np.asarray(db, dtype=np.float64), (change, reactions, gaps + moved)

    def known(self, at: Iterate) -> KnownState:
        """Contacts and friction of an iterate."""
        slip = slips(self.friction, at.x) - self.before.slip
        return KnownState(at.closed, at.slips, self.gaps(at), at.lam, at.force, slip)

    def stepped(
        self, at: Iterate, correction: Correction, length: float, contacts: tuple[UnitResponses, ContactForces]
    ) -> Iterate:
        """The iterate after part of a correction, with the contact forces that belong to it."""
        columns, found = contacts
        lam, force = np.zeros_like(at.lam), np.zeros_like(at.force)
        closed, slides = np.zeros_like(at.closed), np.zeros_like(at.slips)
        lam[columns.contacts], closed[columns.contacts] = found.reaction(columns.space), found.states.closed
        force[columns.rubbing] = found.friction
        slides[columns.rubbing] = np.tile(found.states.slips, self.friction.directions)
        x, b = at.x + length * correction.x, at.b + length * correction.b
        return Iterate(x, b, lam, force, closed, slides)

    def state(self, at: Iterate, sliding: SlidingTangent) -> tuple[ContactState, FrictionState]:
        """An iterate with its residual, and its slips and friction forces."""
        problem, friction = self.equations.at(at.b), self.friction
        linearized = problem.linearize(at.x)
        left = linearized.residual + against_slip(friction, at.force, len(at.x)) - problem.acting.T @ at.lam
        residual = float(np.max(np.abs(left) / linearized.row_scale, initial=0.0))
        gaps, constraints = problem.gaps(at.x), sliding.constraints
        state = ContactState(at.x, at.b, at.lam, at.closed, residual, constraints, linearized, gaps)
        return state, FrictionState(slips(friction, at.x), at.force, friction.coefficient * friction.normal(at.lam))
