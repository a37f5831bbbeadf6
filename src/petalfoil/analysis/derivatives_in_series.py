"""Derivatives at each point of a load characteristic or of a run-up, each followed from the one before."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from petalfoil.analysis.curve import displaced_problem, point_after
from petalfoil.analysis.derivative_sources import DerivativeRequest, best_of, of_equilibrium, sources_of
from petalfoil.analysis.displacements import displaced
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.sensitivity_table import Source
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.units import format_quantity

SERIES = ("curve", "runup")
"""Questions of several equilibria."""


@dataclass(frozen=True)
class Where:
    """Where a point of a series is, in words; None of a question with one equilibrium."""

    place: str | None = None


@dataclass(frozen=True)
class Differentiated:
    """An equilibrium whose derivatives are asked for.

    Attributes
    ----------
    case : Case
        The bearing there.
    sources : callable
        Finds it and its derivatives; of a series in order.
    where : Where
        Where it is.
    """

    case: Case
    sources: Callable[[], Sequence[Source]]
    where: Where = Where()


def points_of(case: Case, asked: DerivativeRequest) -> list[Differentiated]:
    """The equilibria of a question.

    Raises
    ------
    UsageError
        They are displaced beside a moment.
    """
    if asked.verb == "curve":
        return along_curve(displaced(case, asked.series["curve"] or (), asked.direction, None), asked)
    if asked.verb == "runup":
        return along_speeds(case, asked.series["runup"] or (), asked)
    return [Differentiated(case, lambda: sources_of(case, asked))]


def along_curve(cases: list[Case], asked: DerivativeRequest) -> list[Differentiated]:
    """The points of a load characteristic."""
    base, before = build_problem(cases[0]), None

    def found_at(case: Case) -> Sequence[Source]:
        nonlocal before
        last, before = before, None
        before = point_after(case, displaced_problem(base, case), last, leads=False).answer
        return best_of([of_equilibrium(case, before, asked)], asked)

    return [
        Differentiated(case, partial(found_at, case), Where(f"e = {format_quantity(distance, 'm')}"))
        for case, distance in zip(cases, asked.series["curve"] or (), strict=True)
    ]


def along_speeds(case: Case, speeds: Sequence[float], asked: DerivativeRequest) -> list[Differentiated]:
    """The points of a run-up."""
    if case.operation.load is None:
        raise ValueError("a run-up has a load")
    line = SpeedLine(at(case, speeds[0]), case.operation.load, leads=False)

    def found_at(there: Case) -> Sequence[Source]:
        try:
            found: Solution = line.at(there.operation.speed)
        except ConvergenceError:
            line.known = None
            raise
        return best_of([of_equilibrium(there, found, asked)], asked)

    return [
        Differentiated(there, partial(found_at, there), Where(format_quantity(speed, "rad/s")))
        for speed in speeds
        for there in (at(case, speed),)
    ]
