"""What derivatives are compared with: the results of equilibria that are solved again beside the first one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from petalfoil.analysis.derivatives import Derivative, DerivativesOf, Results, nearest_turn
from petalfoil.analysis.varied_case import VariedCase
from petalfoil.case import Case
from petalfoil.case.parameters import parameters_of
from petalfoil.equilibrium.element_rates import under
from petalfoil.equilibrium.line_contacts import LineContacts, stepped
from petalfoil.equilibrium.line_tangent import LineTangent
from petalfoil.equilibrium.parameter_response import Equations
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.results.schema import SCALARS

STEPS = 20
"""Corrections with the tangent of the first equilibrium: each takes three digits off the residual, or one where two
contact points are close together."""

AT_LEAST = 3
"""Corrections that are made in any case, so that nothing is left of a start that the derivative foretold."""

SMALL = 1e-11
"""Correction of the unknowns at which the second equilibrium is reached."""

CLEAR = 2.5
"""Steps of the difference quotient that must fit before the nearest contact opens or closes."""

WITHOUT_EFFECT = ("model", "rotor", "surface.friction_width", "surface.petal_friction", "petals.free_shape_tolerance")
"""Parameters of the numerical model, the rotor and histories, on which an equilibrium does not depend."""


def solved_again(derivatives: DerivativesOf, there: Equations, start: Solution | None = None) -> Solution:
    """The equilibrium of `there` with the same active contacts, by Newton's method from `start`, or the first one."""
    found = derivatives.told if start is None else start
    if found.elements is not None:
        return replace(found, elements=on_elements(derivatives, found.elements, there), problem=there.problem)
    if isinstance(found.lines, LineContacts):
        return replace(found, lines=on_lines(derivatives, found.lines, there), problem=there.problem, load=there.load)
    first, held = derivatives.solution, derivatives.held
    problem = there.problem if there.load is None else there.problem.at(displacement=first.problem.displacement)
    found = replace(first, problem=problem, load=there.load)
    for _ in range(STEPS):
        values = there.at_state(found)
        rate = held.respond(replace(values, displacement=np.zeros_like(values.displacement)))
        found = rate.moved(found, 1.0, there)
        if np.max(np.abs(rate.x)) < SMALL * np.max(np.abs(found.x)):
            return found
    raise AssertionError("the second equilibrium was not reached")


def on_elements(derivatives: DerivativesOf, first: ElementEquilibrium, there: Equations) -> ElementEquilibrium:
    """The same with petals of continuous slopes: contacts stay, their places and reactions follow."""
    load = there.load
    tangent, found = derivatives.smooth.held_elements, under(first, there)
    assert found is not None
    for count in range(STEPS):
        equations = found.equations
        force = equations.newton_force + (np.zeros_like(equations.force) if load is None else load)
        change, move = tangent.correction(equations.newton_residual, force)
        problem = equations.problem.at(displacement=equations.problem.displacement + move)
        found = found.moved(problem, change)
        small = np.max(np.abs(change)) < SMALL * max(1.0, np.max(np.abs(found.equations.deflection)))
        if small and count + 1 >= AT_LEAST:
            return found
    raise AssertionError("the second equilibrium was not reached")


def on_lines(derivatives: DerivativesOf, first: LineContacts, there: Equations) -> LineContacts:
    """The same in 3-D with contact lines, whose points follow."""
    response, state = derivatives.smooth.held_lines, first.under(there.problem, there.load)
    assert response is not None
    tangent = LineTangent.of(first, response)
    for count in range(STEPS):
        before, state = state, stepped(state, tangent)
        if np.max(np.abs(state.x - before.x)) < SMALL * np.max(np.abs(state.x)) and count + 1 >= AT_LEAST:
            return state
    raise AssertionError("the second equilibrium was not reached")


