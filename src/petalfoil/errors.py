"""Every error petalfoil raises on purpose, and what each carries.

::

    PetalfoilError(Exception)
     ├── DefinitionError      a bad case
     │    ├── UnitError       a wrong or unknown unit
     │    └── PackError       a foil pack that cannot be assembled: no overlap, no clearance, no free shape
     ├── UsageError           a bad argument of an analysis, a bad value on the command line
     ├── ConvergenceError     no converged answer
     └── StoreError           a result file that cannot be read or written

The command line leaves with status 2 for definition, usage and store errors and with 3 for a run without a converged
answer (`exit_code`); it never shows a traceback for any of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

History = Sequence[Mapping[str, float | int | str]]


class PetalfoilError(Exception):
    """Root of all errors of this package; the message is one a user can act on."""

    exit_code: ClassVar[int] = 2


class DefinitionError(PetalfoilError):
    """A case that cannot be: unknown or missing key, wrong type, value outside its range.

    Parameters
    ----------
    message : str
        Text that names every problem found.
    key : str, optional
        Dotted path of the first problem, such as ``"petals.count"``; empty where there is none.
    given : object, optional
        What was found there.
    allowed : str, optional
        What is allowed there.
    problems : sequence of (str, str), optional
        Dotted path and text of every problem found; by default the only one is that of `key`.
    """

    def __init__(
        self,
        message: str,
        *,
        key: str = "",
        given: object = None,
        allowed: str = "",
        problems: Sequence[tuple[str, str]] = (),
    ) -> None:
        super().__init__(message)
        self.key = key
        self.given = given
        self.allowed = allowed
        self.problems = tuple(problems) or ((key, message.removeprefix(f"{key}: ")),)


class UnitError(DefinitionError):
    """A quantity whose text cannot be read, or whose unit measures something else."""


class PackError(DefinitionError):
    """A foil pack that cannot be assembled; the message says by how much."""


class UsageError(PetalfoilError):
    """A bad argument of an analysis, or a bad value on the command line."""


class ConvergenceError(PetalfoilError):
    """No converged answer.

    Parameters
    ----------
    message : str
        What did not converge, and how far it came.
    history : sequence of mappings, optional
        One mapping per iteration.
    advice : str, optional
        What to try next.
    """

    exit_code: ClassVar[int] = 3

    def __init__(self, message: str, *, history: History = (), advice: str = "") -> None:
        super().__init__(message)
        self.history = [dict(step) for step in history]
        self.advice = advice


class StoreError(PetalfoilError):
    """A result file that is absent, unreadable, not one of ours, or cannot be written."""
