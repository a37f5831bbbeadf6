"""Newton's method of petalfoil and the method of the paper, on the bearings and grids of the paper.

    python benchmarks/race.py PETALS NODES STATIONS MICROMETRES ENGINE TURNS SECONDS    the classic method, JSON lines

The classic method runs in its own process, which is stopped at a limit of its processor time. The time to convergence
is then extrapolated from the decrease of its changes. As the paper words its algorithm (`TURNS` is "settled"), every
outer iteration solves film and pack to the accuracy of the paper. In NumPy this takes about two hours; that time is
estimated from the number of steps of the compiled loops.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import resource
import signal
import subprocess
import sys
import time
from dataclasses import astuple, dataclass, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from measure import Row, Value, at_least, in_turn

from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.errors import ConvergenceError
from petalfoil.physics.forces import node_area
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem

EXAMPLES = Path(__file__).parents[1] / "examples"
EPSILON = 1e-5
"""Accuracy of the paper: relative change between outer iterations."""
LEAST = 1e-10
"""Smallest `epsilon` that the classic method is run with."""
TARGET = 1000.0


@dataclass(frozen=True)
class Race:
    """One bearing of the paper on `nodes` by `stations` nodes (0 stations: 2-D), with a downward displacement.

    `engine` runs the inner loops of the classic method: "numba" or "numpy". With `turns` "loose" the tolerance of film
    and pack follows the last outer change. With "settled" both are solved to the accuracy of the paper in every outer
    iteration, as the paper words its algorithm.
    """

    petals: int
    nodes: int
    stations: int
    micrometres: int
    engine: str = "numba"
    turns: str = "loose"

    @property
    def name(self) -> str:
        """Key of the row."""
        word = "" if self.turns == "loose" else f"_{self.turns}"
        return f"race_n{self.petals}_{self.grid.replace('×', 'x')}_e{self.micrometres}_{self.engine}{word}"

    @property
    def patience(self) -> float:
        """Time limit over that of the loose races [1]."""
        return 1.0 if self.turns == "loose" else SETTLED[self.engine]

    @property
    def description(self) -> str:
        """Description of the row."""
        about = f"{self.petals} petals, {self.grid} nodes per petal, e = {self.micrometres} µm"
        how = self.engine if self.turns == "loose" else f"{self.engine}, as worded"
        return f"classic ({how}) over newton: {about}"

    @property
    def grid(self) -> str:
        """Nodes per petal."""
        return f"{self.nodes}×{self.stations}" if self.stations else f"{self.nodes}"

    def case(self) -> Case:
        """The bearing with the number of cells per pitch that gives this number of nodes per petal."""
        case = Case.load(EXAMPLES / f"paper_n{self.petals}.toml")
        overlap = case.pack.overlap if case.pack is not None else 1.0
        changes: dict[str, object] = {
            "operation.eccentricity": (0.0, -1e-6 * self.micrometres),
            "model.cells_per_pitch": round((self.nodes - 1) / overlap),
        }
        if self.stations:
            changes |= {"model.kind": "3d", "model.axial_cells": self.stations - 1, "petals.theory": "inextensible"}
        return case.replace(**changes)


QUICK = (Race(8, 11, 0, 0, "numpy"),)
FULL = (
    *(Race(n, 24, 0, e) for n in (6, 8, 10) for e in (0, 200)),
    Race(8, 24, 0, 200, "numpy"),
    Race(8, 17, 0, 200),
    Race(8, 72, 0, 200),
    Race(8, 143, 0, 200),
    Race(8, 17, 11, 200),
    Race(8, 24, 17, 200),
    Race(8, 24, 17, 200, "numpy"),
    Race(8, 24, 17, 200, "numba", "settled"),
    Race(8, 24, 17, 200, "numpy", "settled"),
    Race(8, 35, 31, 200),
)
"""Numbers of nodes of the paper and coarser ones; in 2-D also finer ones, of 32 and 64 cells per pitch."""


def rows(races: tuple[Race, ...], limit: float, repeats: int) -> list[Row]:
    """A row for each race; the classic method has `limit` seconds in each."""
    if find_spec("petalfoil.classic") is None:
        return [Row("race", "classic over newton", None, remark="this version has no classic method")]
    compiles = find_spec("numba") is not None
    return [
        raced(race, limit, repeats)
        if compiles
        or (race.engine, race.turns)
        == ("numpy", "loose")  # settled turns in NumPy need the step counts of the compiled run
        else Row(race.name, race.description, None, remark="numba is not installed")
        for race in races
    ]


def raced(race: Race, limit: float, repeats: int) -> Row:
    """Time of the classic method over that of Newton's method, both from a cold start to the same solution."""
    problem = build_problem(race.case())
    with one_thread():
        newton = in_turn({"newton": lambda: solve_cold(problem)}, repeats)["newton"]
    lines, stopped = alone(race, limit * race.patience)
    details: dict[str, Value] = {"seconds_newton": newton, "unknowns": problem.layout.n}
    stops = [line for line in lines if "stop" in line]
    for line in stops:
        details |= {f"seconds to {line['stop']:.0e}": line["seconds"], f"apart at {line['stop']:.0e}": line["apart"]}
    if stops and stops[-1]["apart"] <= EPSILON:
        seconds, first = stops[-1]["seconds"], stops[0]
        remark = f"its own stop after {first['seconds'] / newton:.3g} times newton's time, {first['apart']:.0e} apart"
        return at_least(race.name, race.description, seconds / newton, TARGET, details=details, remark=remark)
    row = Row(race.name, race.description, None, f"≥ {TARGET:g}", details=details)
    if not stopped:
        why = next((line["error"] for line in lines if "error" in line), "it stopped before it reached the solution")
        return replace(row, remark=why)
    if (race.engine, race.turns) == ("numpy", "settled"):
        twin = replace(race, engine="numba")
        return by_steps(row, lines, alone(twin, limit * twin.patience)[0], newton)
    return unfinished(row, lines, newton, limit * race.patience)


