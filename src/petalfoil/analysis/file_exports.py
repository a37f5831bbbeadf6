"""Files for other programs that an analysis can write, as it declares them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from petalfoil.analysis.arguments import Argument

Values: TypeAlias = Mapping[str, Any]
"""Arguments by name, SI."""


@dataclass(frozen=True, kw_only=True)
class Export:
    """A file for another program, by an option of the command line.

    Attributes
    ----------
    option : str
        Name of the option.
    help, metavar : str
        Its help text.
    suffixes : tuple of str
        Suffixes of its files.
    writer : str
        Function of a dataset and a path, as ``module:function``; it is loaded when it is needed.
    check : callable or None
        Refuses arguments whose results it could not write; takes them by name in SI units, and their names as the
        caller knows them.
    fill : callable or None
        Gives arguments that the caller left out the values that the file is best with; takes the others.
    settings : mapping
        Further arguments of the writer by name; exports that share one declare it alike.
    """

    option: str
    help: str
    metavar: str
    suffixes: tuple[str, ...]
    writer: str
    check: Callable[[Values, Mapping[str, str]], None] | None = None
    fill: Callable[[Values], Values] | None = None
    settings: Mapping[str, Argument] = field(default_factory=dict)


TABLE = Export(
    option="table",
    metavar="FILE.csv",
    help="Write all results in SI units for other programs: .csv, or .xlsx with fields.",
    suffixes=(".csv", ".xlsx"),
    writer="petalfoil.results.spreadsheet:write_table",
)
"""File that every analysis can write."""
