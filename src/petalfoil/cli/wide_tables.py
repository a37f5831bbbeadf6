"""Printed tables of coefficients, of natural modes, and of figures over load and speed."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich import box
from rich.table import Table

from petalfoil.cli.kinds import MODES, ChartAnswer, CoefficientsAnswer
from petalfoil.results import Record
from petalfoil.results.summary import cell, number

ENTRIES = [(row, column) for row in (0, 1) for column in (0, 1)]
MATRICES = {"stiffness": ("K", "N/m"), "damping": ("C", "N s/m")}
CHARTED = {"critical_mass": "critical mass [kg] over load and speed", "whirl_ratio": "whirl ratio over load and speed"}


def coefficients(answer: CoefficientsAnswer) -> Table:
    """One line for each speed and whirl frequency."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("speed\nrpm", "whirl\nrad/s", "ratio"):
        table.add_column(heading, justify="right")
    for letter, unit in MATRICES.values():
        for row, column in ENTRIES:
            table.add_column(f"{letter}_{'xy'[row]}{'xy'[column]}\n{unit}", justify="right")
    table.add_column("")
    for record in answer.records:
        for line in _lines(record):
            table.add_row(*line)
    return table


def _lines(record: Record) -> Iterator[list[str]]:
    speed = float(record.scalars["speed"])
    turn = cell("speed", speed).value
    if not record.converged:
        yield [turn, *[""] * (2 + len(MATRICES) * len(ENTRIES)), "failed"]
        return
    for place, frequency in enumerate(record.coords["whirl_frequency"].tolist()):
        entries = [number(float(record.fields[name][place][entry])) for name in MATRICES for entry in ENTRIES]
        yield [turn, number(frequency), number(frequency / speed), *entries, ""]


def modes(record: Record) -> Iterator[Table]:
    """One line for each natural mode of the rotor, if its mass is known."""
    if "natural_frequency" not in record.fields:
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    headings = (
        "natural\nrpm",
        "Hz",
        "growth\n1/s",
        "damping\nratio",
        "rotor's\nshare",
        "with (+1) or against (-1)\nthe rotation",
    )
    for heading in headings:
        table.add_column(heading, justify="right")
    lines = zip(*(record.fields[name].tolist() for name in MODES), strict=True)
    for frequency, *others in lines:
        table.add_row(cell("speed", frequency).value, number(frequency / (2.0 * math.pi)), *map(number, others))
    yield table


def charts(answer: ChartAnswer) -> Iterator[Table]:
    """One table for each figure: a row for each load, a column for each speed."""
    for name, title in CHARTED.items():
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=title, title_justify="left", title_style="")
        table.add_column("load\nN", justify="right")
        for speed in answer.speeds:
            table.add_column(f"{cell('speed', speed).value}\nrpm", justify="right")
        for load, line in zip(answer.loads, answer.table(name), strict=True):
            table.add_row(number(load), *(number(math.nan if value is None else float(value)) for value in line))
        yield table