def unfinished(row: Row, lines: list[dict[str, Any]], newton: float, limit: float) -> Row:
    """The row of a stopped classic method: extrapolated from the decrease of its changes, or the time limit."""
    changes = [line for line in lines if "change" in line]
    if not changes:
        return replace(row, remark=f"stopped after {limit:g} s, within its first outer iteration")
    needed, last = estimate(changes), changes[-1]
    if needed is None:
        least = last["seconds"] / newton
        remark = f"stopped at a change of {last['change']:.0e} that did not decrease steadily: lower limit"
        return replace(row, ratio=least, met=True if least >= TARGET else None, remark=remark)
    remark = f"estimated: stopped at a change of {last['change']:.0e}, extrapolated to {EPSILON:.0e}"
    details = row.details | {"seconds_measured": last["seconds"], "seconds_estimated": needed}
    return replace(row, ratio=needed / newton, met=needed / newton >= TARGET, remark=remark, details=details)


SETTLED = {"numba": 15.0, "numpy": 6.0}
"""Time limit of a race with settled turns over that of a loose one [1].

The compiled loops need five minutes. In NumPy the first outer iterations suffice to measure the time of a step.
"""


def by_steps(row: Row, lines: list[dict[str, Any]], twin: list[dict[str, Any]], newton: float) -> Row:
    """The row of a stopped run in NumPy: the time of its steps times the number of steps of the compiled run."""
    done = [line for line in lines if "change" in line]
    if len(done) < 3 or not twin or twin[-1].get("apart", math.inf) > EPSILON:
        return replace(row, remark="stopped before its steps could be timed, or the compiled run was")
    steps = np.array([[line["film_steps"], line["pack_steps"]] for line in done], dtype=float)
    cost = np.linalg.lstsq(steps, np.array([line["seconds"] for line in done]), rcond=None)[0]
    last = [line for line in twin if "change" in line][-1]
    needed = float(cost @ [last["film_steps"], last["pack_steps"]])
    remark = f"estimated: a step takes {1e6 * cost[0]:.0f} µs in the film, {1e6 * cost[1]:.0f} µs in the pack; the "
    remark += f"compiled run took {last['film_steps']:.3g} and {last['pack_steps']:.3g}"
    details = row.details | {"seconds_measured": done[-1]["seconds"], "seconds_estimated": needed}
    return replace(row, ratio=needed / newton, met=needed / newton >= TARGET, remark=remark, details=details)


