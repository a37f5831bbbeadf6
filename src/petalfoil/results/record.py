"""One answer as plain arrays: what an analysis returns and everything downstream reads."""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from petalfoil.results.schema import COORDINATES, FIELDS, SCALARS
from petalfoil.results.variable import DataType, Role, Variable

Array: TypeAlias = npt.NDArray[np.generic]
Scalar: TypeAlias = float | int | bool | str

_PLAIN: dict[DataType, tuple[type, ...]] = {
    DataType.FLOAT: (float, int, np.floating, np.integer),
    DataType.INT: (int, np.integer),
    DataType.BOOL: (bool, np.bool_),
    DataType.STR: (str,),
}


@dataclass(frozen=True, kw_only=True)
class Record:
    """One answer of an analysis; every name is declared in ``results.schema``.

    Parameters
    ----------
    analysis : str
        Analysis that gave it, such as "solve".
    scalars : dict
        Results by name, SI.
    fields : dict
        Arrays by name, SI, with the dimensions the schema declares.
    coords : dict
        Coordinate arrays by name.
    case_toml : str
        The whole case, so that the run can be repeated.
    title : str
        Title of the case.
    history : list of dict
        One entry an iteration.
    errors : dict of float, optional
        Error bars of the results from a grid study; None where none was asked for, empty where none was found.
    remarks : tuple of str
        What the user is told beside the results.
    warnings : tuple of str
        What is implausible about the case and its results: key or quantity before a colon, then what and why.

    Raises
    ------
    ValueError
        A name, a type or a shape is not the declared one: a mistake of the program, not of its user.
    """

    analysis: str
    scalars: dict[str, Scalar]
    fields: dict[str, Array] = field(default_factory=dict)
    coords: dict[str, Array] = field(default_factory=dict)
    case_toml: str = ""
    title: str = ""
    history: list[dict[str, float | int | str]] = field(default_factory=list)
    errors: Mapping[str, float] | None = None
    remarks: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _refuse_unknown("scalar", self.scalars, SCALARS)
        _refuse_unknown("field", self.fields, FIELDS)
        _refuse_unknown("coordinate", self.coords, COORDINATES)
        for name in self.scalars.keys() & self.fields.keys():
            raise ValueError(f"{name!r} is given as a scalar and as a field: a result has one of them")
        for name, value in self.scalars.items():
            _refuse_type(name, value, SCALARS[name])
        sizes = {name: len(values) for name, values in self.coords.items() if name in COORDINATES[name].dims}
        for name, values in {**self.coords, **self.fields}.items():
            _refuse_shape(name, values, {**COORDINATES, **FIELDS}[name], sizes)

    @property
    def converged(self) -> bool:
        """Whether the state satisfies the equations; true where the analysis declares no such flag."""
        return bool(self.scalars.get("converged", True))

    def reported(self) -> dict[str, Scalar]:
        """Scalars as plain Python values; results of a state that did not converge are NaN, its flags false."""
        return {name: _plain(name, value, self.converged) for name, value in self.scalars.items()}


def warnings_of_all(records: Sequence[Record]) -> tuple[str, ...]:
    """Warnings of records, one for each doubt of a key or quantity: the first, and how many more points have it.

    Parameters
    ----------
    records : sequence of Record
        The points in order.

    Returns
    -------
    tuple of str
        One line each. A record that has two doubts of one key, such as a Mach and a Reynolds number, tells both.
    """
    by_doubt: dict[tuple[str, int], list[str]] = {}
    for record in records:
        told: Counter[str] = Counter()
        for warning in record.warnings:
            key = warning.partition(":")[0]
            by_doubt.setdefault((key, told[key]), []).append(warning)
            told[key] += 1
    return tuple(_with_number(first, more) for first, *more in by_doubt.values())


def _with_number(first: str, more: Sequence[str]) -> str:
    """A warning with the number of further points that have it in other words."""
    if all(text == first for text in more):
        return first
    return f"{first} ({len(more)} more point{'s' if len(more) > 1 else ''} alike)"


def _plain(name: str, value: Scalar, converged: bool) -> Scalar:
    variable = SCALARS[name]
    if variable.role is Role.ANSWER and not converged:
        return blank(variable)
    convert = {DataType.FLOAT: float, DataType.INT: int, DataType.BOOL: bool, DataType.STR: str}[variable.kind]
    result: Scalar = convert(value)
    return result


NO_COUNT = -1
"""What stands for a count that is not there: whole numbers know no NaN."""


def blank(variable: Variable) -> Scalar:
    """What stands for a figure that is not there."""
    match variable.kind:
        case DataType.FLOAT:
            return float("nan")
        case DataType.BOOL:
            return False
        case DataType.STR:
            return ""
        case DataType.INT:
            return NO_COUNT


def _refuse_unknown(what: str, given: Mapping[str, object], declared: Mapping[str, Variable]) -> None:
    for name in given:
        if name not in declared:
            near = difflib.get_close_matches(name, declared, 1)
            hint = f" Did you mean {near[0]!r}?" if near else ""
            raise ValueError(f"no {what} {name!r} in results.schema.{hint}")


def _refuse_type(name: str, value: object, variable: Variable) -> None:
    bool_as_number = isinstance(value, (bool, np.bool_)) and variable.kind is not DataType.BOOL
    if bool_as_number or not isinstance(value, _PLAIN[variable.kind]):
        raise ValueError(f"scalar {name!r} must be {variable.kind.value}, got {value!r}")


def _refuse_shape(name: str, values: Array, variable: Variable, sizes: Mapping[str, int]) -> None:
    missing = [dim for dim in variable.dims if dim not in sizes]
    if missing:
        raise ValueError(f"{name!r} needs the coordinate {missing[0]!r}")
    shape = tuple(sizes[dim] for dim in variable.dims)
    if np.shape(values) != shape:
        raise ValueError(f"{name!r} must have shape {shape} {variable.dims}, got {np.shape(values)}")
