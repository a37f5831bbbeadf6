"""An answer as tables of text, in the units an engineer reads: for the terminal, a page, a file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile

from petalfoil.results.answer import Answer
from petalfoil.results.estimate import Estimate
from petalfoil.results.grid import LoadSpeedGrid
from petalfoil.results.layout import ArrayTable, Cell, Layout, Series, SinglePoint, load_of
from petalfoil.results.record import Record, Scalar
from petalfoil.results.rounding import without_rounding
from petalfoil.results.study import GridStudy, grid_text
from petalfoil.results.summary import ABSENT, TableRow, cell, in_order, number, row, rows, with_bar

PLACES = ("leg", "load_y", "speed")
"""Results that tell where a point of a series stands, if they lead its columns."""


@dataclass(frozen=True)
class TextColumn:
    """A column: heading, unit, and whether it holds numbers."""

    heading: str
    unit: str = ""
    of_numbers: bool = True

    @property
    def words(self) -> str:
        """Heading and unit in one line."""
        heading = " ".join(self.heading.split())
        return f"{heading} [{self.unit}]" if self.unit else heading


@dataclass
class TextTable:
    """Cells of text line by line.

    Attributes
    ----------
    columns : tuple of TextColumn
        Headed columns; none where lines explain themselves: label, value and unit, or label, value, error bar and unit.
    lines : list of tuple of str
        Cells of each line.
    title : str
        What stands above it.
    keys : int
        Columns at the left that tell what a line is of: each part of a table too wide for a page has them.
    """

    columns: tuple[TextColumn, ...] = ()
    lines: list[tuple[str, ...]] = field(default_factory=list)
    title: str = ""
    keys: int = 1


def tables_of(answer: Answer) -> Iterator[TextTable]:
    """The tables of an answer, in order.

    Parameters
    ----------
    answer : Answer
        Answer of any analysis.

    Yields
    ------
    TextTable
        A point gives lines of label, value and unit; a series a line for each point; a grid a table for each result.
        Below several points stands what they have in common.
    """
    layout, records = answer.layout, answer.records
    if isinstance(layout, LoadSpeedGrid):
        yield from _grids(layout, records)
    elif isinstance(layout, GridStudy):
        yield _study(records, answer.estimates)
    elif isinstance(layout, Series) and not layout.array_tables:
        yield _series(layout, records)
    if isinstance(layout, SinglePoint):
        lines = layout.rows(records[-1]) if layout.rows else _with_bars(records[-1])
        yield TextTable(lines=[tuple(line) for line in lines])
    yield from _arrays(layout, records)
    if not isinstance(layout, SinglePoint):
        told = [*friction_paths(records), *(layout.told(records) if isinstance(layout, Series) and layout.told else ())]
        if told:
            yield TextTable(lines=[tuple(line) for line in told])


def friction_paths(records: Sequence[Record]) -> Iterator[TableRow]:
    """Which path the friction forces between petals are those of: a line, or one for each path with its points."""
    paths: dict[str, list[str]] = {}
    for position, record in enumerate(records, start=1):
        if "friction_path" in record.scalars:
            paths.setdefault(str(record.scalars["friction_path"]), []).append(str(position))
    for path, points in paths.items():
        of = f" (points {', '.join(points)})" if len(paths) > 1 else ""
        yield cell("friction_path", path + of)


def _with_bars(record: Record) -> Iterator[tuple[str, ...]]:
    if not record.errors:
        yield from rows(record)
        return
    reported = without_rounding(record)
    bars = shown_bars(record, reported)
    for name in in_order(reported):
        line, bar = row(name, reported, record), ""
        if name in bars:
            (value,), bar = with_bar(name, [float(reported[name])], bars[name])
            line = line._replace(value=value)
        yield line.label, line.value, bar and f"± {bar}", line.unit


def shown_bars(record: Record, reported: Mapping[str, Scalar]) -> dict[str, float]:
    """Error bars of a point that are shown beside what is `reported` of it.

    What is 0 on every grid, such as the force of no contact, has none; nor has what is nothing but rounding.
    """
    rounded = {name for name, value in reported.items() if value == 0.0 != record.scalars[name]}
    return {name: bar for name, bar in (record.errors or {}).items() if bar and name not in rounded}


def _study(records: Sequence[Record], found: Sequence[Estimate]) -> TextTable:
    estimates = {estimate.name: estimate for estimate in found}
    words = [TextColumn("cells", of_numbers=False), TextColumn("", of_numbers=False)]
    grids = [TextColumn(grid_text(record)) for record in records]
    trust = [*map(TextColumn, ("order", "limit", "error")), TextColumn("trust", of_numbers=False)]
    table = TextTable((*words, *grids, *trust))
    for name in in_order(estimates):
        estimate, shown = estimates[name], cell(name, 0.0)
        (*values, limit), bar = with_bar(name, [*estimate.values, estimate.limit], estimate.error)
        order = ABSENT if math.isnan(estimate.order) else f"{estimate.order:.2f}"
        table.lines.append((shown.label.strip(), shown.unit, *values, order, limit, f"± {bar}", estimate.trust))
    return table


def _series(layout: Series, records: Sequence[Record]) -> TextTable:
    points = [without_rounding(record) for record in records]
    headings = layout.columns or {name: cell(name, 0.0).label for name in in_order(set().union(*points))}
    names = [name for name in headings if any(name in point for point in points)]
    columns = [TextColumn(headings[name], cell(name, 0.0).unit) for name in names]
    keys = 1 + len(list(takewhile(PLACES.__contains__, names)))
    table = TextTable((TextColumn("point"), *columns, TextColumn("", of_numbers=False)), keys=keys)
    for position, (point, record) in enumerate(zip(points, records, strict=True), start=1):
        bars = shown_bars(record, point)
        values = [_with_bar(name, point.get(name, math.nan), bars.get(name)) for name in names]
        table.lines.append((str(position), *values, _remark(record)))
    return table


def _with_bar(name: str, value: Scalar, error: float | None) -> str:
    """A result of a point, and its error bar where it has one."""
    if error is None:
        return cell(name, value).value
    (shown,), bar = with_bar(name, [float(value)], error)
    return f"{shown} ± {bar}"


def _remark(record: Record) -> str:
    """What is to be said of a point that its results do not tell."""
    if not record.converged:
        return "failed"
    return str(record.scalars.get("status", "")).removeprefix("converged").removeprefix("; ")


def _grids(layout: LoadSpeedGrid, records: Sequence[Record]) -> Iterator[TextTable]:
    """One table for each result: a row for each load, a column for each speed."""
    speeds = [TextColumn(cell("speed", speed).value, "rpm") for speed in layout.speeds(records)]
    there = [record.scalars for record in records if record.converged]
    for name, title in layout.tables.items():
        if there and not any(name in scalars for scalars in there):
            continue
        table = TextTable((TextColumn("load", "N"), *speeds), title=title)
        at = {(load_of(one), float(one.scalars["speed"])): one.reported().get(name) for one in records}
        for load in layout.loads(records):
            values = (at.get((load, speed)) for speed in layout.speeds(records))
            table.lines.append((number(load), *(cell(name, math.nan if v is None else v).value for v in values)))
        yield table


def _arrays(layout: Layout, records: Sequence[Record]) -> Iterator[TextTable]:
    """The tables of arrays that some record fills, with titles where they are several."""
    found = [table for content in layout.array_tables if (table := _of_arrays(layout, content, records)) is not None]
    for table in found:
        yield table if len(found) > 1 else replace(table, title="")


def _of_arrays(layout: Layout, content: ArrayTable, records: Sequence[Record]) -> TextTable | None:
    """A line for each entry of the arrays of each record; without columns that no record fills; None without any."""
    of_records = [list(content.lines(record)) for record in records]
    width = len(content.columns)
    kept = [k for k in range(width) if any(line[k] != ABSENT for lines in of_records for line in lines)]
    if not any(k >= content.keys for k in kept):
        return None
    headings = list(content.columns)
    columns = (*(TextColumn(headings[k]) for k in kept), TextColumn("", of_numbers=False))
    table = TextTable(columns, title=content.title, keys=sum(k < content.keys for k in kept))
    for position, (record, lines) in enumerate(zip(records, of_records, strict=True), start=1):
        table.lines += ((*(_text(line[k]) for k in kept), "") for line in lines)
        if not record.converged:
            table.lines.append((*[""] * len(kept), f"{layout.place(position, record)} failed"))
    return table


def _text(value: Cell) -> str:
    return value if isinstance(value, str) else number(value)
