"""Kinds of arguments: what a caller may give, as numbers or as text, to SI numbers; and the arguments analyses share.

An argument carries its declaration as an annotation. Unit, range and help text stand there once; the Python function
and the command line read them alike::

    Speed = Annotated[float | None, NumberWithUnit(unit="rad/s", help="Speed for the case's", metavar="QUANTITY")]
"""

from __future__ import annotations

import math
import os
import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias, TypeGuard

from petalfoil.case.number_fields import Range, load_along_minus_y
from petalfoil.errors import UnitError, UsageError
from petalfoil.units import format_quantity, parse_pair, parse_quantity, parse_ramp, parse_range
from petalfoil.units.reading import is_bare, shown

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class Argument(ABC):
    """An argument of an analysis.

    Attributes
    ----------
    help : str
        What it is, for the help text.
    metavar : str
        What stands for its value there.
    option : str
        Name of the option, if it is not that of the argument.
    also : str
        Another name of the option.
    """

    help: str
    metavar: str = "QUANTITY"
    option: str = ""
    also: str = ""

    @abstractmethod
    def read(self, given: Any) -> Any:
        """A number or a text to SI numbers, checked."""

    def text(self, value: Any) -> str:
        """A default value for the help text."""
        return f"{value}"

    def option_name(self, name: str) -> str:
        """The option of the command line for the argument of a name."""
        return f"--{self.option or name.replace('_', '-')}"

    def named(self, name: str, given: object) -> Any:
        """Read what was given; a refusal names the argument.

        Raises
        ------
        UnitError
            It measures something else, or its unit is not known.
        UsageError
            It has another form, or is outside its range.
        """
        try:
            return self.read(given)
        except UnitError as error:
            raise UnitError(f"{name}: {error}", given=error.given, allowed=error.allowed) from error
        except UsageError as error:
            raise UsageError(f"{name}: {error}") from error


@dataclass(frozen=True, kw_only=True)
class Measured(Range, Argument, ABC):
    """One quantity or several, of one kind.

    Attributes
    ----------
    unit : str
        SI unit.
    """

    unit: str

    def checked(self, value: float, given: object) -> float:
        """A value, if it is inside its range."""
        if not self.holds(value):
            is_bare_text = isinstance(given, str) and is_bare(given) and self.unit != "1"
            bare = f" (a bare number is read in {self.unit})" if is_bare_text else ""
            raise UsageError(f"{shown(given)}{bare} is outside its range; allowed: {self.bounds(self.unit)}")
        return value

    def with_unit(self, value: float) -> str:
        """A value with its unit."""
        if self.unit == "rad":
            return f"{math.degrees(value):g} deg"
        return f"{value:g}" if self.unit == "1" else f"{value:g} {self.unit}"


@dataclass(frozen=True, kw_only=True)
class NumberWithUnit(Measured):
    """One quantity."""

    def read(self, given: object) -> float:
        """The quantity [unit]."""
        return self.checked(parse_quantity(given, self.unit), given)

    def text(self, value: float) -> str:
        """The value with its unit."""
        return self.with_unit(value)


@dataclass(frozen=True, kw_only=True)
class NumbersWithUnit(Measured):
    """Several quantities: a list, a range as text, or a single one.

    Attributes
    ----------
    whirl : bool
        They are whirl frequencies, which may be given in Hz.
    """

    whirl: bool = False

    def read(self, given: Any) -> list[float]:
        """The quantities [unit]."""
        if isinstance(given, str):
            return [self.checked(value, given) for value in parse_range(given, self.unit, whirl=self.whirl)]
        entries = given if _is_sequence(given) else [given]
        if len(entries) == 0:
            raise UsageError("give at least one value")
        return [self.checked(parse_quantity(entry, self.unit, whirl=self.whirl), entry) for entry in entries]

    def text(self, value: Any) -> str:
        """The values with their unit."""
        return ", ".join(map(self.with_unit, value))


