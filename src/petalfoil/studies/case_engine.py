"""Where the cases of a study are answered: in this process, or on the workers of a `dask` cluster.

Both engines take tasks one by one, as many as keep the workers busy, and give outcomes as they come. A worker that dies
loses nothing: its task goes to another one, and after `ATTEMPTS` deaths the case itself is held to be the reason.
"""

from __future__ import annotations

import gc
import os
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, ExitStack, contextmanager
from dataclasses import dataclass, field
from importlib import metadata
from itertools import islice
from typing import Any, Protocol

import psutil

from petalfoil import __version__
from petalfoil.errors import UsageError
from petalfoil.studies.question import DIED, CaseOutcome, CaseTask, analysis_of, answered

AHEAD = 3
"""Tasks for each worker that wait on the cluster: the next one is there when a worker has finished, and no more of the
study than that is in memory."""
ATTEMPTS = 3
"""Workers that may die of one case before it counts as failed."""
PATIENCE = 10.0
"""Time to find a scheduler [s]."""
START = 120.0
"""Time that workers on this machine have to begin [s]: each loads the package, on a machine that may be busy."""
LOOK = "1s"
"""How often processes look after themselves: what they do then is overhead."""
MESSAGES = 100
"""Messages that each process remembers for whoever looks for a mistake; they hold tasks and outcomes."""
RETIRE_AT = 0.95
"""Part of its memory at which a worker is ended and begun anew, as `distributed` has it by default."""
NOT_STARTED = (OSError, ValueError, RuntimeError, TimeoutError, AssertionError)
"""What `distributed` raises where it does not start: addresses, ports, processes; and where its event loop is not there
within its ten seconds, an assertion."""
EXTRA = "studies on several workers need the package dask: pip install 'petalfoil[studies]', or use --workers 0"


@dataclass
class ProcessorTime:
    """Processor time that a study took [s].

    Attributes
    ----------
    solver : float
        Of the cases themselves.
    workers : float
        Of the worker processes altogether, from when they were ready.
    driver : float
        Of this process beside the cases.
    """

    solver: float = 0.0
    workers: float = 0.0
    driver: float = 0.0


class Engine(Protocol):
    """What answers cases."""

    effort: ProcessorTime

    def outcomes(self, tasks: Iterable[CaseTask]) -> Iterator[CaseOutcome]:
        """Answer tasks; outcomes come in any order."""


@dataclass
class InThisProcess:
    """One case after another, in this process."""

    effort: ProcessorTime = field(default_factory=ProcessorTime)

    def outcomes(self, tasks: Iterable[CaseTask]) -> Iterator[CaseOutcome]:
        """Answer tasks in order."""
        for task in tasks:
            begun = time.process_time()
            outcome = answered(task)
            self.effort.workers += time.process_time() - begun
            self.effort.solver += outcome.seconds
            yield outcome


@dataclass
class OnCluster:
    """On the workers of a cluster.

    Attributes
    ----------
    client : distributed.Client
        The connection.
    workers : int
        Number of worker threads at the start.
    """

    client: Any
    workers: int
    effort: ProcessorTime = field(default_factory=ProcessorTime)

    def outcomes(self, tasks: Iterable[CaseTask]) -> Iterator[CaseOutcome]:
        """Answer tasks; outcomes come as they are ready.

        Raises
        ------
        UsageError
            The scheduler is gone.
        """
        try:
            yield from self._answered(iter(tasks))
        except (OSError, TimeoutError, CancelledError) as error:
            raise UsageError(
                f"the connection to the workers was lost: {told(error)}. Cases that are answered are kept in the "
                "folder of the study, which goes on with `petalfoil study resume`"
            ) from error

    def _answered(self, waiting: Iterator[CaseTask]) -> Iterator[CaseOutcome]:
        from distributed import as_completed

        running: dict[str, CaseTask] = {}
        first = list(islice(waiting, AHEAD * self.workers))
        for verb in {task.question.verb for task in first}:
            self.client.run(_load, verb)
        completed = as_completed(loop=self.client.loop)
        before, own = self._times(), time.process_time()
        for task in first:
            running[name_of(task)] = task
            completed.add(self._submit(task))
        while running:
            future = next(completed)
            outcome = _outcome(future, running.pop(future.key))
            future.release()
            for task in islice(waiting, 1):
                running[name_of(task)] = task
                completed.add(self._submit(task))
            self.effort.solver += outcome.seconds
            yield outcome
        self.effort.driver += time.process_time() - own
        self.effort.workers += sum(now - before.get(pid, 0.0) for pid, now in self._times().items())

    def _submit(self, task: CaseTask) -> Any:
        return self.client.submit(answered, task, key=name_of(task), pure=False)

    def _times(self) -> dict[tuple[str, int], float]:
        """Processor time of each worker process so far [s]."""
        return {(name, pid): spent for name, (pid, spent) in self.client.run(_process_time).items()}


