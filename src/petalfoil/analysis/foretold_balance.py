"""Balances a little farther, under more load or at a higher speed, foretold by the tangent of a known one alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution

Array = NDArray[np.float64]


def foretold(answer: Solution, more: Array, faster: float = 0.0) -> Solution:
    """The balance under `more` load (n_position,) than that of `answer`, and a part `faster`, by its tangent alone."""
    if answer.elements is not None:
        return replace(answer, elements=foretold_on_elements(answer.elements, more, faster))
    if answer.lines is not None:
        return replace(answer, lines=answer.lines.foretold(more, faster))
    if answer.contacts is None:
        raise ValueError("an equilibrium of the interior point alone has no tangent")
    tangent, problem = answer.contacts.tangent, answer.problem
    there = problem.at(bearing_number=problem.bearing_number * (1.0 + faster))
    forcing = there.linearize(answer.x).residual - problem.linearize(answer.x).residual
    closing = there.gaps(answer.x) - problem.gaps(answer.x)
    move = np.linalg.solve(tangent.gradient, -more - tangent.border.rows(*tangent.respond(forcing, closing)))
    change, reactions = tangent.respond(
        forcing + tangent.forcing @ move, closing + tangent.border.gap_derivative @ move
    )
    moved = there.at(displacement=problem.displacement + move)
    return replace(answer, problem=moved, state=replace(answer.state, x=answer.x + change, lam=answer.lam + reactions))


def foretold_on_elements(found: ElementEquilibrium, more: Array, faster: float) -> ElementEquilibrium:
    """The same of petals with continuous slopes; one factorisation."""
    equations = found.equations
    problem, whole = equations.problem, equations.problem.layout.elements
    if whole is None:
        raise ValueError("this bearing has no petals with continuous slopes")
    there = problem.at(bearing_number=problem.bearing_number * (1.0 + faster))
    ahead = found.under(whole, there)
    tangent = ElementTangent.at(equations, -equations.force, current_run().probe_solver)
    forcing = ahead.equations.newton_residual - equations.newton_residual
    change, move = tangent.correction(forcing, ahead.equations.force - equations.force + more)
    return ahead.moved(there.at(displacement=problem.displacement + move), change)