@dataclass(frozen=True, kw_only=True)
class Pair(Argument):
    """Two quantities (x, y).

    Attributes
    ----------
    unit : str
        SI unit of both.
    word : str
        Word that may stand for them.
    """

    unit: str
    word: str = ""

    def read(self, given: Any) -> tuple[float, float] | str:
        """The pair [unit], or the word."""
        if isinstance(given, str):
            return self.word if self.word and given.strip() == self.word else parse_pair(given, self.unit)
        if not _is_sequence(given) or len(given) != 2:
            raise UsageError(
                f"{shown(given)} is not a pair (x, y); write both, such as '0 {self.unit}, -1 {self.unit}'"
            )
        return parse_quantity(given[0], self.unit), parse_quantity(given[1], self.unit)

    def text(self, value: Any) -> str:
        """The pair with its unit, or the word."""
        return value if isinstance(value, str) else ", ".join(format_quantity(part, self.unit) for part in value)


@dataclass(frozen=True, kw_only=True)
class LoadVector(Argument):
    """A load on the journal: a pair (x, y), or a single value along -y.

    Attributes
    ----------
    unit : str
        SI unit.
    """

    unit: str = "N"

    def read(self, given: Any) -> tuple[float, float]:
        """The load (x, y) [N]."""
        if isinstance(given, str) and ":" in given:
            raise UsageError(f"{shown(given)} is a range of loads; one load is meant here: a value or a pair (x, y)")
        if isinstance(given, str) and "," in given:
            return parse_pair(given, "N")
        if not _is_sequence(given):
            return load_along_minus_y(given)
        if len(given) != 2:
            raise UsageError(f"{shown(given)} is neither a value nor a pair (x, y)")
        return parse_quantity(given[0], "N"), parse_quantity(given[1], "N")

    def text(self, value: Any) -> str:
        """The load with its unit; along -y a single value."""
        x, y = value
        return format_quantity(-y, "N") if x == 0.0 and y < 0.0 else ", ".join(format_quantity(f, "N") for f in value)


@dataclass(frozen=True, kw_only=True)
class Ramp(Argument):
    """A speed over time: instants and speeds, or a text such as ``"0 rpm : 60000 rpm : 2 s"``."""

    def read(self, given: Any) -> tuple[tuple[float, float], ...]:
        """Instants [s] and speeds [rad/s]."""
        if isinstance(given, str):
            return tuple(parse_ramp(given))
        for point in given if _is_sequence(given) else [given]:
            if not _is_sequence(point) or len(point) != 2:
                raise UsageError(f"{shown(point)} is not a pair (time, speed)")
        return tuple((parse_quantity(time, "s"), parse_quantity(speed, "rad/s")) for time, speed in given)


@dataclass(frozen=True, kw_only=True)
class Whole(Range, Argument):
    """A whole number."""

    def read(self, given: Any) -> int:
        """The number."""
        is_text = isinstance(given, str) and re.fullmatch(r"\s*[+-]?[0-9]{1,9}\s*", given)
        if isinstance(given, bool) or not (is_text or isinstance(given, Integral)):
            raise UsageError(f"{shown(given)} is not a whole number")
        number = int(given)
        if not self.holds(number):
            raise UsageError(f"{shown(given)} is outside its range; allowed: {self.bounds('1')}")
        return number


@dataclass(frozen=True, kw_only=True)
class Name(Argument):
    """A name of something: letters, digits, spaces, ``.``, ``_`` and ``-``."""

    def read(self, given: object) -> str:
        """The name."""
        if not isinstance(given, str) or not re.fullmatch(r"[\w .-]+", given):
            raise UsageError(f"{shown(given)} is no name; allowed: letters, digits, spaces, '.', '_' and '-'")
        return given


@dataclass(frozen=True, kw_only=True)
class Flag(Argument):
    """Yes or no."""

    def read(self, given: object) -> bool:
        """The flag."""
        if not isinstance(given, bool):
            raise UsageError(f"{shown(given)} is neither True nor False")
        return given


