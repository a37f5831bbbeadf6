"""A search along gradients: SciPy's SLSQP, with exact derivatives or with differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from petalfoil.errors import ConvergenceError
from petalfoil.studies.goals import FEASIBLE
from petalfoil.studies.question import CaseOutcome
from petalfoil.studies.search import BudgetSpent, DesignSearch, FloatArray, Slopes, interval_of
from petalfoil.studies.variation import Variation

STEP = 1e-4
"""Step of a difference over the range of its parameter: results are solved to 1e-8, so its error is about 1e-4."""
PRECISION = 1e-5
"""Change of the objective, over its size, at which SLSQP ends."""
PENALTY = 10.0
"""What a design without an answer costs, in sizes of the objective: the search turns back from it."""
EXPLORED = 3
"""Designs for each parameter among which the beginning of a descent is chosen."""
DESCENTS = 3
"""Designs from which a descent begins, the best of those."""
ITERATIONS = 30
"""Iterations of SLSQP; a descent takes 5 to 15."""
GAIN = 1e-3
"""Gain of the objective or of the limits, over their sizes, for which a descent begins anew where it ended."""


@dataclass
class Descent:
    """Objective and limits over the unit cube, with their gradients."""

    search: DesignSearch
    scale: float = 1.0

    def cost(self, unit: FloatArray) -> float:
        """The objective over its size."""
        outcome = self._at(unit)
        return float(self._costs(outcome)[0])

    def margins(self, unit: FloatArray) -> FloatArray:
        """Margins of the limits over their values."""
        found: FloatArray = self._costs(self._at(unit))[1:]
        return found

    def missed(self, unit: FloatArray) -> float:
        """By how much limits are missed in all, over their values."""
        return -float(np.minimum(self.margins(unit), 0.0).sum())

    def cost_slope(self, unit: FloatArray) -> FloatArray:
        """Gradient of the objective."""
        slope: FloatArray = self._jacobian(unit)[0]
        return slope

    def margin_slopes(self, unit: FloatArray) -> FloatArray:
        """Gradients of the margins, a row for each."""
        slopes: FloatArray = self._jacobian(unit)[1:]
        return slopes

    def _at(self, unit: FloatArray) -> CaseOutcome:
        return self.search.outcomes([self.search.point(np.clip(unit, 0.0, 1.0))])[0]

    def _costs(self, outcome: CaseOutcome) -> FloatArray:
        """Objective and margins; a design without an answer costs much and keeps nothing."""
        goals = self.search.goals
        found = np.concatenate([goals.costs(outcome) / self.scale, goals.margins(outcome)])
        worst = np.concatenate([[PENALTY], np.full(len(goals.limits), -1.0)])
        priced: FloatArray = np.where(np.isfinite(found), found, worst)
        return priced

    def _jacobian(self, unit: FloatArray) -> FloatArray:
        unit = np.clip(unit, 0.0, 1.0)
        exact = self.search.slopes(self.search.point(unit))
        if exact is not None:
            return self._exact(exact)
        return self._differences(unit)

    def _exact(self, slopes: Slopes) -> FloatArray:
        """Rows of objective and margins from derivatives by the parameters."""
        goals = self.search.goals
        (objective,) = goals.objectives
        factors = [(objective.name, objective.sign / self.scale)]
        for limit in goals.limits:
            factors.append((limit.name, (-1.0 if limit.is_upper else 1.0) / (abs(limit.value) or 1.0)))
        ranges = [interval_of(variation) for variation in self.search.variations]
        return np.array(
            [
                [factor * slopes[name][r.path] * (float(r.high) - float(r.low)) for r in ranges]
                for name, factor in factors
            ]
        )

    def _differences(self, unit: FloatArray) -> FloatArray:
        """The same from one more design for each parameter, asked together."""
        steps = np.where(unit + STEP <= 1.0, STEP, -STEP)
        points = [self.search.point(unit + step * along) for step, along in zip(steps, np.eye(len(unit)), strict=True)]
        here, *there = self.search.outcomes([self.search.point(unit), *points])
        moved = np.array([self._costs(outcome) for outcome in there])
        slopes = ((moved - self._costs(here)) / steps[:, None]).T
        answered = np.array([outcome.converged for outcome in there]) & here.converged
        return np.ascontiguousarray(np.where(answered[None, :], slopes, 0.0))  # SciPy 1.17 reads rows of others wrongly


def along_gradients(search: DesignSearch, seed: int = 0) -> None:
    """Sequential quadratic programming (SLSQP; Kraft 1988) from the best of the case and a few other designs.

    A descent that ends at a kink, such as another place of the minimum film thickness, begins anew from there as long
    as that gains something. There may be several local optima: descents begin from several designs.

    Raises
    ------
    ConvergenceError
        None of the designs that it could begin from has an answer.
    """
    begins = _explored(search, seed)
    sizes = [abs(float(search.goals.costs(outcome)[0])) for outcome in search.ranked()]
    descent = Descent(search, float(np.median(sizes)) or 1.0)
    try:
        for begin in begins[:DESCENTS]:
            search.ended = f"SLSQP: {_descend(descent, begin)}"
    except BudgetSpent:
        search.ended = "SLSQP: the budget is spent"


def _explored(search: DesignSearch, seed: int) -> list[FloatArray]:
    """Places of the case and of a Latin hypercube, which all workers answer together, the best first."""
    from scipy.stats import qmc

    dimensions = len(search.variations)
    count = min(EXPLORED * dimensions, search.budget - 1)
    cube = qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(count)
    places = np.vstack([start_of(search.variations), cube])
    answered = search.outcomes([search.point(place) for place in places])
    ranked = search.ranked()
    if not ranked:
        first = answered[0]
        raise ConvergenceError(
            f"no design that the search could begin from has an answer; the case: {first.reason or first.status}",
            advice="begin from a case that has one, or narrow the ranges",
        )
    return [search.place(outcome) for outcome in ranked]


def _descend(descent: Descent, begin: FloatArray) -> str:
    """Run SLSQP as often as it gains something; how it ended."""
    while True:
        end, message = _slsqp(descent, begin)
        misses, missed = descent.missed(end), descent.missed(begin)
        gained = descent.cost(begin) - descent.cost(end)
        if not (missed - misses > GAIN or (misses <= max(missed, FEASIBLE) and gained > GAIN)):
            return message
        begin = end


def _slsqp(descent: Descent, begin: FloatArray) -> tuple[FloatArray, str]:
    """Run SLSQP once; where and how it ended."""
    from scipy.optimize import Bounds, minimize

    limits = {"type": "ineq", "fun": descent.margins, "jac": descent.margin_slopes}
    found = minimize(
        descent.cost,
        begin,
        jac=descent.cost_slope,
        method="SLSQP",
        bounds=Bounds(0.0, 1.0),
        constraints=[limits] if descent.search.goals.limits else (),
        options={"ftol": PRECISION, "maxiter": ITERATIONS},
    )
    return np.clip(found.x, 0.0, 1.0), str(found.message)


def start_of(variations: Sequence[Variation]) -> FloatArray:
    """Place of the case in the unit cube, clipped to it; the middle where the case gives no number."""
    places = []
    for variation in variations:
        interval, value = interval_of(variation), variation.parameter.value
        part = 0.5 if value is None else (value - interval.low) / (interval.high - interval.low)
        places.append(min(max(part, 0.0), 1.0))
    return np.array(places)
