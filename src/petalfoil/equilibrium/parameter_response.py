"""How an equilibrium follows a parameter of its case: the derivative of its state, contacts held (V1)-(V3).

With unknowns `x`, reactions `lam` of the active contacts and, under a load, the journal's position `e`, an equilibrium
at the value `p` of a parameter satisfies

    F(x, e, p) - G^T lam = 0       film and wall
    g(x, e, p) = 0                 gaps of the active contacts                                         (V1)
    f(x, lam, p) + load(p) = 0     journal, where a load determines its position

The derivative of (V1) along the parameter is linear in the rates of the state, with the tangent of Newton's method:

    F_x x' + F_e e' - G^T lam' = -F_p + G_p^T lam
    g_x x' + g_e e' = -g_p                                                                             (V2)
    f_x x' + f_lam lam' = -f_p - load_p

One factorisation serves all parameters of an equilibrium; each of them costs a solve with it. A contact whose reaction
vanishes with its gap is at a kink: it opens on one side of `p` and stays closed on the other. Its rates follow from a
linear complementarity problem on either side (V3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import RefinedState, Solution
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.lcp import solve_lcp
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Equations:
    """The equations of a bearing at one value of a parameter.

    Attributes
    ----------
    problem : CoupledProblem
        Film, wall and contacts at its speed and displacement.
    load : (n_position,) array or None
        Load over the unit of force; None where the displacement is given [1].
    """

    problem: CoupledProblem
    load: Array | None

    def at_temperatures(self, temperatures: Temperatures | None) -> Equations:
        """The same at temperatures of shaft, pack and bushing; None leaves them as the case has them."""
        return self if temperatures is None else replace(self, problem=self.problem.at(temperatures=temperatures))

    def at_state(self, solution: Solution) -> EquationValues:
        """Left-hand sides of (V1) at the state of a solution, and the displacement where it is given."""
        problem = self.problem
        if self.load is not None:
            problem = problem.at(displacement=solution.problem.displacement)
        x, lam = solution.x, solution.lam
        linearized = problem.linearize(x, low_order=solution.state.low_order)
        load = np.zeros(problem.layout.n_position) if self.load is None else self.load
        return EquationValues(
            linearized.residual - problem.acting.T @ lam,
            problem.gaps(x),
            problem.journal_force(x, lam) + load,
            problem.displacement,
        )


@dataclass(frozen=True)
class EquationValues:
    """Left-hand sides of (V1), or their derivatives by a parameter at a fixed state.

    Attributes
    ----------
    residual : (n,) array
        Rows of film and wall, reactions included.
    gaps : (m,) array
        All gaps.
    force : (d,) array
        Rows of the journal, load included.
    displacement : (d,) array
        Displacement of the journal where it is given.
    """

    residual: Array
    gaps: Array
    force: Array
    displacement: Array

    @classmethod
    def combined(cls, values: Sequence[EquationValues], weights: Sequence[float]) -> EquationValues:
        """Weighted sum of several, such as a difference quotient."""
        parts = zip(*((v.residual, v.gaps, v.force, v.displacement) for v in values), strict=True)
        return cls(*(sum((w * a for w, a in zip(weights, part, strict=True)), 0.0 * part[0]) for part in parts))

    def reversed(self) -> EquationValues:
        """With opposite signs."""
        return EquationValues.combined([self], [-1.0])


@dataclass(frozen=True)
class StateRate:
    """Derivative of a state by a parameter.

    Attributes
    ----------
    x : (n,) array
        Of the unknowns.
    lam, gaps : (m,) array
        Of reactions and gaps.
    displacement : (d,) array
        Of the journal's displacement.
    """

    x: Array
    lam: Array
    gaps: Array
    displacement: Array

    def plus(self, others: Sequence[StateRate], amounts: Array) -> StateRate:
        """Sum with multiples of others."""
        rate = self
        for other, amount in zip(others, amounts, strict=True):
            rate = StateRate(
                rate.x + amount * other.x,
                rate.lam + amount * other.lam,
                rate.gaps + amount * other.gaps,
                rate.displacement + amount * other.displacement,
            )
        return rate

    def moved(self, solution: Solution, change: float, there: Equations) -> Solution:
        """The state that the rate leads to after a `change` of the parameter, under the equations `there`."""
        state = solution.state
        ahead = RefinedState(state.x + change * self.x, state.low_order, state.lam + change * self.lam)
        problem = there.problem.at(displacement=solution.problem.displacement + change * self.displacement)
        return replace(solution, problem=problem, state=ahead, load=there.load)


@dataclass(frozen=True)
class StateWeights:
    """Derivatives of a result by a state, or of its derivative by the rates of the equations (V11).

    Attributes
    ----------
    residual : (n,) array
        By the unknowns, or by the rows of film and wall.
    gaps : (m,) array
        By the reactions, or by the gaps; none where reactions are among the unknowns.
    force : (d,) array
        By the journal's position, or by its rows.
    """

    residual: Array
    gaps: Array
    force: Array

    def of(self, rates: Rates) -> float:
        """The result's derivative along rates of the equations."""
        gaps = float(self.gaps @ rates.gaps) if len(self.gaps) else 0.0
        return float(self.residual @ rates.residual) + gaps + float(self.force @ rates.force)


