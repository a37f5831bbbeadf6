"""The linearised equations on one set of active contacts, factorised, with a few bordered unknowns.

`Tangent` is the factorised system with active gaps eliminated. `BorderedTangent` adds unknowns `b` that reach all over
the problem (the journal's position): block elimination with one factorisation and a solve for each of them. It also
follows a contact set that changes by a few gaps without a new factorisation (O4).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.constraints import ContactConstraints, constrain
from petalfoil.solvers.problem import Border, Linearized
from petalfoil.solvers.sparse_lu import Factor
from petalfoil.sparsity import SparseRows

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real, or complex at a frequency."""
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]
GapRows = tuple[SparseRows, SparseRows]
"""Derivative of the gaps, and forces of unit reactions, (m, n) each."""

MOST_EXCHANGED = 16
"""Gaps that may change before a factorisation is cheaper: each asks for a solve, a fortieth of one."""

WORST_CONDITION = 1e12
"""Condition of an exchange past which a factorisation is safer (openings and reactions have units of their own)."""


@dataclass(frozen=True)
class Tangent:
    """`M dx = -residual + H^T dlam` with the change of the active gaps given.

    Attributes
    ----------
    matrix : (n, n) sparse
        `M`.
    constraints : ContactConstraints
        The active contacts.
    factor : Factor
        Of `M` over the free unknowns.
    """

    matrix: sp.csc_array
    constraints: ContactConstraints
    factor: Factor

    def step(self, residual: Values) -> Values:
        """Change of the unknowns against `residual`, (n,) or (n, j), active gaps held (T1)."""
        return self.constraints.spread(self.factor.solve(-self.constraints.balanced(residual)))

    def respond(self, residual: Values, gap_change: Array | None = None) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and of the held reactions (k,) against `residual`.

        `gap_change` (k,) is what else changes the held gaps: the unknowns follow it (T5).
        """
        if gap_change is None:
            change = self.step(residual)
        else:
            follow = self.constraints.close(gap_change)
            change = follow + self.step(self.matrix @ follow + residual)
        return change, self.constraints.reactions(self.matrix @ change + residual)

    def respond_each(self, residuals: Array, openings: Index) -> tuple[Array, Array]:
        """The same against each of `j` residuals (n, j), where `openings` (j,) name a held gap that opens by 1, or -1.

        Shapes (n, j) and (k, j).
        """
        constraints, opens = self.constraints, np.flatnonzero(openings >= 0)
        change, left = np.zeros_like(residuals), residuals
        if len(opens):
            unit_openings = np.zeros((constraints.G.shape[0], len(opens)))
            unit_openings[openings[opens], np.arange(len(opens))] = -1.0
            change[:, opens] = constraints.close(unit_openings)
            left = residuals + self.matrix @ change
        change = change + self.step(left)
        return change, constraints.reactions(self.matrix @ change + residuals)

    def adjoint(self, by_change: Array, by_reactions: Array) -> tuple[Array, Array]:
        """Derivatives by `residual` (n,) and `gap_change` (k,) of what has these by the outcome of `respond`.

        One transposed solve.
        """
        constraints = self.constraints
        pushed = constraints.reactions_adjoint(by_reactions)
        by_unknowns = by_change + self.matrix.T @ pushed
        a = constraints.balanced_adjoint(self.factor.solve_transposed(constraints.gather(by_unknowns)))
        return pushed - a, constraints.close_adjoint(by_unknowns - self.matrix.T @ a)


@dataclass(frozen=True)
class Exchange:
    """Gaps opened and closed since the factorisation.

    A gap that opens is a motion of unit opening whose reaction must vanish; a gap that closes is a unit reaction under
    which it must not open (O4).

    Attributes
    ----------
    opened : (a,) int array
        Places among the held gaps of the factor.
    added : (b,) int array
        Numbers of the gaps that have closed.
    rows : (b, n) sparse
        Their derivatives.
    changes, reactions : (n, a + b), (k, a + b) array
        Changes of the unknowns and of the factor's reactions by a unit opening or a unit reaction of each.
    lu : tuple
        Factors of the conditions that openings carry no load and added gaps stay closed.
    """

    opened: Index
    added: Index
    rows: sp.csr_array
    changes: Array
    reactions: Array
    lu: tuple[Array, Array]

    @classmethod
    def between(cls, tangent: Tangent, gaps: GapRows, active: Mask) -> Exchange | None:
        """Open and close gaps of `tangent` until `active` are held; None if these do not determine the unknowns."""
        constraints, (G, acting) = tangent.constraints, gaps
        opened, added = np.flatnonzero(~active[constraints.held]), np.flatnonzero(active & ~constraints.held)
        rows, pushes, none = sp.csr_array(G[added]), sp.csr_array(acting[added]), np.zeros(G.shape[1])
        columns = []
        for place in opened:
            unit_opening = np.zeros(constraints.G.shape[0])
            unit_opening[place] = -1.0
            columns.append(tangent.respond(none, unit_opening))
        columns += [tangent.respond(-pushes[[row]].toarray()[0]) for row in range(len(added))]
        changes, reactions = (np.column_stack(part) for part in zip(*columns, strict=True))
        conditions = np.vstack([reactions[opened], rows @ changes])
        if not np.all(np.isfinite(conditions)) or np.linalg.cond(conditions) > WORST_CONDITION:
            return None
        return cls(opened, added, rows, changes, reactions, la.lu_factor(conditions))

    def amend(self, change: Array, reactions: Array, gap_change: Array) -> tuple[Array, Array, Array]:
        """Unknowns, reactions of the factor's gaps and of the gaps added, from what the factor alone gave.

        `gap_change` (b,) is what else changes the gaps added.
        """
        violation = np.concatenate([reactions[self.opened], self.rows @ change + gap_change])
        amounts = la.lu_solve(self.lu, -violation)
        reactions = reactions + self.reactions @ amounts
        reactions[self.opened] = 0.0
        return change + self.changes @ amounts, reactions, amounts[len(self.opened) :]


@dataclass(frozen=True, kw_only=True)
class SeenTangent:
    """A tangent that serves many steps, and what it has been seen to answer.

    Attributes
    ----------
    response : float
        Largest correction over the residual that was left for it, seen after a correction with it; 0 before any is.
    """

    response: float = 0.0

    def seen(self, correction: float, residual: float) -> Self:
        """The same after a correction of this size has answered what another one left; what it has computed is kept."""
        if residual <= 0.0 or correction <= self.response * residual:
            return self
        seen = copy(self)
        vars(seen)["response"] = correction / residual
        return seen


@dataclass(frozen=True)
class BorderedTangent(SeenTangent):
    """A tangent with its bordered unknowns, on the contacts of its factor or on a few others.

    Attributes
    ----------
    tangent : Tangent
        The factorised system.
    border : Border
        How the bordered unknowns enter.
    forcing : (n, d) array
        Derivative of the equations by them, at fixed unknowns.
    constraints : ContactConstraints
        The contacts held now.
    exchange : Exchange or None
        How they differ from those of the factor.
    units : (n, d) array
        Change of the unknowns by a unit of each bordered unknown.
    gradient : (d, d) array
        Change of the rows `R x + A^T lam` by them.
    """

    tangent: Tangent
    border: Border
    forcing: Values
    constraints: ContactConstraints
    exchange: Exchange | None
    units: Values
    gradient: Values

    @classmethod
    def at(cls, tangent: Tangent, border: Border, linearized: Linearized) -> BorderedTangent:
        """The tangent of equations linearised at a point."""
        columns = [linearized.slack_derivative(column) for column in border.gap_derivative.T]
        forcing = np.column_stack(columns) if columns else np.zeros((tangent.matrix.shape[0], 0))
        if border.forcing is not None:
            forcing = forcing + border.forcing
        return cls.of(tangent, border, forcing)

    @classmethod
    def of(
        cls,
        tangent: Tangent,
        border: Border,
        forcing: Values,
        constraints: ContactConstraints | None = None,
        exchange: Exchange | None = None,
    ) -> BorderedTangent:
        """Solve for a unit of each bordered unknown."""
        bare = cls(tangent, border, forcing, constraints or tangent.constraints, exchange, forcing, np.zeros((0, 0)))
        if not border.size:
            return bare
        both = [bare.respond(forcing[:, k], border.gap_derivative[:, k]) for k in range(border.size)]
        gradient = np.column_stack([border.rows(*change) for change in both])
        units = np.column_stack([change for change, _ in both])
        return cls(tangent, border, forcing, bare.constraints, exchange, units, gradient)

    def respond(self, residual: Values, gap_change: Array | None = None) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and of all reactions (m,) against `residual`, bordered unknowns held.

        `gap_change` (m,) is what else changes the gaps.
        """
        held = self.tangent.constraints.held
        change, reactions = self.tangent.respond(residual, None if gap_change is None else gap_change[held])
        lam = np.zeros(len(held), dtype=change.dtype)
        if self.exchange is not None:
            added = self.exchange.added
            moved = np.zeros(len(added)) if gap_change is None else gap_change[added]
            change, reactions, lam[added] = self.exchange.amend(change, reactions, moved)
        lam[held] = reactions
        return change, lam

    def adjoint(self, by_change: Array, by_reactions: Array) -> tuple[Array, Array]:
        """Derivatives by `residual` (n,) and `gap_change` (m,) of what has these by the outcome of `respond`.

        On the contacts of the factor; one transposed solve.
        """
        held = self.tangent.constraints.held
        by_residual, by_held = self.tangent.adjoint(by_change, by_reactions[held])
        by_gaps = np.zeros(len(held))
        by_gaps[held] = by_held
        return by_residual, by_gaps

    @cached_property
    def reaction_units(self) -> Array:
        """Change of all reactions by a unit of each bordered unknown, (m, d)."""
        own = self.tangent
        lam = np.zeros((len(own.constraints.held), self.border.size))
        for k in range(self.border.size):
            lam[own.constraints.held, k] = own.constraints.reactions(own.matrix @ self.units[:, k] + self.forcing[:, k])
        return lam

    def serves(self, active: Mask) -> bool:
        """Whether the gaps `active` are those held, apart from stops."""
        held = self.constraints.held.copy()
        held[self.constraints.stops] = active[self.constraints.stops]
        return bool(np.array_equal(held, active))

    def exchanged(self, gaps: GapRows, active: Mask) -> BorderedTangent | None:
        """The same factor for other active contacts; None where too many differ or they need a factor of their own."""
        own = self.tangent.constraints
        if len(self.constraints.stops) or np.count_nonzero(active != own.held) > MOST_EXCHANGED:
            return None
        constraints = constrain(gaps[0], active, acting=gaps[1])
        if not constraints.determinate:
            return None
        if np.array_equal(active, own.held):
            return BorderedTangent.of(self.tangent, self.border, self.forcing, constraints)
        exchange = Exchange.between(self.tangent, gaps, active)
        if exchange is None:
            return None
        return BorderedTangent.of(self.tangent, self.border, self.forcing, constraints, exchange)
