"""What an optimum is: objectives, limits, and which of the evaluated designs are best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import UsageError
from petalfoil.studies.limits import ResultLimit, result_of, value_of
from petalfoil.studies.question import CaseOutcome

FloatArray = NDArray[np.float64]

MAXIMIZE, MINIMIZE = "maximize", "minimize"
FEASIBLE = 1e-4
"""Relative amount by which a limit may be missed: an optimum lies on its limits, where the last digit decides."""


@dataclass(frozen=True)
class Objective:
    """A result that is to be as large or as small as can be.

    Attributes
    ----------
    name : str
        The result.
    is_maximum : bool
        Whether it is to be large.
    """

    name: str
    is_maximum: bool

    @property
    def sign(self) -> float:
        """Factor that makes a minimum of it."""
        return -1.0 if self.is_maximum else 1.0


@dataclass(frozen=True)
class Goals:
    """Objectives and limits of an optimisation."""

    objectives: tuple[Objective, ...]
    limits: tuple[ResultLimit, ...]

    @classmethod
    def read(cls, maximize: Sequence[str], minimize: Sequence[str], subject: Sequence[str]) -> Goals:
        """Read objectives and limits.

        Raises
        ------
        UsageError
            There is no objective, one is named twice, or a result is unknown.
        """
        objectives = [Objective(result_of(name), True) for name in maximize]
        objectives += [Objective(result_of(name), False) for name in minimize]
        names = [objective.name for objective in objectives]
        if not names:
            raise UsageError("nothing to optimize: give a result to maximize or to minimize")
        for name in names:
            if names.count(name) > 1:
                raise UsageError(f"{name} is an objective twice: leave one of them out")
        return cls(tuple(objectives), tuple(ResultLimit.read(text) for text in subject))

    @property
    def names(self) -> list[str]:
        """All results that matter, each once."""
        return list(dict.fromkeys([*(o.name for o in self.objectives), *(limit.name for limit in self.limits)]))

    def costs(self, outcome: CaseOutcome) -> FloatArray:
        """Objectives as minima [SI]; NaN of a design without an answer."""
        if not outcome.converged:
            return np.full(len(self.objectives), np.nan)
        return np.array([o.sign * value_of(outcome.records, o.name) for o in self.objectives])

    def margins(self, outcome: CaseOutcome) -> FloatArray:
        """Margins of the limits over their values [1], negative where one is not kept; of a limit at 0 plain."""
        if not outcome.converged:
            return np.full(len(self.limits), np.nan)
        return np.array(
            [limit.margin(value_of(outcome.records, limit.name)) / scale_of(limit) for limit in self.limits]
        )

    def is_feasible(self, outcome: CaseOutcome) -> bool:
        """Whether a design has an answer, and keeps every limit."""
        finite = bool(np.isfinite(self.costs(outcome)).all())
        return outcome.converged and finite and bool((self.margins(outcome) >= -FEASIBLE).all())


def scale_of(limit: ResultLimit) -> float:
    """Size of the value of a limit."""
    return abs(limit.value) or 1.0


def front(costs: FloatArray, feasible: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which designs no other feasible one beats in every objective: the Pareto front.

    Parameters
    ----------
    costs : (design, objective) array
        Objectives as minima.
    feasible : (design,) array of bool
        Designs that count.
    """
    on_front = feasible.copy()
    for number in np.flatnonzero(feasible):
        better = (costs <= costs[number]).all(axis=1) & (costs < costs[number]).any(axis=1) & feasible
        same = (costs[:number] == costs[number]).all(axis=1) & feasible[:number]
        on_front[number] = not better.any() and not same.any()
    return on_front
