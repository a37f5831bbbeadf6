"""What the tasks of `former_tasks.py` would take at least: libraries alone, and with the least evaluations in NumPy.

    python benchmarks/floors.py [TASK ...] [--repeats N]

A line for each task, in shares of the processor time of the earlier state (`former.COMMIT`), the least of some runs:
what it takes; SuperLU, LAPACK and sparse products within it, as a profile has them; the same with the fluxes of all its
films along the journal, written out in place. Nothing of Python between these calls is in such a floor. Tasks that
measure a part of what they do have none.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import os
import pstats
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import former
import numpy as np
from former_tasks import TASKS, VERBS, pack
from numpy.typing import NDArray

import petalfoil
from petalfoil.physics.mass_balance import FilmBalance

Array = NDArray[np.float64]

LIBRARIES = ("gstrf", "SuperLU", "_sparsetools", "c_einsum", "numpy/linalg/", "scipy/linalg/", "numpy.dot")
"""What a profile calls functions that only compute."""


@dataclass
class Films:
    """Film evaluations of a task, and the arrays of the largest: pressures and film thicknesses at the nodes."""

    count: int = 0
    P: Array | None = None
    H: Array | None = None


def main() -> None:
    """Measure and print, or the part of it that a process of its own measures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tasks", nargs="*", default=list(TASKS))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.inside:
        print(json.dumps(inside(chosen.tasks[0])))
        return
    print(f"{'task':<16}{'former [s]':>11}{'now':>7}{'libraries':>11}{'and films':>11}   film evaluations")
    for name in chosen.tasks:
        print(line(name, chosen.repeats), flush=True)


def line(name: str, repeats: int) -> str:
    """A task, both states in turn."""
    with tempfile.TemporaryDirectory() as folder:
        reason = former.unpacked(Path(folder))
        if reason:
            return f"{name:<16}{reason}"
        sources = {"now": former.ROOT / "src", "former": Path(folder) / "src"}
        best = former.measured([name], sources, repeats, quick=False)[name]
    shown = f"{name:<16}{best['former']:>11.3f}{best['now'] / best['former']:>7.3f}"
    parts = [part for part in (separately(name, former.ROOT / "src") for _ in range(repeats)) if part]
    if not parts:
        return shown
    least = {key: min(part[key] for part in parts) for key in parts[0]}
    floors = [seconds / best["former"] for seconds in (least["libraries"], least["libraries"] + least["films"])]
    films = f"{least['count']:.0f} of {1e6 * least['film']:.0f} us"
    return f"{shown}{floors[0]:>11.3f}{floors[1]:>11.3f}   {films}"


def separately(name: str, source: Path) -> dict[str, float]:
    """The parts of a task, in a process of its own."""
    environment = os.environ | {"PYTHONPATH": str(source), "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    call = [sys.executable, __file__, name, "--inside"]
    printed = subprocess.run(call, capture_output=True, text=True, check=True, env=environment).stdout
    parts: dict[str, float] = json.loads(printed.splitlines()[-1])
    return parts


def inside(name: str) -> dict[str, float]:
    """Seconds of libraries in a task, its film evaluations, and the least seconds of one and of all of them.

    Nothing for tasks that measure a part of what they do.
    """
    warnings.simplefilter("ignore")
    for verb in VERBS:
        getattr(petalfoil, verb)
    petalfoil.solve(pack("paper_n8", 16))
    films = counted_films()
    profile = cProfile.Profile(time.process_time)
    profile.enable()
    own = TASKS[name](False)
    profile.disable()
    if own is not None:
        return {}
    stats, film = pstats.Stats(profile), least_flux(films)
    return {
        "seconds": stats.total_tt,  # type: ignore[attr-defined]
        "libraries": in_libraries(stats),
        "count": films.count,
        "film": film,
        "films": film * films.count,
    }


def in_libraries(stats: pstats.Stats) -> float:
    """Own time of all functions that only compute [s]."""
    own: dict[tuple[str, int, str], tuple[int, int, float, float, object]] = stats.stats  # type: ignore[attr-defined]
    return sum(row[2] for key, row in own.items() if any(part in f"{key[0]}{key[2]}" for part in LIBRARIES))


def counted_films() -> Films:
    """Count evaluations of films from now on."""
    films, plain = Films(), FilmBalance.fluxes

    def fluxes(self: FilmBalance, P: Array, H: Array, Lam: float) -> object:
        films.count += 1
        if films.H is None or H.size >= films.H.size:
            films.P, films.H = P, H
        return plain(self, P, H, Lam)

    FilmBalance.fluxes = fluxes  # type: ignore[assignment, method-assign]
    return films


def least_flux(films: Films) -> float:
    """Least seconds of the fluxes (F2) through the faces of a film and of what they add up to, in place."""
    if films.P is None or films.H is None:
        return 0.0
    sides = [np.ascontiguousarray(side) for nodes in (films.P, films.H) for side in (nodes[:, :-1], nodes[:, 1:])]
    flux, total = Flux(*sides), np.zeros(films.H.shape)

    def evaluated() -> None:
        value = flux.through(10.0, 0.01)
        total[:] = 0.0
        total[:, :-1] += value
        total[:, 1:] -= value

    return best(evaluated)


def best(call: Callable[[], None]) -> float:
    """Least mean time of some hundred calls [s]."""
    times = []
    for _ in range(20):
        begin = time.process_time()
        for _ in range(100):
            call()
        times.append((time.process_time() - begin) / 100)
    return min(times)


class Flux:
    """The circumferential flux (F2) with as few passes as its formula has, none of which allocates."""

    def __init__(self, P0: Array, P1: Array, H0: Array, H1: Array) -> None:
        self.sides = (P0, P1, H0, H1)
        self.between = [np.empty_like(P0) for _ in range(6)]

    def through(self, Lam: float, dphi: float) -> Array:
        """It, without slip and limit."""
        P0, P1, H0, H1 = self.sides
        both, conductance, x, behind, ahead, value = self.between
        np.add(H0, H1, out=both)
        np.multiply(H0, H1, out=conductance)
        np.multiply(conductance, conductance, out=conductance)
        np.divide(conductance, both, out=conductance)  # half of the mean cube
        np.add(P0, P1, out=x)
        np.multiply(conductance, x, out=conductance)
        np.multiply(conductance, 1.0 / dphi, out=conductance)
        np.divide(both, conductance, out=x)
        np.multiply(x, 0.25 * Lam, out=x)
        np.subtract(P0, P1, out=value)
        np.multiply(value, conductance, out=value)
        np.multiply(P0, H0, out=behind)
        np.multiply(P1, H1, out=ahead)
        np.multiply(x, -2.0, out=both)
        np.expm1(both, out=both)
        np.divide(-2.0, both, out=both)
        np.subtract(both, 1.0, out=both)
        np.divide(1.0, x, out=x)
        np.subtract(both, x, out=both)  # coth x - 1/x
        np.subtract(behind, ahead, out=x)
        np.multiply(both, x, out=both)
        np.add(both, behind, out=both)
        np.add(both, ahead, out=both)
        np.multiply(both, 0.5 * Lam, out=both)
        np.add(value, both, out=value)
        return value


if __name__ == "__main__":
    main()
