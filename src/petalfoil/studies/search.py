"""How an optimum is looked for: along gradients (SciPy's SLSQP), or by sampling (Optuna's TPE and NSGA-II).

Every search depends on the answers to its questions alone: with the same answers it asks the same again. So a search
that was stopped goes on by being begun anew on the answers that are stored.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import UsageError
from petalfoil.studies.goals import Goals
from petalfoil.studies.plan import Point
from petalfoil.studies.question import CaseOutcome
from petalfoil.studies.variation import Interval, Number, Variation

FloatArray = NDArray[np.float64]
AnswerPoints: TypeAlias = Callable[[Sequence[Point]], list[CaseOutcome]]
Slopes: TypeAlias = dict[str, dict[str, float]]
"""Derivatives of results by parameters, by result and path, SI."""
Gradients: TypeAlias = Callable[[Point], Slopes | None]
"""Derivatives at a point; None where there are none."""


class BudgetSpent(Exception):
    """As many designs as allowed are answered."""


@dataclass
class DesignSearch:
    """A search under way.

    Attributes
    ----------
    variations : tuple of Variation
        What varies.
    goals : Goals
        What is wanted.
    answer : callable
        Outcomes of points.
    budget : int
        Number of designs that may be asked.
    gradients : callable
        Exact derivatives at a point, where there are some.
    asked : list of CaseOutcome
        Designs in the order in which they were asked, each once.
    ended : str
        How it ended.
    """

    variations: tuple[Variation, ...]
    goals: Goals
    answer: AnswerPoints
    budget: int
    gradients: Gradients = lambda point: None
    asked: list[CaseOutcome] = field(default_factory=list)
    ended: str = ""

    def __post_init__(self) -> None:
        self._known: dict[tuple[Number, ...], CaseOutcome] = {}
        self._places: dict[tuple[Number, ...], FloatArray] = {}
        self._slopes: dict[tuple[Number, ...], Slopes | None] = {}

    @property
    def with_derivatives(self) -> int:
        """Designs whose derivatives are exact."""
        return sum(slopes is not None for slopes in self._slopes.values())

    def slopes(self, point: Point) -> Slopes | None:
        """Exact derivatives at a point; None where there are none."""
        at = tuple(point.values())
        if at not in self._slopes:
            self._slopes[at] = self.gradients(point)
        return self._slopes[at]

    def outcomes(self, points: Sequence[Point]) -> list[CaseOutcome]:
        """Outcomes of points; those that are new count.

        Raises
        ------
        BudgetSpent
            There are more new points than the budget allows.
        """
        new = [point for point in _each_once(points) if tuple(point.values()) not in self._known]
        if len(self.asked) + len(new) > self.budget:
            raise BudgetSpent
        for point, outcome in zip(new, self.answer(new), strict=True):
            self._known[tuple(point.values())] = outcome
            self.asked.append(outcome)
        return [self._known[tuple(point.values())] for point in points]

    def ranked(self) -> list[CaseOutcome]:
        """Designs that have an answer, for one objective: those that keep the limits, then by how little they miss."""

        def rank(outcome: CaseOutcome) -> tuple[float, float]:
            missed = (
                0.0 if self.goals.is_feasible(outcome) else -float(np.minimum(self.goals.margins(outcome), 0.0).sum())
            )
            return missed, float(self.goals.costs(outcome)[0])

        answered = [outcome for outcome in self.asked if np.isfinite(self.goals.costs(outcome)).all()]
        return sorted(answered, key=rank)

    def place(self, outcome: CaseOutcome) -> FloatArray:
        """Place in the unit cube of a design that `point` has given."""
        return self._places[tuple(outcome.values.values())]

    def point(self, unit: FloatArray) -> Point:
        """The design at a place in the unit cube."""
        point = {v.path: v.at(np.array([part]))[0] for v, part in zip(self.variations, unit, strict=True)}
        self._places[tuple(point.values())] = np.array(unit)
        return point


def _each_once(points: Sequence[Point]) -> list[Point]:
    return list({tuple(point.values()): point for point in points}.values())


def interval_of(variation: Variation) -> Interval:
    """The interval of a continuous parameter.

    Raises
    ------
    UsageError
        It is a count, or has levels.
    """
    if not isinstance(variation, Interval) or variation.parameter.is_count:
        raise UsageError(
            f"{variation.path} has no gradient: use the method tpe, or give an interval of a continuous number"
        )
    return variation
