"""Limits and objectives: results of an analysis with a bound or a direction, read from texts with units.

::

    min_film_thickness > 5 um
    liftoff_speed < 15000 rpm
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from petalfoil.case.hints import nearest
from petalfoil.errors import UnitError, UsageError
from petalfoil.results.record import Scalar
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import cell, label_alone
from petalfoil.results.variable import DataType, Role
from petalfoil.units import parse_quantity
from petalfoil.units.reading import shown

LIMIT = re.compile(r"\s*(?P<name>\w+)\s*(?P<sign><=?|>=?)\s*(?P<value>.+?)\s*")


@dataclass(frozen=True)
class ResultLimit:
    """A result on one side of a value.

    Attributes
    ----------
    name : str
        The result.
    is_upper : bool
        Whether it must stay below the value, else above.
    value : float
        The value [SI].
    """

    name: str
    is_upper: bool
    value: float

    @classmethod
    def read(cls, text: str) -> ResultLimit:
        """Read ``"min_film_thickness > 5 um"``.

        Raises
        ------
        UsageError
            The text has another form, or there is no such result.
        UnitError
            The value measures something else.
        """
        form = LIMIT.fullmatch(text)
        if form is None:
            raise UsageError(
                f"{shown(text)} is no limit; write a result, < or >, and a value: 'min_film_thickness > 5 um'"
            )
        name = result_of(form["name"])
        try:
            value = parse_quantity(form["value"], unit_of(name))
        except UnitError as error:
            raise UnitError(f"{name}: {error}", given=error.given, allowed=error.allowed) from error
        return cls(name, form["sign"].startswith("<"), value)

    def margin(self, value: float) -> float:
        """By how much a value keeps the limit; negative where it does not [SI]."""
        return self.value - value if self.is_upper else value - self.value

    @property
    def text(self) -> str:
        """The limit in the units of tables."""
        line = cell(self.name, self.value)
        return f"{label_alone(self.name)} {'<' if self.is_upper else '>'} {line.value} {line.unit}".strip()


def result_of(name: str) -> str:
    """The name of a numeric result.

    Raises
    ------
    UsageError
        No analysis has it; the message has the nearest one.
    """
    known = [
        key
        for key, variable in SCALARS.items()
        if variable.kind is DataType.FLOAT and variable.role is not Role.GEOMETRY
    ]
    if name not in known:
        raise UsageError(f"{shown(name)} is no result of an analysis.{nearest(name, known)}")
    return name


def unit_of(name: str) -> str:
    """Unit of a result as quantities are read in: ``"rad/s"`` of a speed, ``"N*m"`` of a torque."""
    parts = [re.fullmatch(r"([A-Za-z]+|1)(-?\d+)?", part) for part in (SCALARS[name].units or "1").split()]
    factors = [(part[1], int(part[2] or 1)) for part in parts if part]
    over = "*".join(unit if power == 1 else f"{unit}^{power}" for unit, power in factors if power > 0) or "1"
    under = [unit if power == -1 else f"{unit}^{-power}" for unit, power in factors if power < 0]
    return "/".join([over, *under])


def value_of(records: Iterable[Mapping[str, Scalar]], name: str) -> float:
    """A result of a case, of the last of its points; NaN where it has none."""
    found = [record[name] for record in records if name in record]
    return float(found[-1]) if found else float("nan")


def refuse_absent(names: Iterable[str], records: list[dict[str, Scalar]], verb: str) -> None:
    """Refuse results that the analysis does not give, as soon as it has given some.

    Raises
    ------
    UsageError
        A result is not among those of a converged case.
    """
    given = sorted({key for record in records for key, value in record.items() if isinstance(value, float)})
    for name in names:
        if given and name not in given:
            raise UsageError(f"{verb} gives no {name}; it gives {', '.join(given)}.{nearest(name, given)}")
