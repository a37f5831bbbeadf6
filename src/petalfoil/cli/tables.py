"""An answer as printed tables, in the units an engineer reads."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator, Sequence

from rich import box
from rich.console import Console
from rich.table import Table

from petalfoil.results.estimate import Estimate
from petalfoil.results.grid import Grid
from petalfoil.results.layout import Answer, Cell, Layout, Point, Series
from petalfoil.results.record import Record, Scalar
from petalfoil.results.study import GridStudy, grid_text
from petalfoil.results.summary import ABSENT, cell, in_order, number, rows, with_bar, without_rounding
from petalfoil.text import for_terminal

PIPE_WIDTH = 120  # where no terminal says how wide it is: no column of a series is cut off


def render(answer: Answer) -> str:
    """Lay out an answer for the standard output as it is: a terminal of some width, or a file.

    Parameters
    ----------
    answer : Answer
        What to show.

    Returns
    -------
    str
        Text, with colours for a terminal.
    """
    width = None if sys.stdout.isatty() else PIPE_WIDTH
    console = Console(width=width, markup=False, highlight=False, emoji=False)
    with console.capture() as capture:
        heading = f"{answer.verb}: {answer.title}" if answer.title else answer.verb
        console.print(for_terminal(heading), style="bold")
        for table in _tables(answer):
            console.print(table)
        for warning in answer.warnings:
            console.print(for_terminal(f"Warning: {warning}"))
    return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines()) + "\n"


def _tables(answer: Answer) -> Iterator[Table]:
    layout, records = answer.layout, answer.records
    if isinstance(layout, Grid):
        yield from _grids(layout, records)
    elif isinstance(layout, GridStudy):
        yield _study(records, answer.estimates)
    elif isinstance(layout, Series) and layout.table is None:
        yield _series(layout, records)
    if isinstance(layout, Point):
        yield _rows(layout.rows(records[-1]) if layout.rows else _with_bars(records[-1]))
    if layout.table is not None and any(list(layout.table.lines(record)) for record in records):
        yield _arrays(layout, records)


def _rows(lines: Iterable[tuple[str, ...]]) -> Table:
    """Lines of label, value, unit; or of label, value, error bar, unit."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column()
    for line in lines:
        while len(table.columns) < len(line):
            table.add_column(justify="right" if len(table.columns) < len(line) - 1 else "left")
        _add(table, *line)
    return table


def _with_bars(record: Record) -> Iterator[tuple[str, ...]]:
    reported, errors = without_rounding(record), record.errors or {}
    if not errors:
        yield from rows(record)
        return
    for name in in_order(reported):
        row, bar = cell(name, reported[name]), ""
        is_rounding = reported[name] == 0.0 != record.scalars[name]
        if name in errors and not is_rounding:
            (value,), bar = with_bar(name, [float(reported[name])], errors[name])
            row = row._replace(value=value)
        yield row.label, row.value, bar and f"± {bar}", row.unit


def _study(records: Sequence[Record], found: Sequence[Estimate]) -> Table:
    estimates = {estimate.name: estimate for estimate in found}
    grids = [(grid_text(record), "right") for record in records]
    trust = [("order", "right"), ("limit", "right"), ("error", "right"), ("trust", "left")]
    table = _headed([("cells", "left"), ("", "left"), *grids, *trust])
    for name in in_order(estimates):
        estimate, row = estimates[name], cell(name, 0.0)
        (*values, limit), bar = with_bar(name, [*estimate.values, estimate.limit], estimate.error)
        order = ABSENT if math.isnan(estimate.order) else f"{estimate.order:.2f}"
        _add(table, row.label.strip(), row.unit, *values, order, limit, f"± {bar}", estimate.trust)
    return table


def _series(layout: Series, records: Sequence[Record]) -> Table:
    points = [without_rounding(record) for record in records]
    headings = layout.columns or {name: cell(name, 0.0).label for name in in_order(set().union(*points))}
    names = [name for name in headings if any(name in point for point in points)]
    columns = [(f"{headings[name]}\n{cell(name, 0.0).unit}".rstrip(), "right") for name in names]
    table = _headed([("point", "right"), *columns, ("", "left")])
    for position, (point, record) in enumerate(zip(points, records, strict=True), start=1):
        values = [_with_bar(name, point.get(name, math.nan), record) for name in names]
        _add(table, str(position), *values, _remark(record))
    return table


def _with_bar(name: str, value: Scalar, record: Record) -> str:
    """A result of a point, and its error bar where it has one."""
    if name not in (record.errors or {}):
        return cell(name, value).value
    (shown,), bar = with_bar(name, [float(value)], (record.errors or {})[name])
    return f"{shown} ± {bar}"


def _remark(record: Record) -> str:
    """What is to be said of a point that its results do not tell."""
    if not record.converged:
        return "failed"
    return str(record.scalars.get("status", "")).removeprefix("converged").removeprefix("; ")


def _grids(layout: Grid, records: Sequence[Record]) -> Iterator[Table]:
    """One table for each result: a row for each load, a column for each speed."""
    speeds = [(f"{cell('speed', speed).value}\nrpm", "right") for speed in layout.speeds(records)]
    for name, title in layout.tables.items():
        table = _headed([("load\nN", "right"), *speeds])
        table.title, table.title_justify, table.title_style = title, "left", ""
        for load, line in zip(layout.loads(records), layout.over(records, name), strict=True):
            _add(table, number(load), *(number(math.nan if value is None else float(value)) for value in line))
        yield table


def _arrays(layout: Layout, records: Sequence[Record]) -> Table:
    """A line for each entry of the arrays of each record; columns that no record fills are left out."""
    if layout.table is None:
        raise ValueError("this layout has no table of arrays")
    lines = [line for record in records for line in layout.table.lines(record)]
    kept = [k for k in range(len(layout.table.columns)) if any(line[k] != ABSENT for line in lines)]
    headings = list(layout.table.columns)
    table = _headed([*((headings[k], "right") for k in kept), ("", "left")])
    for position, record in enumerate(records, start=1):
        for line in layout.table.lines(record):
            _add(table, *(_text(line[k]) for k in kept), "")
        if not record.converged:
            _add(table, *[""] * len(kept), f"{layout.place(position, record)} failed")
    return table


def _headed(columns: Iterable[tuple[str, str]]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading, side in columns:
        table.add_column(heading, justify="right" if side == "right" else "left")
    return table


def _add(table: Table, *values: str) -> None:
    """Add a line; a status of a foreign file may hold anything."""
    table.add_row(*map(for_terminal, values))


def _text(value: Cell) -> str:
    return value if isinstance(value, str) else number(value)
