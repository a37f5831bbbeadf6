"""An answer as the printed table, in the units an engineer reads."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping

from rich import box
from rich.console import Console
from rich.table import Table

from petalfoil.cli.answer import Answer
from petalfoil.cli.study import StudyAnswer, grid_text
from petalfoil.results import Record
from petalfoil.results.summary import ABSENT, cell, in_order, with_bar

PIPE_WIDTH = 120  # where no terminal says how wide it is: no column of a curve is cut off

# Columns of a curve with their headings; those that no point has are left out.
COLUMNS = {
    "eccentricity_x": "e_x",
    "eccentricity_y": "e_y",
    "load_capacity": "load",
    "attitude_angle": "attitude",
    "contact_total": "contacts",
    "contact_share": "contact share",
    "min_film": "film",
    "max_pressure": "pressure",
    "friction_torque": "torque",
    "starting_torque": "starting torque",
    "max_stress": "stress",
}


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
    table = _table(answer)
    with console.capture() as capture:
        console.print(f"{answer.verb}: {answer.title}" if answer.title else answer.verb, style="bold")
        console.print(table)
    return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines()) + "\n"


def _table(answer: Answer) -> Table:
    if isinstance(answer, StudyAnswer):
        return _study(answer)
    return _curve(answer) if answer.is_curve else _single(answer.records[0], answer.errors or {})


def _single(record: Record, errors: Mapping[str, float]) -> Table:
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_column(justify="right")
    table.add_column()
    reported = record.reported()
    for name in in_order(reported):
        row, bar = cell(name, reported[name]), ""
        if name in errors:
            (value,), bar = with_bar(name, [float(reported[name])], errors[name])
            row = row._replace(value=value)
        table.add_row(row.label, row.value, bar and f"± {bar}", row.unit)
    return table


def _study(answer: StudyAnswer) -> Table:
    estimates = {estimate.name: estimate for estimate in answer.estimates}
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("cells")
    table.add_column("")
    for record in answer.records:
        table.add_column(grid_text(record), justify="right")
    for heading in ("order", "limit", "error"):
        table.add_column(heading, justify="right")
    table.add_column("trust")
    for name in in_order(estimates):
        found = estimates[name]
        (*values, limit), bar = with_bar(name, [*found.values, found.limit], found.error)
        order = ABSENT if math.isnan(found.order) else f"{found.order:.2f}"
        row = cell(name, 0.0)
        table.add_row(row.label.strip(), row.unit, *values, order, limit, f"± {bar}", found.trust)
    return table


def _curve(answer: Answer) -> Table:
    points = [record.reported() for record in answer.records]
    names = [name for name in COLUMNS if any(name in point for point in points)]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("point", justify="right")
    for name in names:
        unit = cell(name, 0.0).unit
        table.add_column(f"{COLUMNS[name]}\n{unit}" if unit else COLUMNS[name], justify="right")
    table.add_column("")
    for number, (point, record) in enumerate(zip(points, answer.records, strict=True), start=1):
        figures = [cell(name, point.get(name, float("nan"))).value for name in names]
        table.add_row(str(number), *figures, "" if record.converged else "failed")
    return table
