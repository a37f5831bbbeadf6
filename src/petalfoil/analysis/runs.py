"""An analysis under way: what is computed step by step, and can be kept when it is stopped."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from petalfoil.results.layout import Layout
from petalfoil.results.record import Record

RecordSource: TypeAlias = Callable[[Sequence[Record]], Iterator[Record]]


class Run(Protocol):
    """An analysis that has begun.

    Attributes
    ----------
    is_series : bool
        Whether its records are points of a series rather than one answer.
    """

    is_series: bool

    def advance(self) -> Iterator[tuple[float, str]]:
        """Compute on; after each piece that can be kept, give the part done (0 to 1) and how far that is."""

    def records(self, ended: str = "") -> tuple[Record, ...]:
        """What is computed so far; `ended` says why it is not all, empty where it is."""

    def finished(self) -> str:
        """What is computed so far in words; empty where there is nothing to keep."""


@dataclass
class Single:
    """One answer, which is there at once."""

    record: Record
    is_series: bool = False

    def advance(self) -> Iterator[tuple[float, str]]:
        """Nothing is left to compute."""
        yield from ()

    def records(self, ended: str = "") -> tuple[Record, ...]:
        """The answer."""
        return (self.record,)

    def finished(self) -> str:
        """Nothing that could be kept of a part."""
        return ""


@dataclass
class Points:
    """Points, computed one after another.

    Attributes
    ----------
    source : callable or iterator of Record
        Given the points that are done, computes the next whenever it is asked for; an iterator begins at the first.
    count : int
        How many there will be.
    noun : str
        What they are called.
    least : int
        Number of converged points below which nothing is worth keeping; 0 keeps failed ones too.
    parts : sequence of float or None
        Part of the whole that is done after each point; by default all cost the same.
    asked : str
        What the series is asked for; empty where nothing can go on from it.
    layout : type of Layout or None
        Which of the layouts of its analysis it has; by default the first for a series.
    """

    source: Iterator[Record] | RecordSource
    count: int
    noun: str = "points"
    least: int = 0
    parts: Sequence[float] | None = None
    done: list[Record] = field(default_factory=list)
    asked: str = ""
    layout: type[Layout] | None = None
    is_series: bool = True

    def advance(self) -> Iterator[tuple[float, str]]:
        """Compute point after point, from those that are done on."""
        for record in self.source(tuple(self.done)) if callable(self.source) else self.source:
            self.done.append(record)
            number = len(self.done)
            part = number / self.count if self.parts is None else self.parts[number - 1]
            yield part, f"{number} of {self.count} {self.noun}"

    def records(self, ended: str = "") -> tuple[Record, ...]:
        """The finished points."""
        return tuple(self.done)

    def finished(self) -> str:
        """How many are finished."""
        enough = sum(record.converged for record in self.done) >= self.least
        return f"{len(self.done)} of {self.count} {self.noun} are finished" if self.done and enough else ""