class Rates(Protocol):
    """Derivatives of equations by a parameter at a fixed state."""

    @property
    def residual(self) -> Array:
        """Of the rows."""

    @property
    def gaps(self) -> Array:
        """Of the gaps."""

    @property
    def force(self) -> Array:
        """Of the journal's rows."""


@dataclass(frozen=True)
class HeldEquilibrium:
    """An equilibrium whose contacts are held, its tangent factorised.

    Attributes
    ----------
    solution : Solution
        The equilibrium.
    tangent : BorderedTangent
        The tangent of film and wall there, the journal's position bordered.
    held : (m,) bool array
        The contacts kept closed.
    """

    solution: Solution
    tangent: BorderedTangent
    held: Mask

    @classmethod
    def of(cls, solution: Solution, held: Mask) -> HeldEquilibrium:
        """Factorise the tangent at a solution with the contacts `held` (m,).

        Raises
        ------
        ConvergenceError
            The contacts do not determine the state, so that it has no derivative.
        """
        problem, state = solution.problem, solution.state
        constraints = constrain(problem.G, held, problem.layout.wall.contacts.journal, problem.acting)
        linearized = problem.linearize(state.x, low_order=state.low_order)
        matrix = linearized.matrix(np.zeros(len(held)))
        try:
            factor = constraints.factor(matrix, current_run().probe_solver, problem.elimination_key)
        except SingularMatrixError:
            raise undetermined() from None
        tangent = BorderedTangent.at(Tangent(matrix, constraints, factor), problem.border, linearized)
        return cls(solution, tangent, held)

    @property
    def under_load(self) -> bool:
        """Whether a load determines the displacement."""
        return self.solution.load is not None

    def respond(self, rates: EquationValues) -> StateRate:
        """The rate of the state (V2) from the rates of the equations at a fixed state."""
        rate = self._chains_free(rates)
        if not len(stops := self.tangent.constraints.stops):
            return rate
        reactions = [self.to_reaction(int(stop)) for stop in stops]
        stiffness = np.column_stack([reaction.gaps[stops] for reaction in reactions])
        if np.linalg.cond(stiffness) > WORST_CONDITION:
            raise undetermined()
        pushes = np.asarray(np.linalg.solve(stiffness, rate.gaps[stops]), dtype=np.float64)
        return rate.plus(reactions, -pushes)

    def adjoint(self, by_state: StateWeights) -> StateWeights:
        """Derivatives of a result along the equilibrium by the rates of the equations (V11); one transposed solve.

        Raises
        ------
        ConvergenceError
            Active gaps close a chain of held ones.
        """
        tangent, border = self.tangent, self.tangent.border
        if len(tangent.constraints.stops):
            raise undetermined()
        by_x, by_lam, none = by_state.residual, by_state.gaps, np.zeros(border.size)
        if not self.under_load:
            return StateWeights(*tangent.adjoint(by_x, by_lam), none)
        moved = by_x @ tangent.units + by_lam @ tangent.reaction_units + by_state.force
        s = np.asarray(np.linalg.solve(tangent.gradient.T, moved), dtype=np.float64)
        by_x, by_lam = by_x.copy(), by_lam - s @ border.by_reactions
        by_x[border.columns] -= s @ border.row_derivative
        return StateWeights(*tangent.adjoint(by_x, by_lam), -s)

    def to_reaction(self, gap: int) -> StateRate:
        """The rate of the state by a reaction of the gap number `gap`, stops left free."""
        problem = self.solution.problem
        lam = np.zeros(len(self.held))
        lam[gap] = 1.0
        none = np.zeros_like(lam)
        rates = EquationValues(
            -(problem.acting.T @ lam), none, problem.contact_force(lam), np.zeros(problem.border.size)
        )
        rate = self._chains_free(rates)
        return replace(rate, lam=rate.lam + lam)

    def _chains_free(self, rates: EquationValues) -> StateRate:
        """The same where active gaps that close a chain of held ones do not push."""
        tangent, border = self.tangent, self.tangent.border
        x, lam = tangent.respond(rates.residual, rates.gaps)
        displacement = np.zeros(border.size)
        if self.under_load:
            unbalanced = border.rows(x, lam) + rates.force
            displacement = -np.asarray(np.linalg.solve(tangent.gradient, unbalanced), dtype=np.float64)
            x, lam = x + tangent.units @ displacement, lam + tangent.reaction_units @ displacement
        gaps = rates.gaps + border.gap_derivative @ displacement + self.solution.problem.G @ x
        return StateRate(x, lam, gaps, displacement if self.under_load else rates.displacement)


