"""Tables of stiffness and damping at each frequency; of a journal that tilts one for each block of 2 by 2 entries."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from petalfoil.results.layout import ArrayTable, Cell
from petalfoil.results.record import Record
from petalfoil.results.summary import ABSENT, barred, cell

AT: dict[str, Callable[[Record, int], Cell]] = {
    "speed\nrpm": lambda record, _: cell("speed", record.scalars["speed"]).value,
    "whirl\nrad/s": lambda record, index: float(record.coords["whirl_frequency"][index]),
    "ratio": lambda record, index: float(record.coords["whirl_frequency"][index]) / float(record.scalars["speed"]),
}
"""Columns that tell speed and frequency."""


ROUNDING = 1e-9
"""Part of the size of a block below which an entry is rounding: equations are solved to 1e-8 of their rows."""
COUPLING = ("_force_tilt", "_moment_displacement")
"""Blocks that couple displacement and slopes."""


@dataclass(frozen=True)
class Block:
    """A block of 2 by 2 entries of stiffness and damping.

    Attributes
    ----------
    title : str
        What by what.
    suffix : str
        What its name has behind "stiffness" and "damping".
    rows, columns : str
        Letters of its entries.
    unit : str
        Unit of the stiffness; that of the damping has a second more.
    """

    title: str
    suffix: str
    rows: str
    columns: str
    unit: tuple[str, str]

    def table(self) -> ArrayTable:
        """Its table: four columns of stiffness, four of damping."""
        pairs = zip(("stiffness", "damping"), "KC", self.unit, strict=True)
        entries = {
            f"{letter}_{row}{column}\n{unit}": entry(f"{name}{self.suffix}", i, j)
            for name, letter, unit in pairs
            for i, row in enumerate(self.rows)
            for j, column in enumerate(self.columns)
        }
        return ArrayTable(dim="whirl_frequency", columns=AT | entries, title=self.title, keys=len(AT))


def entry(name: str, row: int, column: int) -> Callable[[Record, int], Cell]:
    """One entry of a matrix at each frequency, and its error bar where it has one."""

    def read(record: Record, index: int) -> Cell:
        if name not in record.fields:
            return ABSENT
        value, bars = float(record.fields[name][index][row][column]), record.fields.get(f"{name}_error")
        bar = np.nan if bars is None else float(bars[index][row][column])
        if abs(value) < ROUNDING * size_of(name, record, index):
            value = 0.0
        return barred(value, bar)

    return read


def size_of(name: str, record: Record, index: int) -> float:
    """What an entry is compared with: the largest of its block; of force by slope and the reverse their geometric mean.

    Those of a journal without tilt in the middle of its bearing are 0.
    """
    kind = name.partition("_")[0]
    blocks = (kind, f"{kind}_moment_tilt") if name.endswith(COUPLING) else (name,)
    sizes = [float(np.max(np.abs(record.fields[block][index].astype(float)))) for block in blocks]
    return math.prod(sizes) ** (1.0 / len(sizes))


BLOCKS = (
    Block("force by displacement", "", "xy", "xy", ("N/m", "N s/m")),
    Block("force by slope of the axis, a toward x and b toward y", "_force_tilt", "xy", "ab", ("N", "N s")),
    Block("moment, a toward x and b toward y, by displacement", "_moment_displacement", "ab", "xy", ("N", "N s")),
    Block("moment by slope of the axis, a toward x and b toward y", "_moment_tilt", "ab", "ab", ("N m", "N m s")),
)
TABLES = tuple(block.table() for block in BLOCKS)
"""Tables of all blocks; those of a journal that does not tilt stay empty but for the first."""
