"""An answer as printed tables."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import zip_longest

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

from petalfoil.results.answer import Answer
from petalfoil.results.tables import TextTable, tables_of
from petalfoil.text import for_terminal

PIPE_WIDTH = 120  # where no terminal says how wide it is: no column of a series is cut off
BETWEEN = 3
"""Places that a column of a headed table takes beside its cells."""
NUMBER_WIDTH = 14
"""Longest value that is set flush right with the numbers: those of four digits and an exponent, and words such as
"converged"."""


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
        for table in tables_of(answer):
            for part in _parts(table, console.width) if table.columns else [_rows(table)]:
                console.print(part)
        for warning in answer.warnings:
            console.print(for_terminal(f"Warning: {warning}"))
    return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines()) + "\n"


def _rows(content: TextTable) -> Table:
    """Lines of label, value, unit; or of label, value, error bar, unit. Long words begin where numbers do, and fold."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(no_wrap=True)
    table.add_column()
    lines = [tuple(map(for_terminal, line)) for line in content.lines]
    short = [[cell_len(cell) for cell in cells] for _, *cells, _ in lines if not _is_long(cells[0])]
    widths = [max(column) for column in zip_longest(*short, fillvalue=0)]
    for label, *cells, unit in lines:
        if not _is_long(cells[0]):
            cells = [" " * (width - cell_len(cell)) + cell for cell, width in zip(cells, widths, strict=False)]
        table.add_row(label, "  ".join((*cells, unit)).rstrip())
    return table


def _is_long(value: str) -> bool:
    """Whether a value is a text too long to stand among the numbers."""
    return cell_len(value) > NUMBER_WIDTH


def _parts(content: TextTable, width: int) -> list[Table]:
    """A table with headings; in parts with as many columns each, between its keys and remarks, where it is too wide.

    Numbers do not break over lines unless one alone is wider than the page.
    """
    count = len(content.columns)
    remarks = range(count - 1, count) if not content.columns[-1].words else range(0)
    keys, columns = range(content.keys), range(content.keys, count - len(remarks))
    for size in (-(-len(columns) // number) for number in range(1, len(columns) + 1)):
        starts = range(columns.start, columns.stop, size)
        kept = [[*keys, *range(k, min(k + size, columns.stop)), *remarks] for k in starts]
        parts = [_of_columns(content, some) for some in kept]
        if all(_least_width(part) <= width for part in parts):
            return [_headed(part, breaks=False) for part in parts]
    return [_headed(content)]


def _least_width(content: TextTable) -> int:
    """Width of a table in which words break over lines, and numbers do not."""
    cells = [[for_terminal(line[k]) for line in content.lines] for k in range(len(content.columns))]
    widths = []
    for column, texts in zip(content.columns, cells, strict=True):
        unbroken = texts if column.of_numbers else [word for text in texts for word in text.split()]
        widths.append(max(map(cell_len, [*column.heading.splitlines(), column.unit, *unbroken])))
    return sum(widths) + BETWEEN * len(widths)


def _of_columns(content: TextTable, kept: list[int]) -> TextTable:
    """A table with the columns that are kept."""
    lines = [tuple(line[k] for k in kept) for line in content.lines]
    return replace(content, columns=tuple(content.columns[k] for k in kept), lines=lines)


def _headed(content: TextTable, *, breaks: bool = True) -> Table:
    """A table with headings; whether numbers may break over lines."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in content.columns:
        heading = f"{column.heading}\n{column.unit}".rstrip()
        is_whole = column.of_numbers and not breaks
        table.add_column(heading, justify="right" if column.of_numbers else "left", overflow="fold", no_wrap=is_whole)
    if content.title:
        table.title, table.title_justify, table.title_style = content.title, "left", ""
    for line in content.lines:
        _add(table, *line)
    return table


def _add(table: Table, *values: str) -> None:
    """Add a line; a status of a foreign file may hold anything."""
    table.add_row(*map(for_terminal, values))
