"""petalfoil's Newton against the paper's own method, on the paper's packages and grids.

    python benchmarks/race.py PETALS NODES STATIONS MICROMETRES ENGINE TURNS    the classic method alone, JSON lines

The classic method runs in a process of its own, which is stopped when its time is up; what it would have needed is then
estimated from how its changes fell. As the paper words it (`TURNS` is "settled") each turn settles film and package;
in NumPy that takes some two hours, which are estimated from the steps that the compiled twin takes.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
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
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import ConvergenceError
from petalfoil.physics.forces import contact_force, film_force, node_area
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem

EXAMPLES = Path(__file__).parents[1] / "examples"
EPSILON = 1e-5
"""Accuracy of the paper: relative change from one outer iteration to the next."""
LEAST = 1e-10
"""The classic method is not asked for more."""
WANTED = 1000.0


@dataclass(frozen=True)
class Lane:
    """One package of the paper on `nodes` by `stations` nodes a petal (no stations: flat), displaced downward.

    `engine` is what runs the inner loops of the classic method: numba, which compiles them, or numpy. `turns` are
    "loose", film and package as close as the last outer change asks for, or "settled", both to the paper's accuracy in
    every turn, as it words its algorithm.
    """

    petals: int
    nodes: int
    stations: int
    micrometres: int
    engine: str = "numba"
    turns: str = "loose"

    @property
    def name(self) -> str:
        """Key of its row."""
        word = "" if self.turns == "loose" else f"_{self.turns}"
        return f"race_n{self.petals}_{self.grid.replace('×', 'x')}_e{self.micrometres}_{self.engine}{word}"

    @property
    def patience(self) -> float:
        """Times the limit of the loose races that it is given."""
        return 1.0 if self.turns == "loose" else SETTLED[self.engine]

    @property
    def says(self) -> str:
        """What its row says."""
        about = f"{self.petals} petals, {self.grid} nodes a petal, e = {self.micrometres} µm"
        how = self.engine if self.turns == "loose" else f"{self.engine}, as worded"
        return f"classic ({how}) over newton: {about}"

    @property
    def grid(self) -> str:
        """Nodes a petal."""
        return f"{self.nodes}×{self.stations}" if self.stations else f"{self.nodes}"

    def case(self) -> Case:
        """The package; the cells a pitch that give a petal that many nodes."""
        case = Case.load(EXAMPLES / f"paper_n{self.petals}.toml")
        overlap = case.package.overlap if case.package is not None else 1.0
        changes: dict[str, object] = {
            "operation.eccentricity": (0.0, -1e-6 * self.micrometres),
            "model.cells_per_pitch": round((self.nodes - 1) / overlap),
        }
        if self.stations:
            changes |= {"model.kind": "3d", "model.axial_cells": self.stations - 1}
        return case.replace(**changes)


QUICK = (Lane(8, 14, 0, 0, "numpy"),)
FULL = (
    *(Lane(n, 24, 0, e) for n in (6, 8, 10) for e in (0, 200)),
    Lane(8, 24, 0, 200, "numpy"),
    Lane(8, 17, 0, 200),
    Lane(8, 72, 0, 200),
    Lane(8, 143, 0, 200),
    Lane(8, 17, 11, 200),
    Lane(8, 24, 17, 200),
    Lane(8, 24, 17, 200, "numpy"),
    Lane(8, 24, 17, 200, "numba", "settled"),
    Lane(8, 24, 17, 200, "numpy", "settled"),
    Lane(8, 35, 31, 200),
)
"""Nodes a petal as in the paper and coarser; and finer ones flat: 32 and 64 cells a pitch."""


def rows(lanes: tuple[Lane, ...], limit: float, repeats: int) -> list[Row]:
    """A row for each lane; the classic method has `limit` seconds in each."""
    if find_spec("petalfoil.classic") is None:
        return [Row("race", "classic over newton", None, remark="this version has no classic method")]
    compiles = find_spec("numba") is not None
    return [
        raced(lane, limit, repeats)
        if compiles or (lane.engine, lane.turns) == ("numpy", "loose")  # as worded, NumPy asks its compiled twin
        else Row(lane.name, lane.says, None, remark="numba is not installed")
        for lane in lanes
    ]


def raced(lane: Lane, limit: float, repeats: int) -> Row:
    """Time of the classic method over that of Newton, both from nothing, to the same answer."""
    problem = build_problem(lane.case())
    with one_thread():
        newton = in_turn({"newton": lambda: solve_cold(problem, RunLog())}, repeats)["newton"]
    lines, stopped = alone(lane, limit * lane.patience)
    details: dict[str, Value] = {"seconds_newton": newton, "unknowns": problem.layout.n}
    stops = [line for line in lines if "stop" in line]
    for line in stops:
        details |= {f"seconds to {line['stop']:.0e}": line["seconds"], f"apart at {line['stop']:.0e}": line["apart"]}
    if stops and stops[-1]["apart"] <= EPSILON:
        seconds, first = stops[-1]["seconds"], stops[0]
        remark = f"its own stop after {first['seconds'] / newton:.3g} times newton's time, {first['apart']:.0e} apart"
        return at_least(lane.name, lane.says, seconds / newton, WANTED, details=details, remark=remark)
    row = Row(lane.name, lane.says, None, f"≥ {WANTED:g}", details=details)
    if not stopped:
        why = next((line["error"] for line in lines if "error" in line), "it stopped short of the answer")
        return replace(row, remark=why)
    if (lane.engine, lane.turns) == ("numpy", "settled"):
        twin = replace(lane, engine="numba")
        return by_steps(row, lines, alone(twin, limit * twin.patience)[0], newton)
    return unfinished(row, lines, newton, limit * lane.patience)


def unfinished(row: Row, lines: list[dict[str, Any]], newton: float, limit: float) -> Row:
    """The row of a classic method that was stopped: estimated from how its changes fell, else what was waited for."""
    changes = [line for line in lines if "change" in line]
    if not changes:
        return replace(row, remark=f"stopped after {limit:g} s, within its first outer iteration")
    needed, last = estimate(changes), changes[-1]
    if needed is None:
        least = last["seconds"] / newton
        remark = f"stopped at a change of {last['change']:.0e} that did not fall steadily: at least this"
        return replace(row, ratio=least, met=True if least >= WANTED else None, remark=remark)
    remark = f"estimated: stopped at a change of {last['change']:.0e}, to fall to {EPSILON:.0e} at its rate"
    details = row.details | {"seconds_measured": last["seconds"], "seconds_estimated": needed}
    return replace(row, ratio=needed / newton, met=needed / newton >= WANTED, remark=remark, details=details)


SETTLED = {"numba": 15.0, "numpy": 6.0}
"""Times the limit of the other races that one with settled turns is given: compiled it needs five minutes; in NumPy the
first turns tell what a step costs."""


def by_steps(row: Row, lines: list[dict[str, Any]], twin: list[dict[str, Any]], newton: float) -> Row:
    """The row of a run in NumPy that was stopped: what its steps cost, times those that its compiled twin took."""
    done = [line for line in lines if "change" in line]
    if len(done) < 3 or not twin or twin[-1].get("apart", math.inf) > EPSILON:
        return replace(row, remark="stopped before its steps could be timed, or its compiled twin was")
    steps = np.array([[line["film_steps"], line["pack_steps"]] for line in done], dtype=float)
    cost = np.linalg.lstsq(steps, np.array([line["seconds"] for line in done]), rcond=None)[0]
    last = [line for line in twin if "change" in line][-1]
    needed = float(cost @ [last["film_steps"], last["pack_steps"]])
    remark = f"estimated: a step takes {1e6 * cost[0]:.0f} µs in the film, {1e6 * cost[1]:.0f} µs in the package; its "
    remark += f"compiled twin took {last['film_steps']:.3g} and {last['pack_steps']:.3g}"
    details = row.details | {"seconds_measured": done[-1]["seconds"], "seconds_estimated": needed}
    return replace(row, ratio=needed / newton, met=needed / newton >= WANTED, remark=remark, details=details)


STEADY = 0.1
"""A change below this over the second half of a run, and tenfold less at its end, falls steadily."""


def estimate(changes: list[dict[str, Any]]) -> float | None:
    """Time to the paper's accuracy from how the changes fell over the second half [s]; None if they did not."""
    late = changes[len(changes) // 2 :]
    seconds, level = np.array([line["seconds"] for line in late]), np.log([line["change"] for line in late])
    if len(late) < 3 or level[0] > math.log(STEADY) or level[-1] > level[0] + math.log(STEADY):
        return None
    slope, start = np.polyfit(seconds, level, 1)
    return float((math.log(EPSILON) - start) / slope)


def figures(problem: CoupledProblem, x: Any, lam: Any) -> np.ndarray:
    """Force on the journal, smallest film and largest pressure, each over what it is measured by."""
    film, pressure, journal = problem.layout.wall.film, problem.pressure(x), problem.layout.wall.contacts.journal
    push = film_force(film, 1.0, pressure - 1.0) * problem.layout.scales.pressure
    touching = lam[journal].reshape(*film.theta.shape, -1).sum(axis=2) * problem.layout.scales.force
    load = push + contact_force(film.theta, touching)[0]
    lift = np.sum((pressure - 1.0) * node_area(film, 1.0)) * problem.layout.scales.pressure
    return np.array([*(load / lift), problem.film(x).min(), pressure.max()])


@cache
def alone(lane: Lane, limit: float) -> tuple[list[dict[str, Any]], bool]:
    """Lines of the classic method in its own process, and whether its time was up."""
    call = [sys.executable, str(Path(__file__)), *map(str, astuple(lane))]
    try:
        text, ended = subprocess.run(call, capture_output=True, text=True, timeout=limit, check=False).stdout, False
    except subprocess.TimeoutExpired as expired:
        kept = expired.stdout or b""
        text, ended = kept.decode() if isinstance(kept, bytes) else kept, True
    whole = [line for line in text.splitlines(keepends=True) if line.endswith("\n")]
    return [json.loads(line) for line in whole], ended


# ---------------------------------------------------------------------------------------------- in that process


def run_classic(lane: Lane) -> None:
    """Print a line for each outer iteration and for each stop, until the answer is that of Newton."""
    from petalfoil.classic.kernels import Engine
    from petalfoil.classic.method_options import ClassicOptions
    from petalfoil.classic.relaxation import ClassicRun, relax

    problem = build_problem(lane.case())
    found = solve_cold(problem, RunLog())
    wanted = figures(problem, found.x, found.lam)
    engine = Engine(lane.engine)
    with contextlib.suppress(ConvergenceError):  # compiles, where something compiles
        relax(ClassicRun(build_problem(Lane(6, 9, 0, 0).case()), ClassicOptions(max_outer=1), engine))
    start = time.process_time()

    def tell(row: dict[str, Any]) -> None:
        change = max(row["pressure_change"], row["film_change"])
        steps = {name: row[name] for name in ("film_steps", "pack_steps")}
        say({"seconds": time.process_time() - start, "change": change, **steps})

    def options(epsilon: float) -> ClassicOptions:
        plain = ClassicOptions(epsilon=epsilon)
        return plain if lane.turns == "loose" else replace(plain, loosest_inner_tolerance=epsilon)

    state, epsilon, apart = None, EPSILON, math.inf
    while apart > EPSILON and epsilon > LEAST:
        try:
            state = relax(ClassicRun(problem, options(epsilon), engine, tell), state)
        except ConvergenceError as failure:
            say({"error": str(failure)})
            return
        reached = figures(problem, np.concatenate([state.w, state.P]), state.lam)
        apart = float(np.max(np.abs(reached / wanted - 1.0), where=np.abs(wanted) > 1e-9, initial=0.0))
        say({"seconds": time.process_time() - start, "stop": epsilon, "apart": apart})
        epsilon *= 0.1


def say(line: dict[str, Any]) -> None:
    """Print one line at once: the process may be stopped at any time."""
    sys.stdout.write(json.dumps(line) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    run_classic(Lane(*map(int, sys.argv[1:5]), *sys.argv[5:7]))
