"""Derivatives of results by the adjoint of an equilibrium: one transposed solve for each result (V11).

With the tangent `J` of the unknowns `X`, the derivatives `F_e` of the rows by the journal's position, those of the
force on it, `R` and `R_e`, and the derivatives `q_X`, `q_e` of a result,

    J^T a + R^T s = q_X ,   F_e^T a + R_e^T s = q_e                                                    (V11)
    dq/dp = q_p - a^T F_p - s^T (f_p + load_p)

`a` and `s` serve all parameters. They do not tell how the state moves, hence not where a contact opens or closes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.derivatives import ByParameters, Derivative, DerivativesOf, Results
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.result_gradients import GRADIENTS, FieldGradient, gradient
from petalfoil.analysis.smooth_equilibrium import ELEMENTS_CHANGE
from petalfoil.analysis.varied_case import EquationFamily, VariedCase
from petalfoil.case import Case
from petalfoil.equilibrium.element_rates import ElementValues, under
from petalfoil.equilibrium.parameter_response import Equations, EquationValues, StateWeights
from petalfoil.equilibrium.small_motion import TangentEquations
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.sparsity import add_up
from petalfoil.system.asperity_equations import AsperityEquations
from petalfoil.system.point_equations import PointEquations
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]

TANGENT = "ask by the tangent (--method tangent)"


@dataclass(frozen=True, eq=False)
class AdjointDerivatives(ByParameters):
    """Derivatives of some results of one equilibrium by their adjoints.

    Attributes
    ----------
    tangent : DerivativesOf
        The equilibrium, its results and its factorised tangent.
    names : sequence of str
        The results.
    """

    tangent: DerivativesOf
    names: Sequence[str]
    _known: dict[str, StateWeights] = field(default_factory=dict)

    @classmethod
    def of_all(cls, tangent: DerivativesOf) -> AdjointDerivatives:
        """Of all results that have an adjoint."""
        every = cls(tangent, list(tangent.values))
        return cls(tangent, [name for name in every.names if gradient(name, every.evaluated) is not None])

    @cached_property
    def evaluated(self) -> Evaluation:
        """The equilibrium as results read it, once for all of them."""
        return Evaluation.of(self.tangent.case, self.tangent.told)

    @property
    def case(self) -> Case:
        """The bearing."""
        return self.tangent.case

    @property
    def solution(self) -> Solution:
        """The equilibrium."""
        return self.tangent.solution

    @property
    def as_points(self) -> bool:
        """Whether contacts are points; see `DerivativesOf`."""
        return self.tangent.as_points

    @property
    def values(self) -> Results:
        """The results."""
        return {name: self.tangent.values[name] for name in self.names}

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""
        return self.tangent.residual

    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`; see `DerivativesOf.variation`."""
        return self.tangent.variation(path)

    def along(self, variation: EquationFamily) -> Derivative:
        """Derivatives along a variation of the case; its `reach` is not known.

        Raises
        ------
        UsageError
            A result has no adjoint.
        ConvergenceError
            The elements change with the parameter.
        """
        weights = [weight / variation.step for _, weight in variation.stencil]
        there = [variation.at(steps) for steps, _ in variation.stencil]
        moved = [self.in_place(equations) for _, equations in there]
        rates = self.rates(variation)
        sampled = [self.tangent.results(case, state) for (case, _), state in zip(there, moved, strict=True)]
        found, lost = {}, lost_reactions(moved, weights)
        for name in self.names:
            direct = sum(weight * results[name] for weight, results in zip(weights, sampled, strict=True))
            found[name] = float(direct) + self.weights(name).of(rates) - self.by_lost_reactions(name, lost)
        reach = math.nan if lost is None else math.inf  # pressures over asperities neither begin nor end
        return Derivative(found, found, (reach, reach), False, variation.fineness)

    def in_place(self, there: Equations) -> Solution:
        """The state under other equations, unknowns and reactions held; under a load the position too."""
        found, problem = self.tangent.told, there.problem
        if found.elements is None:
            problem = problem if there.load is None else problem.at(displacement=found.problem.displacement)
            return replace(found, problem=problem, load=there.load)
        elements = under(found.elements, there)
        if elements is None:
            raise ConvergenceError(ELEMENTS_CHANGE)
        return replace(found, problem=problem, elements=elements, load=there.load)

    def rates(self, variation: EquationFamily) -> EquationValues | ElementValues:
        """Derivatives of the equations at the fixed state.

        Raises
        ------
        ConvergenceError
            The elements change with the parameter.
        """
        found = self.tangent.told
        if found.elements is None:
            return variation.rates(found)
        rates = self.tangent.smooth.element_rates(variation)
        if rates is None:
            raise ConvergenceError(ELEMENTS_CHANGE)
        return rates

    def by_lost_reactions(self, name: str, lost: Array | None) -> float:
        """Derivative of a result along reactions that asperities lose, (E, S); these are no unknowns."""
        fields, equations = gradient(name, self.evaluated), elements_of(self.tangent.told)
        if lost is None or fields is None or not isinstance(equations, AsperityEquations):
            return 0.0
        return float(np.sum(by_reactions(fields, equations) * lost))

    def weights(self, name: str) -> StateWeights:
        """`-a` and `-s` of a result; one transposed solve, once."""
        if name not in self._known:
            by_state = self.gradient(name)
            held = self.tangent.held if self.tangent.told.elements is None else self.tangent.smooth.held_elements
            self._known[name] = held.adjoint(by_state)
        return self._known[name]

    def gradient(self, name: str) -> StateWeights:
        """Derivatives of a result by unknowns, reactions and position.

        Raises
        ------
        UsageError
            It has no adjoint.
        """
        found = self.tangent.told
        fields = gradient(name, self.evaluated)
        if fields is None:
            if name in GRADIENTS:
                raise UsageError(f"no adjoint of {name}: contact keeps it, and its derivative has two sides: {TANGENT}")
            raise UsageError(f"no adjoint of {name}; there is one of {', '.join(GRADIENTS)}: {TANGENT}")
        if found.elements is None:
            if self.tangent.with_points is not None or found.lines is not None:
                raise UsageError(f"no adjoint where contacts are between nodes of the grid: {TANGENT}")
            return by_nodes(fields, found)
        equations = found.elements.equations
        if isinstance(equations, PointEquations):
            return by_points(fields, equations)
        if isinstance(equations, AsperityEquations):
            return by_samples(fields, equations)
        raise TypeError(f"no adjoint of {type(equations).__name__}")


