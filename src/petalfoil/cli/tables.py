"""An answer as the printed table, in the units an engineer reads."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping

from rich import box
from rich.console import Console
from rich.table import Table

from petalfoil.cli.answer import Answer
from petalfoil.cli.kinds import ChartAnswer, CoefficientsAnswer, OrbitAnswer, StabilityAnswer
from petalfoil.cli.motion_table import motion
from petalfoil.cli.study import StudyAnswer, grid_text
from petalfoil.cli.wide_tables import charts, coefficients, modes
from petalfoil.results import Record
from petalfoil.results.summary import ABSENT, cell, in_order, with_bar

PIPE_WIDTH = 120  # where no terminal says how wide it is: no column of a curve is cut off

# Columns of a curve with their headings, by verb where they differ; those that no point has are left out.
COLUMNS = {
    "eccentricity_x": "e_x",
    "eccentricity_y": "e_y",
    "bearing_force": "load",
    "attitude_angle": "attitude",
    "contact_normal_force": "contacts",
    "contact_fraction": "contact share",
    "min_film_thickness": "film",
    "peak_pressure": "pressure",
    "friction_torque": "torque",
    "starting_torque": "starting torque",
    "max_bending_stress": "stress",
    "petal_friction_work": "lost",
}
OWN_COLUMNS = {
    "liftoff": {
        "load_y": "load y",
        "liftoff_speed": "lift-off",
        "touchdown_speed": "touch-down",
        "liftoff_by_contact_film_thickness": "d ln up\n/ d ln floor",
        "liftoff_by_contact_fraction": "d ln up\n/ d ln share",
    },
    "runup": {
        "leg": "leg",
        "speed": "speed",
        "eccentricity_x": "e_x",
        "eccentricity_y": "e_y",
        "contact_fraction": "contact share",
        "min_film_thickness": "film",
        "peak_pressure": "pressure",
        "friction_torque": "torque",
    },
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
    tables = _tables(answer)
    with console.capture() as capture:
        console.print(f"{answer.verb}: {answer.title}" if answer.title else answer.verb, style="bold")
        for table in tables:
            console.print(table)
    return "\n".join(line.rstrip() for line in capture.get().rstrip().splitlines()) + "\n"


def _tables(answer: Answer) -> list[Table]:
    if isinstance(answer, StudyAnswer):
        return [_study(answer)]
    if isinstance(answer, ChartAnswer):
        return list(charts(answer))
    if isinstance(answer, OrbitAnswer):
        return [motion(answer.records[0])]
    if answer.is_curve and not isinstance(answer, CoefficientsAnswer):
        return [_curve(answer)]
    tables = [] if answer.is_curve else [_single(answer.records[0], answer.errors or {})]
    if isinstance(answer, StabilityAnswer):
        return [*tables, *modes(answer.records[0])]
    return [*tables, coefficients(answer)] if isinstance(answer, CoefficientsAnswer) else tables


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
    columns = OWN_COLUMNS.get(answer.verb, COLUMNS)
    names = [name for name in columns if any(name in point for point in points)]
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("point", justify="right")
    for name in names:
        unit = cell(name, 0.0).unit
        table.add_column(f"{columns[name]}\n{unit}" if unit else columns[name], justify="right")
    table.add_column("")
    for number, (point, record) in enumerate(zip(points, answer.records, strict=True), start=1):
        figures = [cell(name, point.get(name, float("nan"))).value for name in names]
        table.add_row(str(number), *figures, _remark(record))
    return table


def _remark(record: Record) -> str:
    """What is to be said of a point that its figures do not tell."""
    if not record.converged:
        return "failed"
    return str(record.scalars.get("status", "")).removeprefix("converged").removeprefix("; ")
