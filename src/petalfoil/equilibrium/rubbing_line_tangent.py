"""A step of Newton's method with Coulomb friction on contact lines (3-D): contacts open, stick or slip in it.

What is not linear are the film and the places of contact points. With `n`, `n'` the derivatives of gap and slope at a
point, and `B` that of the slips, Newton's method has the tangent of small motions (E12),

    F - n^T lam + B^T T + n'^T (lam / p'') (p' + n' dx) = 0 ,     p + n dx = 0 ,     dphi = -(p' + n' dx) / p''

and Coulomb's law on the slips `B (x - x_0)` since the step began is the dense problem of (M6) and (M11) by units of
one factor. Under a load the journal's position answers to every unit of them, as in (O3).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_signs import without
from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.solvers.contact_space import Follower, KnownState, RubbingContacts, UnitResponses, Units
from petalfoil.solvers.coulomb import ContactForces
from petalfoil.solvers.problem import positive_step
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.system.friction import FrictionState, slipping, slips

Array = NDArray[np.float64]

OnPath = TypeVar("OnPath", bound=RubbingLines)
"""A state of a path, with or without film."""

TRUST = 0.5
"""Farthest that a point travels in a correction, in cells."""

SHORTEST = 0.1
"""Least part of a correction that is taken where the film would close."""


class NoPathError(ArithmeticError):
    """A step of a path has no state with contact lines near it; it says why."""


@dataclass(frozen=True)
class LineAnswer:
    """What the equations answer to what is left of them.

    Attributes
    ----------
    change : (n,) array
        Of the unknowns.
    way : (d,) array
        Of the journal's position, where it answers.
    reactions : (j + k,) array
        Of all contacts after it.
    """

    change: Array
    way: Array
    reactions: Array

    def with_units(self, units: Units, amounts: Array) -> LineAnswer:
        """The same with amounts (j + k + f,) of openings and friction forces besides."""
        return LineAnswer(
            self.change + units.change @ amounts,
            self.way + units.moved @ amounts,
            self.reactions + units.reactions @ amounts,
        )


@dataclass(frozen=True)
class RubbingLineTangent:
    """The factorised equations at a state.

    Attributes
    ----------
    state : RubbingLines
        The state.
    bordered : BorderedTangent
        The equations there, all contacts closed, and the journal's position where a load asks for it.
    follower : Follower
        What this position does in answer to forces.
    columns : UnitResponses or None
        What units of openings and friction forces do; None where friction forces stay as they are.
    """

    state: RubbingLines
    bordered: BorderedTangent
    follower: Follower
    columns: UnitResponses | None

    @classmethod
    def about(cls, state: RubbingLines, solver: LinearSolver, *, rubs: bool) -> RubbingLineTangent:
        """Factorise at a state, with a column for each contact and friction force if petals are to rub.

        Raises
        ------
        NoPathError
            The contacts do not determine the petals, or the load not the journal's position.
        """
        constraints = state.contacts.constraints
        if not constraints.determinate:
            raise NoPathError("contacts with friction do not determine the petals")
        try:
            factor = constraints.factor(state.matrix, solver, state.elimination_key)
            tangent = Tangent(state.matrix, constraints, factor)
            bordered = BorderedTangent.of(tangent, state.border, state.forcing)
            resists = state.border_stiffness - bordered.gradient
            follower = Follower(bordered.border, bordered.units, bordered.reaction_units, resists)
            columns = columns_of(state, bordered, follower) if rubs else None
        except SingularMatrixError:
            raise NoPathError("contacts with friction do not determine the petals") from None
        except np.linalg.LinAlgError:
            raise NoPathError("the load does not determine the journal's position") from None
        return cls(state, bordered, follower, columns)

    def serves(self, state: RubbingLines) -> bool:
        """Whether a state has the contacts that were factorised, wherever its points are on their lines."""
        points, own = state.points, self.state.points
        alike = np.array_equal(points.line, own.line) and np.array_equal(points.kind, own.kind)
        return alike and np.array_equal(state.held, self.state.held)

    def corrected(self, state: OnPath, before: RubbingLines) -> tuple[OnPath, bool]:
        """The state after a correction, in a step that began at the state `before`, and whether all of it was taken.

        Raises
        ------
        NoPathError
            None of the states of the contacts is consistent, or the film closes.
        """
        answer = self.answer(state)
        if self.columns is None:
            return stepped(state, answer, state.friction_force)
        own, units = self.columns.rubbing, self.columns.units
        without_friction = answer.with_units(
            units, np.append(np.zeros(len(state.reactions)), -state.friction_force.ravel()[own])
        )
        found = self.forces(state, before, without_friction)
        after = without_friction.with_units(units, np.concatenate([found.unknown, found.friction]))
        force = np.zeros(state.friction_force.size)
        force[own] = found.friction
        whole = replace(after, reactions=found.reaction(self.columns.space))
        moved, all_of_it = stepped(state, whole, force.reshape(state.friction_force.shape))
        bears, j = found.states.closed, len(state.held_reaction)
        if bears.all():
            return moved, all_of_it
        return moved.on(without(moved, ~bears[:j], ~bears[j:]), moved.friction_force[:, bears]), all_of_it

    def answer(self, state: RubbingLines) -> LineAnswer:
        """What answers to what is left of the equations at a state, friction forces as they are."""
        border, moments = self.bordered.border, state.travel_stiffness * state.slopes
        change, more = self.bordered.respond(state.rows + state.contacts.slope_by_x.T @ moments, state.closed)
        way = np.linalg.solve(self.follower.stiffness, state.force_left + border.rows(change, more))
        more = more + self.follower.pushed @ way
        return LineAnswer(change + self.follower.units @ way, way, state.reactions + more)

    def forces(self, state: RubbingLines, before: RubbingLines, answer: LineAnswer) -> ContactForces:
        """Forces of all contacts, of which `answer` has none of friction; see `UnitResponses.solved`.

        Near those known, and where none are found there, from contacts that all slip, or as if none had rubbed before.

        Raises
        ------
        NoPathError
            None are found.
        """
        if self.columns is None:
            raise ValueError("friction forces stay as they are")
        border, count = self.bordered.border, len(state.reactions)
        gaps = state.closed + self.bordered.constraints.G @ answer.change + border.gap_derivative @ answer.way
        since, closed, none = slips(state.law, state.x - before.x), np.ones(count, dtype=np.bool_), np.zeros(count)
        force, slip = state.friction_force.ravel(), since + slips(state.law, answer.change)
        slides = slipping(state.law, FrictionState(np.zeros(2 * count), force, np.tile(state.limit, 2)))
        for near in (
            KnownState(closed, slides, none, state.reactions, force, since),
            KnownState(closed, np.ones_like(slides), none, state.reactions, force, since),
            KnownState(closed, np.ones_like(slides), none, answer.reactions, np.zeros_like(force), slip),
        ):
            found = self.columns.solved((answer.change, answer.reactions, gaps), slip, near)
            if found is not None:
                return found
        raise NoPathError("no contacts, sticking or slipping, carry the friction of a step")


def stepped(state: OnPath, answer: LineAnswer, force: Array) -> tuple[OnPath, bool]:
    """The state after an answer, under friction forces `force` (2, j + k), its points where slopes vanish.

    Only a part of the way to it where pressures or the film would vanish; whether it is all of it.

    Raises
    ------
    NoPathError
        The film closes all the same.
    """
    length, j = positive_step(state.equations, state.x, answer.change), len(state.held_reaction)
    at = state.shifted(length * answer.change, length * answer.way)
    while not at.equations.admits(at.x):
        length *= 0.5
        if length < SHORTEST:
            raise NoPathError("the film closes in a correction")
        at = state.shifted(length * answer.change, length * answer.way)
    farthest = TRUST * state.points.cell_length
    lam = state.reactions + length * (answer.reactions - state.reactions)
    found = replace(
        at,
        points=state.points.moved(np.clip(-at.slopes / state.bending, -farthest, farthest)),
        held_reaction=lam[:j],
        reaction=lam[j:],
        friction_force=state.friction_force + length * (force - state.friction_force),
    )
    return found, length == 1.0


def columns_of(state: RubbingLines, bordered: BorderedTangent, follower: Follower) -> UnitResponses:
    """What units of openings and friction forces do; contacts on the journal slip on no petal."""
    rows, count, slip = state.contacts.constraints.G, len(state.reactions), state.law.slip
    on_film = sp.csr_array((slip.shape[0], len(state.x) - slip.shape[1]))
    every = RubbingContacts(sp.csr_array(sp.hstack([slip, on_film])), np.arange(count), state.law.coefficient)
    own = np.flatnonzero(np.diff(slip.indptr)[:count])
    rubbing = replace(every, slip=sp.csr_array(every.slip[every.every_slip(own)]), gap=own)
    columns = UnitResponses.of(bordered, (rows, rows), np.arange(count), rubbing, follower)
    return replace(columns, rubbing=every.every_slip(own))
