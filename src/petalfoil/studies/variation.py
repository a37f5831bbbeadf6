"""What varies in a study: a parameter of the case, and the values that it takes.

The texts of ``--vary`` and ``--scatter`` are read here::

    petals.thickness = 0.1 mm : 0.2 mm : 11      levels: start, stop, number of them
    petals.count     = 6, 8, 10                  levels: a list
    petals.thickness = 0.1 mm : 0.2 mm           an interval
    petals.thickness = ± 5 um                    uniform scatter about the value of the case
    petals.thickness = normal 0.2 mm             normal scatter: standard deviation
    petals.thickness = normal 2 % each           the same, drawn for each petal by itself
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, Parameter, parameter_of, parameters_of_petals
from petalfoil.errors import DefinitionError, UnitError, UsageError
from petalfoil.units import format_quantity, parse_quantity, parse_range
from petalfoil.units.reading import shown

FloatArray = NDArray[np.float64]
Number = float | int

SCATTER = re.compile(
    r"(?P<kind>±|\+-|\+/-|normal|uniform|triangular)\s*(?:±|\+-|\+/-)?\s*(?P<width>.+?)(?P<each>\s+each)?"
)
"""Form of a scatter."""
UNIFORM = ("±", "+-", "+/-", "uniform")
TAIL = 1e-9
"""Probability at which a normal distribution is cut: a sample at 0 or 1 would lie at infinity."""


@dataclass(frozen=True)
class Variation(ABC):
    """A parameter and the values that it takes.

    Attributes
    ----------
    parameter : Parameter
        What varies.
    """

    parameter: Parameter

    @property
    def path(self) -> str:
        """Path of the parameter."""
        return self.parameter.path

    @property
    def name(self) -> str:
        """Name of the parameter in a dataset."""
        return self.parameter.name

    @abstractmethod
    def at(self, probability: FloatArray) -> list[Number]:
        """The values below which the parameter lies with these probabilities [SI]."""


@dataclass(frozen=True)
class Levels(Variation):
    """A list of values."""

    values: tuple[Number, ...]

    def at(self, probability: FloatArray) -> list[Number]:
        """Values that are equally likely."""
        last = len(self.values) - 1
        return [self.values[min(int(part * len(self.values)), last)] for part in probability]


@dataclass(frozen=True)
class Interval(Variation):
    """All values between two; of a count all whole numbers."""

    low: Number
    high: Number

    def at(self, probability: FloatArray) -> list[Number]:
        """Values that are equally likely."""
        if self.parameter.is_count:
            return Levels(self.parameter, tuple(range(int(self.low), int(self.high) + 1))).at(probability)
        return [float(self.low + part * (self.high - self.low)) for part in probability]


@dataclass(frozen=True)
class Scatter(Variation):
    """Scatter about a nominal value.

    Attributes
    ----------
    kind : str
        ``"uniform"``, ``"normal"`` or ``"triangular"``.
    nominal : float
        Mean value [SI].
    width : float
        Half the width of the distribution; of a normal one its standard deviation [SI].
    """

    kind: str
    nominal: float
    width: float

    @property
    def standard_deviation(self) -> float:
        """Standard deviation [SI]."""
        return self.width / math.sqrt({"uniform": 3.0, "normal": 1.0, "triangular": 6.0}[self.kind])

    def at(self, probability: FloatArray) -> list[Number]:
        """Quantiles of the distribution."""
        from scipy.special import ndtri

        u = np.asarray(probability, dtype=np.float64)
        unit = {
            "uniform": 2.0 * u - 1.0,
            "normal": ndtri(np.clip(u, TAIL, 1.0 - TAIL)),
            "triangular": np.where(u < 0.5, np.sqrt(2.0 * u) - 1.0, 1.0 - np.sqrt(2.0 * (1.0 - u))),
        }[self.kind]
        return [float(value) for value in self.nominal + self.width * unit]


def read_levels(case: Case, path: str, given: object) -> Levels:
    """Levels of a parameter from a text or a list.

    Raises
    ------
    DefinitionError
        There is no such parameter, or a value is outside its range.
    UsageError
        The text has another form, or a value comes twice.
    """
    parameter = parameter_of(case, path)
    values = tuple(_entries(parameter, given))
    if len(set(values)) < len(values):
        raise UsageError(f"{path}: {shown(given)} has a value twice; allowed: each value once")
    return Levels(parameter, values)


def read_range(case: Case, path: str, given: object) -> Levels | Interval:
    """An interval ``"low : high"``, or levels, of a parameter.

    Raises
    ------
    DefinitionError
        There is no such parameter, or a value is outside its range.
    UsageError
        The text has another form, or the interval is empty.
    """
    ends = given.split(":") if isinstance(given, str) else given
    if not isinstance(ends, Sequence) or len(ends) != 2 or (not isinstance(given, str | tuple)):
        return read_levels(case, path, given)
    parameter = parameter_of(case, path)
    low, high = (_read(parameter, end) for end in ends)
    if not low < high:
        raise UsageError(f"{path}: {shown(given)} is empty; allowed: low : high, the second greater")
    return Interval(parameter, low, high)


def read_scatter(case: Case, path: str, given: str) -> tuple[Scatter, ...]:
    """Scatter of a parameter about its value in the case; with ``each`` one for every petal.

    Raises
    ------
    DefinitionError
        There is no such parameter, the case gives it no number, or the width has another unit.
    UsageError
        The text has another form.
    """
    form = SCATTER.fullmatch(given.strip())
    if form is None:
        raise UsageError(
            f"{path}: {shown(given)} is no scatter; write '± 5 um', 'normal 0.2 mm', 'triangular ± 2 %', and 'each' "
            "behind it for one value a petal"
        )
    kind = "uniform" if form["kind"] in UNIFORM else form["kind"]
    parameters = parameters_of_petals(case, path) if form["each"] else (parameter_of(case, path),)
    return tuple(_scatter(parameter, kind, form["width"].strip()) for parameter in parameters)


def _scatter(parameter: Parameter, kind: str, width: str) -> Scatter:
    if parameter.is_count:
        raise DefinitionError(f"{parameter.path}: a count does not scatter", key=parameter.path, given=width)
    if parameter.value is None:
        text = f"{parameter.path}: the case gives no number to scatter about; set one in the case"
        raise DefinitionError(text, key=parameter.path, given=None)
    if width.endswith("%"):
        size = abs(parameter.value) * parse_quantity(width.removesuffix("%"), "1") / 100.0
    else:
        try:
            size = parse_quantity(width, parameter.unit)
        except UnitError as error:
            raise UnitError(f"{parameter.path}: {error}; behind the width only 'each' may stand") from error
    if not size > 0.0:
        text = f"{parameter.path}: a scatter of {shown(width)} is too small; allowed: greater than 0"
        raise DefinitionError(text, key=parameter.path, given=width, allowed="greater than 0")
    return Scatter(parameter, kind, float(parameter.value), size)


def _entries(parameter: Parameter, given: object) -> Iterator[Number]:
    """Single values of a text or a list [SI]."""
    if isinstance(given, str):
        try:
            values = parse_range(given, parameter.unit)
        except (UsageError, UnitError) as error:
            raise type(error)(f"{parameter.path}: {error}") from error
        outside = [value for value in values if not parameter.declared.holds(value)]
        if outside:
            text = f"{format_quantity(outside[0], parameter.unit)} of {shown(given)} is outside its range"
            allowed = parameter.declared.allowed
            raise DefinitionError(f"{parameter.path}: {text}; allowed: {allowed}", key=parameter.path, given=given)
        yield from (parameter.read(value) for value in values)
        return
    listed = given.tolist() if isinstance(given, np.ndarray) else given
    yield from (parameter.read(value) for value in (listed if isinstance(listed, Sequence) else [listed]))


def _read(parameter: Parameter, given: object) -> Number:
    return parameter.read(given.strip() if isinstance(given, str) else given)
