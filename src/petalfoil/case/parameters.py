"""Parameters of a case: every number that may vary, by its dotted path.

A parameter is a number that the case's own definitions declare: ``petals.thickness``, ``petals.count``,
``operation.load.y``. Studies vary them, derivatives are taken by them. Unit and range stand in the declaration of the
field (`number_fields`); nothing is repeated here.
"""

from __future__ import annotations

import re
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError

from petalfoil.case.definition import Definition
from petalfoil.case.definitions import Case
from petalfoil.case.hints import nearest, nearest_key
from petalfoil.case.number_fields import UNIT_PROBLEM, Count, PerPetal, PerPetalOrWord, Quantity
from petalfoil.errors import DefinitionError, UnitError
from petalfoil.text import for_terminal
from petalfoil.units.reading import shown

AXES = ("x", "y")
"""Names of the two entries of a pair."""

ZERO = (0.0, 0.0)
"""What the other entry of a pair is where the case gives none: a load along one axis only."""

Number = float | int


@dataclass(frozen=True)
class Parameter:
    """A number of a case that may vary.

    Attributes
    ----------
    path : str
        Dotted path, such as ``"petals.thickness"``; a pair has the entries ``.x`` and ``.y``, a list ``[0]``, ``[1]`` …
    declared : Quantity or Count
        Meaning, unit, symbol and range.
    value : float, int or None
        Value in the case, SI; None where the case leaves it to a rule, such as ``root_tilt = "chordal"``.
    """

    path: str
    declared: Quantity | Count
    value: Number | None

    @property
    def unit(self) -> str:
        """SI unit; ``"1"`` of a plain number and of a count."""
        return "1" if isinstance(self.declared, Count) else self.declared.unit

    @property
    def is_count(self) -> bool:
        """Whether it is a whole number."""
        return isinstance(self.declared, Count)

    @property
    def meaning(self) -> str:
        """What it is, in words."""
        return self.declared.meaning

    @property
    def symbol(self) -> str:
        """Letter of the equations; empty where it has none."""
        return self.declared.symbol

    @property
    def name(self) -> str:
        """Its path without the table, as an identifier: ``"thickness"``, ``"load_y"``, ``"thickness_3"``."""
        return re.sub(r"\W+", "_", self.path.partition(".")[2]).strip("_")

    def read(self, given: object) -> Number:
        """A value of this parameter in SI, from a number or a text with a unit.

        Raises
        ------
        UnitError
            The unit is unknown or measures something else.
        DefinitionError
            The value is no number, or outside the range of the parameter.
        """
        try:
            return self.declared.parse(_whole(given) if self.is_count else given)
        except PydanticCustomError as error:
            kind = UnitError if error.type == UNIT_PROBLEM else DefinitionError
            allowed = str((error.context or {}).get("allowed", ""))
            raise kind(f"{self.path}: {error.message()}", key=self.path, given=given, allowed=allowed) from None


def parameters_of(case: Case) -> dict[str, Parameter]:
    """All parameters of a case by path, in the order of its tables.

    Tables that the case does not have, and numbers that follow from others (the viscosity of a gas by name), have none.
    """
    return {parameter.path: parameter for parameter in _parameters(case)}


def parameter_of(case: Case, path: str) -> Parameter:
    """One parameter of a case; of a field that all petals share, also that of one petal, as ``petals.thickness[3]``.

    Raises
    ------
    DefinitionError
        The case has no such parameter; the message has the nearest known one.
    """
    known = parameters_of(case)
    if path in known:
        return known[path]
    field, entry = _entry(path)
    if entry is not None and field in known and entry < _petals_with_one(case, known[field]):
        return replace(known[field], path=path)
    text = f"{shown(for_terminal(path))} is no parameter of this case.{_hint(case, path, known)}"
    raise DefinitionError(text, key=path, given=path, allowed=", ".join(known))


def parameters_of_petals(case: Case, path: str) -> tuple[Parameter, ...]:
    """The parameters of the single petals that one path stands for.

    Raises
    ------
    DefinitionError
        The path is no field of the table of the petals, or one that they share.
    """
    if not _petals(case) or not path.startswith("petals."):
        raise DefinitionError(f"{path}: 'each' is for fields of [petals], one value a petal", key=path, given="each")
    return tuple(parameter_of(case, f"{path}[{number}]") for number in range(_petals(case)))


