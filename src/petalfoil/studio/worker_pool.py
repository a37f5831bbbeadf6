"""Workers that stay warm, and one queue for all sessions.

A job waits until a worker is free. Short jobs go before long ones, and long ones leave one worker free for the short,
so that whoever drags a slider is answered while others wait for a 3-D run. A job that is cancelled ends its owner's
waiting at once; its worker is asked to stop, and is killed where it does not within `PATIENCE`.
"""

from __future__ import annotations

import asyncio
import itertools
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from petalfoil.studio.protocol import Cancelled, Done, Failure, ProgressMessage, Work, WorkerTask
from petalfoil.studio.worker_process import WorkerProcess

PATIENCE = 5.0
"""Processor time that a worker has to stop a cancelled task before it is killed [s]: a large factorisation takes some
seconds."""
MOST_WAITING = 8
"""Jobs that one session may have waiting: two of the sliders, a question, a file, and as many again."""
MOST_STARTS_IN_A_ROW = 3
"""Workers that may end before they were ready until no more are started."""
SPARE_AFTER = 4.0
"""Time after which the spare workers follow one that is ready [s]: before, the page that opens needs the cores."""
LARGE = 1.5e9
"""Memory of an idle worker above which it is replaced: what a large grid took is not always given back [bytes]."""

Outcome = Done | Failure | Cancelled


@dataclass(eq=False)
class Job:
    """A task on its way.

    Attributes
    ----------
    task : WorkerTask
        What is to be done.
    owner : str
        Session that asked.
    is_long : bool
        It may take long, and leaves one worker to others.
    outcome : Future
        What becomes of it.
    on_progress : callable or None
        Called with the part done and a text.
    """

    task: WorkerTask
    owner: str
    is_long: bool
    outcome: asyncio.Future[Outcome]
    on_progress: Callable[[float, str], None] | None = None
    worker: WorkerProcess | None = field(default=None, repr=False)


