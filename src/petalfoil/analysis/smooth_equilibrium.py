"""How an equilibrium with contacts between nodes follows a variation of its case, as long as none begins or ends.

In 2-D its petals have continuous slopes (`element_rates.py`), in 3-D it has contact lines (`line_rates.py`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.varied_case import (
    CENTRAL,
    FILM_CHANGE,
    PRESSURE_CHANGE,
    SIXTH_ORDER,
    EquationFamily,
    Stencil,
)
from petalfoil.equilibrium.element_rates import ElementRate, ElementValues, element_rate, element_tangent, under
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_rates import LineRate, LineRates, line_rate, line_response
from petalfoil.equilibrium.linear_response import LinearResponse
from petalfoil.equilibrium.parameter_response import Equations
from petalfoil.equilibrium.small_motion import AT_ASPERITIES, ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError

Array = NDArray[np.float64]

STEPS_TO_CONTACT = 10.0
"""Steps that fit before a contact opens or closes: a quotient takes up to four."""

ELEMENT_CHANGE = 1e-4
"""Change of the length of an element in a step, over the length, past which a quotient has sixth order. Stiffness
changes with the cube of the length, forces near a tip may be 1e5 times those of the results, and the last element of a
petal may be a small part of a cell: with 1e-3 a derivative by the arc length was 2e-5 off."""

LARGE_ELEMENT_CHANGE = 2e-3
"""The same past which such steps are shortened: then 1e-13 is left of the force of an element."""

ELEMENTS_CHANGE = "no derivative: the elements of the petals change with the parameter"


class SmoothRate(Protocol):
    """How an equilibrium follows a parameter as long as no contact begins or ends."""

    @property
    def reach(self) -> tuple[float, float]:
        """How far the parameter can decrease and increase until one does."""

    def moved(self, solution: Solution, change: float, there: Equations) -> Solution | None:
        """The equilibrium after a change of the parameter, under the equations `there`; None on other elements."""


@dataclass(frozen=True, eq=False)
class SmoothEquilibrium:
    """An equilibrium and its tangent, factorised once.

    Attributes
    ----------
    told : Solution
        The equilibrium that results are taken from.
    """

    told: Solution

    @property
    def between_nodes(self) -> bool:
        """Whether it has contacts between nodes."""
        return self.told.elements is not None or self.told.lines is not None

    @cached_property
    def held_elements(self) -> ElementTangent:
        """The tangent of petals with continuous slopes.

        Raises
        ------
        NoPointsError
            The contacts do not determine the state.
        """
        if self.told.elements is None:
            raise ValueError("the equilibrium has no petals with continuous slopes")
        return element_tangent(self.told.elements, under_load=self.told.load is not None)

    @cached_property
    def held_lines(self) -> LinearResponse | None:
        """The same with contact lines; None where the contacts do not determine the state."""
        return line_response(self.told.lines) if isinstance(self.told.lines, LineContacts) else None

    def rate(self, variation: EquationFamily) -> SmoothRate | None:
        """Derivative of the state (V9); None where the grid changes.

        Raises
        ------
        ConvergenceError
            The contacts do not determine the state.
        """
        return self._line_rate(variation) if self.told.elements is None else self._element_rate(variation)

    def _element_rate(self, variation: EquationFamily) -> ElementRate | None:
        """The rate of petals with continuous slopes."""
        rates = self.element_rates(variation)
        if rates is None or self.told.elements is None:
            return None
        try:
            return element_rate(self.told.elements, self.held_elements, rates)
        except NoPointsError as failure:
            raise ConvergenceError(f"no derivative: {failure}", advice="change the case by a millionth") from None

    def _line_rate(self, variation: EquationFamily) -> LineRate | None:
        """The same with contact lines."""
        found, response = self.told.lines, self.held_lines
        weights = [weight / variation.step for _, weight in variation.stencil]
        if not isinstance(found, LineContacts) or response is None:
            return None
        rates = LineRates.of(found, [variation.at(steps)[1] for steps, _ in variation.stencil], weights)
        return None if rates is None else line_rate(found, response, rates)

    def element_rates(self, variation: EquationFamily) -> ElementValues | None:
        """Derivatives of the equations at the fixed state; None where the elements change."""
        found = self.told.elements
        if found is None:
            raise ValueError("the equilibrium has no petals with continuous slopes")
        for family, points in (self._long_steps(found, variation), (variation, variation.stencil)):
            weights = [weight / family.step for _, weight in points]
            rates = ElementValues.rates(found, [family.at(steps)[1] for steps, _ in points], weights)
            if rates is not None:
                return rates
        return None

    def _long_steps(self, found: ElementEquilibrium, variation: EquationFamily) -> tuple[EquationFamily, Stencil]:
        """The variation in steps for a held film, see `ELEMENT_CHANGE`, and its quotient.

        It is itself where the elements are others, and over asperities, whose pressures change with gaps of 5 nm.
        """
        long = variation.at_held_film
        points, last = long.stencil, long.stencil[-1][0]
        ahead = None if over_asperities(self.told) else under(found, long.at(last)[1])
        if ahead is None:
            return variation, variation.stencil
        own, there = found.pack.curves.angle, ahead.pack.curves.angle
        change = float(np.max(np.abs(there / own - 1.0))) / abs(last)
        if change <= ELEMENT_CHANGE or points is not CENTRAL:
            return long, points
        shorter = long.finer(max(long.fineness * min(LARGE_ELEMENT_CHANGE / change, 1.0), variation.fineness))
        return shorter, SIXTH_ORDER if shorter.admits(SIXTH_ORDER) else shorter.stencil

    def in_steps_of_the_line(self, variation: EquationFamily, rate: SmoothRate) -> EquationFamily:
        """The variation in the longest steps that change neither film nor contacts much; see `FILM_CHANGE`.

        The line of the state changes the film far less, or more, than the parameter does at a fixed state.
        """
        steps = variation.stencil[-1][0]
        ahead = self.moved(rate, steps * variation.step, variation.at(steps)[1])
        own, there = film_of(self.told), film_of(ahead)
        change = float(np.max(np.abs(there / own - 1.0))) / FILM_CHANGE
        before, after = self.told.elements, ahead.elements
        if before is not None and after is not None:
            change = max(change, before.nonlinearity(after) / PRESSURE_CHANGE)
        change = max(change / abs(steps), STEPS_TO_CONTACT * variation.step / min(rate.reach))
        most = variation.fineness if over_asperities(self.told) else variation.most_fineness
        fineness = min(variation.fineness / change if change > 0.0 else math.inf, most)
        found = variation.finer(fineness)
        return found if fineness <= variation.fineness or self._is_on_one_grid(rate, found) else variation

    def _is_on_one_grid(self, rate: SmoothRate, variation: EquationFamily) -> bool:
        """Whether the elements are the same at all points of the quotient."""
        ahead = (rate.moved(self.told, n * variation.step, variation.at(n)[1]) for n, _ in variation.stencil)
        return all(state is not None for state in ahead)

    def moved(self, rate: SmoothRate, change: float, there: Equations) -> Solution:
        """The equilibrium after a change of the parameter.

        Raises
        ------
        ConvergenceError
            The elements change with the parameter.
        """
        ahead = rate.moved(self.told, change, there)
        if ahead is None:
            raise ConvergenceError(ELEMENTS_CHANGE)
        return ahead


def over_asperities(solution: Solution) -> bool:
    """Whether contact pressures over asperities carry."""
    return solution.elements is not None and solution.elements.contact_model == AT_ASPERITIES


def film_of(solution: Solution) -> Array:
    """Film thickness of petals with continuous slopes, or between contact lines [m]."""
    problem, elements, lines = solution.problem, solution.elements, solution.lines
    if elements is not None:
        return elements.equations.film_thickness * elements.equations.problem.layout.scales.length
    film = problem.film(solution.x) if lines is None else lines.problem.film(lines.x)
    return np.asarray(film * problem.layout.scales.length)