def with_values(case: Case, values: Mapping[str, object]) -> Case:
    """The case with other values of some of its parameters, validated.

    Parameters
    ----------
    case : Case
        The bearing.
    values : mapping
        Values by path: numbers in SI, or texts with units.

    Raises
    ------
    DefinitionError
        A path is unknown, a value outside its range, or the values do not go together (a `PackError` where the foil
        pack cannot be assembled).
    """
    changes: dict[str, object] = {}
    for path, given in values.items():
        parameter = parameter_of(case, path)
        field, entry = _entry(path)
        number = parameter.read(given)
        if entry is None:
            changes[field] = number
        else:
            own = changes.get(field) or _value(case, field) or ZERO
            entries = list(own) if isinstance(own, tuple) else [own] * _petals(case)
            entries[entry] = number
            changes[field] = tuple(entries)
    return case.replace(**changes) if changes else case


def _petals(case: Case) -> int:
    """Petals of the case."""
    return 0 if case.petals is None else case.petals.count


def _petals_with_one(case: Case, parameter: Parameter) -> int:
    """How many petals may have a value of their own of a parameter that the case gives for all."""
    return _petals(case) if isinstance(parameter.declared, PerPetal | PerPetalOrWord) else 0


def _parameters(case: Case) -> Iterator[Parameter]:
    for section in type(case).model_fields:
        table = getattr(case, section)
        if isinstance(table, Definition):
            for name, value in table.entries().items():
                yield from _of_field(f"{section}.{name}", type(table).model_fields[name], value)


def _of_field(path: str, field: FieldInfo, value: object) -> Iterator[Parameter]:
    declared = [*_declared(field.metadata), *_declared_in(field.annotation)]
    if not declared or _are_rows(field.annotation):
        return
    if _is_pair(field.annotation):
        names, entries = [f".{axis}" for axis in AXES], value or (None, None)
    elif isinstance(value, tuple):
        names, entries = [f"[{number}]" for number in range(len(value))], value
    else:
        names, entries = [""], (value,)
    for name, entry in zip(names, typing.cast("tuple[object, ...]", entries), strict=True):
        yield Parameter(path + name, declared[0], entry if isinstance(entry, Number) else None)


def _declared(metadata: typing.Iterable[object]) -> list[Quantity | Count]:
    return [part for part in metadata if isinstance(part, Quantity | Count)]


def _declared_in(annotation: object) -> Iterator[Quantity | Count]:
    """Declarations inside an annotation: of an optional number, of the entries of a pair or a list."""
    yield from _declared(getattr(annotation, "__metadata__", ()))
    for inner in typing.get_args(annotation):
        yield from _declared_in(inner)


def _is_pair(annotation: object) -> bool:
    """Whether an annotation is a tuple of two components, possibly None."""
    return any(len(parts) == len(AXES) and Ellipsis not in parts for parts in _tuples(annotation))


def _are_rows(annotation: object) -> bool:
    """Whether an annotation is a table: a tuple of tuples."""
    return any(typing.get_origin(part) is tuple for parts in _tuples(annotation) for part in parts)


def _tuples(annotation: object) -> Iterator[tuple[object, ...]]:
    """Entries of the tuples that an annotation allows."""
    if typing.get_origin(annotation) is tuple:
        yield typing.get_args(annotation)
    else:
        for inner in typing.get_args(annotation):
            yield from _tuples(inner)


def _entry(path: str) -> tuple[str, int | None]:
    """Path of the field of a parameter, and which of its entries it is."""
    if listed := re.fullmatch(r"(.+)\[(\d+)\]", path):
        return listed[1], int(listed[2])
    field, _, axis = path.rpartition(".")
    return (field, AXES.index(axis)) if axis in AXES and "." in field else (path, None)


def _value(case: Case, field: str) -> object:
    section, _, name = field.partition(".")
    return getattr(getattr(case, section), name)


def _whole(given: object) -> object:
    """A count as a whole number, where it is written as a text or as a float without fraction."""
    if isinstance(given, str) and re.fullmatch(r"\s*[+-]?[0-9]{1,9}\s*", given):
        return int(given)
    return int(given) if isinstance(given, float) and given.is_integer() else given


def _hint(case: Case, path: str, known: Mapping[str, Parameter]) -> str:
    """What an unknown path was meant to be, or why it is none."""
    inside = [name for name in known if name.startswith((f"{path}.", f"{path}["))]
    if inside:
        return f" It has entries: {', '.join(inside)}."
    section, _, name = path.partition(".")
    is_table = section in type(case).model_fields
    table = getattr(case, section) if is_table else None
    if is_table and table is None:
        return f" The case has no table [{section}]."
    if isinstance(table, Definition) and name in type(table).model_fields:
        return f" It is {shown(str(getattr(table, name)))} here, which is no number that can vary."
    listed = re.sub(r"\[\d+\]$", "", path)
    if listed in known:
        return f" {listed!r} is one number for all."
    meant = nearest(path, list(known)) or nearest_key(path.rpartition(".")[2], "", list(known))
    return meant or f" Known: {', '.join(known)}."
