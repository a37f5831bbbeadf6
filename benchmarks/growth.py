"""Growth of time and memory of a warm point with the number of unknowns; each size in its own process.

python benchmarks/growth.py CELLS AXIAL point     one size as a JSON object; `factor` instead of `point`: without
                                                  the points, for a size at which they take too long
"""

from __future__ import annotations

import json
import os
import re
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from measure import Row, Value, at_most
from warm_point import FARTHEST, STEP, Grid

from petalfoil.analysis.curve import curve
from petalfoil.analysis.session import one_thread
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem

SIZES = (Grid(10, 6), Grid(18, 12), Grid(34, 22), Grid(58, 38))
"""Grids of about 1000, 3000, 10 000 and 30 000 unknowns, with a short curve on each."""
LARGEST = Grid(106, 72)
"""A grid of about 100 000 unknowns. A curve on it takes minutes; only one factorisation is measured."""
MEGABYTES = 1.0
"""Smallest difference of memory that is told from that of the imports [MB]."""

Found = dict[str, float]


def rows(sizes: tuple[Grid, ...], largest: Grid | None) -> list[Row]:
    """Fitted exponents of time and memory."""
    found = [alone(grid, "point") for grid in sizes]
    far = [] if largest is None else [alone(largest, "factor")]
    return [growth_of_time(found, far), growth_of_memory(found, far)]


def growth_of_time(found: list[Found], far: list[Found]) -> Row:
    """Exponent of the time of a warm point; at the largest size a factorisation times the ratio of the one before."""
    over = found[-1]["point"] / found[-1]["factorisation"]
    seconds = [size["point"] for size in found] + [size["factorisation"] * over for size in far]
    unknowns = [size["unknowns"] for size in found + far]
    slope, details = fitted(unknowns, seconds, "seconds")
    description = f"growth: exponent of the time per warm point, {unknowns[0]:.0f} to {unknowns[-1]:.0f} unknowns"
    remark = "largest size: one factorisation, times the ratio of a point to a factorisation at the size before"
    return at_most("growth_time", description, slope, 1.35, details=details, remark=remark if far else "")


def growth_of_memory(found: list[Found], far: list[Found]) -> Row:
    """Exponent of the peak memory of a curve. The remark states the memory of a factorisation at the largest size."""
    unknowns, megabytes = [size["unknowns"] for size in found], [size["megabytes"] for size in found]
    slope, details = fitted(unknowns, [max(held, MEGABYTES) for held in megabytes], "megabytes")
    description = f"growth: exponent of the memory of a curve, {unknowns[0]:.0f} to {unknowns[-1]:.0f} unknowns"
    remark = f"peak {megabytes[-1]:.0f} MB at {unknowns[-1]:.0f} unknowns, Python and imports not counted"
    for size in far:
        remark += f"; one factorisation of {size['unknowns']:.0f}: {size['megabytes']:.0f} MB"
        details["megabytes of the largest factorisation"] = size["megabytes"]
    return Row("growth_memory", description, slope, details=details, remark=remark)


def fitted(n: list[float], values: list[float], unit: str) -> tuple[float, dict[str, Value]]:
    """Exponent of the growth of `values` with `n`, and the values behind it."""
    local = np.diff(np.log(values)) / np.diff(np.log(n))
    details: dict[str, Value] = {f"{unit} at {size:.0f}": float(value) for size, value in zip(n, values, strict=True)}
    details |= {f"exponent to {size:.0f}": float(slope) for size, slope in zip(n[1:], local, strict=True)}
    return float(np.polyfit(np.log(n), np.log(values), 1)[0]), details


def alone(grid: Grid, kind: str) -> Found:
    """Measure one size in its own process."""
    call = [sys.executable, str(Path(__file__)), str(grid.pitch), str(grid.axial), kind]
    done = subprocess.run(call, capture_output=True, text=True, check=True)
    found: Found = json.loads(done.stdout)
    return found


# ---------------------------------------------------------------------------------------------- in that process


def measured(grid: Grid, kind: str) -> Found:
    """Time of assembly and factorisation, and of a point if requested [s]; peak memory above that of the imports."""
    before = peak()
    found = {"unknowns": float(build_problem(grid.case()).layout.n), "factorisation": factorisation(grid)}
    if kind == "point":
        found["point"] = point(grid)
    return found | {"megabytes": peak() - before}


def peak() -> float:
    """Peak memory of this process [MB].

    On Linux from /proc: `getrusage` includes the memory of the parent before `exec`.
    """
    status = Path("/proc/self/status")
    if status.exists():
        (held,) = re.findall(r"^VmHWM:\s*(\d+) kB", status.read_text(encoding="ascii"), re.MULTILINE)
        return float(held) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def factorisation(grid: Grid) -> float:
    """Time of one assembly and factorisation of the coupled tangent at the free shape with open gaps [s]."""
    problem = build_problem(grid.case(0.5 * FARTHEST))
    x = np.ones(problem.layout.n)
    x[: problem.layout.n_wall] = 0.0
    shift = 1.0 - np.minimum(problem.gaps(x), 0.0)
    with one_thread():
        solver = LinearSolver()
        order = solver.elimination(problem.elimination_key)
        solver.factor(problem.linearize(x, shift).matrix(problem.weight), order)  # finds the elimination order
        start = time.process_time()
        solver.factor(problem.linearize(x, shift).matrix(problem.weight), order)
        return time.process_time() - start


def point(grid: Grid) -> float:
    """Median time of the warm points of a short curve [s]."""
    points = curve.records(grid.case(), 0.5 * FARTHEST + STEP * np.arange(4))
    next(points)  # the cold start
    seconds = []
    for _ in range(3):
        start = time.process_time()
        record = next(points)
        seconds.append(time.process_time() - start)
        if not record.converged:
            raise RuntimeError(f"a point of the benchmark did not converge: {record.scalars['status']}")
    return statistics.median(seconds)


if __name__ == "__main__":
    sys.stdout.write(json.dumps(measured(Grid(int(sys.argv[1]), int(sys.argv[2])), sys.argv[3])))
