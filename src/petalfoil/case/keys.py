"""Every key of a case, read from its definitions: unit, range, default, meaning; and what a case says to each."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from html import escape
from typing import Any

from pydantic.fields import FieldInfo

from petalfoil.case.attribute_texts import attribute_texts
from petalfoil.case.definition import Definition
from petalfoil.case.definitions import Case
from petalfoil.case.number_fields import Count, Quantity, QuantityOrWord
from petalfoil.case.wall_tables import registered_tables
from petalfoil.units.writing import format_quantity

DIGITS = 6
"""Digits of values and defaults: 20 °C are 293.15 K, which 4 digits would round."""


@dataclass(frozen=True)
class Key:
    """One key of a case.

    Attributes
    ----------
    name, symbol : str
        Its name, and its letter in the equations.
    unit : str
        SI unit; empty of words.
    allowed : str
        Its range, or the words that it may be.
    default : str
        What it is where a case does not say it, with its unit.
    meaning : str
        What it is.
    """

    name: str
    symbol: str
    unit: str
    allowed: str
    default: str
    meaning: str


def sections() -> dict[str, type[Definition]]:
    """Definitions of the tables of a case by name: those that every case knows, and those of further walls."""
    found = {name: definition for name, field in Case.model_fields.items() if (definition := _definition(field))}
    return found | {table.section: table for table in registered_tables()}


def keys(definition: type[Definition], prefix: str = "") -> Iterator[Key]:
    """The keys of a table; those of a table inside it are dotted."""
    for name, field in definition.model_fields.items():
        inner = _definition(field)
        if inner is None:
            yield _key(prefix + name, field, attribute_texts(definition).get(name, ""))
        elif definition is not Case:
            yield from keys(inner, f"{prefix}{name}.")


@dataclass(frozen=True)
class KeyEntry:
    """What a case says to a key, or leaves to its default.

    Attributes
    ----------
    key : Key
        The key, by its dotted path.
    value : str
        Its value, with its unit.
    given : bool
        Whether the case says it.
    """

    key: Key
    value: str
    given: bool


def entries(case: Case) -> Iterator[KeyEntry]:
    """All keys of the tables that a case has, with their values.

    A table that the case leaves out is one of defaults. Keys without value, for which the case has a rule, are left
    out, and so is the title.
    """
    for section in type(case).model_fields:
        table = getattr(case, section)
        if isinstance(table, Definition):
            yield from _entries(table, f"{section}.")


def as_html(case: Case) -> str:
    """What a notebook shows of a case: its title and the keys that it gives, with their meanings."""
    rows = "".join(
        f"<tr><td><code>{escape(entry.key.name)}</code></td><td>{escape(entry.value)}</td>"
        f"<td style='text-align:left'>{escape(entry.key.meaning)}</td></tr>"
        for entry in entries(case)
        if entry.given
    )
    return f"<b>{escape(case.title or 'Case without a title')}</b><table>{rows}</table>"


def _entries(table: Definition, prefix: str) -> Iterator[KeyEntry]:
    texts = attribute_texts(type(table))
    for name, field in type(table).model_fields.items():
        value, key = getattr(table, name), _key(prefix + name, field, texts.get(name, ""))
        if isinstance(value, Definition):
            yield from _entries(value, f"{prefix}{name}.")
        elif value is not None:
            yield KeyEntry(key, _plain(value, key.unit.partition(",")[0]), name in table.model_fields_set)


def _plain(value: object, unit: str) -> str:
    """A value for a reader."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return f"{len(value)} rows" if any(isinstance(v, tuple) for v in value) else _several(value, unit)
    if isinstance(value, float) and unit:
        return format_quantity(value, unit, digits=DIGITS)
    return f"{value}"


def _several(values: tuple[Any, ...], unit: str) -> str:
    return ", ".join(_plain(value, unit) for value in values)


def _key(name: str, field: FieldInfo, text: str) -> Key:
    declared = list(_parts(field.annotation, field.metadata))
    numbers = [part for part in declared if isinstance(part, Quantity | Count)]
    words = [part for part in declared if inspect.isclass(part) and issubclass(part, StrEnum)]
    number = numbers[0] if numbers else None
    said = [part for part in (number.meaning if number else "", _flow(text)) if part]
    return Key(
        name=name,
        symbol=", ".join(dict.fromkeys(part.symbol for part in numbers if part.symbol)),
        unit=", ".join(dict.fromkeys(getattr(part, "unit", "1") for part in numbers)),
        allowed=_allowed(number, words, declared),
        default=_default(field, getattr(number, "unit", "")),
        meaning=". ".join(text[:1].upper() + text[1:].rstrip(".") for text in said),
    )


def _allowed(number: Quantity | Count | None, words: list[type[StrEnum]], declared: list[Any]) -> str:
    if words:
        return ", ".join(f'`"{member}"`' for member in words[0])
    if number is None:
        return "`true`, `false`" if any(getattr(part, "__name__", "") == "bool" for part in declared) else "text"
    bounds = number.bounds(getattr(number, "unit", "1")) or "any"
    return f'{bounds}, or `"{number.word}"`' if isinstance(number, QuantityOrWord) else bounds


def _default(field: FieldInfo, unit: str) -> str:
    if field.is_required():
        return "required"
    value: Any = field.get_default(call_default_factory=True)
    if value is None:
        return "–"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, str):
        return f'`"{value}"`'
    if isinstance(value, tuple):
        return ", ".join(format_quantity(entry, unit, digits=DIGITS) for entry in value)
    return format_quantity(value, unit, digits=DIGITS) if unit else f"{value}"


def _definition(field: FieldInfo) -> type[Definition] | None:
    """The definition of a table that a field holds, optional or not."""
    kinds = (field.annotation, *typing.get_args(field.annotation))
    return next((kind for kind in kinds if inspect.isclass(kind) and issubclass(kind, Definition)), None)


def _parts(annotation: Any, metadata: list[Any]) -> Iterator[Any]:
    """Everything that an annotation is made of, and what is declared beside it."""
    yield from metadata
    yield annotation
    yield from getattr(annotation, "__metadata__", ())
    for inner in typing.get_args(annotation):
        yield from _parts(inner, [])


def _flow(text: str) -> str:
    return " ".join(text.split())