STEADY = 0.1
"""Limit of the change over the second half of a run, and of its decrease there, for an extrapolation."""


def estimate(changes: list[dict[str, Any]]) -> float | None:
    """Time to the accuracy of the paper by extrapolation of the second half [s]; None without a steady decrease."""
    late = changes[len(changes) // 2 :]
    seconds, level = np.array([line["seconds"] for line in late]), np.log([line["change"] for line in late])
    if len(late) < 3 or level[0] > math.log(STEADY) or level[-1] > level[0] + math.log(STEADY):
        return None
    slope, start = np.polyfit(seconds, level, 1)
    return float((math.log(EPSILON) - start) / slope)


def compared_results(problem: CoupledProblem, x: Any, lam: Any) -> np.ndarray:
    """Force on the journal, minimum film thickness and peak pressure, each over its scale."""
    layout, pressure = problem.layout, problem.pressure(x)
    load = problem.journal_force(x, lam) * layout.scales.force
    lift = np.sum((pressure - 1.0) * node_area(layout.wall.film, layout.balance.radius)) * layout.scales.pressure
    return np.array([*(load / lift), problem.film(x).min(), pressure.max()])


@cache
def alone(race: Race, limit: float) -> tuple[list[dict[str, Any]], bool]:
    """Lines of the classic method from its own process, and whether the limit of processor time [s] ended it."""
    call = [sys.executable, str(Path(__file__)), *map(str, astuple(race)), str(math.ceil(limit))]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    whole = [line for line in done.stdout.splitlines(keepends=True) if line.endswith("\n")]
    return [json.loads(line) for line in whole], done.returncode == -signal.SIGXCPU


# ---------------------------------------------------------------------------------------------- in that process


def run_classic(race: Race) -> None:
    """Print a line for each outer iteration and each stop, until the solution is that of Newton's method."""
    from petalfoil.classic.kernels import KernelBackend
    from petalfoil.classic.method_options import ClassicOptions
    from petalfoil.classic.relaxation import ClassicRun, relax

    problem = build_problem(race.case())
    found = solve_cold(problem)
    reference = compared_results(problem, found.x, found.lam)
    engine = KernelBackend(race.engine)
    with contextlib.suppress(ConvergenceError):  # compiles the loops
        relax(ClassicRun(build_problem(Race(6, 9, 0, 0).case()), ClassicOptions(max_outer=1), engine))
    start = time.process_time()

    def tell(row: dict[str, Any]) -> None:
        change = max(row["pressure_change"], row["film_change"])
        steps = {name: row[name] for name in ("film_steps", "pack_steps")}
        say({"seconds": time.process_time() - start, "change": change, **steps})

    def options(epsilon: float) -> ClassicOptions:
        plain = ClassicOptions(epsilon=epsilon)
        return plain if race.turns == "loose" else replace(plain, loosest_inner_tolerance=epsilon)

    state, epsilon, apart = None, EPSILON, math.inf
    while apart > EPSILON and epsilon > LEAST:
        try:
            state = relax(ClassicRun(problem, options(epsilon), engine, tell), state)
        except ConvergenceError as failure:
            say({"error": str(failure)})
            return
        reached = compared_results(problem, np.concatenate([state.w, state.P]), state.lam)
        apart = float(np.max(np.abs(reached / reference - 1.0), where=np.abs(reference) > 1e-9, initial=0.0))
        say({"seconds": time.process_time() - start, "stop": epsilon, "apart": apart})
        epsilon *= 0.1


def say(line: dict[str, Any]) -> None:
    """Print and flush one line: the process may be stopped at any time."""
    sys.stdout.write(json.dumps(line) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[7]), resource.RLIM_INFINITY))
    run_classic(Race(*map(int, sys.argv[1:5]), *sys.argv[5:7]))
