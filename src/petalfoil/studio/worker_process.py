"""The server's end of a worker: the process, its pipes, and the job it is at."""

from __future__ import annotations

import asyncio
import math
import os
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Self

from petalfoil.studio.lifeline import COMMAND
from petalfoil.studio.protocol import HEADER, Cancel, Message, Ready, frame, unframed

if TYPE_CHECKING:
    from petalfoil.studio.worker_pool import Job

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that limit the threads of a worker to one: parallel work is over tasks."""
MOST_MEMORY = 4e9
"""Memory that a worker may take on a large machine [bytes]: the largest grid of the page needs some 2.3 GB."""
PART_OF_MACHINE = 0.4
"""The same over the memory of a small machine: two workers leave a fifth to others."""
SHARED = 12.0
"""Wall time over processor time of a worker on a machine that others use, up to which it is waited for."""
WATCH = 0.2
"""Time between two looks at a worker that is to stop [s]."""
GRACE = 2.0
"""Time that an idle worker has to end by itself when the server closes [s]."""


class WorkerProcess:
    """A worker seen from the server; made by `start`."""

    def __init__(self, process: asyncio.subprocess.Process, lifeline: int, told: Callable[..., None]) -> None:
        self.job: Job | None = None
        self.was_ready = False
        self._process = process
        self._lifeline = lifeline
        self._told = told
        self._watch: asyncio.TimerHandle | None = None
        self._reading: asyncio.Task[None] | None = None

    @classmethod
    async def start(
        cls, told: Callable[[WorkerProcess, Any], None], ended: Callable[[WorkerProcess, int], None]
    ) -> Self:
        """Start a process.

        Parameters
        ----------
        told : callable
            Called with the worker and each report; the first, None, says that it is ready.
        ended : callable
            Called with the worker and its exit code when it is gone.
        """
        posix = os.name == "posix"
        reading, writing = os.pipe()
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-c",
            COMMAND,
            str(reading if posix else -1),
            str(int(memory_limit())),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            pass_fds=(reading,) if posix else (),
            env=os.environ | dict.fromkeys(THREADS, "1"),
        )
        os.close(reading)
        worker = cls(process, writing, told)
        worker._reading = asyncio.get_running_loop().create_task(worker._follow(ended))
        return worker

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def is_free(self) -> bool:
        """Whether it waits for a job."""
        return self.was_ready and self.job is None and self._process.returncode is None

    def give(self, job: Job) -> None:
        """Hand over a job."""
        self.job = job
        self._send(job.task)

    def take_back(self) -> Job | None:
        """The job that it was at, which has ended."""
        job, self.job = self.job, None
        if self._watch is not None:
            self._watch.cancel()
            self._watch = None
        return job

    def stop_task(self, patience: float) -> None:
        """Ask it to stop its task, and kill it where it does not within `patience` seconds of its processor time."""
        if self.job is not None and self._watch is None:
            self._send(Cancel(self.job.task.number))
            loop = asyncio.get_running_loop()
            self._watch = loop.call_later(
                patience, self._watch_stop, self.processor_time() + patience, loop.time() + SHARED * patience
            )

    def _watch_stop(self, processor_time: float, time: float) -> None:
        """Kill the worker if it has had its time to stop; on a busy machine it may not have."""
        loop = asyncio.get_running_loop()
        if self.processor_time() >= processor_time or loop.time() >= time:
            self.kill()
        else:
            self._watch = loop.call_later(WATCH, self._watch_stop, processor_time, time)

    def processor_time(self) -> float:
        """Processor time that it took so far [s]; infinite where it is gone."""
        import psutil

        try:
            return float(sum(psutil.Process(self.pid).cpu_times()[:2]))
        except psutil.NoSuchProcess:
            return math.inf

    def memory(self) -> float:
        """Memory that it takes [bytes]; 0 where it is gone."""
        import psutil

        try:
            return float(psutil.Process(self.pid).memory_info().rss)
        except psutil.NoSuchProcess:
            return 0.0

    def kill(self) -> None:
        """End it at once."""
        with suppress(ProcessLookupError):
            self._process.kill()

    async def end(self) -> None:
        """End it, gently where it is idle."""
        if self.job is not None:
            self.kill()
        elif self._process.stdin is not None:
            self._process.stdin.close()
        try:
            await asyncio.wait_for(self._process.wait(), GRACE)
        except TimeoutError:
            self.kill()
        if self._reading is not None:
            await self._reading

    def _send(self, message: Message) -> None:
        """Send a message; to a worker that is gone nothing is sent, and `_follow` tells that it is."""
        if self._process.stdin is not None and not self._process.stdin.is_closing():
            self._process.stdin.write(frame(message))

    async def _follow(self, ended: Callable[[WorkerProcess, int], None]) -> None:
        """Read reports until the process is gone."""
        reports = self._process.stdout
        if reports is None:
            raise RuntimeError("a worker is started with a pipe for its reports")
        try:
            while True:
                (size,) = HEADER.unpack(await reports.readexactly(HEADER.size))
                message = unframed(await reports.readexactly(size))
                self.was_ready = True
                self._told(self, None if isinstance(message, Ready) else message)
        except asyncio.IncompleteReadError:
            code = await self._process.wait()
        finally:
            os.close(self._lifeline)
        ended(self, code)


def memory_limit() -> float:
    """Memory that a worker may take on this machine [bytes]."""
    import psutil

    return min(MOST_MEMORY, PART_OF_MACHINE * float(psutil.virtual_memory().total))