@dataclass(frozen=True, kw_only=True)
class StoredResult(Argument):
    """A result at hand, or the file of one."""

    def read(self, given: Any) -> xr.Dataset:
        """The result as labelled data.

        Raises
        ------
        StoreError
            The file cannot be read.
        """
        if not isinstance(given, str | os.PathLike):
            import xarray

            if not isinstance(given, xarray.Dataset):
                raise UsageError(f"{shown(given)} is neither a result nor the file of one")
            return given
        from petalfoil.results.store import load

        return load(Path(given))


def _is_sequence(value: object) -> TypeGuard[Sequence[Any]]:
    """Whether `value` has entries in order.

    A text is one value. NumPy arrays are sequences in all but name, but for those without dimensions.
    """
    if isinstance(value, str) or getattr(value, "ndim", 1) == 0:
        return False
    return isinstance(value, Sequence) or (hasattr(value, "__len__") and hasattr(value, "__getitem__"))


# ---------------------------------------------------------------------------------------------- shared arguments

TURNING_ONLY = (
    "Petals slide along themselves, unless petals.theory is inextensible: surface.petal_friction then counts the "
    "turning of their faces only, about a sixtieth of the slip in the paper's bearing."
)
"""What users of friction between petals are told where petals do not slide along themselves."""

DOWNWARD = -math.pi / 2.0
"""Direction of the weight, along -y [rad]."""

SPEED_HELP = 'Speed instead of the case\'s: "8000 rad/s", "60000 rpm".'
LOAD_HELP = 'Load on the rotor instead of the case\'s: "0 N, -50 N"; a single value acts along -y.'
DISPLACEMENTS_HELP = 'Displacements along the direction: "0 um : 280 um : 15"; or a list or single one: "100 um".'

Speed: TypeAlias = Annotated[float | None, NumberWithUnit(unit="rad/s", help=SPEED_HELP, at_least=0.0)]
Speeds: TypeAlias = Annotated[
    Sequence[float] | None,
    NumbersWithUnit(
        unit="rad/s", metavar="LIST", help='Several speeds instead of one: "20000 rpm : 60000 rpm : 5".', at_least=0.0
    ),
]
JournalPosition: TypeAlias = Annotated[
    tuple[float, float] | None,
    Pair(unit="m", metavar="X,Y", help='Displacement of the journal instead of the case\'s: "0 um, -100 um".'),
]
Displacements: TypeAlias = Annotated[
    Sequence[float],
    NumbersWithUnit(unit="m", option="eccentricity", metavar="START:STOP:COUNT", help=DISPLACEMENTS_HELP),
]
DisplacementDirection: TypeAlias = Annotated[
    float, NumberWithUnit(unit="rad", metavar="ANGLE", help="Direction of the displacements, from x toward y.")
]
Load: TypeAlias = Annotated[tuple[float, float] | None, LoadVector(also="loads", metavar="LOAD", help=LOAD_HELP)]
Moment: TypeAlias = Annotated[
    tuple[float, float] | None,
    Pair(
        unit="N*m",
        metavar="X,Y",
        help='Moment on the journal about the bearing\'s centre, toward x and y: "0 N*m, 0.1 N*m"; the journal is '
        "then free to tilt.",
    ),
]
Loads: TypeAlias = Annotated[
    Sequence[float] | None,
    NumbersWithUnit(unit="N", metavar="LIST", help='Several loads along -y instead of one: "10 N, 20 N".', above=0.0),
]
Mass: TypeAlias = Annotated[
    float | None,
    NumberWithUnit(
        unit="kg",
        help='Mass that this one bearing carries: "2 kg"; with rotor.span that of the whole rotor in its two bearings. '
        "By default rotor.mass of the case, else load over gravity.",
        above=0.0,
    ),
]
Accuracy: TypeAlias = Annotated[
    float | None,
    NumberWithUnit(
        unit="1",
        metavar="NUMBER",
        help='Refine the grid until the error bar of every result is below this, as "1 %"; what misses it is named.',
        above=0.0,
        at_most=1.0,
    ),
]
ErrorBars: TypeAlias = Annotated[bool, Flag(help="Add error bars, from a study on the case's grid and two more.")]
Place: TypeAlias = tuple[float, float] | Literal["balance"] | None
