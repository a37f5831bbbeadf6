"""Runs a study: every case that its folder does not hold yet is answered, kept, and at the end laid out.

Each kind of study is one file with a `KIND`: what it asks in which order (`conduct`), and how its outcomes are laid out
(`assemble`), finished or not.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import TypeAlias

import xarray as xr

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.store import save
from petalfoil.studies import study_store as folders
from petalfoil.studies.case_engine import Engine, ProcessorTime, engine
from petalfoil.studies.plan import Point
from petalfoil.studies.question import ERROR, CaseOutcome, CaseTask, Question
from petalfoil.studies.study_dataset import write_table
from petalfoil.studies.study_definition import FILE, NEIGHBOURS, Study
from petalfoil.studies.study_store import Store

Progress: TypeAlias = Callable[[float, str], None]

KINDS = ("sweep", "tolerance", "sobol", "optimize")
"""Kinds of study, each in the file of its name."""


@dataclass(frozen=True)
class Execution:
    """How a study is run; nothing of it but `neighbours` changes a bit of an answer.

    Attributes
    ----------
    workers : int or None
        Worker processes; by default one for each processor, 0 for the own process alone.
    scheduler : str
        Address of a scheduler that runs already.
    memory : float or None
        Memory of each worker [byte].
    fields : bool
        Whether all labelled data of each case are written too.
    anew : bool
        Whether another study in the folder is replaced.
    neighbours : bool
        Whether cases begin at the nearest solution that their worker has, where that is quicker. Answers then agree to
        1e-9 with those of cases by themselves. It becomes part of the study, which goes on the same way.
    progress : callable or None
        Called with the part done (0 to 1) and a text.
    """

    workers: int | None = None
    scheduler: str = ""
    memory: float | None = None
    fields: bool = False
    anew: bool = False
    neighbours: bool = False
    progress: Progress | None = None


@dataclass(frozen=True)
class Kind:
    """A kind of study.

    Attributes
    ----------
    conduct : callable
        Asks its cases through a runner.
    assemble : callable
        Lays out what a store holds.
    finish : callable or None
        Writes into the folder what this kind leaves beside data, table, figures and page.
    """

    conduct: Callable[[Study, Runner], None]
    assemble: Callable[[Study, Store], xr.Dataset]
    finish: Callable[[Path, Study, xr.Dataset], None] | None = None


@dataclass
class Runner:
    """Answers cases of one study, each once.

    Attributes
    ----------
    study : Study
        What is asked.
    store : Store
        Where outcomes are kept.
    engine : Engine
        What answers cases.
    execution : Execution
        How it is run.
    """

    study: Study
    store: Store
    engine: Engine
    execution: Execution = field(default_factory=Execution)

    def __post_init__(self) -> None:
        self.base = self.study.case.to_toml()

    def answer(self, points: Sequence[Point]) -> None:
        """Answer those points that the store does not hold, and keep each outcome as soon as it is there."""
        finished, total = self.store.keys(), len(points)
        done = total - sum(1 for _ in self._tasks(points, finished))
        pace, failed = _Pace(total, done), 0
        for outcome in self.engine.outcomes(self._tasks(points, finished)):
            self.store.add(outcome)
            failed += not outcome.converged
            pace.tell(self.execution.progress, failed)

    def outcomes(self, points: Sequence[Point]) -> list[CaseOutcome]:
        """Outcomes of points, answered where they are not yet."""
        return self.ask(points, self.study.question)

    def ask(self, points: Sequence[Point], question: Question) -> list[CaseOutcome]:
        """Outcomes of points under any question, answered where they are not yet; nothing is told of the progress."""
        keys = [question.key(self.base, point) for point in points]
        finished = {key for key in keys if self.store.get(key) is not None}
        for answered in self.engine.outcomes(self._tasks(points, finished, question)):
            self.store.add(answered)
        found = [self.store.get(key) for key in keys]
        return [outcome for outcome in found if outcome is not None]

    def _tasks(
        self, points: Sequence[Point], finished: set[str], question: Question | None = None
    ) -> Iterator[CaseTask]:
        """Tasks of the points that are not finished, each once."""
        met: set[str] = set()
        asked = question or self.study.question
        for point in points:
            key = asked.key(self.base, point)
            if key in finished or key in met:
                continue
            met.add(key)
            path = str(self.store.fields_of(key).resolve()) if self.execution.fields else ""
            yield CaseTask(key, self.base, point, asked, path, self.study.from_neighbours)


class _Pace:
    """How fast a study goes: cases a second and time left."""

    def __init__(self, total: int, done: int) -> None:
        self.total, self.done, self.new = total, done, 0
        self.begun = time.monotonic()

    def tell(self, progress: Progress | None, failed: int) -> None:
        """Report one more case."""
        self.done, self.new = self.done + 1, self.new + 1
        if progress is None:
            return
        rate = self.new / max(time.monotonic() - self.begun, 1e-9)
        left = (self.total - self.done) / rate
        text = f"{self.done} of {self.total} cases, {rate:.3g} a second, {_duration(left)} left"
        progress(self.done / self.total, text + (f", {failed} without an answer" if failed else ""))


def _duration(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {seconds} s" if minutes else f"{seconds} s"


def key_of(study: Study, base: str, point: Point) -> str:
    """Name of a case of a study in its store."""
    return study.question.key(base, point)


def kind_of(study: Study) -> Kind:
    """The kind of a study.

    Raises
    ------
    StoreError
        Its definition names none.
    """
    if study.kind not in KINDS:
        raise StoreError(f"this version knows no study of the kind {study.kind!r}; known: {', '.join(KINDS)}")
    kind: Kind = import_module(f"petalfoil.studies.{study.kind}").KIND
    return kind


def run(study: Study, out: str | Path | None = None, execution: Execution | None = None) -> xr.Dataset:
    """Run a study to its end, from what its folder holds already.

    Parameters
    ----------
    study : Study
        What is asked.
    out : str or Path, optional
        Folder of the study; without one nothing is kept but what is returned.
    execution : Execution, optional
        How it is run.

    Returns
    -------
    xarray.Dataset
        The study as labelled data.

    Raises
    ------
    UsageError
        The folder holds another study, or another process runs it; or there is no scheduler.
    StoreError
        The folder cannot be read or written.
    """
    return run_with_effort(study, out, execution)[0]


def run_with_effort(
    study: Study, out: str | Path | None = None, execution: Execution | None = None
) -> tuple[xr.Dataset, ProcessorTime]:
    """The same, and the processor time that it took in this run."""
    how = execution or Execution()
    if how.neighbours:
        study = replace(study, settings={**study.settings, NEIGHBOURS: True})
    with ExitStack() as stack:
        if how.scheduler:  # one that is not there leaves no folder
            answers = stack.enter_context(engine(None, how.scheduler, None))
        folder = stack.enter_context(_folder(out))
        store = stack.enter_context(folders.begun(folder, study, anew=how.anew))
        store.forget(ERROR)  # a mistake of the program may have been put right since
        if not how.scheduler:
            answers = stack.enter_context(engine(how.workers, "", how.memory))
        kind_of(study).conduct(study, Runner(study, store, answers, how))
        ds = kind_of(study).assemble(study, store)
        if out is not None:
            complete(folder, study, ds)
        return ds, answers.effort


def resume(folder: str | Path, execution: Execution | None = None) -> xr.Dataset:
    """Go on with the study in a folder, from its own definition.

    Raises
    ------
    StoreError
        The folder holds no study.
    UsageError
        Another version of petalfoil began it, or another process runs it.
    """
    study = Study.load(Path(folder))
    refuse_other_version(study)
    return run(study, folder, execution)


def refuse_other_version(study: Study) -> None:
    """Refuse to go on with the study of another version, whose answers may differ."""
    now = Study(kind=study.kind, case=study.case, question=study.question, vary={}).version
    if study.version != now:
        raise UsageError(
            f"petalfoil {study.version} began this study, this is {now}, which may answer otherwise: begin it anew "
            "with --anew, or go on with that version"
        )


def stored(folder: str | Path) -> xr.Dataset:
    """The study in a folder as labelled data, finished or not.

    Raises
    ------
    StoreError
        The folder holds no study.
    """
    path = Path(folder)
    study = Study.load(path)
    with folders.opened(path) as store:
        return kind_of(study).assemble(study, store)


def complete(folder: Path, study: Study, ds: xr.Dataset) -> None:
    """Write what a finished study leaves: data, table, figures, page, and what its kind adds."""
    from petalfoil.studies.study_page import write_page

    save(ds, folder / folders.DATA)
    write_table(folder / folders.TABLE, ds)
    write_page(folder, ds)
    if (finish := kind_of(study).finish) is not None:
        finish(folder, study, ds)


@contextmanager
def _folder(out: str | Path | None) -> Iterator[Path]:
    if out is not None:
        if Path(out).is_file():
            raise UsageError(f"{out} is a file; a study needs a folder, which holds {FILE} and its data")
        yield Path(out)
        return
    with tempfile.TemporaryDirectory(prefix="petalfoil-study-") as name:
        yield Path(name)
