"""A study on two workers whose processes are killed: nothing finished is lost or doubled, and the result is the same.

``PETALFOIL_KILLS=10`` kills at ten random moments each instead of one.
"""

from __future__ import annotations

import os
import random
import shutil
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
import xarray as xr

from petalfoil.results.store import load
from tests.cases import EXAMPLES

pytestmark = pytest.mark.slow

KILLS = int(os.environ.get("PETALFOIL_KILLS", "1"))
CASES = 20
SWEEP = [
    *(sys.executable, "-m", "petalfoil", "sweep", str(EXAMPLES / "paper_n8.toml"), "--workers", "2"),
    *("--vary", "petals.thickness=0.14 mm : 0.24 mm : 10", "--vary", "model.cells_per_pitch=12, 16"),
    *("--ask", "balance", "--load", "20 N"),
]
PATIENCE = 120.0
"""Time until the first rows are there, on a busy machine [s]."""


def begun(folder: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen([*SWEEP, "--out", str(folder)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def rows(folder: Path) -> dict[str, str]:
    """Outcomes in the index by key."""
    if not (folder / "index.sqlite").exists():
        return {}
    index = sqlite3.connect(folder / "index.sqlite")
    try:
        return dict(index.execute("SELECT key, outcome FROM cases"))
    except sqlite3.OperationalError:  # the table is not made yet
        return {}
    finally:
        index.close()


def workers_of(process: subprocess.Popen[bytes]) -> list[psutil.Process]:
    children = psutil.Process(process.pid).children(recursive=True)
    return [child for child in children if "spawn_main" in " ".join(child.cmdline())]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> xr.Dataset:
    folder = tmp_path_factory.mktemp("whole") / "study"
    assert begun(folder).wait(300) == 0
    return load(folder / "study.nc")


@pytest.mark.parametrize("moment", range(KILLS))
@pytest.mark.parametrize("what", ["worker", "driver", "both"])
def test_nothing_is_lost_or_doubled(what: str, moment: int, whole: xr.Dataset, tmp_path: Path) -> None:
    folder, rng = tmp_path / "study", random.Random(f"{what} {moment}")
    process, wanted, waited = begun(folder), rng.randrange(CASES - 8), time.monotonic()
    while len(rows(folder)) <= wanted and process.poll() is None and time.monotonic() - waited < PATIENCE:
        time.sleep(0.05)
    assert process.poll() is None, "it ended before it was killed"
    workers = workers_of(process)
    if what in ("worker", "both"):
        rng.choice(workers).kill()
    if what in ("driver", "both"):
        process.kill()
    ended = process.wait(300)
    assert ended == (0 if what == "worker" else -9)
    before = rows(folder)
    assert len(before) > wanted
    assert begun(folder).wait(300) == 0
    after = rows(folder)
    assert len(after) == CASES
    assert {key: after[key] for key in before} == before
    assert load(folder / "study.nc").identical(whole)
    assert not list(folder.rglob("*.part"))
    assert not [worker for worker in workers if worker.is_running() and worker.status() != psutil.STATUS_ZOMBIE]
    shutil.rmtree(folder)
