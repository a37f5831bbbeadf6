"""Kinds of arguments that are words: one of several, or a list of names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from petalfoil.analysis.arguments import Argument
from petalfoil.case.hints import nearest
from petalfoil.errors import UsageError
from petalfoil.units.reading import shown


@dataclass(frozen=True, kw_only=True)
class Choice(Argument):
    """One of several words.

    Attributes
    ----------
    words : tuple of str
        The words.
    """

    words: tuple[str, ...]

    def read(self, given: object) -> str:
        """The word."""
        if not isinstance(given, str) or given not in self.words:
            hint = nearest(given, self.words)
            raise UsageError(f"{shown(given)} is not known; allowed: {', '.join(self.words)}.{hint}")
        return str(given)


@dataclass(frozen=True, kw_only=True)
class Names(Argument):
    """Names, as a list or as a text with commas between them."""

    def read(self, given: Any) -> list[str]:
        """The names in order."""
        entries = given.split(",") if isinstance(given, str) else given
        if not isinstance(entries, Sequence) or not all(isinstance(entry, str) for entry in entries):
            raise UsageError(
                f"{shown(given)} is no list of names; write them with commas between, or as a list of texts"
            )
        names = [entry.strip() for entry in entries]
        if not names or not all(names):
            raise UsageError(f"{shown(given)} names nothing between two commas: give at least one name")
        return names

    def text(self, value: Sequence[str]) -> str:
        """The names with commas between them."""
        return ", ".join(value)


def known(name: str, names: Sequence[str], what: str) -> str:
    """A name, if it is one of the `names`.

    Raises
    ------
    UsageError
        It is none; the message has the nearest known one.
    """
    if name in names:
        return name
    raise UsageError(f"{shown(name)} is no {what}; known: {', '.join(names)}.{nearest(name, names)}")
