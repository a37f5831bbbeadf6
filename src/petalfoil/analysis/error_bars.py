"""Error bars beside the answer of any analysis: the same question on the case's grid and on two nested with it.

With an accuracy the grids are refined until the bar of every shown result is below it (`accuracy.py`); the answer is
that of the finest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from petalfoil.analysis.accuracy import finer, remark_on, shortfalls
from petalfoil.analysis.grid_study import (
    array_error_bars,
    contacts_alike,
    error_bars,
    grid_of,
    grid_text,
    grids,
    of_one_size,
    unknowns,
)
from petalfoil.analysis.rotor_verdict import neutral_by_error
from petalfoil.analysis.runs import Run
from petalfoil.case import Case, warnings_of_errors
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS

Array = NDArray[np.float64]
Ask = Callable[[Case], tuple[Record, ...]]
"""Answers the question for a case on another grid."""
Answers = dict[tuple[int, int], tuple[Record, ...] | ConvergenceError]
"""The records of each grid, or why it has none."""

BY_HARMONICS = 1.25
"""Part of a bar that comes from the harmonics of slips, over what half as many change. That halves with each doubling,
so that what is left is about as large; with 1 one of 80 bars of two bearings at five amplitudes is 15 % short."""


@dataclass
class WithErrorBars:
    """A run whose records get error bars once they are computed.

    Attributes
    ----------
    run : Run
        The run on the case's own grid.
    case : Case
        The bearing.
    ask : callable
        Answers the same question on another grid.
    accuracy : float or None
        Error bar over the size of a result that is to be met [1]; None leaves the case's own grid as it is.
    barred : tuple of Record or None
        The records with error bars, once they are known.
    """

    run: Run
    case: Case
    ask: Ask
    accuracy: float | None = None
    barred: tuple[Record, ...] | None = None
    _answers: Answers = field(default_factory=dict)

    @property
    def is_series(self) -> bool:
        """Whether its records are points of a series."""
        return self.run.is_series

    @is_series.setter
    def is_series(self, value: bool) -> None:
        raise AttributeError("a run with error bars is a series if the run itself is one")

    def advance(self) -> Iterator[tuple[float, str]]:
        """The run itself, then the other grids; with an accuracy finer ones, as long as it is not met."""
        cases = grids(self.case)
        cost = {grid_of(case): unknowns(case) / sum(map(unknowns, cases)) for case in cases}
        own = done = cost[grid_of(self.case)]
        for part, text in self.run.advance():
            yield part * own, text
        self._answers[grid_of(self.case)] = self.run.records()
        case = self.case
        while True:
            for other in grids(case):
                if self._ask(other):
                    done = min(1.0, done + cost.get(grid_of(other), 0.0))
                    yield done, grid_text(other)
            self.barred, ahead = self._with_bars(case), finer(case)
            if self.accuracy is None or not shortfalls(self.barred, self.accuracy):
                return
            if ahead is not None and self._ask(ahead):
                yield done, grid_text(ahead)
            if ahead is None or isinstance(self._answers[grid_of(ahead)], ConvergenceError):
                self.barred = tuple(remark_on(record, self.accuracy) for record in self.barred)
                return
            case = ahead

    def _with_bars(self, case: Case) -> tuple[Record, ...]:
        """The records on the grid of `case`, which has an answer, with their error bars."""
        records = self._answers[grid_of(case)]
        if isinstance(records, ConvergenceError):
            raise records
        return tuple(barred(record, number, self._answers) for number, record in enumerate(records))

    def _ask(self, case: Case) -> bool:
        """Answer the question on the grid of `case`; whether that was not done before."""
        if grid_of(case) in self._answers:
            return False
        try:
            self._answers[grid_of(case)] = self.ask(case)
        except ConvergenceError as failure:
            self._answers[grid_of(case)] = failure
        return True

    def records(self, ended: str = "") -> tuple[Record, ...]:
        """The records with their error bars; without them if the run ended before."""
        if self.barred is None:
            return self.run.records(ended) if ended else ()
        return self.barred

    def finished(self) -> str:
        """What the run has computed."""
        return self.run.finished()


def barred(record: Record, number: int, answers: Answers) -> Record:
    """A record with its error bars; with none, and a remark why, where only its own grid has an answer.

    `number` is its place among the records of each grid.
    """

    def on_grid(case: Case, progress: Progress | None) -> Record:
        answer = answers[grid_of(case)]
        if isinstance(answer, ConvergenceError):
            raise answer
        return answer[number]

    if not record.converged:
        return record
    try:
        errors = error_bars(record, on_grid)
    except ConvergenceError as failure:
        return replace(record, errors={}, remarks=(*record.remarks, f"no error bars: {failure}"))
    told = (*record.warnings, *warnings_of_errors(record.scalars, errors))
    fields = {**record.fields, **field_bars(record, number, answers)}
    return neutral_by_error(replace(record, errors=errors, fields=fields, warnings=told))


def field_bars(record: Record, number: int, answers: Answers) -> dict[str, Array]:
    """Error bars ``f_error`` of the fields ``f`` for which they are declared.

    What harmonics of slips leave is added to the bar from the grids. With one harmonic it is not known, nor the bar.
    """
    case = Case.from_toml(record.case_toml)
    others: list[Record | None] = []
    for grid in map(grid_of, grids(case)):
        answer = (record,) if grid == grid_of(case) else answers[grid]
        place = 0 if grid == grid_of(case) else number
        others.append(None if isinstance(answer, ConvergenceError) else answer[place])
    alike = contacts_alike(others)
    bars: dict[str, Array] = {}
    for name, own in record.fields.items():
        if f"{name}_error" not in FIELDS:
            continue
        on_grids = [values_of(other, name, record) for other in others]
        own_bars = array_error_bars(own.astype(np.float64), on_grids, alike=alike)
        bars[f"{name}_error"] = of_one_size(own_bars) if FIELDS[name].dims[-2:] == ("row", "column") else own_bars
        if f"{name}_harmonics_change" in record.fields:
            change = np.abs(record.fields[f"{name}_harmonics_change"].astype(np.float64))
            bars[f"{name}_error"] = bars[f"{name}_error"] + BY_HARMONICS * of_one_size(change)
    return bars


def values_of(record: Record | None, name: str, own: Record) -> Array | None:
    """Values of a field on another grid, in the shape of the `own` one; None where that grid has no answer.

    Natural modes belong together whose eigenvalues are nearest; a mode that the other grid does not have is nan.
    """
    if record is None or not record.converged:
        return None
    values: Array = record.fields[name].astype(np.float64)
    if FIELDS[name].dims != ("mode",):
        return values
    here, there = eigenvalues(own), eigenvalues(record)
    mine, others = linear_sum_assignment(np.abs(here[:, None] - there[None, :]))
    matched = np.full(len(here), np.nan)
    matched[mine] = values[others]
    return matched


def eigenvalues(record: Record) -> NDArray[np.complex128]:
    """Eigenvalues of the natural modes of a record, (mode,) [1/s]."""
    growth, frequency = (record.fields[name].astype(np.float64) for name in ("mode_growth_rate", "natural_frequency"))
    return np.asarray(growth + 1j * frequency, dtype=np.complex128)
