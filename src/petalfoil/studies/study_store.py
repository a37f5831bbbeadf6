"""The folder of a study: its definition, an index of finished cases, and at the end data, table, figures and page.

::

    study.toml     what was asked: enough to go on
    index.sqlite   one row for each finished case, written as soon as its answer is there
    fields/        all labelled data of each case, where they were asked for
    study.nc       the whole study as labelled data, once it is complete

Only the process that runs the study writes. It holds a lock that the system releases with the process, however it ends.
A row is there whole or not at all; the key of a case is a hash of everything that its answer depends on.
"""

from __future__ import annotations

import fcntl
import os
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from petalfoil.errors import StoreError, UsageError
from petalfoil.studies.question import CaseOutcome
from petalfoil.studies.study_definition import FILE, Study, no_study

INDEX, FIELDS, LOCK = "index.sqlite", "fields", ".lock"
DATA, TABLE, FIGURES, PAGE = "study.nc", "table.csv", "figures", "index.html"
OURS = (
    FILE,
    INDEX,
    f"{INDEX}-wal",
    f"{INDEX}-shm",
    FIELDS,
    LOCK,
    DATA,
    TABLE,
    FIGURES,
    PAGE,
    "designs",
    "optuna.log",
    "optuna.log.lock",
)
"""What a study may leave in its folder."""

_SCHEMA = """CREATE TABLE IF NOT EXISTS cases (
    number INTEGER PRIMARY KEY AUTOINCREMENT, key TEXT UNIQUE NOT NULL, status TEXT NOT NULL, outcome TEXT NOT NULL
)"""


class Store:
    """The folder of a study.

    Parameters
    ----------
    folder : Path
        Where it is.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._index = self._opened()

    def _opened(self) -> sqlite3.Connection:
        try:
            # A kill loses no row of a write-ahead log, and nobody waits for the disk at every row.
            index = sqlite3.connect(self.folder / INDEX, isolation_level=None)
            index.execute("PRAGMA journal_mode=WAL")
            index.execute("PRAGMA synchronous=NORMAL")
            index.execute(_SCHEMA)
        except sqlite3.Error as error:
            raise StoreError(f"{self.folder / INDEX} cannot be read: {error}") from error
        return index

    def add(self, outcome: CaseOutcome) -> None:
        """Keep an outcome; one that is there already stays."""
        row = (outcome.key, outcome.status, outcome.to_json())
        try:
            self._index.execute("INSERT OR IGNORE INTO cases (key, status, outcome) VALUES (?, ?, ?)", row)
        except sqlite3.Error as error:
            raise StoreError(f"{self.folder / INDEX} cannot be written: {error}") from error

    def keys(self) -> set[str]:
        """Keys of the finished cases."""
        return {key for (key,) in self._index.execute("SELECT key FROM cases")}

    def get(self, key: str) -> CaseOutcome | None:
        """Outcome of a case; None where it is not finished."""
        found = self._index.execute("SELECT outcome FROM cases WHERE key = ?", (key,)).fetchone()
        return None if found is None else CaseOutcome.from_json(found[0])

    def outcomes(self) -> Iterator[CaseOutcome]:
        """All outcomes in the order in which they came."""
        for (text,) in self._index.execute("SELECT outcome FROM cases ORDER BY number"):
            yield CaseOutcome.from_json(text)

    def forget(self, status: str) -> int:
        """Remove the cases of a status, so that they are asked again; how many there were."""
        return self._index.execute("DELETE FROM cases WHERE status = ?", (status,)).rowcount

    def counts(self) -> dict[str, int]:
        """Number of cases by status."""
        return dict(self._index.execute("SELECT status, COUNT(*) FROM cases GROUP BY status ORDER BY status"))

    def fields_of(self, key: str) -> Path:
        """File for the fields of a case."""
        return self.folder / FIELDS / f"{key[:16]}.nc"

    def close(self) -> None:
        """Close the index."""
        self._index.close()


@contextmanager
def begun(folder: Path, study: Study, *, anew: bool = False) -> Iterator[Store]:
    """Open the folder of a study to run it: made if it is not there, gone on with if it holds the same study.

    Parameters
    ----------
    folder : Path
        The folder.
    study : Study
        What is asked.
    anew : bool
        Whether another study in the folder is replaced.

    Raises
    ------
    UsageError
        The folder holds something else, or another process runs the study.
    StoreError
        The folder cannot be read or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(f"{folder} cannot be made: {error.strerror}") from error
    try:
        with locked(folder):
            _made_ready(folder, study, anew=anew)
            with opened(folder) as store:
                yield store
    except PermissionError as error:
        raise StoreError(f"{folder} cannot be written: {error.strerror}") from error


@contextmanager
def opened(folder: Path) -> Iterator[Store]:
    """Open the folder of a study."""
    if not (folder / FILE).is_file():
        raise StoreError(no_study(folder))
    store = Store(folder)
    try:
        yield store
    finally:
        store.close()


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold the lock of a folder.

    Raises
    ------
    UsageError
        Another process holds it, or the path is a file.
    """
    try:
        handle = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
    except NotADirectoryError:
        raise UsageError(f"{folder} is a file; a study needs a folder") from None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError:
        raise UsageError(f"the study in {folder} is being run by another process: wait for it, or stop it") from None
    finally:
        os.close(handle)


def _made_ready(folder: Path, study: Study, *, anew: bool) -> None:
    _refuse_strangers(folder)
    if (folder / FILE).is_file():
        different = study.differences(Study.load(folder))
        if different and not anew:
            raise UsageError(
                f"{folder} holds another study (not the same: {', '.join(different)}): give another folder, or "
                "--anew to replace it"
            )
        if different or anew:
            _emptied(folder)
    _swept(folder)
    (folder / FIELDS).mkdir(exist_ok=True)
    study.save(folder)


def _refuse_strangers(folder: Path) -> None:
    """Refuse a folder with files of others: a study is removed as a whole when it begins anew."""
    others = [path.name for path in folder.iterdir() if path.name not in OURS and not path.name.endswith(".part")]
    if others and not (folder / FILE).is_file():
        raise UsageError(f"{folder} holds other files ({shown_names(others)}): a study needs a folder of its own")


def shown_names(names: list[str]) -> str:
    """A few names in words."""
    return ", ".join(sorted(names)[:3]) + (" …" if len(names) > 3 else "")


def _emptied(folder: Path) -> None:
    """Remove what a study left, and nothing else."""
    for name in OURS:
        path = folder / name
        if name == LOCK:
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)


def _swept(folder: Path) -> None:
    """Remove temporary files that a killed process left: nobody else writes while the lock is held."""
    for path in [*folder.glob(".*.part"), *(folder / FIELDS).glob(".*.part"), *(folder / FIGURES).glob(".*.part")]:
        path.unlink(missing_ok=True)
