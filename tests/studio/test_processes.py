"""Workers stop when they are asked, are replaced when they die, and end with the server, also when it is killed."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import Awaitable, Callable

import psutil
import pytest

from petalfoil.errors import UsageError
from petalfoil.studio.address import address_of
from petalfoil.studio.design import Design
from petalfoil.studio.protocol import Cancelled, Done, Failure, FoundAnswer, Work
from petalfoil.studio.worker_pool import Job, WorkerPool
from tests.studio.server import running_studio, wait_until

pytestmark = [pytest.mark.slow, pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")]

ORPHANS_END = 5.0
"""Time in which workers end after their server was killed [s]."""
LONG = Design.starting().with_value("model.kind", "3d").with_value("model.cells_per_pitch", 192).to_toml()
LITTLE = 300e6
"""Memory in which a worker answers the short case and not the long one [bytes]: it takes 200 MB before it begins."""
SHORT = Design.starting().with_value("model.cells_per_pitch", 24).to_toml()


def with_engine(ask: Callable[[WorkerPool], Awaitable[None]]) -> None:
    """Run something with an engine of two workers."""

    async def run() -> None:
        engine = WorkerPool(2)
        await engine.start()
        try:
            await asyncio.wait_for(ask(engine), 120.0)
        finally:
            await engine.stop()
        assert engine.worker_pids == []

    asyncio.run(run())


def answer(engine: WorkerPool, case: str, owner: str = "a", *, is_long: bool = False) -> Job:
    return engine.submit(owner, Work.ANSWER, verb="balance", case_toml=case, is_long=is_long)


async def at_work(job: Job) -> int:
    """Wait until a job is at a worker, and return its process."""
    while job.worker is None:
        await asyncio.sleep(0.02)
    await asyncio.sleep(0.5)
    return job.worker.pid


def test_a_cancelled_task_leaves_its_worker_warm() -> None:
    async def ask(engine: WorkerPool) -> None:
        job = answer(engine, LONG, is_long=True)
        pid = await at_work(job)
        engine.cancel(job)
        assert isinstance(await job.outcome, Cancelled)
        worker = job.worker
        assert worker is not None
        while not worker.is_free:
            await asyncio.sleep(0.05)
        assert pid in engine.worker_pids
        assert isinstance(await answer(engine, SHORT).outcome, Done)

    with_engine(ask)


def test_a_killed_worker_is_told_and_replaced() -> None:
    async def ask(engine: WorkerPool) -> None:
        job = answer(engine, LONG, is_long=True)
        pid = await at_work(job)
        os.kill(pid, signal.SIGKILL)
        outcome = await job.outcome
        assert isinstance(outcome, Failure)
        assert "killed by signal 9" in outcome.message
        done = await answer(engine, SHORT).outcome
        assert isinstance(done, Done)
        while len(engine.worker_pids) < 2:
            await asyncio.sleep(0.05)
        assert pid not in engine.worker_pids

    with_engine(ask)


def test_a_worker_that_does_not_stop_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studio.worker_pool.PATIENCE", 0.1)

    async def ask(engine: WorkerPool) -> None:
        job = answer(engine, LONG, is_long=True)
        pid = await at_work(job)
        psutil.Process(pid).suspend()
        engine.cancel(job)
        while pid in engine.worker_pids:
            await asyncio.sleep(0.05)
        assert isinstance(await answer(engine, SHORT).outcome, Done)

    with_engine(ask)


def test_a_worker_that_takes_too_much_memory_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.studio.worker_process.MOST_MEMORY", LITTLE)

    async def ask(engine: WorkerPool) -> None:
        outcome = await answer(engine, LONG, is_long=True).outcome
        assert isinstance(outcome, Failure)
        assert "memory" in f"{outcome.message} {outcome.advice}"
        assert isinstance(await answer(engine, SHORT).outcome, Done)

    with_engine(ask)


def test_long_jobs_leave_a_worker_to_short_ones_and_sessions_get_their_own() -> None:
    async def ask(engine: WorkerPool) -> None:
        long = [answer(engine, LONG, owner, is_long=True) for owner in "ab"]
        await at_work(long[0])
        loads = {owner: 5.0 + number for number, owner in enumerate("cdefgh")}
        cases = {
            owner: Design.from_toml(SHORT).with_value("operation.load", f"{load} N") for owner, load in loads.items()
        }
        jobs = {owner: answer(engine, case.to_toml(), owner) for owner, case in cases.items()}
        for owner, job in jobs.items():
            outcome = await job.outcome
            assert isinstance(outcome, Done)
            assert isinstance(outcome.result, FoundAnswer)
            assert outcome.result.scalars["load_y"] == -loads[owner]
        assert not long[1].outcome.done()
        assert long[1].worker is None
        for owner in "ab":
            engine.leave(owner)
        assert all([isinstance(await job.outcome, Cancelled) for job in long])

    with_engine(ask)


def test_a_session_cannot_fill_the_queue() -> None:
    async def ask(engine: WorkerPool) -> None:
        jobs = [answer(engine, SHORT, "greedy") for _ in range(40)]
        other = answer(engine, SHORT, "modest")
        outcomes = [await job.outcome for job in jobs]
        refused = [outcome for outcome in outcomes if isinstance(outcome, Failure)]
        assert refused
        assert "waiting already" in refused[0].message
        assert isinstance(await other.outcome, Done)

    with_engine(ask)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_workers_end_with_the_server(number: signal.Signals) -> None:
    with running_studio() as studio:
        assert wait_until(lambda: len(studio.workers()) >= 2, 30.0)  # some of them still load what they need
        workers = studio.workers()
        studio.process.send_signal(number)
        assert wait_until(lambda: not any(map(is_alive, workers)), ORPHANS_END)
        if number is not signal.SIGKILL:
            assert studio.process.wait(15.0) == 0


def is_alive(process: psutil.Process) -> bool:
    return process.is_running() and process.status() != psutil.STATUS_ZOMBIE


def test_a_worker_ends_with_its_server_though_python_is_busy() -> None:
    """Summing a range holds the interpreter for minutes: no thread of Python could end the process."""
    lines = (
        "import sys; from petalfoil.studio.lifeline import end_with; end_with(int(sys.argv[1]))",
        "print('on', flush=True); sum(range(10**12))",
    )
    reading, writing = os.pipe()
    command = [sys.executable, "-c", "; ".join(lines), str(reading)]
    with subprocess.Popen(command, pass_fds=(reading,), stdout=subprocess.PIPE) as process:
        os.close(reading)
        assert process.stdout is not None
        assert process.stdout.readline() == b"on\n"
        assert process.poll() is None
        os.close(writing)
        assert process.wait(ORPHANS_END) == -signal.SIGIO


def test_another_address_needs_its_flag_and_a_taken_port_is_told() -> None:
    with pytest.raises(UsageError, match="--allow-network"):
        address_of("0.0.0.0", 0, to_network=False)
    with pytest.raises(UsageError, match="no IP address"):
        address_of("evil.example", 0, to_network=True)
    address, listening = address_of("127.0.0.1", 0, to_network=False)
    with listening, pytest.raises(UsageError, match="--port 0"):
        address_of("127.0.0.1", address.port, to_network=False)
