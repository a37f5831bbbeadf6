"""An answer as printed tables."""

from __future__ import annotations

import sys
from itertools import zip_longest

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

from petalfoil.results.answer import Answer
from petalfoil.results.tables import TextTable, tables_of
from petalfoil.text import for_terminal

PIPE_WIDTH = 120  # where no terminal says how wide it is: no column of a series is cut off
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
            console.print(_headed(table) if table.columns else _rows(table))
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


def _headed(content: TextTable) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in content.columns:
        heading = f"{column.heading}\n{column.unit}".rstrip()
        table.add_column(heading, justify="right" if column.of_numbers else "left", overflow="fold")
    if content.title:
        table.title, table.title_justify, table.title_style = content.title, "left", ""
    for line in content.lines:
        _add(table, *line)
    return table


def _add(table: Table, *values: str) -> None:
    """Add a line; a status of a foreign file may hold anything."""
    table.add_row(*map(for_terminal, values))
