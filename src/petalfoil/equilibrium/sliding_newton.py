"""Newton's method for film, wall and journal with petals that slide along themselves, contacts and friction exactly.

Every correction is that of the linearised equations with openings, reactions and friction forces of all contacts in
question as further unknowns, found together from a small dense problem (M6). The factor is that of the equations
without friction; the journal's position answers to every unit of them as in (O3). It serves stages in time and balances
under a load alike.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.coulomb_path import CLOSED, Lines, beside, rubbing_of
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_equations import ContactEquations, ContactState, Correction
from petalfoil.solvers.contact_space import KnownState, RubbingContacts, Unit, UnitResponses
from petalfoil.solvers.coulomb import ContactForces
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
    moved : (d, m + f) array
        Change of the bordered unknowns by each.
    pushed : (m_all, d) array
        Change of all reactions by the bordered unknowns.
    stiffness : (d, d) array
        What resists the bordered unknowns.
    """

    columns: UnitResponses
    moved: Array
    pushed: Array
    stiffness: Array

    @classmethod
    def about(cls, plain: BorderedTangent, resists: Array, contacts: Index, rubs: Rubs) -> SlidingTangent:
        """A solve for each contact and friction force; `resists` (d, d) are the border's own terms."""
        border = plain.border
        both = [plain.respond(plain.forcing[:, k], border.gap_derivative[:, k]) for k in range(border.size)]
        pushed, stiffness = np.column_stack([reactions for _, reactions in both]), resists - plain.gradient
        moves: list[Array] = []

        def answered(unit: Unit) -> Unit:
            moves.append(np.linalg.solve(stiffness, border.rows(unit.change, unit.reactions)))
            change, reactions = unit.change + plain.units @ moves[-1], unit.reactions + pushed @ moves[-1]
            return Unit(change, reactions, border.gap_derivative @ moves[-1])

        columns = UnitResponses.of(plain, rubs[0], contacts, rubs[1], answered)
        own = {field.name: getattr(plain, field.name) for field in fields(BorderedTangent)}
        moved = np.reshape(moves, (len(moves), border.size)).T  # no columns where nothing touches
        return cls(**own, columns=columns, moved=moved, pushed=pushed, stiffness=stiffness)

    def has(self, contacts: Mask) -> bool:
        """Whether `contacts` (m,) are among those in question."""
        inside = np.zeros_like(contacts)
        inside[self.columns.contacts] = True
        return bool(np.all(inside | ~contacts))


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
    lines : sequence of int arrays
        Numbers of the gaps along lines.
    options : SlidingOptions
        Numbers of the method.
    """

    equations: ContactEquations
    friction: Friction
    before: FrictionState
    lines: Lines
    options: SlidingOptions

    def solved(
        self, start: tuple[Array, Array, Mask, Array], tangent: BorderedTangent | None = None
    ) -> tuple[Iterate, SlidingTangent] | None:
        """The state near `start`, unknowns, bordered unknowns, active contacts, reactions; None if there is none.

        `tangent` of a neighbour serves as long as corrections contract.
        """
        x, b, active, lam = start
        at = Iterate(x, b, lam, self.before.force, active, slipping(self.friction, self.before))
        sliding, last, made = tangent if isinstance(tangent, SlidingTangent) else None, np.inf, 0
        for _ in range(CORRECTIONS):
            if sliding is None or not sliding.has(self.in_question(at)):
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
            at, size, full = found
            contraction = size / last if np.isfinite(last) else self.options.first
            error = size * min(1.0, contraction / max(1.0 - contraction, 0.1))
            if full and error <= self.options.accuracy and not np.any(self.gaps(at) < CLOSED):
                return at, sliding
            sliding = sliding if contraction <= self.options.slow and full else None
            last = size
        return None

    def gaps(self, at: Iterate) -> Array:
        """All gaps, (m,)."""
        return self.equations.at(at.b).gaps(at.x)

    def in_question(self, at: Iterate) -> Mask:
        """Contacts that may open or close, (m,): those closed, their neighbours, gaps below zero."""
        return beside(at.closed, self.lines) | (self.gaps(at) < CLOSED)

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
        rubs = (problem.G, problem.acting), rubbing_of(self.friction, len(at.x))
        contacts = np.flatnonzero(self.in_question(at))
        try:
            return SlidingTangent.about(plain, self.equations.border_stiffness, contacts, rubs)
        except np.linalg.LinAlgError:  # nothing holds the journal
            return None

    def corrected(self, at: Iterate, sliding: SlidingTangent) -> tuple[Iterate, float, bool] | None:
        """The next iterate, size of the correction, and whether all of it was taken; None without contact forces."""
        problem, columns = self.equations.at(at.b), sliding.columns
        settled, reactions = sliding.respond(problem.linearize(at.x).residual, problem.gaps(at.x))
        db = np.linalg.solve(sliding.stiffness, self.equations.imbalance(at.x + settled, reactions, at.b))
        change, reactions = settled + sliding.units @ db, reactions + sliding.pushed @ db
        gaps = problem.gaps(at.x) + problem.G @ change + sliding.border.gap_derivative @ db
        slip = slips(self.friction, at.x + change) - self.before.slip
        found = columns.solved((change, reactions, gaps), slip, self.known(at))
        if found is None:
            return None
        amounts = np.concatenate([found.unknown, found.friction])
        whole = Correction(change + columns.change @ amounts, db + sliding.moved @ amounts, np.zeros(0))
        length = self.equations.longest_step((at.x, at.b), whole)
        return self.stepped(at, whole, length, (columns, found)), whole.size, length == 1.0

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
