"""Twenty pages at once: each gets its own answers, memory is bounded, and a page that leaves frees its work."""

from __future__ import annotations

import asyncio
import itertools
import random
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import psutil
import pytest

from petalfoil.studio.design import Design
from tests.studio.server import Studio, running_studio, wait_until

pytestmark = pytest.mark.slow
pytest.importorskip("nicegui")
robots = pytest.importorskip("tests.studio.robot")

SESSIONS = 20
SECONDS, LONG_SECONDS = 10.0, 300.0
"""How long they work, twice and once; what five minutes gave stands in docs/decisions/020."""
OPENS = 300.0
"""Time in which twenty pages that are opened at once have results, on a machine that others use [s]."""
PAUSE = 4.0
"""Mean time between two changes of a session [s]."""
ALONE = """
import fastapi, nicegui.ui, uvicorn
from petalfoil.analysis.balance import balance
from petalfoil.studio.design import Design
balance.record(Design.starting().case())
"""
"""What a server imports of others, and the answer that a page begins with."""
FIRST_ANSWER = 2.0
"""Processor time of the server and of its busiest worker until a page has its first answer, over that of `ALONE` in a
process of its own: measured 1.6, and a third of what the server takes is imports."""
NEEDLESS = {"dask", "matplotlib", "numba", "optuna", "pandas"}
"""Packages that neither has any use for until then; xarray brings pandas."""
STARTS = 3
"""Starts of which the least counts: caches shared with others only add to it."""
MOST_A_WORKER = 400e6
"""Memory of a worker on this grid [bytes]: measured 115 to 135 MB."""
MOST_A_SESSION = 15e6
"""Memory that the server takes for a session [bytes]: measured 2 to 3 MB."""


def memory(studio: Studio) -> float:
    return float(psutil.Process(studio.process.pid).memory_info().rss)


async def work(studio: Studio, number: int, seconds: float) -> int:
    """Change the load of a page again and again; every answer is that of its own load. Returns how many there were."""
    chance = random.Random(number)
    robot = robots.Robot(studio)
    await robot.open()
    await robots.until(robot.results, OPENS)
    end, answers = asyncio.get_running_loop().time() + seconds, 0
    while asyncio.get_running_loop().time() < end:
        load = 5.0 + number + round(0.01 * (answers + 1), 2)
        await robot.type_in("operation.load", f"{load:.2f} N")
        wanted = f"{-load:.3g}" if load < 10 else f"{-load:.2f}"
        await robots.until(
            lambda wanted=wanted: float(robot.results()["load_y"]) == pytest.approx(float(wanted), abs=5e-3), OPENS
        )
        assert float(robot.results()["bearing_force"]) == pytest.approx(load, abs=5e-3)
        answers += 1
        await asyncio.sleep(chance.expovariate(1.0 / PAUSE))
    await robot.leave()
    return answers


def processor_time(process: psutil.Process) -> float:
    """Of a process until now [s]."""
    return float(sum(process.cpu_times()[:2]))


def time_alone() -> float:
    """Processor time of a fresh interpreter that imports and answers [s]."""
    before = psutil.Process().cpu_times()
    subprocess.run([sys.executable, "-c", ALONE], check=True)
    after = psutil.Process().cpu_times()
    return float(after.children_user + after.children_system - before.children_user - before.children_system)


def loaded(process: psutil.Process) -> set[str]:
    """Packages of which a process has compiled modules in its memory."""
    paths = [Path(one.path).parts for one in process.memory_maps()]
    return {parts[parts.index("site-packages") + 1] for parts in paths if "site-packages" in parts}


