"""Error bars beside the answer of any analysis: the same question on the case's grid and on two nested with it.

With an accuracy grids are refined, and harmonics of slips added, until the bar of every shown result is below it
(`accuracy.py`); the answer is that of the finest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.accuracy import Resolution, ahead_of, remark_on, shortfalls
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
from petalfoil.analysis.harmonics_bars import harmonics_bar, harmonics_bars, is_matrix
from petalfoil.analysis.rotor_verdict import neutral_by_error
from petalfoil.analysis.runs import Run
from petalfoil.case import Case, warnings_of_errors
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS

Array = NDArray[np.float64]
Ask = Callable[[Case, int | None], tuple[Record, ...]]
"""Answers the question for a case on another grid, with so many harmonics of slips at least or as many as they need."""
Answers = dict[tuple[int, int], tuple[Record, ...] | ConvergenceError]
"""The records of each grid, or why it has none."""


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
        Error bar over the size of a result that is to be met [1]; None leaves grid and harmonics as they are.
    barred : tuple of Record or None
        The records with error bars, once they are known.
    """

    run: Run
    case: Case
    ask: Ask
    accuracy: float | None = None
    barred: tuple[Record, ...] | None = None
    _answers: dict[int | None, Answers] = field(default_factory=dict)

    @property
    def is_series(self) -> bool:
        """Whether its records are points of a series."""
        return self.run.is_series

    @is_series.setter
    def is_series(self, value: bool) -> None:
        raise AttributeError("a run with error bars is a series if the run itself is one")

    def advance(self) -> Iterator[tuple[float, str]]:
        """The run itself, then the other grids; with an accuracy finer ones or more harmonics while it is not met."""
        cases = grids(self.case)
        cost = {grid_of(case): unknowns(case) / sum(map(unknowns, cases)) for case in cases}
        own = done = cost[grid_of(self.case)]
        for part, text in self.run.advance():
            yield part * own, text
        here = Resolution(self.case)
        self._answers[here.harmonics] = {grid_of(self.case): self.run.records()}
        while True:
            for other in grids(here.case):
                if self._ask(replace(here, case=other)):
                    done = min(1.0, done + cost.get(grid_of(other), 0.0))
                    yield done, grid_text(other)
            self.barred = self._with_bars(here)
            if self.accuracy is None or not shortfalls(self.barred, self.accuracy):
                return
            ahead = ahead_of(here, self.barred, self.accuracy)
            if ahead is not None and self._ask(ahead):
                yield done, ahead.text
            failure = None if ahead is None else self._answers[ahead.harmonics][grid_of(ahead.case)]
            if ahead is None or isinstance(failure, ConvergenceError):
                stopped = "" if ahead is None else f"{ahead.text} has no answer: {failure}"
                self.barred = tuple(remark_on(record, self.accuracy, stopped) for record in self.barred)
                return
            here = ahead

    def _with_bars(self, here: Resolution) -> tuple[Record, ...]:
        """The records on the grid of `here`, which has an answer, with their error bars."""
        answers = self._answers[here.harmonics]
        records = answers[grid_of(here.case)]
        if isinstance(records, ConvergenceError):
            raise records
        return tuple(barred(record, number, answers) for number, record in enumerate(records))

    def _ask(self, there: Resolution) -> bool:
        """Answer the question on a grid with harmonics; whether that was not done before."""
        answers, grid = self._answers.setdefault(there.harmonics, {}), grid_of(there.case)
        if grid in answers:
            return False
        try:
            answers[grid] = self.ask(there.case, there.harmonics)
        except ConvergenceError as failure:
            answers[grid] = failure
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
        errors = harmonics_bars(record, error_bars(record, on_grid))
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
        bars[f"{name}_error"] = of_one_size(own_bars) if is_matrix(name) else own_bars
        by_harmonics = harmonics_bar(name, record)
        if by_harmonics is not None:
            bars[f"{name}_error"] = bars[f"{name}_error"] + by_harmonics
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
    from scipy.optimize import linear_sum_assignment  # 0.2 s: only where it is needed

    here, there = eigenvalues(own), eigenvalues(record)
    mine, others = linear_sum_assignment(np.abs(here[:, None] - there[None, :]))
    matched = np.full(len(here), np.nan)
    matched[mine] = values[others]
    return matched


def eigenvalues(record: Record) -> NDArray[np.complex128]:
    """Eigenvalues of the natural modes of a record, (mode,) [1/s]."""
    growth, frequency = (record.fields[name].astype(np.float64) for name in ("mode_growth_rate", "natural_frequency"))
    return np.asarray(growth + 1j * frequency, dtype=np.complex128)
