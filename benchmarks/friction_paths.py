"""What friction along a path at rest gives over the grid, with contact points and with contacts at nodes.

    python -m benchmarks.friction_paths

Starting moment of the assembled pack and at the end, force at the largest displacement, width of the loop in its
middle, energy of a cycle: the rig down to 10 um and the paper's eight petals down to 100 um and back. Writes the table
of `docs/decisions/033-friction-paths.md`; some two minutes.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from petalfoil import Case
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.static import static

EXAMPLES = Path(__file__).parents[1] / "examples"
DEEPEST = {"rig": 10e-6, "paper_n8": 100e-6}
"""Largest displacement [m]."""
PLACES = 5
"""Displacements on each leg."""


def row(name: str, friction: float, contacts: str, cells: int) -> str:
    """One loop as a row of the table."""
    changes = {"model.cells_per_pitch": cells, "surface.petal_friction": friction, "model.contacts": contacts}
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


def main() -> None:
    """Print the table."""
    print("| bearing, friction | contacts | cells | moment | moment at the end | force | width | energy of a cycle |")
    print("|---|---|---:|" + "---:|" * 5)
    with one_thread():
        for name in DEEPEST:
            for friction in (0.1, 0.3):
                for contacts in ("nodes", "points"):
                    for cells in (24, 48, 96):
                        print(row(name, friction, contacts, cells), flush=True)


if __name__ == "__main__":
    main()
