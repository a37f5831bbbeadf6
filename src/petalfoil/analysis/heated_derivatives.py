"""Exact derivatives of the results of an equilibrium with its heat network.

The temperatures follow every parameter. With the state held in equilibrium at fixed temperatures `T`, the heat balances
`r` and a result `q` have derivatives along the parameter `p` and along each temperature. The balances stay zero:

    r_p + r_T T' = 0,    dq/dp = q_p + q_T T'                                                          (V7)

where subscripts are derivatives along the equilibrium, contacts held, by (V2) or (V5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.derivatives import KINK, ByParameters, Derivative, DerivativesOf, Results, ResultsOf
from petalfoil.analysis.varied_case import CENTRAL, EquationFamily, Stencil, VariedCase
from petalfoil.case import Case
from petalfoil.equilibrium.parameter_response import Equations, EquationValues
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.system.heat_network import NODES, HeatNetwork
from petalfoil.system.heat_rows import HeatRows
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]

TEMPERATURE_STEP = 0.02
"""Step of a temperature [K], made finer where growth moves films by more than `FILM_CHANGE` of them."""

BALANCES = tuple(f"heat balance {node}" for node in Temperatures._fields)
"""Names of the balances among the results that are differentiated; none of a user's results has a blank."""


@dataclass(frozen=True, eq=False)
class TemperatureVariation(EquationFamily):
    """The equations at several values of one temperature.

    Attributes
    ----------
    case : Case
        The bearing.
    own : Equations
        Its equations at its own temperatures.
    node : int
        Which of the temperatures varies.
    fineness : float
        Steps over `TEMPERATURE_STEP` [1].
    """

    case: Case
    own: Equations
    node: int
    fineness: float = 1.0

    @property
    def step(self) -> float:
        """Step [K]."""
        return self.fineness * TEMPERATURE_STEP

    @property
    def size(self) -> float:
        """The temperature itself [K]."""
        return self._own[self.node]

    @property
    def stencil(self) -> Stencil:
        """Steps to both sides."""
        return CENTRAL

    def at(self, steps: int) -> tuple[Case, Equations]:
        """Case and equations a number of steps away."""
        nodes = list(self._own)
        nodes[self.node] += steps * self.step
        return self.case, self.own.at_temperatures(Temperatures(*nodes))

    def admits(self, points: Stencil) -> bool:
        """A temperature has no range."""
        return True

    def finer(self, fineness: float) -> Self:
        """The same with steps of another `fineness`."""
        return replace(self, fineness=fineness)

    @property
    def _own(self) -> Temperatures:
        if self.own.problem.temperatures is None:
            raise ValueError("this equilibrium has no temperatures")
        return self.own.problem.temperatures


@dataclass(frozen=True, eq=False)
class HeatedDerivatives(ByParameters):
    """Derivatives of the results of one equilibrium whose temperatures follow.

    Attributes
    ----------
    frozen : DerivativesOf
        Derivatives at fixed temperatures of its results and of the heat balances.
    """

    frozen: DerivativesOf

    @property
    def case(self) -> Case:
        """The bearing."""
        return self.frozen.case

    @property
    def as_points(self) -> bool:
        """Whether contacts are points; see `DerivativesOf`."""
        return self.frozen.as_points

    @property
    def solution(self) -> Solution:
        """The equilibrium."""
        return self.frozen.solution

    @cached_property
    def values(self) -> Results:
        """The results."""
        return {name: value for name, value in self.frozen.values.items() if name not in BALANCES}

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""
        return self.frozen.residual

    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`; see `DerivativesOf.variation`."""
        return self.frozen.variation(path)

    @cached_property
    def by_temperatures(self) -> list[tuple[EquationFamily, Derivative]]:
        """Derivatives along each temperature, the others held."""
        families = [TemperatureVariation(self.case, self.frozen.own, node) for node in range(NODES)]
        return [(family, smooth(self.frozen.along(family))) for family in families]

    def along(self, variation: VariedCase) -> Derivative:
        """Derivatives along a variation of the case (V7).

        Raises
        ------
        ConvergenceError
            A contact opens or closes here, or the temperatures are at the verge of a runaway.
        """
        held = smooth(self.frozen.along(variation))
        change = self.temperatures_along(held)
        results = dict.fromkeys(self.values, 0.0)
        for name in results:
            by_temperature = [found.above[name] for _, found in self.by_temperatures]
            results[name] = held.above[name] + float(change @ np.array(by_temperature))
        response = self.frozen.response(self._rates(variation, change), KINK * variation.size)
        return smooth(Derivative(results, results, response.reach, response.at_kink, held.fineness))

    def temperatures_along(self, held: Derivative) -> Array:
        """Derivatives of the temperatures, (4,), from those of the balances at fixed temperatures.

        Raises
        ------
        ConvergenceError
            The balances do not determine them.
        """
        slopes = np.array([[found.above[name] for _, found in self.by_temperatures] for name in BALANCES])
        if not np.linalg.cond(slopes) < WORST_CONDITION:
            raise ConvergenceError(
                "no derivative: the bearing is where its steady temperature ends",
                advice="lower the speed or the load, or carry more heat away",
            )
        return -np.asarray(np.linalg.solve(slopes, [held.above[name] for name in BALANCES]), dtype=np.float64)

    def _rates(self, variation: VariedCase, change: Array) -> EquationValues:
        """Derivatives of the equations with the temperatures following."""
        families: list[EquationFamily] = [variation, *(family for family, _ in self.by_temperatures)]
        return EquationValues.combined([family.rates(self.solution) for family in families], [1.0, *change])


WORST_CONDITION = 1e12
"""Condition of the balances by the temperatures past which a runaway begins."""

Derivatives: TypeAlias = DerivativesOf | HeatedDerivatives


def derivatives_of(case: Case, solution: Solution, results: ResultsOf, *, as_points: bool = False) -> Derivatives:
    """Derivatives of results of an equilibrium; see `DerivativesOf`. Its temperatures follow where it has a network."""
    if case.heat is None:
        return DerivativesOf(case, solution, results, as_points)
    return HeatedDerivatives(DerivativesOf(case, solution, with_balances(results), as_points))


def with_balances(results: ResultsOf) -> Callable[[Case, Solution], Results]:
    """Results and the heat balances [W]."""

    def both(case: Case, solution: Solution) -> Results:
        network = HeatNetwork.of(case)
        if network is None:
            raise ValueError("this case has no [heat]")
        gained = HeatRows(network, solution.problem, solution.x, solution.lam).residual
        return {**results(case, solution), **{name: float(r) for name, r in zip(BALANCES, gained, strict=True)}}

    return both


def smooth(found: Derivative) -> Derivative:
    """A derivative that is the same on both sides.

    Raises
    ------
    ConvergenceError
        It is not.
    """
    if found.at_kink:
        raise ConvergenceError(
            "no derivative with [heat]: a contact opens or closes at this very state",
            advice="change the case by a millionth",
        )
    return found
