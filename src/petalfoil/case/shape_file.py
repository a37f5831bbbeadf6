"""A measured free shape in a CSV file: two columns, angle from the root and radius of the free mid-surface.

::

    angle [deg], radius [mm]
    0.0, 25.912
    9.045, 24.568

Units stand in the header, in brackets, or with each quantity; numbers without either are in SI (rad, m). Columns are
separated by commas, semicolons or tabs; lines that begin with ``#`` are skipped.
"""

from __future__ import annotations

import csv
import os
import re

from petalfoil.case import toml
from petalfoil.case.number_fields import VALUE_PROBLEM, as_sequence, refuse
from petalfoil.errors import DefinitionError
from petalfoil.text import for_terminal
from petalfoil.units.reading import shown

ALLOWED = "a list of rows [angle, radius], or the name of a CSV file of two columns"

_UNIT = re.compile(r"[\[(]([^\])]*)[\])]")
_NUMBER = re.compile(r"\s*[-+−.0-9]")


def as_shape(value: object) -> object:
    """Let rows of two entries through, and read those of a CSV file that is named."""
    rows = _read_rows(os.fspath(value)) if isinstance(value, str | os.PathLike) else as_sequence(value)
    pairs = None if rows is None else [as_sequence(row) for row in rows]
    if pairs is None or any(pair is None or len(pair) != 2 for pair in pairs):
        raise refuse(VALUE_PROBLEM, f"{shown(value)} is not {ALLOWED}", ALLOWED)
    return tuple(tuple(pair) for pair in pairs if pair is not None)


def _read_rows(path: str) -> list[list[str]]:
    """Rows of a CSV file as texts [angle, radius], each with its unit where one is stated."""
    try:
        text = toml.read_file(path)
    except DefinitionError as error:
        raise refuse(VALUE_PROBLEM, f"{for_terminal(path)}: {error}", ALLOWED) from None
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    separator = next((mark for mark in ";\t" if mark in text), ",")
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines, delimiter=separator)]
    for row in rows:
        if len(row) != 2:
            text = (
                f"{for_terminal(path)}: the row {shown(separator.join(row))} has {len(row)} columns; expected {ALLOWED}"
            )
            raise refuse(VALUE_PROBLEM, text, ALLOWED)
    has_header = bool(rows) and not any(_NUMBER.match(cell) for cell in rows[0])
    stated = [_unit(cell) for cell in rows[0]] if has_header else ["", ""]
    return [[_with_unit(cell, unit) for cell, unit in zip(row, stated, strict=True)] for row in rows[has_header:]]


def _unit(head: str) -> str:
    match = _UNIT.search(head)
    return match.group(1).strip() if match else ""


def _with_unit(cell: str, unit: str) -> str:
    """`cell` with the unit of its column, unless it says its own."""
    return f"{cell} {unit}" if unit and re.fullmatch(r"[-+−.,0-9eE]+", cell) else cell
