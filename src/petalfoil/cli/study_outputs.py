"""A study on standard output: its counts and ranges as a table or as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich import box
from rich.console import Console
from rich.table import Table

from petalfoil.cli.failures import NOT_CONVERGED
from petalfoil.cli.printed_tables import PIPE_WIDTH
from petalfoil.cli.streams import emit, say
from petalfoil.studies import study_summary
from petalfoil.text import for_terminal

if TYPE_CHECKING:
    import xarray as xr

    from petalfoil.studies.case_engine import ProcessorTime

MOST_REASONS = 5
MOST_CASES = 3
"""Cases that are named beside a reason."""


def deliver(ds: xr.Dataset, folder: Path, *, as_json: bool, effort: ProcessorTime | None = None) -> None:
    """Print a study, and say on standard error why cases have no answer.

    Raises
    ------
    typer.Exit
        No case has an answer.
    """
    if as_json:
        emit(json.dumps({**study_summary.to_json(ds), "folder": str(folder)}, allow_nan=False) + "\n")
    else:
        emit(text_of(ds) + f"\nFolder: {for_terminal(str(folder))}\n")
    told = list(study_summary.reasons(ds).items())
    for reason, cases in told[:MOST_REASONS]:
        which = "; ".join(cases[:MOST_CASES]) + ("; …" if len(cases) > MOST_CASES else "")
        say(f"{len(cases)} without an answer ({which}): {reason}")
    if len(told) > MOST_REASONS:
        say(f"{len(told) - MOST_REASONS} more reasons are in the folder's table.csv")
    if effort is not None and effort.solver > 0.0:
        say(
            f"processor time: {effort.solver:.1f} s for the cases, {effort.workers:.1f} s of the workers in all, "
            f"{effort.driver:.1f} s to hand them out"
        )
    if not bool(ds["converged"].values.any()):
        raise typer.Exit(NOT_CONVERGED)


def text_of(ds: xr.Dataset) -> str:
    """Headline, tables, what was asked."""
    console = Console(width=PIPE_WIDTH, markup=False, highlight=False, emoji=False)
    with console.capture() as capture:
        console.print(for_terminal(study_summary.headline(ds)), style="bold")
        for line in study_summary.asked(ds):
            console.print(for_terminal(line))
        for heads, lines in study_summary.tables(ds):
            console.print(_table(heads, lines))
    return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines()) + "\n"


def _table(heads: tuple[str, ...], lines: Any) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for number, head in enumerate(heads):
        table.add_column(head, justify="left" if number in (0, len(heads) - 1) else "right")
    for line in lines:
        table.add_row(*map(for_terminal, line))
    return table
