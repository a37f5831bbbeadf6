"""What a result is: its dimensions, SI unit, long name and symbol, and how a table shows it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class DataType(Enum):
    """Type of a variable's values."""

    FLOAT = "float"
    INT = "int"
    BOOL = "bool"
    STR = "str"


class Role(Enum):
    """What a variable tells, hence what becomes of it when the state did not converge or when points form a curve."""

    GIVEN = "given"
    """Input of the point: kept whatever happens."""
    BOOKKEEPING = "bookkeeping"
    """How the run went: kept whatever happens."""
    ANSWER = "answer"
    """Result of the state: NaN (false, for a flag) when the state did not converge."""
    GEOMETRY = "geometry"
    """Same for all points of a curve: kept, and stored once."""


@dataclass(frozen=True, slots=True)
class TableLabel:
    """How a table shows a scalar: label, unit for engineers, factor from the SI unit, and an infinite one in words."""

    label: str
    unit: str = ""
    factor: float = 1.0
    infinite: str = "none"


@dataclass(frozen=True, slots=True)
class Variable:
    """Declaration of one variable.

    Parameters
    ----------
    dims : tuple of str
        Dimensions, in order; empty for a scalar.
    units : str
        SI unit in UDUNITS spelling, "1" for a pure number, "" for text and flags.
    long_name : str
        One line for a reader of the file.
    symbol : str
        Symbol in ``docs/notation`` and in figures.
    kind : DataType
        Type of the values.
    role : Role
        Given, bookkeeping, answer or geometry.
    shown : TableLabel, optional
        How tables show a scalar that an analysis declares for itself.
    """

    dims: tuple[str, ...]
    units: str
    long_name: str
    symbol: str
    kind: DataType = DataType.FLOAT
    role: Role = Role.ANSWER
    shown: TableLabel | None = None
