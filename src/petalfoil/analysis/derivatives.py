"""Exact derivatives of the results of an equilibrium by the parameters of its case.

The state follows a parameter by one solve with the tangent of the equilibrium (V2). A result is a function of state and
case; its derivative is taken along that line, through geometry, mesh and units alike. Where a contact is about to open
or to close, the derivative has two values, one on either side.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import all_fields
from petalfoil.analysis.heat_results import heat_results
from petalfoil.analysis.records import position
from petalfoil.analysis.smooth_equilibrium import SmoothEquilibrium, SmoothRate, over_asperities
from petalfoil.analysis.varied_case import (
    ABOVE,
    BELOW,
    FILM_CHANGE,
    EquationFamily,
    Stencil,
    VariedCase,
    equations_of,
    quotient,
)
from petalfoil.case import Case
from petalfoil.case.parameters import parameter_of
from petalfoil.dynamics.leading_mode import LeadingMode
from petalfoil.equilibrium.parameter_response import (
    Equations,
    EquationValues,
    HeldEquilibrium,
    ParameterResponse,
    StateRate,
)
from petalfoil.equilibrium.point_rates import PointEquilibrium, point_response
from petalfoil.equilibrium.solution import Solution, total_residual
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.parts import scalars_of
from petalfoil.results.schema import SCALARS
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

Results: TypeAlias = Mapping[str, float]
"""Results of an equilibrium by name, SI."""
ResultsOf: TypeAlias = Callable[[Case, Solution], Results]

KINK = 1e-6
"""A contact that opens or closes within this relative change of a parameter makes a kink: its derivative would hold for
no change that a user can mean."""


FOREIGN = 1e-6
"""Residual of a state above which it is that of another case; a solution has 1e-8."""


@dataclass(frozen=True)
class Derivative:
    """Derivatives of the results by one parameter.

    Attributes
    ----------
    below, above : dict
        Derivative of each result toward smaller and toward larger values of the parameter; equal where it is smooth.
    reach : (float, float)
        How far the parameter can decrease and increase until a contact opens or closes.
    at_kink : bool
        Whether the two sides differ.
    fineness : float
        Steps in which the results were differentiated, see `VariedCase`.
    remark : str
        What they are not known to the last digits by, for people.
    """

    below: Results
    above: Results
    reach: tuple[float, float]
    at_kink: bool
    fineness: float = 1.0
    remark: str = ""


ROUNDED = "over asperities: in stiff packs rounding leaves some 1e-5 of the largest result of this kind"
NOT_ON_LINES = "with contacts at nodes, isolated ones moved between them, not on contact lines"
POINT_CHANGES = "a contact point begins or ends here: derivatives with contacts at nodes"


class ByParameters(ABC):
    """Something with derivatives along variations of its case, hence by its parameters."""

    @abstractmethod
    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`."""

    @abstractmethod
    def along(self, variation: VariedCase) -> Derivative:
        """Derivatives along a variation of the case."""

    def by(self, path: str) -> Derivative:
        """Derivatives by the parameter `path`.

        Raises
        ------
        DefinitionError, UsageError
            The case has no such parameter, or none that it could be differentiated by.
        ConvergenceError
            The contacts do not determine the state.
        """
        return self.along(self.variation(path))