def test_the_first_answer_after_a_start_takes_little_work() -> None:
    """Server and worker load side by side, so that the sum bounds the time on a machine with a core to spare."""

    async def first(studio: Studio) -> tuple[float, set[str]]:
        robot = robots.Robot(studio)
        await robot.open()
        await robots.until(robot.results)
        processes = [psutil.Process(studio.process.pid), *studio.workers()]
        spent, packages = [processor_time(one) for one in processes], set().union(*map(loaded, processes))
        await robot.leave()
        return spent[0] + max(spent[1:]), packages

    spent: list[float] = []
    alone: list[float] = []
    while len(spent) < STARTS and (not spent or min(spent) > FIRST_ANSWER * min(alone)):
        alone.append(time_alone())
        with running_studio() as studio:
            taken, packages = asyncio.run(first(studio))
        assert {"numpy", "scipy"} <= packages
        assert not packages & NEEDLESS
        spent.append(taken)
    print(f"{min(spent):.2f} s of processor time until the first answer, {min(alone):.2f} s alone")
    assert min(spent) <= FIRST_ANSWER * min(alone)


def twenty_sessions(folder: Path, seconds: tuple[float, ...]) -> None:
    """Let twenty pages work for some times, one after the other; check memory and that nothing is left at work."""
    path = folder / "small.toml"
    path.write_text(Design.starting().with_value("model.cells_per_pitch", 24).to_toml())

    async def all_of_them(studio: Studio, duration: float) -> list[int]:
        return await asyncio.gather(*(work(studio, number, duration) for number in range(SESSIONS)))

    with running_studio(str(path)) as studio:
        assert asyncio.run(work(studio, 0, 0.5)) > 0
        taken = [memory(studio)]
        for duration in seconds:
            answers = asyncio.run(all_of_them(studio, duration))
            taken.append(memory(studio))
            print(f"{sum(answers)} answers, {min(answers)} to {max(answers)} a page, none of another page")
            assert min(answers) > 0
        assert wait_until(lambda: _is_idle(studio), 60.0)
        workers = [worker.memory_info().rss for worker in studio.workers()]
        spent = sum(psutil.Process(studio.process.pid).cpu_times()[:2])
    print(f"server {_megabytes(taken)} MB, {spent:.0f} s of processor time; workers {_megabytes(workers)} MB")
    assert len(workers) >= 2
    assert max(b - a for a, b in itertools.pairwise(taken)) / SESSIONS < MOST_A_SESSION
    assert max(workers) < MOST_A_WORKER


def test_twenty_sessions_at_once(tmp_path: Path) -> None:
    twenty_sessions(tmp_path, (SECONDS, SECONDS))


@pytest.mark.long
def test_twenty_sessions_for_five_minutes(tmp_path: Path) -> None:
    twenty_sessions(tmp_path, (LONG_SECONDS,))


def _megabytes(sizes: Sequence[float]) -> str:
    return ", ".join(f"{1e-6 * size:.0f}" for size in sizes)


def test_a_page_that_leaves_frees_its_work_and_finds_its_state_again(tmp_path: Path) -> None:
    """The page leaves while a 3-D run is under way: another page, whose runs are long too, is answered at once."""
    design = Design.starting().with_value("model.cells_per_pitch", 64).with_value("model.kind", "3d")
    path = tmp_path / "long.toml"
    path.write_text(design.to_toml())

    async def leave(studio: Studio) -> None:
        robot = robots.Robot(studio)
        await robot.open()
        await robots.until(robot.results)
        await robot.type_in("operation.load", "12 N")
        await robots.until(lambda: robot.results()["load_y"] == "-12.00")
        await robot.leave()
        back = robots.Robot(studio, robot.tab)
        await back.open()
        await robots.until(lambda: back.results().get("load_y") == "-12.00")
        await back.leave()
        other = robots.Robot(studio)
        await other.open()
        await robots.until(other.results)
        assert other.results()["load_y"] == "-15.00"
        await other.leave()

    with running_studio(str(path)) as studio:
        asyncio.run(leave(studio))
        idle = [worker.cpu_times().user for worker in studio.workers()]
        assert wait_until(lambda: _is_idle(studio), 60.0), idle


def _is_idle(studio: Studio) -> bool:
    """Whether no worker computes: the pages have left."""
    before = [worker.cpu_times().user for worker in studio.workers()]
    time.sleep(1.0)
    return [worker.cpu_times().user for worker in studio.workers()] == before
