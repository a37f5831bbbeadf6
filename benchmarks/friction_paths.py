"""What friction along a path at rest gives over the grid, with contact points and with contacts at nodes.

    python -m benchmarks.friction_paths
    python -m benchmarks.friction_paths 3d
    python -m benchmarks.friction_paths loads

Starting moment of the assembled pack and at the end, force at the largest displacement, width of the loop in its
middle, energy of a cycle: the rig down to 10 um and the paper's eight petals down to 100 um and back. Writes the tables
of `docs/decisions/033-friction-paths.md`: two minutes in 2-D. `3d rig nodes 32` is one row in 3-D; with contact lines
that of 32 x 12 cells takes three minutes. `loads` balances loads in 3-D with the friction of assembly and run-up:
position, minimum film thickness and energy lost; `loads rig lines 16` is one row.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from petalfoil import Case
from petalfoil.analysis.balance import balance
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.static import static

EXAMPLES = Path(__file__).parents[1] / "examples"
DEEPEST = {"rig": 10e-6, "paper_n8": 100e-6}
"""Largest displacement [m]."""
PLACES = 5
"""Displacements on each leg."""


AXIAL = {16: 6, 24: 8, 32: 12}
"""Cells along the shaft by those per pitch, in 3-D."""


def row(name: str, friction: float, contacts: str, cells: int, kind: str = "2d") -> str:
    """One loop as a row of the table."""
    changes = {"model.cells_per_pitch": cells, "surface.petal_friction": friction, "model.contacts": contacts}
    if kind == "3d":
        changes |= {"model.kind": kind, "model.axial_cells": AXIAL[cells]}
    bearing = Case.load(EXAMPLES / f"{name}.toml").replace(**changes)
    points = [record.scalars for record in static.records(bearing, np.linspace(0.0, DEEPEST[name], PLACES), loop=True)]
    force, work, moment = (
        np.array([float(point[key]) for point in points])
        for key in ("force_y", "petal_friction_work", "starting_torque")
    )
    top, middle = PLACES - 1, PLACES // 2
    back, again = force[top + middle], force[2 * top + middle]
    values = (
        f"{moment[0]:.4f}", f"{moment[2 * top]:.4f}", f"{force[top]:.3f}", f"{again - back:.3f}",
        f"{1e6 * (work[-1] - work[top]):.2f}",
    )  # fmt: skip
    return " | ".join([f"| {name}, {friction:g}", contacts, str(cells), *values]) + " |"


LOADS = {"rig": (55.6, 1000.0), "paper_n8_spatial": (5.0, 1500.0)}
"""Load [N] and speed [rad/s] of a balance."""


def loaded_row(name: str, contacts: str, cells: int) -> str:
    """One balance as a row of the table."""
    load, speed = LOADS[name]
    kept = {"surface.petal_friction": 0.1, "surface.friction_history": "assembled", "petals.theory": "shell"}
    grid = {"model.kind": "3d", "model.cells_per_pitch": cells, "model.axial_cells": AXIAL[cells]}
    held = {"model.contacts": "nodes" if contacts == "nodes" else "points"}
    bearing = Case.load(EXAMPLES / f"{name}.toml").replace(**kept, **grid, **held)
    found = balance.record(bearing, load=(0.0, -load), speed=speed).scalars
    micro = [1e6 * float(found[key]) for key in ("eccentricity_y", "min_film_thickness", "petal_friction_work")]
    counts = [str(found[key]) for key in ("factorizations", "pack_iterations")]
    return (
        " | ".join([f"| {name}", contacts, f"{cells} × {AXIAL[cells]}", *(f"{x:.3f}" for x in micro), *counts]) + " |"
    )


def loaded_rows(asked: list[str]) -> Iterator[str]:
    """The balances that are asked for, all without any."""
    yield "| bearing | contacts | cells | position | min film | energy lost | factorisations with film | of the pack |"
    yield "|---|---|---:|" + "---:|" * 5
    if asked:
        yield loaded_row(asked[0], asked[1], int(asked[2]))
        return
    for name in LOADS:
        for contacts in ("nodes", "lines"):
            for cells in AXIAL:
                yield loaded_row(name, contacts, cells)


def asked_rows(asked: list[str]) -> Iterator[str]:
    """The rows that are asked for."""
    kind, names, models, grids = "2d", list(DEEPEST), ["nodes", "points"], [24, 48, 96]
    if asked:
        kind, grids = asked[0], list(AXIAL)
    if asked[1:]:
        names, models, grids = [asked[1]], [asked[2]], [int(asked[3])]
    for name in names:
        for friction in (0.1, 0.3) if kind == "2d" else (0.1,):
            for contacts in models:
                for cells in grids:
                    yield row(name, friction, contacts, cells, kind)


def main() -> None:
    """Print the table."""
    if sys.argv[1:2] == ["loads"]:
        with one_thread():
            for line in loaded_rows(sys.argv[2:]):
                print(line, flush=True)
        return
    print("| bearing, friction | contacts | cells | moment | moment at the end | force | width | energy of a cycle |")
    print("|---|---|---:|" + "---:|" * 5)
    with one_thread():
        for line in asked_rows(sys.argv[1:]):
            print(line, flush=True)


if __name__ == "__main__":
    main()
