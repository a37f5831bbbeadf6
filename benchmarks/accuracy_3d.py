"""Accuracy of the default 3-D grid: results, stiffness and damping against a fine grid, and whether error bars hold.

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md

Four of the paper's packs at the speed of the case files, and the rig under its first load: 64 × 24 cells against
128 × 48, both with adapted stations. Four minutes on one core; cases may be named to run some of them.
"""

from __future__ import annotations

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
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.impedance import elastic, impedances
from petalfoil.analysis.operating_point import operating_point
from petalfoil.equilibrium.run_context import running

EXAMPLES = Path(__file__).parents[1] / "examples"
DEFAULT, FINE = (64, 24), (128, 48)

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

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md{names}

Packs of 6, 8 and 10 petals are those of `examples/paper_n6.toml` and its neighbours, displaced downward; the rig is
`examples/rig.toml` in 3-D at 8800 rpm under 46.4 N. Petals bend only, as the paper's
(`petals.theory = "inextensible"`). Differences are those of the default grid from the fine one; of
stiffness and damping (at synchronous whirl) the largest difference of an entry over the largest entry. A bar holds if
the result on the fine grid is within it.
"""


@dataclass(frozen=True)
class Found:
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


def found(case: Case) -> Found:
    """Equilibrium, stiffness and damping at synchronous whirl."""
    case = with_stations(case)
    with running():
        answer = operating_point(case, None).answer
        told = Evaluation.of(case, answer)
        speed = case.operation.speed
        ((K, C),) = impedances(elastic(case, answer), np.array([speed]), speed)
    parts = asdict(told.forces()) | asdict(told.film())
    scalars = {name: float(value) for name, value in parts.items() if isinstance(value, float)}
    return Found(scalars, np.asarray(K), np.asarray(C))


def apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Largest difference of an entry over the largest entry [%]."""
    return 100.0 * float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


def row(name: str, case: Case) -> tuple[str, int, int]:
    """A row of the table, how many error bars hold, and of how many."""
    barred = petalfoil.solve.record(on_grid(case, DEFAULT), error=True)
    coarse, fine = found(on_grid(case, DEFAULT)), found(on_grid(case, FINE))
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
    return f"| {name} | {' | '.join(cells)} | {sum(held)} of {len(held)} |", sum(held), len(held)


def main(path: Path, names: list[str]) -> None:
    """Write the page."""
    err, known = Console(stderr=True, highlight=False), cases()
    titles = ["bearing", *SHOWN.values(), "stiffness", "damping", "bars that hold"]
    lines = ["| " + " | ".join(titles) + " |", "|---|" + "---:|" * (len(titles) - 1)]
    holds = total = 0
    for name in names or list(known):
        line, held, of = row(name, known[name])
        lines, holds, total = [*lines, line], holds + held, total + of
        err.print(line)
    named = "".join(f' "{name}"' for name in names)
    head = HEAD.format(day=date.today().isoformat(), names=named)
    path.write_text(f"{head}\n" + "\n".join(lines) + f"\n\n{holds} of {total} error bars hold.\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python benchmarks/accuracy_3d.py FILE.md [CASE ...]")
    main(Path(sys.argv[1]), sys.argv[2:])
