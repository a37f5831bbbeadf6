"""Accuracy of the default 3-D grid: results, stiffness and damping against a fine grid, and whether error bars hold.

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md

Four of the paper's packs at the speed of the case files, and the rig under its first load: 64 × 24 cells against
128 × 48, both with their default stations, with petals that stretch and with petals that bend only. Then the rig's
lift-off speed. Ten minutes on one core and a gigabyte for petals that bend only, an hour and 4 GB for those that
stretch. A theory and cases may be named, and `lift-off`: the other rows of the page stay.

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md shell "rig" "6 petals, 100 µm"
"""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from petalfoil import Case
from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.crossings import CONTACT_FRACTION, crossing, walk
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

THEORIES = {
    "shell": "Petals that stretch (the default)",
    "inextensible": "Petals that bend only, as the paper's",
}
"""Headings of the tables, by `petals.theory`."""

COARSER = {("shell", "10 petals, 280 µm"): (96, 36)}
"""Fine grids where twice the default takes too much: 6 GB of memory."""

SHOWN = {
    "bearing_force": "bearing force",
    "min_film_thickness": "minimum film thickness",
    "peak_pressure": "peak pressure",
    "friction_torque": "friction torque",
    "contact_fraction": "contact fraction",
}
HEAD = """# Accuracy of the default grid in 3-D

64 × 24 cells against 128 × 48 or the grid that is named, stations as by default on both, contact lines between nodes
([decision 023](../decisions/023-contact-lines.md)). Written on {day} by

    python benchmarks/accuracy_3d.py docs/validation/accuracy-3d.md

Packs of 6, 8 and 10 petals are those of `examples/paper_n6.toml` and its neighbours, displaced downward; the rig is
`examples/rig.toml` in 3-D at 8800 rpm under 46.4 N. Differences are those of the default grid from the fine one; of
stiffness and damping (at synchronous whirl) the largest difference of an entry over the largest entry. The lift-off
speed is that at which the contact fraction falls below 1 %, from 10 500 rpm upward. Error bars of the default grid
(`--error`) come from 32 × 12, 64 × 24 and 128 × 48 cells: they cover the differences from 128 × 48 by construction, so
that this page is no test of them.
"""

NOTES = {
    "shell": """The row of ten petals is of stations adapted to a coarse solution, with contacts at nodes
on 64 × 24 cells. On those that are now the default, crowded at the petals' sides
([decision 018](../decisions/018-axial-stations.md)), ten petals have contact lines on 64 × 24 cells too
([decision 023](../decisions/023-contact-lines.md)).

Lift-off of the rig: 1255 rad/s on 64 × 24 cells, 1265 on 64 × 48, 1256 on 96 × 36 (as the row below is made, 26
November 2026).
""",
    "inextensible": "",
}
"""What a table does not say, below it."""


@dataclass(frozen=True)
class GridResults:
    """Results of a case on one grid."""

    scalars: dict[str, float]
    stiffness: NDArray[np.float64]
    damping: NDArray[np.float64]


def cases(theory: str) -> dict[str, Case]:
    """The bearings with petals of a theory, by name."""
    spatial = {"model.kind": "3d", "petals.theory": theory}
    packs = {
        f"{count} petals, {e} µm": Case.load(EXAMPLES / f"paper_n{count}.toml").replace(
            **spatial, **{"operation.eccentricity": ["0 um", f"-{e} um"]}
        )
        for count, e in PACKS
    }
    rig = {**spatial, "operation.speed": "8800 rpm", "operation.load": "46.4 N"}
    return packs | {"rig": Case.load(EXAMPLES / "rig.toml").replace(**rig)}


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


def row(theory: str, name: str) -> str:
    """A row of the table."""
    case, grid = cases(theory)[name], COARSER.get((theory, name), FINE)
    coarse, fine = results(on_grid(case, DEFAULT)), results(on_grid(case, grid))
    cells = []
    for key in SHOWN:
        limit = fine.scalars[key]
        cells.append("–" if limit == 0.0 else f"{100.0 * (coarse.scalars[key] / limit - 1.0):+.2f} %")
    cells += [
        f"{apart(one, other):.2f} %"
        for one, other in ((coarse.stiffness, fine.stiffness), (coarse.damping, fine.damping))
    ]
    return f"| {name} | {grid[0]} × {grid[1]} | {' | '.join(cells)} |"


def liftoff_row(rig: Case) -> str:
    """Lift-off speeds of the rig on the grids [rad/s], from below."""
    speeds = []
    for grid in LIFTOFF_GRIDS:
        case = with_stations(on_grid(rig, grid))
        load = case.operation.load or (0.0, 0.0)
        with running():
            speeds.append(
                crossing(SpeedLine(case, load), walk(case, TOUCHING), CONTACT_FRACTION, upward=True) or math.nan
            )
    return f"| {LIFTOFF} | {' | '.join(f'{speed:.1f}' for speed in speeds)} |"


def table(head: list[str], rows: list[str]) -> str:
    """A table in Markdown."""
    return "\n".join(["| " + " | ".join(head) + " |", "|---|" + "---:|" * (len(head) - 1), *rows])


Rows = dict[tuple[str, str], str]
"""Rows of the page, by theory and name."""


def page(rows: Rows) -> str:
    """The page with the rows that there are."""
    titles = ["bearing", "fine grid", *SHOWN.values(), "stiffness", "damping"]
    parts = [HEAD.format(day=date.today().isoformat())]
    for theory, heading in THEORIES.items():
        lines = [rows[theory, name] for name in cases(theory) if (theory, name) in rows]
        parts.append(f"## {heading}\n\n{table(titles, lines)}\n")
        parts += [NOTES[theory]] if NOTES[theory] else []
        if (theory, LIFTOFF) in rows:
            grids = [f"{cells} × {axial}" for cells, axial in LIFTOFF_GRIDS]
            head = ["lift-off speed of the rig under 46.4 N, rad/s", *grids]
            parts.append(table(head, [rows[theory, LIFTOFF]]) + "\n")
    return "\n".join(parts)


def read(path: Path) -> Rows:
    """The rows of a page that there is."""
    rows: Rows = {}
    sections = path.read_text(encoding="utf-8").split("\n## ") if path.exists() else []
    for theory, heading in THEORIES.items():
        lines = [line for section in sections if section.startswith(heading) for line in section.splitlines()]
        names = (*cases(theory), LIFTOFF)
        rows |= {(theory, name): line for line in lines for name in names if line.startswith(f"| {name} |")}
    return rows


def main(path: Path, theories: list[str], names: list[str]) -> None:
    """Write the page, row by row; rows that are not asked for stay."""
    err, rows = Console(stderr=True, highlight=False), read(path)
    for theory in theories:
        for name in names or [*cases(theory), LIFTOFF]:
            rows[theory, name] = liftoff_row(cases(theory)["rig"]) if name == LIFTOFF else row(theory, name)
            err.print(rows[theory, name])
            path.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit("usage: python benchmarks/accuracy_3d.py FILE.md [THEORY [CASE ...]]")
    main(Path(sys.argv[1]), sys.argv[2:3] or list(THEORIES), sys.argv[3:])
