"""A study on the workers of a scheduler that runs already, as on a cluster; and schedulers that are not there."""

from __future__ import annotations

import contextlib
import json
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from petalfoil.cli.app import app
from petalfoil.errors import UsageError
from petalfoil.results.store import load
from petalfoil.studies import case_engine
from petalfoil.studies.question import CaseTask, Question
from petalfoil.studies.run import Execution
from petalfoil.studies.sweep import sweep
from tests.cases import EXAMPLES, case

PATIENCE = 120.0
"""Time until scheduler and workers are there, on a busy machine [s]."""
PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 16})
VARY = {"operation.speed": "3000 rad/s : 5000 rad/s : 4"}


def started(part: str, *options: str) -> subprocess.Popen[bytes]:
    """A process of `dask`, reachable from this machine alone."""
    call = [sys.executable, "-m", f"distributed.cli.dask_{part}", *options, "--host", "127.0.0.1", "--no-dashboard"]
    return subprocess.Popen(call, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Address of a scheduler with two workers, in three processes of their own."""
    pytest.importorskip("distributed")
    file = tmp_path_factory.mktemp("cluster") / "scheduler.json"
    begun = time.monotonic()
    processes = [started("scheduler", "--port", "0", "--scheduler-file", str(file))]
    worker = ("--scheduler-file", str(file), "--nthreads", "1", "--no-nanny")
    processes += [started("worker", *worker) for _ in range(2)]
    try:
        while not file.exists() and time.monotonic() - begun < PATIENCE:
            time.sleep(0.1)
        address = json.loads(file.read_text())["address"]
        from distributed import Client

        with Client(address, timeout=PATIENCE) as client:
            client.wait_for_workers(2, timeout=PATIENCE)
        yield address
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(PATIENCE)


@pytest.mark.slow
def test_a_sweep_on_a_scheduler_is_that_of_one_process(scheduler: str, tmp_path: Path) -> None:
    words = ["sweep", str(EXAMPLES / "paper_n8.toml"), "--vary", "petals.thickness=0.16 mm, 0.18 mm, 0.2 mm"]
    words += ["--vary", "model.cells_per_pitch=8, 12", "--ask", "balance", "--load", "20 N", "--fields"]
    done = CliRunner().invoke(app, [*words, "--scheduler", scheduler, "--out", str(tmp_path / "there")])
    assert done.exit_code == 0, done.output
    assert "6 cases, 6 converged" in done.stdout
    alone = CliRunner().invoke(app, [*words, "--workers", "0", "--out", str(tmp_path / "here")])
    assert alone.exit_code == 0, alone.output
    assert load(tmp_path / "there" / "study.nc").identical(load(tmp_path / "here" / "study.nc"))
    assert len(list((tmp_path / "there" / "fields").glob("*.nc"))) == 6


@pytest.mark.slow
def test_workers_with_another_version_are_refused(scheduler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(case_engine, "__version__", "0.0.0")
    with pytest.raises(UsageError, match=r"this is 0\.0\.0: install the same version on all of them"):
        sweep(PLAIN, VARY, execution=Execution(scheduler=scheduler))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:{free}", "nonsense", "udp://127.0.0.1:1"])
def test_a_scheduler_that_is_not_there_is_refused(
    address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dask = pytest.importorskip("dask")
    pytest.importorskip("distributed")
    monkeypatch.setattr(case_engine, "PATIENCE", 0.3)
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        free = listener.getsockname()[1]
    with pytest.raises(UsageError, match="--scheduler: there is no scheduler at "):
        sweep(PLAIN, VARY, out=tmp_path / "study", execution=Execution(scheduler=address.format(free=free)))
    assert not (tmp_path / "study").exists()
    assert dask.config.get("scheduler", None) is None, "what is written afterwards would look for it"


def raising(error: Exception) -> Callable[..., None]:
    """What raises whatever it is called with."""

    def call(*_: object, **__: object) -> None:
        raise error

    return call


def test_an_event_loop_that_does_not_start_is_told_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    """`distributed` asserts that its event loop is there within ten seconds."""
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "Client", raising(AssertionError()))
    with pytest.raises(UsageError, match=r"no scheduler at udp://127\.0\.0\.1:1: its event loop did not start in time"):
        sweep(PLAIN, VARY, execution=Execution(scheduler="udp://127.0.0.1:1"))


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (AssertionError(), "its event loop did not start in time, because this machine is busy; try again"),
        (RuntimeError("Nanny failed to start."), "Nanny failed to start"),
        (OSError(24, "Too many open files"), "Too many open files"),
        (TimeoutError(), "TimeoutError"),
    ],
)
def test_workers_that_do_not_start_are_told_in_words(
    error: Exception, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed = pytest.importorskip("distributed")
    monkeypatch.setattr(distributed, "LocalCluster", raising(error))
    with pytest.raises(UsageError, match="2 workers did not start on this machine: ") as refusal:
        sweep(PLAIN, VARY, execution=Execution(workers=2))
    assert f"{text}. Ask fewer of them with --workers, or --workers 0" in str(refusal.value)


def cluster_of_threads() -> Any:
    """A cluster with one worker in this process. Its event loop, which has ten seconds to start, is tried thrice."""
    distributed = pytest.importorskip("distributed")
    options = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
    for _ in range(2):
        with contextlib.suppress(AssertionError):
            return distributed.LocalCluster(**options, silence_logs=50)
    return distributed.LocalCluster(**options, silence_logs=50)


@pytest.mark.slow
def test_a_scheduler_that_goes_away_is_told_in_words() -> None:
    distributed = pytest.importorskip("distributed")
    base, question = PLAIN.to_toml(), Question.read("solve", {})
    tasks = [CaseTask(f"{k}", base, {"operation.speed": 3000.0 + k}, question) for k in range(20)]
    with (
        cluster_of_threads() as cluster,
        distributed.Client(cluster.scheduler_address, timeout=10, set_as_default=False) as client,
    ):
        outcomes = case_engine.OnCluster(client, 1).outcomes(tasks)
        assert next(outcomes).converged
        cluster.close()
        with pytest.raises(UsageError, match=r"connection to the workers was lost: .*`petalfoil study resume`"):
            list(outcomes)
