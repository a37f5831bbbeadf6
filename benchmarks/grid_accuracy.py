"""How far coarse and default grids are from a fine one, on the paper's packs: the table of *How far to trust it*.

    python benchmarks/grid_accuracy.py docs/validation/grid-accuracy.md

6, 8 and 10 petals displaced by 0 to 280 µm, in 2-D against 512 cells per pitch, in 3-D against 96 × 48. Five minutes on
one core, nearly all of it for the fine 3-D grid.
"""

from __future__ import annotations

import sys
from datetime import date
from pathlib import Path

import numpy as np
from rich.console import Console

import petalfoil
from petalfoil import Case

EXAMPLES = Path(__file__).parents[1] / "examples"
COUNTS, DISPLACEMENTS = (6, 8, 10), (0, 100, 200, 280)  # the latter in µm, downward

Grid = tuple[int, int | None]  # cells per pitch, and over the length
GRIDS: dict[str, tuple[Grid, ...]] = {"2d": ((32, None), (64, None), (128, None)), "3d": ((32, 16), (64, 24))}
FINE: dict[str, Grid] = {"2d": (512, None), "3d": (96, 48)}
MODELS = {"2d": "2-D", "3d": "3-D"}
DEFAULT = ((128, None), (64, 24))

SHOWN = {
    "bearing_force": "bearing force",
    "min_film_thickness": "minimum film thickness",
    "peak_pressure": "peak pressure",
    "friction_torque": "friction torque",
}
LEAST_FORCE = 0.1
"""Forces below it [N] are those of a centred journal, zero but for rounding, and have no relative difference."""

HEAD = """# Coarse and default grids

The largest difference of a result from that on a fine grid, 512 cells per pitch in 2-D and 96 × 48 in 3-D, over the
paper's foil packs (`examples/paper_n6.toml` and its neighbours) displaced downward by 0, 100, 200 and 280 µm. Recorded
on {day} by

    python benchmarks/grid_accuracy.py docs/validation/grid-accuracy.md

In 3-D stations are adapted to a coarse solution, as by default
([decision 018](../decisions/018-axial-stations.md)). Stiffness, damping and the default 3-D grid against a finer one
still: [accuracy in 3-D](accuracy-3d.md).

"""


def results(count: int, e: int, kind: str, grid: Grid) -> dict[str, float]:
    """Results of a pack at a displacement [µm] on a grid, by key."""
    case = Case.load(EXAMPLES / f"paper_n{count}.toml").replace(
        **{
            "model.kind": kind,
            "petals.theory": "inextensible",
            "model.cells_per_pitch": grid[0],
            "model.axial_cells": grid[1],
            "operation.eccentricity": ["0 um", f"-{e} um"],
        }
    )
    point = petalfoil.solve(case)
    return {key: float(point[key]) for key in SHOWN}


def difference(value: float, limit: float, key: str) -> float:
    """Relative difference [%]; NaN for a force that is zero."""
    if key == "bearing_force" and abs(limit) < LEAST_FORCE:
        return float("nan")
    return 100.0 * abs(value / limit - 1.0)


def name(kind: str, grid: Grid) -> str:
    """A grid as the table shows it."""
    cells = str(grid[0]) if grid[1] is None else f"{grid[0]} × {grid[1]}"
    return f"{MODELS[kind]}, {cells}" + (" (default)" if grid in DEFAULT else "")


def main(path: Path) -> None:
    """Write the page."""
    err = Console(stderr=True, highlight=False)
    titles = ["cells per pitch (× along the axis)", *(f"{title} within" for title in SHOWN.values())]
    lines = [f"| {' | '.join(titles)} |", "|---|" + "---:|" * len(SHOWN)]
    for kind, grids in GRIDS.items():
        found: dict[Grid, list[list[float]]] = {grid: [] for grid in grids}
        for count, e in ((count, e) for count in COUNTS for e in DISPLACEMENTS):
            limit = results(count, e, kind, FINE[kind])
            for grid, rows in found.items():
                values = results(count, e, kind, grid)
                rows.append([difference(values[key], limit[key], key) for key in SHOWN])
            err.print(
                f"{MODELS[kind]}, {count} petals, {e} µm: " + str([np.round(rows[-1], 2) for rows in found.values()])
            )
        for grid, rows in found.items():
            lines.append(f"| {name(kind, grid)} | " + " | ".join(f"{x:.2g} %" for x in np.nanmax(rows, axis=0)) + " |")
    path.write_text(HEAD.format(day=date.today().isoformat()) + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python benchmarks/grid_accuracy.py FILE.md")
    main(Path(sys.argv[1]))
