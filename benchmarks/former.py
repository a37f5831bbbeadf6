"""Times of whole questions over those of an earlier state of this program, each in processes of its own, in turn."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import tempfile
from io import BytesIO
from pathlib import Path

from former_tasks import TASKS
from measure import Row, at_most

ROOT = Path(__file__).parents[1]
COMMIT = "2286840"
"""The earlier state, before any of the work that these ratios are asked of: contacts at nodes alone, no reduced model,
extremes by parabolas, stations at equal distances."""

LIMITS = {
    "cold_3d": 0.4,
    "warm_3d": 0.45,
    "curve_2d": 0.3,
    "threshold": 0.1,
    "liftoff": 0.35,
    "runup": 0.35,
    "orbit_2d": 0.2,
    "orbit_fifth": 0.2,
    "orbit_3d": 0.4,
    "orbit_turn_2d": 0.2,
    "orbit_turn_3d": 0.4,
    "designs": 1.0 / 3.0,
}
"""Ratios that are wanted."""


def rows(repeats: int, quick: bool = False) -> list[Row]:
    """A row for each task; without ratios where the earlier state is not at hand.

    Each task has processes of its own, but in a quick run: most of that would be their start.
    """
    with tempfile.TemporaryDirectory() as folder:
        reason = unpacked(Path(folder))
        if reason:
            return [Row(f"former_{name}", description(name), None, remark=reason) for name in TASKS]
        sources = {"now": ROOT / "src", "former": Path(folder) / "src"}
        parts = [list(TASKS)] if quick else [[name] for name in TASKS]
        return [row(name, best) for part in parts for name, best in measured(part, sources, repeats, quick).items()]


def unpacked(folder: Path) -> str:
    """Unpack the earlier sources into `folder`; why not, if they are not at hand."""
    call = ["git", "-C", str(ROOT), "archive", "--format=tar", COMMIT, "src", "examples"]
    try:
        archive = subprocess.run(call, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return f"the history of this folder does not hold {COMMIT}"
    with tarfile.open(fileobj=BytesIO(archive)) as tar:
        tar.extraction_filter = getattr(tarfile, "data_filter", None)  # unknown to Python before 3.11.4, and of no use
        tar.extractall(folder)
    return ""


def description(name: str) -> str:
    """What a task is about."""
    return f"over {COMMIT}: {(TASKS[name].__doc__ or '').partition(' [s]')[0].rstrip('.')}"


def row(name: str, best: dict[str, float]) -> Row:
    """Least time of a task over its least time in the earlier state."""
    details = {f"seconds_{side}": value for side, value in best.items()}
    ratio = best["now"] / best["former"]
    if name not in LIMITS:
        return Row(f"former_{name}", description(name), ratio, details=dict(details))
    return at_most(f"former_{name}", description(name), ratio, round(LIMITS[name], 2), details=details)


def measured(names: list[str], sources: dict[str, Path], repeats: int, quick: bool) -> dict[str, dict[str, float]]:
    """Least processor time of some tasks on either side, measured in turn [s]."""
    best = {name: dict.fromkeys(sources, float("inf")) for name in names}
    for _ in range(repeats):
        for side, source in sources.items():
            for name, value in seconds(names, source, quick).items():
                best[name][side] = min(best[name][side], value)
    return best


def seconds(names: list[str], source: Path, quick: bool) -> dict[str, float]:
    """Processor time of tasks one after the other in the sources at `source` [s]."""
    environment = os.environ | {"PYTHONPATH": str(source), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    call = [sys.executable, str(Path(__file__).parent / "former_tasks.py"), *names, *(["--quick"] if quick else [])]
    printed = subprocess.run(call, capture_output=True, text=True, check=True, env=environment).stdout
    return {one["task"]: float(one["seconds"]) for one in map(json.loads, printed.splitlines())}