def elements_of(found: Solution) -> TangentEquations | None:
    """Equations of the petals with continuous slopes, if there are any."""
    return None if found.elements is None else found.elements.equations


def lost_reactions(moved: Sequence[Solution], weights: Sequence[float]) -> Array | None:
    """Derivative of the reactions that asperities lose at fixed unknowns, (E, S); None where there are none."""
    there = [equations for state in moved if isinstance(equations := elements_of(state), AsperityEquations)]
    if not there:
        return None
    parts = [weight * each.contact.every(each.contact.left) for weight, each in zip(weights, there, strict=True)]
    return np.asarray(sum(parts))


def by_nodes(fields: FieldGradient, found: Solution) -> StateWeights:
    """Derivatives by the state of an equilibrium with contacts at nodes, from those by its fields."""
    problem, x = found.problem, found.x
    layout, border = problem.layout, problem.border
    by_x, by_lam = np.zeros(len(x)), border.by_reactions.T @ fields.contact_force
    by_lam[layout.wall.contacts.journal] += fields.reactions
    by_x[problem.positive] = at_unknowns(layout.wall.film.unknown, fields.pressure, len(x[problem.positive]))
    by_x[border.columns] += border.row_derivative.T @ fields.film_force
    wall = layout.unknowns[DEFLECTION]
    by_x[wall] += at_unknowns(layout.wall.film_unknown, fields.film, layout.n_wall)
    film, e = problem.film(x), problem.displacement
    moved = [problem.at(displacement=e + unit).film(x) - film for unit in np.eye(len(e))]
    by_e = fields.displacement + np.array([np.sum(fields.film * change) for change in moved])
    return StateWeights(by_x, by_lam, by_e)


def by_points(fields: FieldGradient, equations: PointEquations) -> StateWeights:
    """The same with contact points; reactions and places are among the unknowns."""
    whole, points = equations.whole, equations.state.points
    weights, last = by_film_and_force(fields, equations, whole), whole.n_wall + whole.n_film
    on_journal = points.every_curve < whole.pack.mesh.count
    weights.residual[last : last + len(on_journal)] += fields.reactions * on_journal
    return weights


def by_samples(fields: FieldGradient, equations: AsperityEquations) -> StateWeights:
    """The same with contact pressures over asperities, which follow deflections and position by their law (K14)."""
    whole = equations.smooth.whole
    curves, by_gaps = whole.curves, -equations.contact.by_nodal(by_reactions(fields, equations))
    weights = by_film_and_force(replace(fields, contact_force=0.0 * fields.contact_force), equations, whole)
    weights.residual[: whole.n_wall] += curves.by_w.T @ by_gaps
    return replace(weights, force=weights.force + curves.by_e.T @ by_gaps)


def by_reactions(fields: FieldGradient, equations: AsperityEquations) -> Array:
    """Derivatives of a result by the reactions of the samples, (E, S)."""
    whole, samples = equations.smooth.whole, equations.samples
    by_nodal = whole.reaction_on_journal @ fields.contact_force
    on_journal = samples.curve[:, None] < whole.pack.mesh.count
    return np.asarray(samples.at_samples(by_nodal) + fields.reactions * on_journal)


def by_film_and_force(fields: FieldGradient, equations: TangentEquations, whole: PointLayout) -> StateWeights:
    """The part of a result that is read from film and forces."""
    first, last = whole.n_wall, whole.n_wall + whole.n_film
    rows = equations.force_rows
    by_x = fields.contact_force @ rows
    by_x[first:last] = fields.film_force @ rows[:, first:last]
    by_x[first:last] += at_unknowns(whole.layout.wall.film.unknown, fields.pressure, whole.n_film)
    by_x[:first] += whole.film_by_w.T @ fields.film.ravel()
    by_e = fields.displacement + whole.film_by_e.T @ fields.film.ravel()
    if fields.gaps is not None:
        by_x[:first] += whole.curves.by_w.T @ fields.gaps
        by_e = by_e + whole.curves.by_e.T @ fields.gaps
    return StateWeights(by_x, np.zeros(0), by_e)


def at_unknowns(unknown: NDArray[np.intp], by_node: Array, n: int) -> Array:
    """Derivatives by unknowns from those by the nodes that read them, (n,)."""
    there = unknown.ravel() >= 0
    return add_up(unknown.ravel()[there], by_node.ravel()[there], n)
