"""The case that a page edits: tables of texts as they were typed, from which a `Case` is made or refused."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from petalfoil.case import Case
from petalfoil.case import toml as case_toml
from petalfoil.errors import DefinitionError
from petalfoil.text import for_terminal

MOST_BYTES = 64 * 1024
"""Size of the largest case that a page reads; a case has some kilobytes."""

STARTING_CASE = """
title = "Eight petals"

[bearing]
journal_radius = "25 mm"
bushing_radius = "26 mm"
length = "50 mm"

[petals]
count = 8
arc_length = "45 mm"
thickness = "176 um"
bend_radius = "40 mm"
mount = "hinged"
youngs_modulus = "200 GPa"
poisson_ratio = 0.3

[gas]
viscosity = "18.5 uPa*s"
ambient_pressure = "1 bar"

[operation]
speed = "76400 rpm"
load = ["0 N", "-15 N"]

[model]
kind = "2d"
"""
"""What the page shows when no case is given: the paper's pack of eight petals under a load."""


class Design:
    """Tables of a case as they were typed; a change gives another design.

    Parameters
    ----------
    tables : mapping
        Values by section and key, as a TOML file holds them.
    """

    def __init__(self, tables: Mapping[str, Any]) -> None:
        self.tables: dict[str, Any] = copy.deepcopy(dict(tables))

    @classmethod
    def starting(cls) -> Self:
        """The design that is shown when no case is given."""
        return cls.from_toml(STARTING_CASE)

    @classmethod
    def from_file(cls, path: Path) -> Self:
        """Read the case that the command line names; a measured shape in a file of its own becomes rows.

        Raises
        ------
        DefinitionError
            It is no valid case.
        """
        return cls(Case.tables_of_file(path))

    @classmethod
    def from_toml(cls, text: str) -> Self:
        """Read an uploaded case, which need not be valid yet.

        Raises
        ------
        DefinitionError
            It is no TOML text, too large, or names a file.
        """
        return cls(without_files(text))

    def get(self, path: str) -> Any:
        """The value at a dotted path; None where there is none."""
        section, dot, key = path.partition(".")
        value = self.tables.get(section)
        if not dot:
            return value
        return value.get(key) if isinstance(value, dict) else None

    def with_value(self, path: str, value: Any) -> Design:
        """The design with another value at a dotted path; None takes it away."""
        changed = Design(self.tables)
        section, dot, key = path.partition(".")
        table = changed.tables.setdefault(section, {}) if dot else changed.tables
        if not isinstance(table, dict):
            table = changed.tables[section] = {}
        name = key if dot else section
        if value is None:
            table.pop(name, None)
        else:
            table[name] = value
        return changed

    def changes_from(self, before: Design) -> str:
        """What is different from another design, in words."""
        paths = {
            f"{name}.{key}" for one in (self, before) for name, table in one.tables.items() for key in _keys(table)
        }
        plain = {name for one in (self, before) for name, table in one.tables.items() if not isinstance(table, dict)}
        changed = [path for path in sorted(paths | plain) if before.get(path) != self.get(path)]
        return (
            "; ".join(f"{path} {_word(before.get(path))} → {_word(self.get(path))}" for path in changed) or "the same"
        )

    def case(self) -> Case:
        """The case.

        Raises
        ------
        DefinitionError
            It is refused; the error tells all problems by key.
        """
        refuse_files(self.tables)
        return Case(**self.tables)

    def to_toml(self) -> str:
        """A TOML text, values as they were typed."""
        return case_toml.write(self.tables)

    def python(self, verb: str, arguments: Mapping[str, Any]) -> str:
        """The Python lines that ask the same question."""
        given = "".join(f", {name}={value!r}" for name, value in arguments.items())
        text = self.to_toml().replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
        return (
            "import petalfoil\n\n"
            f'case = petalfoil.Case.from_toml("""\n{text}""")\n'
            f"result = petalfoil.{verb}(case{given})\n"
            "print(result)\n"
        )


def _keys(table: object) -> list[str]:
    return list(table) if isinstance(table, dict) else []


def _word(value: object) -> str:
    """A value in the words of a change."""
    if isinstance(value, list):
        return ", ".join(map(str, value)) if len(value) == 2 else f"{len(value)} rows"
    return "none" if value is None else str(value)


def without_files(text: str) -> dict[str, Any]:
    """The tables of a TOML text that comes from a browser.

    Raises
    ------
    DefinitionError
        It is too large, no TOML text, or names a file.
    """
    size = len(text.encode("utf-8", errors="replace"))
    if size > MOST_BYTES:
        raise DefinitionError(f"has {size:,} bytes; a case on this page has up to {MOST_BYTES:,}")
    tables = case_toml.parse(text)
    refuse_files(tables)
    return tables


def refuse_files(tables: Mapping[str, Any]) -> None:
    """Refuse tables that name a file: nothing that a browser sends reaches the file system.

    Raises
    ------
    DefinitionError
        The measured free shape is the name of a file.
    """
    petals = tables.get("petals")
    shape = petals.get("free_shape") if isinstance(petals, Mapping) else None
    if isinstance(shape, str):
        allowed = "rows [angle, radius]"
        raise DefinitionError(
            f"petals.free_shape: {for_terminal(shape)!r} names a file, and the page reads no files of the server; "
            f"allowed here: {allowed}",
            key="petals.free_shape",
            given=shape,
            allowed=allowed,
        )
