"""What a study asks of every case: an analysis and its arguments; and its answer for one case.

`answered` runs on a worker. Whatever becomes of a case is data: its results, or the reason why there are none.
"""

from __future__ import annotations

import hashlib
import json
import time
import traceback
from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeAlias

from petalfoil.analysis.arguments import StoredResult
from petalfoil.analysis.declaration import Analysis
from petalfoil.analysis.known_verbs import find, summaries
from petalfoil.analysis.neighbours import Memory, beside
from petalfoil.case import Case, with_values
from petalfoil.case.hints import nearest
from petalfoil.errors import ConvergenceError, PetalfoilError, UsageError
from petalfoil.results.record import Record, Scalar
from petalfoil.units.reading import shown

Values: TypeAlias = Mapping[str, float | int]
"""Values of the parameters by path, SI."""

CONVERGED = "converged"
NOT_CONVERGED = "not converged"
INVALID = "invalid case"
ERROR = "internal error"
DIED = "worker died"

OVERRIDES = {name: f"operation.{name}" for name in ("speed", "load", "moment", "tilt", "eccentricity")} | {
    "loads": "operation.load",
    "eccentricities": "operation.eccentricity",
}
"""Arguments of analyses that stand in for parameters of the case."""

TIMES = ("wall_time",)
"""Results that differ from run to run; the index keeps the processor time of each case."""


@dataclass(frozen=True)
class Question:
    """An analysis and its arguments.

    Attributes
    ----------
    verb : str
        Name of the analysis.
    arguments : dict
        Its arguments in SI numbers, as JSON has them.
    """

    verb: str
    arguments: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def read(cls, verb: str, given: Mapping[str, Any], known_as: Mapping[str, str] | None = None) -> Question:
        """Check what is asked before anything runs.

        Raises
        ------
        UsageError
            There is no such analysis, or an argument is unknown, or cannot be asked in a study.
        UnitError
            An argument measures something else.
        """
        analysis = analysis_of(verb)
        for name in given:
            if name not in analysis.arguments:
                known = ", ".join(analysis.arguments) or "none"
                raise UsageError(f"{verb} has no argument {name!r}; known: {known}.{nearest(name, known.split(', '))}")
        stored = [name for name, kind in analysis.arguments.items() if isinstance(kind, StoredResult)]
        if asked := [name for name in stored if given.get(name) is not None]:
            raise UsageError(f"{asked[0]} is the result of one case: a study cannot ask {verb} with it")
        values = {name: value for name, value in analysis.read(given, known_as).items() if value is not False}
        return cls(verb, json.loads(json.dumps(values)))

    def key(self, base: str, values: Values) -> str:
        """Name of a case under this question: a hash of the base case, of its values, and of what is asked."""
        content = [base, sorted((path, repr(value)) for path, value in values.items()), self.verb, self.arguments]
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    def refuse_overridden(self, paths: list[str]) -> None:
        """Refuse to vary what an argument fixes for all cases.

        Raises
        ------
        UsageError
            An argument stands in for a parameter that varies.
        """
        for name, field_path in OVERRIDES.items():
            for path in paths:
                if name in self.arguments and path.startswith(field_path):
                    raise UsageError(
                        f"{path} varies, but {name} of {self.verb} stands in for it: leave one of them out"
                    )


@dataclass(frozen=True)
class CaseTask:
    """One case to be answered.

    Attributes
    ----------
    key : str
        Its name in the store.
    base : str
        The base case as TOML.
    values : mapping
        What differs in it, by path, SI.
    question : Question
        What is asked of it.
    fields : str
        File for its fields; empty where only scalars are wanted.
    neighbours : bool
        Whether it may begin at the solution of a similar case that this process has answered.
    """

    key: str
    base: str
    values: Values
    question: Question
    fields: str = ""
    neighbours: bool = False


