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
    "orbit_3d": 0.4,
    "designs": 1.0 / 3.0,
}
"""Ratios that are wanted."""


def rows(repeats: int, quick: bool = False) -> list[Row]:
    """A row for each task; without ratios where the earlier state is not at hand."""
    with tempfile.TemporaryDirectory() as folder:
        reason = unpacked(Path(folder))
        return [row(name, None if reason else Path(folder), repeats, quick, reason) for name in TASKS]


def unpacked(folder: Path) -> str:
    """Unpack the earlier sources into `folder`; why not, if they are not at hand."""
    call = ["git", "-C", str(ROOT), "archive", "--format=tar", COMMIT, "src", "examples"]
    try:
        archive = subprocess.run(call, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return f"the history of this folder does not hold {COMMIT}"
    with tarfile.open(fileobj=BytesIO(archive)) as tar:
        tar.extractall(folder, filter="data")
    return ""


def row(name: str, former: Path | None, repeats: int, quick: bool, reason: str) -> Row:
    """Least time of a task over its least time in the earlier state."""
    description = f"over {COMMIT}: {(TASKS[name].__doc__ or '').partition(' [s]')[0].rstrip('.')}"
    if former is None:
        return Row(f"former_{name}", description, None, remark=reason)
    sources = {"now": ROOT / "src", "former": former / "src"}
    best = dict.fromkeys(sources, float("inf"))
    for _ in range(repeats):
        for side, source in sources.items():
            best[side] = min(best[side], seconds(name, source, quick))
    details = {f"seconds_{side}": value for side, value in best.items()}
    ratio = best["now"] / best["former"]
    if name not in LIMITS:
        return Row(f"former_{name}", description, ratio, details=dict(details))
    return at_most(f"former_{name}", description, ratio, round(LIMITS[name], 2), details=details)


def seconds(name: str, source: Path, quick: bool) -> float:
    """Processor time of a task in the sources at `source` [s]."""
    environment = os.environ | {"PYTHONPATH": str(source), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    call = [sys.executable, str(Path(__file__).parent / "former_tasks.py"), name, *(["--quick"] if quick else [])]
    printed = subprocess.run(call, capture_output=True, text=True, check=True, env=environment).stdout
    return float(json.loads(printed)["seconds"])
