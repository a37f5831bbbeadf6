"""Kinds of fields: what a definition declares about each of its numbers, and the check that follows from it.

A field carries its declaration as an annotation, so meaning, unit, symbol and range stand in one place::

    length: Annotated[float, Quantity("m", "bearing length", symbol="L", above=0.0, at_most=10.0)]
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Integral
from typing import Any, cast

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from petalfoil.errors import UnitError, UsageError
from petalfoil.units import format_quantity, parse_quantity
from petalfoil.units.reading import is_bare, shown

UNIT_PROBLEM = "unit_problem"  # pydantic error types of ours; `problems.py` tells them apart
VALUE_PROBLEM = "value_problem"


UNSET: float = cast(float, None)
"""A number that was not given: it follows from a name, or has a default."""


def refuse(kind: str, text: str, allowed: str) -> PydanticCustomError:
    """Return the error of a value: `text` says what is wrong, `allowed` what would be right."""
    return PydanticCustomError(kind, "{text}", {"text": text, "allowed": allowed})


@dataclass(frozen=True, kw_only=True)
class Range:
    """Bounds of a number; None where there is none."""

    above: float | None = None
    at_least: float | None = None
    below: float | None = None
    at_most: float | None = None

    def holds(self, value: float) -> bool:
        """Whether `value` lies inside."""
        return not (
            (self.above is not None and value <= self.above)
            or (self.at_least is not None and value < self.at_least)
            or (self.below is not None and value >= self.below)
            or (self.at_most is not None and value > self.at_most)
        )

    def bounds(self, unit: str) -> str:
        """Words for the range, such as ``"greater than 0 m and at most 10 m"``."""
        named = (
            ("greater than", self.above),
            ("at least", self.at_least),
            ("less than", self.below),
            ("at most", self.at_most),
        )
        suffix = "" if unit == "1" else f" {unit}"
        return " and ".join(f"{word} {bound:g}{suffix}" for word, bound in named if bound is not None)


@dataclass(frozen=True, kw_only=True)
class Quantity(Range):
    """A physical quantity: a float in SI units, given as a number or as a text with a unit.

    Parameters
    ----------
    unit : str
        SI unit.
    meaning : str
        What it is, in words.
    symbol : str
        Letter of the equations.
    beyond : str
        What to do for a value outside the range, where it is not plain.
    """

    unit: str
    meaning: str
    symbol: str = ""
    beyond: str = ""

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        bounds = self.bounds(self.unit)
        return f"{self.meaning} [{self.unit}]" + (f", {bounds}" if bounds else "")

    def parse(self, value: object) -> float:
        """Read, convert and check one value."""
        try:
            number = parse_quantity(value, self.unit)
        except UnitError as error:
            raise refuse(UNIT_PROBLEM, str(error), error.allowed) from None
        if not self.holds(number):
            bare = f" (a bare number is read in {self.unit})" if is_bare(value) and self.unit != "1" else ""
            do = f"; {self.beyond}" if self.beyond else ""
            text = f"{shown(value)}{bare} is outside its range; allowed: {self.bounds(self.unit)}{do}"
            raise refuse(VALUE_PROBLEM, text, self.bounds(self.unit))
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.parse, core_schema.float_schema())


@dataclass(frozen=True, kw_only=True)
class QuantityOrWord(Quantity):
    """A quantity, or one word that asks for a rule, such as ``"chordal"``."""

    word: str

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        return f"{self.word!r} or {super().allowed}"

    def parse_either(self, value: object) -> float | str:
        """Let the word through, and read anything else as a quantity."""
        if value == self.word:
            return self.word
        if isinstance(value, str) and value.strip()[:1].isalpha():
            raise refuse(VALUE_PROBLEM, f"{shown(value)} is neither {self.word!r} nor an angle", self.allowed)
        return self.parse(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse_either)


PER_PETAL = "one for all petals, or a list with one for each"


@dataclass(frozen=True, kw_only=True)
class PerPetal(Quantity):
    """A quantity of all petals, or a list with that of each."""

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        return f"{super().allowed}; {PER_PETAL}"

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(lambda value: one_or_each(self.parse, value))


@dataclass(frozen=True, kw_only=True)
class PerPetalOrWord(QuantityOrWord):
    """A quantity or a word of all petals, or a list with that of each."""

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        return f"{super().allowed}; {PER_PETAL}"

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(lambda value: one_or_each(self.parse_either, value))


def one_or_each(parse: Callable[[object], float | str], value: object) -> object:
    """Read one value, or those of a list; a refusal names the petal, the first of which is 0."""
    entries = as_sequence(value)
    if entries is None:
        return parse(value)
    read = []
    for petal, entry in enumerate(entries):
        try:
            read.append(parse(entry))
        except PydanticCustomError as error:
            allowed = str((error.context or {}).get("allowed", ""))
            raise refuse(error.type, f"of petal {petal}: {error.message()}", allowed) from None
    return tuple(read)


@dataclass(frozen=True, kw_only=True)
class Count(Range):
    """A whole number; fractions, texts and booleans are refused rather than rounded.

    Parameters
    ----------
    meaning : str
        What is counted.
    symbol : str
        Letter of the equations.
    """

    meaning: str
    symbol: str = ""

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        return f"a whole number, {self.bounds('1')}"

    def parse(self, value: object) -> int:
        """Check one value."""
        if isinstance(value, bool) or not isinstance(value, Integral):
            raise refuse(VALUE_PROBLEM, f"{shown(value)} is not a whole number; allowed: {self.allowed}", self.allowed)
        if not self.holds(int(value)):
            text = f"{shown(value)} is outside its range; allowed: {self.allowed}"
            raise refuse(VALUE_PROBLEM, text, self.allowed)
        return int(value)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.parse, core_schema.int_schema())


@dataclass(frozen=True, kw_only=True)
class NumbersOrWord(Range):
    """A list of numbers, or a word that asks for a rule, such as ``"adapted"``.

    Parameters
    ----------
    meaning : str
        What the numbers are, in words.
    words : tuple of str
        The words.
    least, most : int
        Length of the list.
    """

    meaning: str
    words: tuple[str, ...]
    least: int
    most: int
    symbol: str = ""

    @property
    def allowed(self) -> str:
        """Words for what a user may write."""
        words = " or ".join(f'"{word}"' for word in self.words)
        return f"{words}, or a list of {self.least} to {self.most} numbers, each {self.bounds('1')}: {self.meaning}"

    def parse(self, value: object) -> tuple[float, ...] | str:
        """Let the words through, and check the entries of a list."""
        if isinstance(value, str) and value in self.words:
            return value
        entries = as_sequence(value)
        if entries is None or not self.least <= len(entries) <= self.most:
            raise refuse(VALUE_PROBLEM, f"{shown(value)} is not allowed; allowed: {self.allowed}", self.allowed)
        wrong = [k for k, entry in enumerate(entries) if not self._holds(entry)]
        if wrong:
            text = f"entry {wrong[0] + 1}, {shown(entries[wrong[0]])}, is not allowed; allowed: {self.allowed}"
            raise refuse(VALUE_PROBLEM, text, self.allowed)
        return tuple(float(entry) for entry in entries if isinstance(entry, int | float))

    def _holds(self, entry: object) -> bool:
        return isinstance(entry, int | float) and not isinstance(entry, bool) and self.holds(float(entry))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.parse)


def as_pair(value: object) -> object:
    """Let only sequences of two entries through: the components along x and y."""
    allowed = "two quantities, [x, y]"
    entries = as_sequence(value)
    if entries is None or len(entries) != 2:
        both = f', such as ["{value}", "{value}"]' if isinstance(value, str) and "," not in value else ""
        raise refuse(VALUE_PROBLEM, f"{shown(value)} is not {allowed}{both}", allowed)
    return tuple(entries)


def as_load(value: object) -> object:
    """Let pairs through, and make a single quantity a load along -y: ``"10 N"`` becomes (0, -10) N."""
    if as_sequence(value) is not None:
        return as_pair(value)
    allowed = "two forces, [x, y], or one along -y"
    try:
        return load_along_minus_y(value)
    except UnitError as error:
        raise refuse(UNIT_PROBLEM, str(error), f"{allowed}, {error.allowed}") from None
    except UsageError as error:
        raise refuse(VALUE_PROBLEM, str(error), allowed) from None


def load_along_minus_y(value: object) -> tuple[float, float]:
    """The load (x, y) that a single quantity stands for, its magnitude along -y [N].

    Raises
    ------
    UnitError
        It is no force.
    UsageError
        It is negative: whether the sign means the direction or is that of a component along y cannot be told.
    """
    force = parse_quantity(value, "N")
    if force < 0.0:
        up, down = format_quantity(-force, "N"), format_quantity(force, "N")
        raise UsageError(
            f"{shown(value)} is negative, and a single load is a magnitude along -y, downward: write '{up}' for that, "
            f"or both components, '0 N, {down}' downward and '0 N, {up}' upward"
        )
    return 0.0, -force


def as_sequence(value: object) -> Sequence[object] | None:
    """Entries of a list, a tuple or an array; None for anything else."""
    listed = value.tolist() if hasattr(value, "tolist") else value  # NumPy arrays
    return listed if isinstance(listed, list | tuple) else None
