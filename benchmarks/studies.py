"""What the engine of studies costs: processor time beside that of the cases, and memory over many cases.

    python benchmarks/studies.py throughput           # 1000 balances on two workers
    python benchmarks/studies.py memory FILE.csv      # 5000 checks; memory of every process along the way

Processor time of the worker processes is compared with that of the cases in them, so that other work on the machine
changes neither. The limit of the share is 90 %.
"""

from __future__ import annotations

import argparse
import csv
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil

from petalfoil.case import Case
from petalfoil.studies.question import Question
from petalfoil.studies.run import Execution, run_with_effort
from petalfoil.studies.sweep import sweep_study

BEARING = Path(__file__).parent.parent / "examples" / "paper_n8.toml"
WORKERS = 2
MEGABYTE = 1e6
EVERY = 100
"""Cases between two looks at the memory."""
WARM_UP = 500
"""Cases after which memory is to stay: caches are full by then."""
QUESTIONS = {"throughput": ("balance", {"load": 20.0}, 1000), "memory": ("check", {}, 5000)}
"""What is asked, its arguments, and of how many cases."""


class Watch:
    """Memory of this process and of its workers, as a progress callback."""

    def __init__(self) -> None:
        self.rows: list[tuple[int, float, float]] = []
        self.calls = 0

    def __call__(self, part: float, text: str) -> None:
        """Look, once in a while."""
        self.calls += 1
        if self.calls % EVERY == 1:
            self.rows.append((self.calls, *memory()))
            print(f"{text}: driver {self.rows[-1][1]:.0f} MB, largest worker {self.rows[-1][2]:.0f} MB", flush=True)


def memory() -> tuple[float, float]:
    """Resident memory of this process and of its largest worker [MB]."""
    own = psutil.Process()
    workers = [child.memory_info().rss for child in workers_of(own)]
    return own.memory_info().rss / MEGABYTE, max(workers, default=0) / MEGABYTE


def workers_of(process: psutil.Process) -> Iterator[psutil.Process]:
    """The worker processes of a study."""
    for child in process.children(recursive=True):
        if "spawn_main" in " ".join(child.cmdline()):
            yield child


def measure(name: str, cases: int, cells: int, progress: Callable[[float, str], None]) -> str:
    """Run a study; what it took."""
    verb, arguments, _ = QUESTIONS[name]
    case = Case.load(BEARING).replace(**{"model.cells_per_pitch": cells})
    vary = {"petals.thickness": f"0.14 mm : 0.24 mm : {cases // 10}", "petals.arc_length": "44 mm : 48 mm : 10"}
    with folder() as out:
        study = sweep_study(case, vary, Question.read(verb, arguments))
        ds, effort = run_with_effort(study, out, Execution(workers=WORKERS, progress=progress))
    share = effort.solver / effort.workers
    return (
        f"{ds['converged'].size} cases of {verb} on {cells} cells per pitch, {int(ds['converged'].sum())} converged: "
        f"{effort.solver:.1f} s in cases, {effort.workers:.1f} s in workers ({100.0 * share:.1f} %), "
        f"{1e3 * (effort.workers - effort.solver) / ds['converged'].size:.1f} ms a case beside the answer; "
        f"{effort.driver:.1f} s to hand them out ({1e3 * effort.driver / ds['converged'].size:.1f} ms a case)"
    )


@contextmanager
def folder() -> Iterator[Path]:
    """A folder that is removed afterwards."""
    with tempfile.TemporaryDirectory(prefix="petalfoil-bench-") as name:
        yield Path(name) / "study"


def growth(rows: list[tuple[int, float, float]]) -> str:
    """How memory changes from the warm-up to the end."""
    settled = [row for row in rows if row[0] >= WARM_UP]
    if not settled:
        return f"memory is looked at from {WARM_UP} cases on"
    told = []
    for column, name in ((1, "driver"), (2, "largest worker")):
        values = [row[column] for row in settled]
        told.append(f"{name} {values[0]:.0f} MB after {settled[0][0]} cases, {values[-1]:.0f} after {settled[-1][0]}")
    return "; ".join(told)


def main() -> None:
    """Run what is asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=sorted(QUESTIONS))
    parser.add_argument("file", nargs="?", help="CSV file for the memory over the cases")
    parser.add_argument("--cases", type=int, help="number of cases, a multiple of ten")
    parser.add_argument("--cells", type=int, default=32, help="cells per pitch")
    given = parser.parse_args()
    watch = Watch()
    print(measure(given.what, given.cases or QUESTIONS[given.what][2], given.cells, watch))
    print(growth(watch.rows))
    if given.file:
        with Path(given.file).open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([("cases", "driver [MB]", "largest worker [MB]"), *watch.rows])


if __name__ == "__main__":
    sys.exit(main())