def name_of(task: CaseTask) -> str:
    """Name of a task on the cluster, which keeps a record for good of each first part of a name that it meets."""
    return f"case-{task.key}"


def _load(verb: str) -> None:
    """Import an analysis, so that the first case does not wait for it."""
    analysis_of(verb)


def told(error: BaseException) -> str:
    """A failure of `distributed` in words."""
    if isinstance(error, AssertionError):
        return "its event loop did not start in time, because this machine is busy; try again"
    return str(error).partition("\n")[0].rstrip(".") or type(error).__name__


def _process_time() -> tuple[int, float]:
    used = psutil.Process().cpu_times()
    return os.getpid(), used.user + used.system


def _outcome(future: Any, task: CaseTask) -> CaseOutcome:
    from distributed import KilledWorker

    error = future.exception()
    if error is None:
        outcome: CaseOutcome = future.result()
        return outcome
    if isinstance(error, KilledWorker):
        reason = f"{ATTEMPTS + 1} workers died while they answered it: too little memory for its grid?"
        return CaseOutcome(task.key, dict(task.values), DIED, reason)
    raise error


def engine(
    workers: int | None = None, scheduler: str = "", memory: float | None = None
) -> AbstractContextManager[Engine]:
    """The engine that answers a study.

    Parameters
    ----------
    workers : int, optional
        Worker processes of a cluster on this machine, by default one for each processor; 0 for this process alone.
    scheduler : str
        Address of a scheduler that runs already, such as ``"tcp://10.0.0.1:8786"``.
    memory : float, optional
        Memory of each worker [byte], by default an equal part of the machine's.

    Raises
    ------
    UsageError
        The package `dask` is not installed, or there is no scheduler.
    """
    if workers == 0 and not scheduler:
        return _alone()
    try:
        import distributed  # noqa: F401
    except ImportError:
        raise UsageError(EXTRA) from None
    if scheduler:
        return _remote(scheduler)
    return _local(workers or len(os.sched_getaffinity(0)), memory)


@contextmanager
def _alone() -> Iterator[Engine]:
    yield InThisProcess()


@contextmanager
def _local(workers: int, memory: float | None) -> Iterator[Engine]:
    """A cluster on this machine: one thread a worker, reachable from this machine alone and with a certificate."""
    import dask
    from distributed import Client, LocalCluster

    settings = {
        "distributed.worker.profile.enabled": False,  # a look at every thread each 10 ms
        "distributed.scheduler.allowed-failures": ATTEMPTS,
        "distributed.worker.memory.terminate": RETIRE_AT,
        "distributed.admin.system-monitor.interval": LOOK,
        "distributed.scheduler.http.routes": [],  # nothing is served but the work
        "distributed.worker.http.routes": [],
        "distributed.admin.low-level-log-length": MESSAGES,
        "distributed.admin.tick.interval": LOOK,  # 50 times a second by default, in every process
        "distributed.worker.memory.monitor-interval": LOOK,
    }
    with dask.config.set(settings), ExitStack() as stack:
        try:
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                host="127.0.0.1",
                protocol="tls",
                security=True,
                dashboard_address="127.0.0.1:0",
                memory_limit="auto" if memory is None else int(memory),
                silence_logs=50,
            )
            client = stack.enter_context(Client(stack.enter_context(cluster), set_as_default=False))
            client.wait_for_workers(workers, timeout=START)
        except NOT_STARTED as error:
            raise UsageError(
                f"{workers} workers did not start on this machine: {told(error)}. Ask fewer of them with --workers, or "
                "--workers 0 for this process alone; cases that are answered are kept"
            ) from error
        yield OnCluster(client, workers)


@contextmanager
def _remote(address: str) -> Iterator[Engine]:
    from distributed import Client

    refused = ""
    try:
        # As default it would stay what every file is written through, even where there is no scheduler.
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except NOT_STARTED as error:
        refused = told(error)
    if refused:
        gc.collect()  # it closes its event loop as it is collected: within the start of another one they would lock
        raise UsageError(f"--scheduler: there is no scheduler at {address}: {refused}")
    with client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise UsageError(f"--scheduler: {address} has no workers: start some with 'dask worker {address}'")
        _refuse_others(client, address)
        yield OnCluster(client, threads)


def _refuse_others(client: Any, address: str) -> None:
    """Refuse workers without this package, or with another version of it."""
    try:
        found = set(client.run(metadata.version, "petalfoil").values())
    except metadata.PackageNotFoundError:
        found = {"none"}
    if found != {__version__}:
        raise UsageError(
            f"--scheduler: the workers of {address} have petalfoil {', '.join(sorted(found))}, this is {__version__}: "
            "install the same version on all of them"
        )