@dataclass(frozen=True, eq=False)
class DerivativesOf(ByParameters):
    """Derivatives of the results of one equilibrium.

    Attributes
    ----------
    case : Case
        The bearing, with the load or the eccentricity that the equilibrium belongs to.
    solution : Solution
        The equilibrium.
    results : callable
        Results of a case and a solution.
    as_points : bool
        Whether contacts are points that travel between nodes, or held at their nodes: the first converges with the
        grid, the second is the derivative of the discrete equations. With petals of continuous slopes the first is
        exact too (V9); without them, only isolated contacts travel (V5).
    """

    case: Case
    solution: Solution
    results: ResultsOf
    as_points: bool = False

    @cached_property
    def at_nodes(self) -> Solution:
        """The equilibrium with contacts at nodes."""
        return replace(self.solution, elements=None, lines=None)

    @property
    def told(self) -> Solution:
        """The equilibrium that results are taken from."""
        return self.solution if self.as_points else self.at_nodes

    @cached_property
    def values(self) -> Results:
        """The results themselves."""
        return self.results(self.case, self.told)

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""
        return self.told.reported_residual

    @cached_property
    def held(self) -> HeldEquilibrium:
        """The equilibrium, its tangent factorised."""
        return HeldEquilibrium.of(self.at_nodes, self.solution.active)

    @cached_property
    def smooth(self) -> SmoothEquilibrium:
        """The equilibrium that results are taken from, with contacts between nodes where it has them."""
        return SmoothEquilibrium(self.told)

    @cached_property
    def with_points(self) -> PointEquilibrium | None:
        """The same with contacts as points; None where they are asked for at nodes, or are all there."""
        return PointEquilibrium.of(self.at_nodes) if self.as_points else None

    @cached_property
    def own(self) -> Equations:
        """The equations of the case itself.

        Raises
        ------
        ConvergenceError
            The solution is not one of theirs.
        """
        found = self.solution
        own = equations_of(self.case, under_load=found.load is not None).at_temperatures(found.problem.temperatures)
        residual = total_residual(own.problem.at(displacement=found.problem.displacement), found.state)
        if not residual <= FOREIGN:
            raise ConvergenceError(
                f"no derivative: the equations of the case hold at this state to {residual:.1e} only",
                advice="ask for the derivatives of the case that the state was solved for",
            )
        return own

    @cached_property
    def thinnest(self) -> float:
        """Minimum film thickness at the nodes [m]: what steps are small beside."""
        problem = self.solution.problem
        return float(np.min(problem.film(self.solution.x))) * problem.layout.scales.length

    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`.

        Raises
        ------
        DefinitionError
            The case has no such parameter.
        UsageError
            It is a count, or follows from a rule.
        """
        parameter = parameter_of(self.case, path)
        if parameter.is_count or parameter.value is None:
            why = "is a whole number" if parameter.is_count else "follows from other keys in this case; give it a value"
            raise UsageError(f"no derivative by {path}: it {why}")
        return VariedCase(self.case, parameter, self.own, self.thinnest)

    def response(self, rates: EquationValues, nearest: float) -> ParameterResponse:
        """How the state follows; contacts that change within `nearest` of the parameter make a kink."""
        return point_response(self.with_points, self.held, rates, nearest)

    def along(self, variation: EquationFamily) -> Derivative:
        """Derivatives along a variation of the case."""
        if not self.smooth.between_nodes:
            lost = self.as_points and self.case.has_contact_lines and bool(np.any(self.solution.active))
            return replace(self._at_nodes(variation), remark=NOT_ON_LINES if lost else "")
        rate = self.smooth.rate(variation)
        if rate is None or min(rate.reach) <= KINK * variation.size:
            return replace(self._at_nodes(variation), remark=POINT_CHANGES)
        along_line = self.smooth.in_steps_of_the_line(variation, rate)
        along = self._quotients(along_line, along_line.stencil, rate)
        remark = ROUNDED if over_asperities(self.told) else ""
        return Derivative(along, along, rate.reach, False, along_line.fineness, remark)

    def _at_nodes(self, variation: EquationFamily) -> Derivative:
        """The derivative with contacts at nodes, isolated ones moved between them where they are `as_points`."""
        response = self.response(variation.rates(self.at_nodes), KINK * variation.size)
        finer = self._small_beside_the_film(variation, response)
        if not response.at_kink:
            along = self._along(finer, response.above, variation.stencil)
            return Derivative(along, along, response.reach, False, finer.fineness)
        return self._on_both_sides(finer, response)

    def _small_beside_the_film(self, variation: EquationFamily, response: ParameterResponse) -> EquationFamily:
        """The variation in steps that change no film by more than `FILM_CHANGE` of it: petals may move it further."""
        steps = variation.stencil[-1][0]
        there = response.above.moved(self.at_nodes, steps * variation.step, variation.at(steps)[1])
        unit = there.problem.layout.scales.length / self.solution.problem.layout.scales.length
        own, moved = self.solution.problem.film(self.solution.x), there.problem.film(there.x) * unit
        change = float(np.max(np.abs(moved / own - 1.0))) / abs(steps)
        return variation if change <= FILM_CHANGE else variation.finer(variation.fineness * FILM_CHANGE / change)

    def _quotients(self, variation: EquationFamily, points: Stencil, rate: SmoothRate) -> Results:
        """Derivatives of the results along the line of the state."""
        sampled = []
        for steps, _ in points:
            case, there = variation.at(steps)
            sampled.append(self.results(case, self.smooth.moved(rate, steps * variation.step, there)))
        return self._differences(variation, points, sampled)

    def _differences(self, variation: EquationFamily, points: Stencil, sampled: Sequence[Results]) -> Results:
        """Difference quotients of results at the points of a stencil."""
        return {
            name: quotient(points, variation.step, [nearest_turn(name, at[name], value) for at in sampled])
            for name, value in self.values.items()
        }

    def _on_both_sides(self, variation: EquationFamily, response: ParameterResponse) -> Derivative:
        """Derivatives at a kink; nan on a side where the parameter cannot go."""
        nothing = dict.fromkeys(self.values, math.nan)
        below, above = (
            self._along(variation, rate, points) if variation.admits(points) else nothing
            for rate, points in ((response.below, BELOW), (response.above, ABOVE))
        )
        return Derivative(below, above, response.reach, True, variation.fineness)

    def _along(self, variation: EquationFamily, rate: StateRate, points: Stencil) -> Results:
        """Derivatives of the results along the line of the state."""
        sampled = []
        for steps, _ in points:
            case, equations = variation.at(steps)
            sampled.append(self.results(case, rate.moved(self.at_nodes, steps * variation.step, equations)))
        return self._differences(variation, points, sampled)


def nearest_turn(name: str, angle: float, own: float) -> float:
    """A result; of an angle, the one of its turns that is nearest to its `own` value."""
    if name not in SCALARS or SCALARS[name].units != "rad":
        return angle
    return own + math.remainder(angle - own, 2.0 * math.pi)


def equilibrium_results(case: Case, solution: Solution) -> dict[str, float]:
    """Results of an equilibrium that can be differentiated, SI: forces, film, friction, leakage, stress, position.

    Temperatures and heat flows too, where there is a heat network. The places of extremes are left out: they jump from
    one strip or one node to another.
    """
    found = Evaluation.of(case, solution)
    heat = heat_results(case, solution)
    parts = (found.forces(), found.film(), wall_kind(case).scalars(all_fields(found)), position(case, solution))
    told = scalars_of(*parts, *([] if heat is None else [heat]))
    results = {name: float(value) for name, value in told.items() if isinstance(value, float)}
    return {name: value for name, value in results.items() if name not in WITHOUT_DERIVATIVE}


GROWTH = ("growth_rate", "growth_frequency")
"""Results of the leading eigenvalue, which ask for its vectors."""


def results_with_growth(solution: Solution) -> ResultsOf:
    """The results of `equilibrium_results` and those of the leading eigenvalue about `solution`.

    Raises
    ------
    ConvergenceError
        The eigenvalue has no derivative.
    """
    mode = LeadingMode.of(solution)

    def results(case: Case, moved: Solution) -> Results:
        rate, omega = mode.eigenvalue(moved), case.operation.speed
        growth = (rate.real * omega, abs(rate.imag) * omega)
        return {**equilibrium_results(case, moved), **dict(zip(GROWTH, growth, strict=True))}

    return results


WITHOUT_DERIVATIVE = ("min_film_thickness_angle", "min_film_thickness_z", "peak_pressure_angle", "heat_balance_error")
"""Places of extremes, which jump, and what is rounding."""
