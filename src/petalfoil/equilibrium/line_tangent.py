"""A factorised tangent of contact lines, as it serves its own state and later ones with a few other contacts.

Its contacts are eliminated. One that has ended since is a motion of unit opening whose reaction vanishes, one that has
begun a unit reaction under which the gap there stays closed (O4), and a point whose `lam / p''` is another turns with
that (C16): a solve each (`line_exchange.py`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.line_exchange import CurveRows, FactorAnswers, LineExchange, Turning
from petalfoil.equilibrium.linear_response import LinearResponse
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.constraints import places_among
from petalfoil.solvers.tangent import SeenTangent
from petalfoil.sparsity import SparseRows

if TYPE_CHECKING:
    from petalfoil.equilibrium.line_contacts import LineContacts

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

STIFFER = 0.5
"""Change of `lam / p''` at a point over the larger of both, past which it is corrected. With 0.3 six starts from coarse
grids take as many tangents and half as many solves more."""

MOST_CHANGES = 24
"""Contacts that may have begun, ended or stiffened before a factorisation is cheaper: each asks for a solve, together
half a factorisation."""


@dataclass(frozen=True)
class LineResiduals:
    """What is left of the equations at a state, or the rates of it by a parameter.

    Attributes
    ----------
    rows : (n,) array
        Of (C11).
    closed, slopes : (j + k,) array, (k,) array
        Of (C12): gaps at held nodes and points, slopes at points.
    force : (n_position,) array
        Of the journal; zeros at a fixed position.
    """

    rows: Array
    closed: Array
    slopes: Array
    force: Array

    @classmethod
    def of(cls, state: LineContacts) -> LineResiduals:
        """Those of a state."""
        return cls(state.rows, state.closed, state.slopes, state.unbalanced)


@dataclass(frozen=True)
class LineChange:
    """Changes of the unknowns (n,), reactions at nodes and points (j + k,), position (n_position,), angles (k,)."""

    x: Array
    reaction: Array
    displacement: Array
    phi: Array


@dataclass(frozen=True, kw_only=True)
class LineTangent(SeenTangent):
    """A tangent and the contacts that it serves; residuals that it is seen to answer are those of the film's rows.

    Attributes
    ----------
    linear : LinearResponse
        The factorised tangent of a state.
    answers : FactorAnswers
        What it has been asked for, by whatever contacts it served.
    nodes : (m,) bool array
        Contacts at nodes of that state.
    place : (j + k,) int array
        Place of each contact that is served, at nodes and at points, among those of that state; -1 of others.
    at_nodes : int
        How many of them are at nodes, `j`.
    by_e : (j + k, n_position) array
        Derivative of their gaps by the position of the journal [1].
    springs : (n_position, n_position) array
        Stiffness of what holds the journal beside film and contacts [1].
    exchange : LineExchange or None
        How they differ; None where they are the same.
    turning : (c,) int array
        Points of the exchange that turn with another stiffness; -1 of those that have ended.
    points : LinePoints
        Points that are served.
    held : (m,) bool array
        Contacts at nodes that are.
    travel_stiffness : (k,) array
        `lam / p''` with which points are served [rad^2].
    """

    linear: LinearResponse
    answers: FactorAnswers
    nodes: Mask
    place: Index
    at_nodes: int
    by_e: Array
    springs: Array
    points: LinePoints
    held: Mask
    travel_stiffness: Array
    exchange: LineExchange | None = None
    turning: Index = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    @classmethod
    def of(cls, state: LineContacts, response: LinearResponse) -> LineTangent:
        """That of a state itself."""
        contacts = response.motion.contacts
        by_e, answers = contacts.gap_by_e, FactorAnswers(response.factorised, contacts.slope_by_x)
        return cls(
            linear=response,
            answers=answers,
            nodes=state.held,
            place=np.arange(len(by_e)),
            at_nodes=len(state.held_reaction),
            by_e=by_e,
            springs=state.springs,
            points=state.points,
            held=state.held,
            travel_stiffness=state.travel_stiffness,
        )

    def serves(self, state: LineContacts) -> bool:
        """Whether a state has the contacts that are served, with about the same travel stiffnesses.

        One that has begun may be taken for another on the same line, which a correction that does not contract tells.
        """
        points, served, place = state.points, self.points, self._places(state)
        alike = np.array_equal(points.line, served.line) and np.array_equal(points.kind, served.kind)
        if place is None or not alike or not np.array_equal(state.held, self.held):
            return False
        own, before = state.travel_stiffness, self.travel_stiffness
        near = np.abs(own - before) <= STIFFER * np.maximum(own, before)
        return np.array_equal(place, self.place) and bool(near.all())

    def on(self, state: LineContacts, stiffer: float = STIFFER) -> LineTangent | None:
        """The same for the contacts of a later state; None where a factorisation is better.

        Points are corrected whose travel stiffness has changed by more than the part `stiffer` of the larger one.
        """
        place = self._places(state)
        if place is None:
            return None
        contacts, known = self.linear.motion.contacts, place >= 0
        opened = np.ones(contacts.constraints.G.shape[0], dtype=np.bool_)
        opened[place[known]] = False
        added, (turning, number) = np.flatnonzero(~known), self._turning(state, place, stiffer)
        count = np.count_nonzero(opened) + len(added) + len(turning.stiffer)
        if count > MOST_CHANGES:
            return None
        weights = weights_of(state, added)
        contacts_e = state.problem.layout.wall.contacts.by_e
        gaps = CurveRows(sp.csr_array(weights @ state.problem.G), weights @ contacts_e)
        by_e = np.empty((len(place), contacts_e.shape[1]))
        by_e[known], by_e[added] = contacts.gap_by_e[place[known]], gaps.by_e
        exchange = None
        if count:
            exchange = LineExchange.of(self.answers, np.flatnonzero(opened), gaps, turning)
            if exchange is None:
                return None
        points, served = place[len(state.held_reaction) :] - self._first_point, state.travel_stiffness.copy()
        as_before = (points >= 0) & ~np.isin(points, turning.of_factor)
        served[as_before] = contacts.travel_stiffness[points[as_before]]
        return replace(
            self,
            place=place,
            at_nodes=len(state.held_reaction),
            by_e=by_e,
            exchange=exchange,
            turning=number,
            points=state.points,
            held=state.held,
            travel_stiffness=served,
        )

    def _turning(self, state: LineContacts, place: Index, stiffer: float) -> tuple[Turning, Index]:
        """Points whose travel stiffness is another, and their numbers among those of the state, (c,) (-1: ended)."""
        contacts, points = self.linear.motion.contacts, place[len(state.held_reaction) :] - self._first_point
        own, before = state.travel_stiffness, contacts.travel_stiffness
        here = np.full(len(before), -1)
        here[points[points >= 0]] = np.flatnonzero(points >= 0)
        now = np.where(here >= 0, np.append(own, 0.0)[here], 0.0)
        other = np.flatnonzero(np.abs(now - before) > stiffer * np.maximum(now, before))
        fresh = np.flatnonzero((points < 0) & (own > 0.0))
        slopes = sp.csr_array(state.points.slope[fresh] @ state.problem.G) if len(fresh) else contacts.slope_by_x[:0]
        by_x = sp.csr_array(sp.vstack([contacts.slope_by_x[other], slopes], format="csr"))
        by_e = state.points.slope[fresh] @ state.problem.layout.wall.contacts.by_e
        rows = CurveRows(by_x, np.concatenate([contacts.slope_by_e[other], by_e]))
        added = np.concatenate([now[other] - before[other], own[fresh]])
        return Turning(other, rows, added), np.concatenate([here[other], fresh])

    def _places(self, state: LineContacts) -> Index | None:
        """Places of the contacts of a state among those of the factor, -1 of others; None where that is not known."""
        before = state.points.before
        if before is None:
            return None
        nodes = places_among(self.nodes)[state.held]
        return np.concatenate([nodes, np.where(before >= 0, self._first_point + before, -1)])

    @property
    def numbers(self) -> Index:
        """Number of each point that is served among those of the factor, -1 of others, (k,)."""
        return np.where(self.place >= 0, self.place - self._first_point, -1)[self.at_nodes :]

    @cached_property
    def _turns(self) -> SparseRows:
        """`n'` of the points of the factor, (k, n)."""
        return SparseRows(self.linear.motion.contacts.slope_by_x)

    @cached_property
    def _first_point(self) -> int:
        return int(np.count_nonzero(self.nodes))

    def correction(self, state: LineContacts, left: LineResiduals, way: Array | None) -> LineChange:
        """The change that takes away what is `left` at a state with the contacts that it serves (E12).

        The journal goes a given `way` (n_position,), as in (C14); where that is None, its position follows under the
        load.
        """
        dx, dlam, way = self.moved(left, way)
        by_e = state.problem.layout.wall.contacts.by_e
        after = left.slopes + state.points.along(state.problem.G @ dx + by_e @ way)[1]
        return LineChange(dx, dlam, way, -after / state.bending)

    def moved(self, left: LineResiduals, way: Array | None) -> tuple[Array, Array, Array]:
        """The same of unknowns (n,), reactions (j + k,) and position (n_position,)."""
        contacts, number = self.linear.motion.contacts, self.numbers
        slopes = np.zeros(len(contacts.travel_stiffness))
        slopes[number[number >= 0]] = left.slopes[number >= 0]
        travel, turned = contacts.travel_stiffness * slopes, np.append(left.slopes, 0.0)[self.turning]
        dx, dlam, moments = self.respond(left.rows + self._turns.T @ travel, left.closed, turned)
        if way is None:
            force = left.force + self.border_rows(dx, dlam, moments) - contacts.slope_by_e.T @ travel
            way = np.asarray(np.linalg.solve(-self.gradient, force), dtype=np.float64)
        if np.any(way):
            units, reactions, _ = self.units
            dx, dlam = dx + units @ way, dlam + reactions @ way
        return dx, dlam, way

    def respond(self, rows: Array, closed: Array, turned: Array) -> tuple[Array, Array, Array]:
        """Change of the unknowns (n,) and of the reactions (j + k,), and moments at points `turning` (c,).

        Against `rows` (n,), gaps `closed` (j + k,), and slopes `turned` (c,) of these points.
        """
        tangent, known = self.linear.factorised, self.place >= 0
        own = np.zeros(tangent.constraints.G.shape[0])
        own[self.place[known]] = closed[known]
        return self._amended(*tangent.respond(rows, own), closed, turned)

    def _amended(self, dx: Array, dlam: Array, closed: Array, turned: Array) -> tuple[Array, Array, Array]:
        """What the factor's own contacts answer, as those that are served do."""
        known, out, moments = self.place >= 0, np.zeros(len(self.place)), np.zeros(0)
        if self.exchange is not None:
            dx, dlam, out[~known], moments = self.exchange.amend(dx, dlam, closed[~known], turned)
        out[known] = dlam[self.place[known]]
        return dx, out, moments

    @cached_property
    def units(self) -> tuple[Array, Array, Array]:
        """The same by a unit of each coordinate of the journal, (n, d), (j + k, d) and (c, d)."""
        own = self.linear.tangent
        slopes = np.zeros((0, self.by_e.shape[1])) if self.exchange is None else self.exchange.turning.slopes.by_e
        each = zip(own.units.T, own.reaction_units.T, self.by_e.T, slopes.T, strict=True)
        dx, dlam, moments = zip(*(self._amended(*one) for one in each), strict=True)
        return np.column_stack(dx), np.column_stack(dlam), np.column_stack(moments)

    @cached_property
    def gradient(self) -> Array:
        """`dF/de` on the journal less its `springs`, (n_position, n_position)."""
        columns = zip(*(part.T for part in self.units), strict=True)
        by_e = np.column_stack([self.border_rows(*one) for one in columns])
        return by_e - self.linear.motion.contacts.gradient - self.springs

    def border_rows(self, dx: Array, dlam: Array, moments: Array) -> Array:
        """Force on the journal by changes of the unknowns (n,), reactions (j + k,) and their travel (E13)."""
        border = self.linear.tangent.border
        force = border.row_derivative @ dx[border.columns] + self.by_e.T @ dlam
        return np.asarray(force if self.exchange is None else force - self.exchange.turning.slopes.by_e.T @ moments)


def weights_of(state: LineContacts, contacts: Index) -> sp.csr_array:
    """Weights of the gaps at all nodes in those of some contacts of a state, (b, m)."""
    held = np.flatnonzero(state.held)
    nodes, points = contacts[contacts < len(held)], contacts[contacts >= len(held)] - len(held)
    read, weights = state.points.stencil
    rows = np.concatenate([np.arange(len(nodes)), len(nodes) + np.repeat(np.arange(len(points)), read.shape[1])])
    columns = np.concatenate([held[nodes], read[points].ravel()])
    values = np.concatenate([np.ones(len(nodes)), weights[0, points].ravel()])
    return sp.csr_array((values, (rows, columns)), shape=(len(contacts), len(state.held)))
