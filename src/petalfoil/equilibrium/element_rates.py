"""How an equilibrium of petals with continuous slopes follows a parameter of its case (V9).

Its equations `F(X, e, p) = 0`, reactions and places of contact points among the unknowns `X`, and the force on the
journal `f(X, e, p)` are smooth as long as no contact begins or ends. With the tangent of Newton's method (C10),

    J X' + F_e e' = -F_p ,     R X' + R_e e' = -f_p - load_p    under a load                           (V9)
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import OVERLAP, PULL, least_pull
from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.parameter_response import Equations
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution

Array = NDArray[np.float64]

SMALL = 1e-4
"""Largest change of an unknown over which the closing of gaps is measured: they are nearly linear in all of them."""


@dataclass(frozen=True)
class ElementValues:
    """Left-hand sides at one value of a parameter, or their derivatives by it, the unknowns held.

    Attributes
    ----------
    residual : (n,) array
        Rows of the equations.
    force : (d,) array
        Force on the journal, load included.
    displacement : (d,) array
        Displacement of the journal where it is given.
    gaps : (sample,) array
        Gaps along all curves, see `ElementEquilibrium.gaps`.
    film : (strip, node, axial) array
        Film thickness [1].
    """

    residual: Array
    force: Array
    displacement: Array
    gaps: Array
    film: Array

    @classmethod
    def rates(
        cls, found: ElementEquilibrium, there: Sequence[Equations], weights: Sequence[float]
    ) -> ElementValues | None:
        """Derivatives from the equations at several values of the parameter; None where petals have other elements.

        The rows of the film follow its thickness by the chain rule, `F_p + F_H H_p`: flows change with its cube, while
        gaps are nearly linear in every parameter. So the steps may be as long as the film is thick, and rounded gaps,
        of petals that deflect by thousands of films, count for little.
        """
        values = [cls._at_own_film(found, equations) for equations in there]
        known = [value for value in values if value is not None]
        if len(known) < len(values):
            return None
        parts = zip(*((v.residual, v.force, v.displacement, v.gaps, v.film) for v in known), strict=True)
        rates = cls(*(sum((w * a for w, a in zip(weights, part, strict=True)), 0.0 * part[0]) for part in parts))
        first = len(found.equations.deflection)
        through_film = found.equations.film.moved(rates.film.ravel(), 0.0)
        rates.residual[first : first + len(through_film)] += through_film
        return rates

    @classmethod
    def _at_own_film(cls, found: ElementEquilibrium, there: Equations) -> ElementValues | None:
        """Those of the equations `there` with the film of `found`, and their film."""
        moved = under(found, there)
        if moved is None:
            return None
        equations = moved.equations.with_film(found.equations.film_thickness)
        load = np.zeros_like(equations.force) if there.load is None else there.load
        force, displacement = equations.newton_force + load, equations.problem.displacement
        return cls(equations.newton_residual, force, displacement, moved.gaps[0], moved.equations.film_thickness)


def under(found: ElementEquilibrium, there: Equations) -> ElementEquilibrium | None:
    """The state of `found` under other equations, under a load at its own position; None on other elements."""
    problem = there.problem
    if there.load is not None:
        problem = problem.at(displacement=found.equations.problem.displacement)
    whole = problem.layout.elements
    same = whole is not None and np.array_equal(whole.curves.elements, found.pack.curves.elements)
    return found.under(whole, problem) if whole is not None and same else None


@dataclass(frozen=True)
class ElementRate:
    """Derivative of an equilibrium by a parameter.

    Attributes
    ----------
    change : (n,) array
        Of the unknowns.
    displacement : (d,) array
        Of the journal's displacement.
    reach : (float, float)
        How far the parameter can decrease and increase until a contact begins or ends; infinite for never.
    """

    change: Array
    displacement: Array
    reach: tuple[float, float]

    def moved(self, solution: Solution, change: float, there: Equations) -> Solution | None:
        """The equilibrium after a `change` of the parameter, under the equations `there`; None on other elements."""
        moved = None if solution.elements is None else under(solution.elements, there)
        if moved is None:
            return None
        before = moved.equations.problem.displacement if there.load is not None else solution.position
        problem = moved.equations.problem.at(displacement=before + change * self.displacement)
        return replace(
            solution, problem=there.problem, elements=moved.moved(problem, change * self.change), load=there.load
        )


def element_tangent(found: ElementEquilibrium, *, under_load: bool) -> ElementTangent:
    """The tangent at an equilibrium, factorised; `under_load` with the journal's position bordered.

    Raises
    ------
    NoPointsError
        The contacts do not determine the state.
    """
    equations = found.equations
    return ElementTangent.at(equations, -equations.force if under_load else None, current_run().probe_solver)


def element_rate(found: ElementEquilibrium, tangent: ElementTangent, rates: ElementValues) -> ElementRate:
    """The derivative (V9) from the rates of the equations at a fixed state; one solve or two.

    See `ElementTangent.refined`.

    Raises
    ------
    NoPointsError
        The contacts do not determine the state.
    """
    change, move = tangent.refined(rates.residual, rates.force)
    displacement = move if tangent.units.shape[1] else rates.displacement
    rate = ElementRate(change, displacement, (0.0, 0.0))
    return replace(rate, reach=(reach(found, rates, rate, -1.0), reach(found, rates, rate, 1.0)))


def reach(found: ElementEquilibrium, rates: ElementValues, rate: ElementRate, sign: float) -> float:
    """Change of the parameter at which, as it moves by `sign`, a contact ends or begins; infinite for never.

    Reactions that pull and gaps below zero count as Newton's method counts them: what is smaller decides nothing.
    Contact pressures over asperities neither end nor begin.
    """
    if not isinstance(found, PointContacts):
        return math.inf
    equations, points = found.equations, found.points
    first = len(equations.deflection) + len(equations.pressures)
    ends = falling(
        points.reaction + least_pull(equations, PULL), sign * rate.change[first : first + len(points.reaction)]
    )
    part = SMALL / max(float(np.max(np.abs(rate.change), initial=0.0)), SMALL)
    problem = equations.problem
    ahead = found.moved(problem.at(displacement=problem.displacement + part * rate.displacement), part * rate.change)
    (gaps, beside), (moved, _) = found.gaps, ahead.gaps
    closing = rates.gaps + (moved - gaps) / part
    return min(ends, falling(gaps[~beside] + OVERLAP, sign * closing[~beside]))


def falling(value: Array, change: Array) -> float:
    """Least amount of `change` at which one of the values (k,) vanishes; infinite where none falls."""
    down = change < 0.0
    return float(np.min(np.maximum(value[down], 0.0) / -change[down], initial=math.inf))
