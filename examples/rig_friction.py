"""The rig of the paper's Table 1 with friction between its petals: run-up and coast-down, as tables and a figure.

    python examples/rig_friction.py FOLDER

The bearing is that of `rig.toml` on 32 cells per pitch, friction between petals and on the bushing that of the journal.
Writes the tables of docs/validation/rig-friction.md and its figure; about three minutes.
"""

from __future__ import annotations

import math
import sys
from itertools import pairwise
from pathlib import Path

from rich.console import Console

from petalfoil import Case
from petalfoil.analysis.runup import runup
from petalfoil.analysis.session import one_thread
from petalfoil.plot import style
from petalfoil.results.record import Record

RIG = Path(__file__).parent / "rig.toml"
CELLS, TOP, POINTS = 32, 12_000.0, 13
"""Cells per pitch, highest speed [rpm], speeds on the way up."""
LOADS = (46.4, 104.6)
"""Of experiments 1 and 4 [N]."""
FRICTIONS = (0.0, 0.1555)
MICRON = 1e6
ROWS = {
    "starting moment, N·m": ("friction_torque", 1.0, 0),
    "moment at the end of the coast-down, N·m": ("friction_torque", 1.0, -1),
    "energy lost between petals, µJ": ("petal_friction_work", MICRON, -1),
    "height of the journal at the start, µm": ("eccentricity_y", MICRON, 0),
    "height at the end, µm": ("eccentricity_y", MICRON, -1),
}


def run(friction: float, load: float) -> list[Record]:
    """Run-up and coast-down under a load."""
    case = Case.load(RIG).replace(**{"surface.petal_friction": friction, "model.cells_per_pitch": CELLS})
    case = case.replace(**{"model.contacts": "nodes"})  # as those of a path
    return list(runup.records(case, load=(0.0, -load), to=TOP * math.pi / 30.0, points=POINTS))


def value(record: Record, name: str) -> float:
    """A result of a point; 0 where it has none."""
    return float(record.scalars.get(name, 0.0))


def lift_off(records: list[Record], leg: str) -> float:
    """Speed at which the contact fraction passes 1 %, between points, on a leg [rpm]."""
    points = sorted(
        (value(record, "speed") * 30.0 / math.pi, value(record, "contact_fraction"))
        for record in records
        if record.scalars["leg"] == leg
    )
    for (slow, much), (fast, little) in pairwise(points):
        if much > 0.01 >= little:
            roots = [math.sqrt(share) for share in (much, 0.01, little)]
            return slow + (fast - slow) * (roots[0] - roots[1]) / (roots[0] - roots[2])
    return math.nan


def table(runs: dict[tuple[float, float], list[Record]]) -> str:
    """Rows of results, a column for each friction and load."""
    lines = [
        "| | " + " | ".join(f"{load:g} N, friction {mu:g}" for mu, load in runs) + " |",
        "|---|" + "---:|" * len(runs),
    ]
    for label, (name, unit, place) in ROWS.items():
        cells = [f"{unit * value(records[place], name):.4g}" for records in runs.values()]
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    for label, leg in (("lift-off, rpm", "up"), ("touchdown, rpm", "down")):
        lines.append(f"| {label} | " + " | ".join(f"{lift_off(records, leg):.0f}" for records in runs.values()) + " |")
    return "\n".join(lines)


def figure(runs: dict[tuple[float, float], list[Record]], path: Path) -> None:
    """Moment and height of the journal over speed, both ways."""
    fig = style.figure(10.0, 4.2)
    left, right = fig.subplots(1, 2)
    for (mu, load), records in runs.items():
        colour = {LOADS[0]: "C0", LOADS[1]: "C3"}[load]
        for leg, line in (("up", "-"), ("down", "--")):
            points = [record for record in records if record.scalars["leg"] == leg]
            if leg == "down":
                points = [*[record for record in records if record.scalars["leg"] == "up"][-1:], *points]
            rpm = [value(record, "speed") * 0.03 / math.pi for record in points]
            kept = {"color": colour, "linestyle": line if mu else ":", "linewidth": 1.5 if mu else 1.0}
            label = f"{load:g} N, {leg}" if mu else (f"{load:g} N, no petal friction" if leg == "up" else None)
            left.plot(rpm, [value(record, "friction_torque") for record in points], label=label, **kept)
            right.plot(rpm, [MICRON * value(record, "eccentricity_y") for record in points], **kept)
    style.dress(left, "speed, 1000 rpm", "friction moment, N·m")
    style.dress(right, "speed, 1000 rpm", "height of the journal, µm")
    left.legend(frameon=False)
    fig.savefig(path)


def main(folder: Path) -> None:
    """Print the table and write the figure."""
    folder.mkdir(parents=True, exist_ok=True)
    with one_thread():
        runs = {(mu, load): run(mu, load) for load in LOADS for mu in FRICTIONS}
    for (mu, load), records in runs.items():
        failed = [record.scalars["status"] for record in records if not record.converged]
        if failed:
            raise SystemExit(f"friction {mu:g}, {load:g} N: {failed[0]}")
    Console().print(table(runs), markup=False)
    figure(runs, folder / "rig_friction.png")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: python examples/{Path(__file__).name} FOLDER")
    main(Path(sys.argv[1]))
