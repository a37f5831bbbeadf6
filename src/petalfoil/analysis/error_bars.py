"""Error bars beside the answer of any analysis: the same question on the case's grid and two more."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from petalfoil.analysis.grid_study import array_error_bars, error_bars, grid_of, grid_text, grids, parts
from petalfoil.analysis.runs import Run
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Array, Record
from petalfoil.results.schema import FIELDS

Ask = Callable[[Case], tuple[Record, ...]]
"""Answers the question for a case on another grid."""
Answers = dict[tuple[int, int], tuple[Record, ...] | ConvergenceError]
"""The records of each other grid, or why it has none."""


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
    barred : tuple of Record or None
        The records with error bars, once they are known.
    """

    run: Run
    case: Case
    ask: Ask
    barred: tuple[Record, ...] | None = None

    @property
    def is_series(self) -> bool:
        """Whether its records are points of a series."""
        return self.run.is_series

    @is_series.setter
    def is_series(self, value: bool) -> None:
        raise AttributeError("a run with error bars is a series if the run itself is one")

    def advance(self) -> Iterator[tuple[float, str]]:
        """The run itself, then the other grids."""
        cases = grids(self.case)
        own = next(k for k, case in enumerate(cases) if grid_of(case) == grid_of(self.case))
        spent = [b - a for a, b in zip([0.0, *parts(cases)], parts(cases), strict=False)]
        done = spent[own]
        for part, text in self.run.advance():
            yield part * done, text
        answers: Answers = {}
        for k, case in enumerate(cases):
            if k != own:
                answers[grid_of(case)] = self._answer(case)
                done += spent[k]
                yield done, grid_text(case)
        self.barred = tuple(barred(record, number, answers) for number, record in enumerate(self.run.records()))

    def _answer(self, case: Case) -> tuple[Record, ...] | ConvergenceError:
        try:
            return self.ask(case)
        except ConvergenceError as failure:
            return failure

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
    return replace(record, errors=errors, fields={**record.fields, **field_bars(record, number, answers)})


def field_bars(record: Record, number: int, answers: Answers) -> dict[str, Array]:
    """Error bars ``f_error`` of the fields ``f`` for which they are declared."""
    case = Case.from_toml(record.case_toml)
    others: list[Record | None] = []
    for grid in map(grid_of, grids(case)):
        answer = (record,) if grid == grid_of(case) else answers[grid]
        place = 0 if grid == grid_of(case) else number
        others.append(None if isinstance(answer, ConvergenceError) else answer[place])
    return {
        f"{name}_error": array_error_bars(
            own.astype(float),
            [other.fields[name].astype(float) if other is not None and other.converged else None for other in others],
        )
        for name, own in record.fields.items()
        if f"{name}_error" in FIELDS
    }