class WorkerPool:
    """The workers and their queue.

    Parameters
    ----------
    size : int
        Number of workers, at least 2: one is kept for short jobs.
    """

    def __init__(self, size: int = 2) -> None:
        self._size = max(size, 2)
        self._numbers = itertools.count(1)
        self._waiting: list[Job] = []
        self._workers: list[WorkerProcess] = []
        self._starting: set[asyncio.Task[None]] = set()
        self._failed_starts = 0
        self._is_open = False

    async def start(self) -> None:
        """Start a worker, which warms up while the caller goes on; the others follow when it is ready.

        All at once they would share the cores with the server that loads its page, and the first answer would wait.
        """
        self._is_open = True
        await self._add_worker()

    async def stop(self) -> None:
        """End all workers, and tell whoever waits."""
        self._is_open = False
        for job in self._waiting:
            job.outcome.set_result(Cancelled(job.task.number))
        self._waiting.clear()
        await asyncio.gather(*self._starting)
        await asyncio.gather(*(worker.end() for worker in list(self._workers)))

    @property
    def worker_pids(self) -> list[int]:
        """Numbers of the workers' processes."""
        return [worker.pid for worker in self._workers]

    def submit(
        self,
        owner: str,
        work: Work,
        *,
        is_long: bool = False,
        on_progress: Callable[[float, str], None] | None = None,
        **asked: Any,
    ) -> Job:
        """Queue a task.

        Parameters
        ----------
        owner : str
            Session that asks.
        work : Work
            What for.
        is_long : bool
            It may take long.
        on_progress : callable, optional
            Called with the part done and a text.
        **asked
            Further fields of the task.
        """
        task = WorkerTask(number=next(self._numbers), work=work, **asked)
        job = Job(task, owner, is_long, asyncio.get_running_loop().create_future(), on_progress)
        refusal = self._refusal(owner)
        if refusal:
            job.outcome.set_result(Failure(task.number, refusal))
            return job
        self._waiting.append(job)
        self._dispatch()
        return job

    def cancel(self, job: Job) -> None:
        """Give a job up: its owner waits no longer, and its worker stops as soon as it can."""
        if job.outcome.done():
            return
        job.outcome.set_result(Cancelled(job.task.number))
        if job in self._waiting:
            self._waiting.remove(job)
        elif job.worker is not None:
            job.worker.stop_task(PATIENCE)

    def leave(self, owner: str) -> None:
        """Give up all jobs of a session."""
        for job in self._jobs_of(owner):
            self.cancel(job)

    def ahead_of(self, job: Job) -> int:
        """How many jobs wait in front of one; 0 where it runs."""
        return self._waiting.index(job) if job in self._waiting else 0

    # ------------------------------------------------------------------------------------------ inside

    def _jobs_of(self, owner: str) -> list[Job]:
        running = [worker.job for worker in self._workers if worker.job is not None]
        return [job for job in (*self._waiting, *running) if job.owner == owner]

    def _refusal(self, owner: str) -> str:
        if not self._is_open:
            return "the studio is closing"
        if self._failed_starts >= MOST_STARTS_IN_A_ROW and not self._workers:
            return "no worker process starts; the log of the server tells why"
        if sum(job.owner == owner for job in self._waiting) >= MOST_WAITING:
            return f"{MOST_WAITING} requests of this page are waiting already: let them end, or cancel them"
        return ""

    def _dispatch(self) -> None:
        """Give each free worker the job that comes next."""
        for worker in self._workers:
            if worker.is_free and (job := self._next()) is not None:
                self._waiting.remove(job)
                job.worker = worker
                worker.give(job)

    def _next(self) -> Job | None:
        short = next((job for job in self._waiting if not job.is_long), None)
        if short is not None:
            return short
        running = sum(worker.job is not None and worker.job.is_long for worker in self._workers)
        return next(iter(self._waiting), None) if running < self._size - 1 else None

    def _grow(self) -> None:
        """Start the workers that are missing."""
        missing = self._size - len(self._workers) - len(self._starting) if self._is_open else 0
        for _ in range(missing):
            task = asyncio.get_running_loop().create_task(self._add_worker())
            self._starting.add(task)
            task.add_done_callback(self._started)

    def _started(self, task: asyncio.Task[None]) -> None:
        self._starting.discard(task)
        if not task.cancelled():
            task.result()  # a start that failed is told by the loop

    async def _add_worker(self) -> None:
        worker = await WorkerProcess.start(self._told, self._ended)
        self._workers.append(worker)
        if not self._is_open:
            await worker.end()

    def _told(self, worker: WorkerProcess, message: ProgressMessage | Outcome | None) -> None:
        """What a worker reports: its first report, None, is that it is ready."""
        if message is None:
            self._failed_starts = 0
            asyncio.get_running_loop().call_later(SPARE_AFTER, self._grow)
        elif isinstance(message, ProgressMessage):
            if worker.job is not None and worker.job.on_progress is not None and not worker.job.outcome.done():
                worker.job.on_progress(message.part, message.text)
            return
        elif (job := worker.take_back()) is not None and not job.outcome.done():
            job.outcome.set_result(message)
        if worker.memory() > LARGE:
            worker.kill()
            return
        self._dispatch()

    def _ended(self, worker: WorkerProcess, code: int) -> None:
        """A worker is gone: its job is lost, and another takes its place."""
        self._workers.remove(worker)
        self._failed_starts += not worker.was_ready
        job = worker.take_back()
        if job is not None and not job.outcome.done():
            words = f"the worker process ended unexpectedly ({ending(code)})"
            advice = "another one takes its place: ask again; a grid too fine for the memory may have been the reason"
            job.outcome.set_result(Failure(job.task.number, words, advice))
        if self._failed_starts < MOST_STARTS_IN_A_ROW:
            self._grow()
        elif not self._workers:
            for waiting in self._waiting:
                waiting.outcome.set_result(Failure(waiting.task.number, "no worker process starts"))
            self._waiting.clear()


def words_of(outcome: Outcome) -> str:
    """Why an outcome holds no answer."""
    if isinstance(outcome, Failure):
        text = f"{outcome.message}. {outcome.advice}" if outcome.advice else outcome.message
        return f"a fault of petalfoil, please report it: {text}" if outcome.is_fault else text
    return "cancelled" if isinstance(outcome, Cancelled) else "no answer"


def ending(code: int) -> str:
    """How a process ended, in words."""
    return f"killed by signal {-code}" if code < 0 else f"exit code {code}"


def default_size() -> int:
    """Number of workers for this machine: one a core, at least two, at most four."""
    return min(max(os.cpu_count() or 2, 2), 4)