@dataclass(frozen=True)
class ParameterResponse:
    """How an equilibrium follows a parameter, on both sides of its value.

    Attributes
    ----------
    below, above : StateRate
        Derivative of the state toward smaller and toward larger values; the same object where there is no kink.
    reach : (float, float)
        How far the parameter can decrease and increase until, by these rates, a contact opens or closes; infinite
        where none ever does.
    """

    below: StateRate
    above: StateRate
    reach: tuple[float, float]

    @property
    def at_kink(self) -> bool:
        """Whether the sides differ."""
        return self.below is not self.above


def parameter_response(held: HeldEquilibrium, rates: EquationValues, nearest: float) -> ParameterResponse:
    """The response of an equilibrium to a parameter.

    Parameters
    ----------
    held : HeldEquilibrium
        The equilibrium with all its active contacts held.
    rates : EquationValues
        Derivatives of the equations by the parameter at the fixed state.
    nearest : float
        Change of the parameter within which a contact that changes is a kink here.

    Raises
    ------
    ConvergenceError
        The contacts do not determine the state, here or on one side of a kink.
    """
    rate = held.respond(rates)
    doubt = np.zeros(len(held.held), dtype=bool)
    for sign in (-1.0, 1.0):
        doubt |= distances(held.solution, held.held, rate, sign) <= nearest
    if not doubt.any():
        return ParameterResponse(rate, rate, (reach(held, rate, -1.0, doubt), reach(held, rate, 1.0, doubt)))
    firm = HeldEquilibrium.of(held.solution, held.held & ~doubt)
    below, above = one_sided(firm, rates, doubt, -1.0), one_sided(firm, rates, doubt, 1.0)
    return ParameterResponse(below, above, (reach(held, below, -1.0, doubt), reach(held, above, 1.0, doubt)))


def one_sided(firm: HeldEquilibrium, rates: EquationValues, doubt: Mask, sign: float) -> StateRate:
    """The derivative toward one side (V3): contacts in `doubt` (m,) open, or close and push, as the parameter moves.

    Where the parameter moves by `sign`, their gaps `q + M z >= 0` are complementary to the reactions `z >= 0`.
    """
    if not doubt.any():
        return firm.respond(rates)
    reactions = [firm.to_reaction(int(gap)) for gap in np.flatnonzero(doubt)]
    stiffness = np.column_stack([reaction.gaps[doubt] for reaction in reactions])
    rate = firm.respond(rates)
    pushes = solve_lcp(stiffness, sign * rate.gaps[doubt], firm.solution.active[doubt])
    if pushes is None:
        raise undetermined()
    return rate.plus(reactions, sign * pushes)


def distances(solution: Solution, held: Mask, rate: StateRate, sign: float) -> Array:
    """Change of the parameter at which each contact opens or closes as it moves by `sign`, (m,); infinite for never.

    Reactions (of the contacts `held`) and gaps within the tolerance of a solution are at zero already.
    """
    problem = solution.problem
    here = np.where(held, solution.lam / problem.weight, problem.gaps(solution.x))
    change = sign * np.where(held, rate.lam / problem.weight, rate.gaps)
    left = np.where(np.abs(here) <= RESIDUAL_TOLERANCE, 0.0, np.maximum(here, 0.0))
    falling = change < 0.0
    out = np.full(len(left), np.inf)
    out[falling] = left[falling] / -change[falling]
    return out


def reach(held: HeldEquilibrium, rate: StateRate, sign: float, doubt: Mask) -> float:
    """The smallest of `distances` among the contacts that are not in `doubt`."""
    return float(np.min(distances(held.solution, held.held, rate, sign)[~doubt], initial=np.inf))


WORST_CONDITION = 1e12
"""Condition of the stops past which they repeat what other contacts say: nothing determines their reactions."""


def undetermined() -> ConvergenceError:
    """The error of contacts that do not determine the state."""
    return ConvergenceError(
        "no derivative: the active contacts do not determine the reactions (the foil pack has bottomed out)",
        advice="reduce load or eccentricity until journal, petals and bushing no longer touch at one angle",
    )
