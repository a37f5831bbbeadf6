"""Accuracy of the default 3-D grid: results, stiffness and damping against a fine grid, and whether error bars hold.

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md

Four of the paper's packs at the speed of the case files, and the rig under its first load: 64 × 24 cells against
128 × 48, both with adapted stations. Then the rig's lift-off speed. Ten minutes on one core, a gigabyte for 10 petals.
Cases may be named, and `lift-off`: the other rows of the page stay.
"""

from __future__ import annotations

import math
import re
import sys
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

import petalfoil
from petalfoil import Case
from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.crossings import CONTACT_FRACTION, crossing
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.impedance import elastic, impedances
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.equilibrium.run_context import running

EXAMPLES = Path(__file__).parents[1] / "examples"
DEFAULT, FINE = (64, 24), (128, 48)

LIFTOFF = "lift-off"
LIFTOFF_GRIDS = ((64, 24), (64, 48), (96, 48))
TOUCHING = 10500.0 * math.pi / 30.0
"""Speed at which the rig touches under its first load [rad/s]."""

PACKS = ((8, 200), (8, 280), (10, 280), (6, 100))
"""Petals, and displacement downward [µm]."""

BENDING = {"model.kind": "3d", "petals.theory": "inextensible"}
"""The paper's petals, which bend only."""

SHOWN = {
    "bearing_force": "bearing force",
    "min_film_thickness": "minimum film thickness",
    "peak_pressure": "peak pressure",
    "friction_torque": "friction torque",
    "contact_fraction": "contact fraction",
}
ALWAYS = ("max_bending_stress", "side_leakage", *SHOWN)
"""Results whose error bars are looked at."""

ROUNDING = 1e-9
"""Relative difference that is rounding."""

HEAD = """# Accuracy of the default grid in 3-D

64 × 24 cells against 128 × 48, stations adapted on both, contact lines between nodes
([decision 023](../decisions/023-contact-lines.md)). Written on {day} by

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md

Packs of 6, 8 and 10 petals are those of `examples/paper_n6.toml` and its neighbours, displaced downward; the rig is
`examples/rig.toml` in 3-D at 8800 rpm under 46.4 N. Petals bend only, as the paper's
(`petals.theory = "inextensible"`). Differences are those of the default grid from the fine one; of
stiffness and damping (at synchronous whirl) the largest difference of an entry over the largest entry. A bar holds if
the result on the fine grid is within it. The lift-off speed is that at which the contact fraction falls below 1 %, from
10 500 rpm upward.
"""


@dataclass(frozen=True)
class GridResults:
    """Results of a case on one grid."""

    scalars: dict[str, float]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]


def cases() -> dict[str, Case]:
    """The bearings, by name."""
    found = {
        f"{count} petals, {e} µm": Case.load(EXAMPLES / f"paper_n{count}.toml").replace(
            **BENDING, **{"operation.eccentricity": ["0 um", f"-{e} um"]}
        )
        for count, e in PACKS
    }
    rig = {**BENDING, "operation.speed": "8800 rpm", "operation.load": "46.4 N"}
    return found | {"rig": Case.load(EXAMPLES / "rig.toml").replace(**rig)}


def on_grid(case: Case, grid: tuple[int, int]) -> Case:
    """The case on a grid of cells per pitch and over the length."""
    return case.replace(**{"model.cells_per_pitch": grid[0], "model.axial_cells": grid[1]})


def results(case: Case) -> GridResults:
    """Equilibrium, stiffness and damping at synchronous whirl."""
    case = with_stations(case)
    with running():
        answer = operating_point(case, None).answer
        told = Evaluation.of(case, answer)
        speed = case.operation.speed
        ((K, C),) = impedances(elastic(case, answer), np.array([speed]), speed)
    parts = asdict(told.forces()) | asdict(told.film())
    scalars = {name: float(value) for name, value in parts.items() if isinstance(value, float)}
    return GridResults(scalars, np.asarray(K), np.asarray(C))


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Largest difference of an entry over the largest entry [%]."""
    return 100.0 * float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


def row(name: str, case: Case) -> str:
    """A row of the table."""
    barred = petalfoil.solve.record(on_grid(case, DEFAULT), error=True)
    coarse, fine = results(on_grid(case, DEFAULT)), results(on_grid(case, FINE))
    held = []
    for key in ALWAYS:
        value, error = float(barred.scalars.get(key, np.nan)), barred.errors.get(key)
        limit = fine.scalars.get(key, np.nan)
        if error is not None and np.isfinite(limit) and limit != 0.0:
            held.append(abs(value - limit) <= error + ROUNDING * abs(limit))
    cells = []
    for key in SHOWN:
        limit = fine.scalars[key]
        cells.append("–" if limit == 0.0 else f"{100.0 * (coarse.scalars[key] / limit - 1.0):+.2f} %")
    cells += [
        f"{apart(one, other):.2f} %"
        for one, other in ((coarse.stiffness, fine.stiffness), (coarse.damping, fine.damping))
    ]
    return f"| {name} | {' | '.join(cells)} | {sum(held)} of {len(held)} |"


def liftoff_row(rig: Case) -> str:
    """Lift-off speeds of the rig on the grids [rad/s], from below."""
    speeds = []
    for grid in LIFTOFF_GRIDS:
        case = with_stations(on_grid(rig, grid))
        load = case.operation.load or (0.0, 0.0)
        with running():
            speeds.append(crossing(SpeedLine(case, load), TOUCHING, CONTACT_FRACTION, upward=True) or math.nan)
    return f"| {LIFTOFF} | {' | '.join(f'{speed:.1f}' for speed in speeds)} |"


def table(head: list[str], rows: list[str]) -> str:
    """A table in Markdown."""
    return "\n".join(["| " + " | ".join(head) + " |", "|---|" + "---:|" * (len(head) - 1), *rows])


def page(rows: dict[str, str]) -> str:
    """The page with the rows that there are, by name."""
    titles = ["bearing", *SHOWN.values(), "stiffness", "damping", "bars that hold"]
    bearings = [rows[name] for name in cases() if name in rows]
    bars = [tuple(map(int, re.findall(r"(\d+) of (\d+) \|$", line)[0])) for line in bearings]
    holds, of = (sum(counts) for counts in zip(*bars, strict=True)) if bars else (0, 0)
    grids = [f"{cells} × {axial}" for cells, axial in LIFTOFF_GRIDS]
    speeds = table(
        ["lift-off speed of the rig under 46.4 N, rad/s", *grids], [rows[LIFTOFF]] if LIFTOFF in rows else []
    )
    head = HEAD.format(day=date.today().isoformat())
    return f"{head}\n{table(titles, bearings)}\n\n{holds} of {of} error bars hold.\n\n{speeds}\n"


def main(path: Path, names: list[str]) -> None:
    """Write the page, row by row; rows that are not asked for stay."""
    err, known = Console(stderr=True, highlight=False), cases()
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    rows = {name: line for line in lines for name in (*known, LIFTOFF) if line.startswith(f"| {name} |")}
    for name in names or [*known, LIFTOFF]:
        rows[name] = liftoff_row(known["rig"]) if name == LIFTOFF else row(name, known[name])
        err.print(rows[name])
        path.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python benchmarks/accuracy_3d.py FILE.md [CASE ...]")
    main(Path(sys.argv[1]), sys.argv[2:])