@dataclass(frozen=True)
class CaseOutcome:
    """What became of one case.

    Attributes
    ----------
    key : str
        Its name in the store.
    values : dict
        What differs from the base case, by path, SI.
    status : str
        `CONVERGED`, `NOT_CONVERGED`, `INVALID`, `ERROR` or `DIED`.
    reason : str
        Why there is no answer, or what is to be said of it.
    records : list of dict
        Scalars of its points by name, SI; empty where the case could not be asked.
    seconds : float
        Processor time that it took [s].
    trace : str
        Where an internal error happened.
    """

    key: str
    values: dict[str, float | int]
    status: str
    reason: str = ""
    records: list[dict[str, Scalar]] = field(default_factory=list)
    seconds: float = 0.0
    trace: str = ""

    @property
    def converged(self) -> bool:
        """Whether every point of the case converged."""
        return self.status == CONVERGED

    def to_json(self) -> str:
        """All of it, from which `from_json` makes an equal one."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> CaseOutcome:
        """Read `to_json` back."""
        return cls(**json.loads(text))


def analysis_of(verb: str) -> Analysis:
    """The analysis of a name.

    Raises
    ------
    UsageError
        There is none; the message has the nearest name.
    """
    analysis = find(verb)
    if analysis is None:
        known = list(summaries())
        raise UsageError(f"{shown(verb)} is no analysis; known: {', '.join(known)}.{nearest(verb, known)}")
    return analysis


def answered(task: CaseTask) -> CaseOutcome:
    """Answer one case: build it, ask, and put what comes of it into an outcome."""
    begun = time.thread_time()
    values = dict(task.values)
    status, reason, trace = ERROR, "", ""
    records: list[dict[str, Scalar]] = []
    try:
        records, status, reason = _asked(task)
    except ConvergenceError as error:
        status, reason = NOT_CONVERGED, str(error)
    except PetalfoilError as error:
        status, reason = INVALID, str(error)
    except Exception as error:  # a mistake of the program in one case is reported with that case
        status, reason, trace = ERROR, f"{type(error).__name__}: {error}", traceback.format_exc()
    return CaseOutcome(task.key, values, status, reason, records, time.thread_time() - begun, trace)


def _asked(task: CaseTask) -> tuple[list[dict[str, Scalar]], str, str]:
    """Scalars of all points, status and reason."""
    under_load = any(name in task.question.arguments for name in ("load", "loads"))
    case = with_values(_base(task.base, centred=under_load), task.values)
    analysis = analysis_of(task.question.verb)
    with _beside_others(task):
        run = analysis.start(case, analysis.read(task.question.arguments))
        for _ in analysis.advance(run):
            pass
    records = run.records()
    if task.fields:
        _write(analysis, run, Path(task.fields))
    failed = [record for record in records if not record.converged]
    scalars = [_scalars(record) for record in records]
    if failed:
        return scalars, NOT_CONVERGED, _words(failed[0])
    return scalars, CONVERGED, _words(records[-1]) if records else ""


def _beside_others(task: CaseTask) -> AbstractContextManager[None]:
    """The solutions of other cases of the study at hand, where the task may use them."""
    if not task.neighbours:
        return nullcontext()
    asked = json.dumps([task.question.verb, task.question.arguments], sort_keys=True)
    return beside(_memory(task.base, asked), task.values)


@lru_cache(maxsize=2)  # a search asks for results and for their derivatives
def _memory(base: str, asked: str) -> Memory:
    return Memory()


def _scalars(record: Record) -> dict[str, Scalar]:
    """Results that are the same whenever the case is asked again."""
    told = record.reported()
    return {name: value for name, value in told.items() if name not in (*TIMES, "status", "converged")}


def _words(record: Record) -> str:
    """What the record says of itself beyond having converged."""
    status = str(record.scalars.get("status", ""))
    return status.removeprefix("converged").removeprefix("not converged").lstrip(":; ")


def _write(analysis: Analysis, run: Any, path: Path) -> None:
    """Write all labelled data of a case, in this thread alone."""
    from petalfoil.results.store import save

    try:
        from dask import config
    except ImportError:
        save(analysis.answer(run).to_dataset(), path)
        return
    with config.set(scheduler="synchronous"):  # else a lock is asked of the whole cluster for every file
        save(analysis.answer(run).to_dataset(), path)


@lru_cache(maxsize=4)  # a worker has one study at a time
def _base(text: str, *, centred: bool) -> Case:
    """The base case; `centred` where a load finds the position, so that a design need not fit at that of the case."""
    case = Case.from_toml(text)
    return case.replace(**{"operation.eccentricity": (0.0, 0.0)}) if centred else case
