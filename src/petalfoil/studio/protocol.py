"""What the server and its workers say to each other: tasks one way, reports the other, as frames on pipes.

Both ends are processes of this program, started by the server on the same machine with pipes that no one else has.
What comes from a browser reaches a worker as texts and numbers inside a `WorkerTask` and never as a pickle of its own.
"""

from __future__ import annotations

import pickle
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:  # the server starts its first worker before it loads these
    from petalfoil.results.record import Record
    from petalfoil.results.tables import TextTable

HEADER = struct.Struct("!Q")
"""Length of a frame [bytes], in front of it."""


class Work(Enum):
    """What a task asks for."""

    ANSWER = "answer"
    """Run an analysis."""
    STUDY = "study"
    """Run an analysis over one or two parameters."""
    OPTIMUM = "optimum"
    """Find the best designs, or the front of several objectives."""
    NETCDF, PNG, SVG, REPORT = "nc", "png", "svg", "html"
    """Make a file of the records of an answer."""


@dataclass(frozen=True, kw_only=True)
class WorkerTask:
    """One piece of work.

    Attributes
    ----------
    number : int
        Number that reports refer to.
    work : Work
        What is asked for.
    verb : str
        Name of the analysis.
    case_toml : str
        The whole case.
    arguments : mapping
        Arguments of the analysis by name, as given: texts, or flags.
    coarse : bool
        Answer on a coarse 2-D grid instead of the case's.
    records : tuple of Record
        Records of the answer that a file is made of.
    vary : mapping
        Values of parameters by path, as typed.
    goals : mapping
        Of an optimum: what to maximize and to minimize, limits, and the budget of designs.
    """

    number: int
    work: Work
    verb: str
    case_toml: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    coarse: bool = False
    records: tuple[Record, ...] = ()
    vary: Mapping[str, str] = field(default_factory=dict)
    goals: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Cancel:
    """Stop the task of this number; nothing happens where it has ended already."""

    number: int


@dataclass(frozen=True)
class Ready:
    """The worker has loaded what it needs, and is idle."""


@dataclass(frozen=True)
class ProgressMessage:
    """How far a task is: the part done (0 to 1) and a text."""

    number: int
    part: float
    text: str


@dataclass(frozen=True)
class Cancelled:
    """A task was stopped."""

    number: int


@dataclass(frozen=True)
class Failure:
    """A task ended without an answer.

    Attributes
    ----------
    message, advice : str
        What went wrong, and what to try.
    problems : tuple of (str, str)
        Dotted path of a key, and what is wrong with it.
    is_fault : bool
        It is a mistake of the program, not of its user.
    """

    number: int
    message: str
    advice: str = ""
    problems: tuple[tuple[str, str], ...] = ()
    is_fault: bool = False


Arrays = dict[str, npt.NDArray[np.generic]]


@dataclass(frozen=True, kw_only=True)
class FoundAnswer:
    """What an analysis found, ready to be shown.

    Attributes
    ----------
    verb : str
        Name of the analysis.
    tables : tuple of TextTable
        Its tables.
    warnings, failures : tuple of str
        What is implausible; which points did not converge, and why.
    scalars : dict
        Results of the last record by name, SI; of a state that did not converge NaN.
    bars : dict
        Error bars of these, SI.
    arrays : dict
        Arrays that a browser draws: those of the last record, or of a series by name over its points.
    records : tuple of Record
        All records, for files; empty for a coarse answer.
    grid : str
        The grid in words.
    seconds : float
        Wall time that it took [s].
    is_series : bool
        Whether it consists of points in order.
    """

    verb: str
    tables: tuple[TextTable, ...]
    warnings: tuple[str, ...] = ()
    failures: tuple[str, ...] = ()
    scalars: Mapping[str, float | int | bool | str] = field(default_factory=dict)
    bars: Mapping[str, float] = field(default_factory=dict)
    arrays: Arrays = field(default_factory=dict)
    records: tuple[Record, ...] = ()
    grid: str = ""
    seconds: float = 0.0
    is_series: bool = False


@dataclass(frozen=True, kw_only=True)
class Mapped:
    """Results over one or two parameters.

    Attributes
    ----------
    parameters : mapping
        Values of each parameter by path, SI.
    units : mapping
        SI unit of each, by path.
    results : mapping
        Results by name over the parameters in order, SI; NaN where a case has no answer.
    missing : int
        Number of cases without an answer.
    seconds : float
        Wall time that it took [s].
    """

    parameters: Mapping[str, tuple[float, ...]]
    units: Mapping[str, str]
    results: Arrays
    missing: int
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Searched:
    """Designs that a search for the best one tried, in their order.

    Attributes
    ----------
    parameters : mapping
        Value of each parameter by path, one for each design, SI.
    units : mapping
        SI unit of each, by path.
    results : mapping
        Results by name, one for each design, SI; NaN where a design has no answer.
    objectives : tuple of str
        What was wanted, such as ``"maximize min_film_thickness"``.
    feasible, on_front : (design,) array of bool
        Which keep every limit; which no other beats in every objective.
    ended : str
        How the search ended.
    seconds : float
        Wall time that it took [s].
    """

    parameters: Mapping[str, tuple[float, ...]]
    units: Mapping[str, str]
    results: Arrays
    objectives: tuple[str, ...]
    feasible: npt.NDArray[np.bool_]
    on_front: npt.NDArray[np.bool_]
    ended: str
    seconds: float


@dataclass(frozen=True)
class Done:
    """A task is done: what was found, or the bytes of a file."""

    number: int
    result: FoundAnswer | Mapped | Searched | bytes


Message = WorkerTask | Cancel | Ready | ProgressMessage | Cancelled | Failure | Done


def frame(message: Message) -> bytes:
    """A message with its length in front."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    return HEADER.pack(len(body)) + body


def unframed(body: bytes) -> Message:
    """The message of a frame without its length."""
    message: Message = pickle.loads(body)
    return message


def read_frame(stream: BinaryIO) -> Message:
    """Wait for the next message.

    Raises
    ------
    EOFError
        The other end is gone.
    """
    (size,) = HEADER.unpack(_exactly(stream, HEADER.size))
    return unframed(_exactly(stream, size))


def _exactly(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise EOFError("the other end of the pipe is gone")
    return content
