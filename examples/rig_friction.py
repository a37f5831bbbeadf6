"""The rig of the paper's Table 1 with friction on its petals: run-up and coast-down, as tables and a figure.

    python examples/rig_friction.py FOLDER

The bearing is that of `rig.toml` on 32 cells per pitch: rubbing of the journal as torque alone, a journal that drags
petals along, the same friction between them and on the bushing, and both. Writes the table of
docs/validation/rig-friction.md and its figure; two minutes.
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
MU = 0.1555
RUBS = {
    "torque alone": {},
    "journal": {"surface.journal_rubbing": "force"},
    "petals": {"surface.petal_friction": MU},
    "petals and journal": {"surface.petal_friction": MU, "surface.journal_rubbing": "force"},
}
"""What pulls at the petals."""
MICRON = 1e6
COLUMNS = {
    "starting moment, N·m": ("friction_torque", 1.0, 0),
    "moment at the end, N·m": ("friction_torque", 1.0, -1),
    "lost between petals, µJ": ("petal_friction_work", MICRON, -1),
    "height at the start, µm": ("eccentricity_y", MICRON, 0),
    "height at the end, µm": ("eccentricity_y", MICRON, -1),
}


def run(rubs: str, load: float) -> list[Record]:
    """Run-up and coast-down under a load."""
    case = Case.load(RIG).replace(**{"model.cells_per_pitch": CELLS, **RUBS[rubs]})
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


def table(runs: dict[tuple[str, float], list[Record]]) -> str:
    """Columns of results, a row for each load and what pulls at the petals."""
    head = ["load, what pulls at the petals", *COLUMNS, "lift-off, rpm", "touchdown, rpm"]
    lines = ["| " + " | ".join(head) + " |", "|---|" + "---:|" * (len(head) - 1)]
    for (rubs, load), records in runs.items():
        cells = [f"{unit * value(records[place], name):.4g}" for name, unit, place in COLUMNS.values()]
        cells += [f"{lift_off(records, leg):.0f}" for leg in ("up", "down")]
        lines.append("| " + " | ".join([f"{load:g} N, {rubs}", *cells]) + " |")
    return "\n".join(lines)


def figure(runs: dict[tuple[str, float], list[Record]], path: Path) -> None:
    """Moment and height of the journal over speed, both ways."""
    fig = style.figure(10.0, 4.2)
    left, right = fig.subplots(1, 2)
    for (rubs, load), records in runs.items():
        colour = f"C{list(RUBS).index(rubs)}"
        for leg, line in (("up", "-"), ("down", "--")):
            points = [record for record in records if record.scalars["leg"] == leg]
            if leg == "down":
                points = [*[record for record in records if record.scalars["leg"] == "up"][-1:], *points]
            rpm = [value(record, "speed") * 0.03 / math.pi for record in points]
            kept = {"color": colour, "linestyle": line, "linewidth": 1.2}
            label = rubs if leg == "up" and load == LOADS[0] else None
            left.plot(rpm, [value(record, "friction_torque") for record in points], label=label, **kept)
            right.plot(rpm, [MICRON * value(record, "eccentricity_y") for record in points], **kept)
    style.dress(left, "speed, 1000 rpm", "friction moment, N·m")
    style.dress(right, "speed, 1000 rpm", "height of the journal, µm")
    left.legend(frameon=False)
    for load in LOADS:
        end = runs["torque alone", load][-1]
        left.annotate(f"{load:g} N", (0.0, value(end, "friction_torque")), (0.35, value(end, "friction_torque")))
        right.annotate(f"{load:g} N", (0.0, 0.0), (10.3, MICRON * value(end, "eccentricity_y") + 1.0))
    fig.savefig(path)


def main(folder: Path) -> None:
    """Print the table and write the figure."""
    folder.mkdir(parents=True, exist_ok=True)
    with one_thread():
        runs = {(rubs, load): run(rubs, load) for load in LOADS for rubs in RUBS}
    for (rubs, load), records in runs.items():
        failed = [record.scalars["status"] for record in records if not record.converged]
        if failed:
            raise SystemExit(f"friction {rubs}, {load:g} N: {failed[0]}")
    Console().print(table(runs), markup=False, soft_wrap=True)
    figure(runs, folder / "rig_friction.png")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: python examples/{Path(__file__).name} FOLDER")
    main(Path(sys.argv[1]))
