"""What a session shows: a result with its case, designs that were tried, what is under way, and what of it changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

from petalfoil.studio.design import Design
from petalfoil.studio.protocol import FoundAnswer


class Aspect(Enum):
    """What of a session has changed."""

    DESIGN, PROBLEMS, STATE, STATUS, ANSWERS, TRIED, LOG = (auto() for _ in range(7))


@dataclass(frozen=True)
class ShownResult:
    """A result and the case that it belongs to.

    Attributes
    ----------
    found : FoundAnswer
        The result.
    toml : str
        The case as it was typed.
    arguments : mapping
        Arguments of the analysis.
    is_coarse : bool
        Whether it is a first answer on a coarse 2-D grid.
    """

    found: FoundAnswer
    toml: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    is_coarse: bool = False


@dataclass(frozen=True)
class Tried:
    """A design that was tried: what changed, and its main results."""

    number: int
    change: str
    design: Design
    scalars: Mapping[str, Any]
    grid: str


@dataclass
class Status:
    """What the session is doing.

    Attributes
    ----------
    words : str
        In words.
    part : float or None
        Part done (0 to 1); None where nothing runs.
    failure : str
        Why there is no answer; empty where there is one.
    """

    words: str = "starting"
    part: float | None = None
    failure: str = ""