@dataclass(frozen=True)
class Comparison:
    """A derivative beside the difference quotient of equilibria solved again.

    Attributes
    ----------
    path : str
        The parameter.
    clear : bool
        Whether no contact opens or closes within the quotient.
    error : float
        Largest difference of a result, both times the size of the parameter, over the larger of the derivative and
        the result itself [1].
    worst : str
        The result that has it.
    """

    path: str
    clear: bool
    error: float
    worst: str = ""


def parameters_with_effect(case: Case, *, under_load: bool) -> list[str]:
    """Continuous parameters that an equilibrium depends on."""
    other = "operation.eccentricity" if under_load else "operation.load"
    return [
        path
        for path, parameter in parameters_of(case).items()
        if not parameter.is_count and parameter.value is not None and not path.startswith((*WITHOUT_EFFECT, other))
    ]


def compared(derivatives: DerivativesOf, path: str) -> Comparison:
    """The derivative by a parameter beside that from two equilibria, or four where the parameter is at its limit."""
    variation = derivatives.variation(path)
    found = derivatives.along(variation)
    variation = variation.finer(found.fineness)
    if found.at_kink or min(found.reach) < CLEAR * variation.step:
        return Comparison(path, False, 0.0)
    quotient = difference_quotient(derivatives, variation)
    errors = {name: relative_error(derivatives, variation, (name, found, quotient)) for name in quotient}
    worst = max(errors, key=errors.__getitem__)
    return Comparison(path, True, errors[worst], worst)


def difference_quotient(derivatives: DerivativesOf, variation: VariedCase) -> Results:
    """Difference quotient of results of equilibria solved again, at the points of the variation."""
    rate = derivatives.smooth.rate(variation) if derivatives.smooth.between_nodes else None
    sampled = []
    for steps, weight in variation.stencil:
        case, there = variation.at(steps)
        start = None if rate is None else derivatives.smooth.moved(rate, steps * variation.step, there)
        sampled.append((weight, derivatives.results(case, solved_again(derivatives, there, start))))
    return {
        name: sum(weight * nearest_turn(name, results[name], value) for weight, results in sampled) / variation.step
        for name, value in derivatives.values.items()
    }


def relative_error(derivatives: DerivativesOf, variation: VariedCase, pair: tuple[str, Derivative, Results]) -> float:
    """Difference of a derivative over its size, in relative changes of result and parameter."""
    name, found, quotient = pair
    change = change_of(derivatives, variation)
    error = abs(found.above[name] - quotient[name]) * change
    return (
        error / max(abs(found.above[name]) * change, scale_of(derivatives, name, change * variation.gap_rate))
        if error > 0.0
        else 0.0
    )


def change_of(derivatives: DerivativesOf, variation: VariedCase) -> float:
    """What a parameter is compared with: its size, of the bearing's radii the clearance that they leave."""
    radii = ("bearing.journal_radius", "bearing.bushing_radius")
    return derivatives.case.bearing.clearance if variation.parameter.path in radii else variation.size


def scale_of(derivatives: DerivativesOf, name: str, gap_change: float) -> float:
    """What a change of a result is compared with.

    Forces: the largest of them; moments: that times the length. Lengths: themselves, and what the parameter does to the
    gaps of the free wall, `gap_change` [m], from which a film that keeps its thickness is what is left. Angles and
    fractions: one.
    """
    values, unit = derivatives.values, SCALARS[name].units
    largest = max(abs(value) for other, value in values.items() if SCALARS[other].units == "N")
    if unit == "N":
        return largest
    if name == "attitude_angle":  # the direction of a force that may be a small part of those it is left from
        return largest / values["bearing_force"]
    if name.startswith("moment"):
        return largest * derivatives.case.bearing.length
    if unit == "m":
        return max(abs(values[name]), gap_change)
    if name == "knudsen_number":
        return values[name] * max(1.0, gap_change / values["min_film_thickness"])
    return 1.0 if unit in ("rad", "1") else abs(values[name])
