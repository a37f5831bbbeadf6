"""The paper's test rig as the model sees it: the four experiments of its Table 1, and a run-up and coast-down.

    python examples/rig_report.py FOLDER

The bearing is that of `rig.toml`, in space, on its own grid and on a coarser one. Writes two tables and a figure. About
an hour on two cores, nearly all of it for the lift-off speeds.
"""

from __future__ import annotations

import csv
import math
import sys
from dataclasses import dataclass
from functools import partial
from multiprocessing import Pool
from pathlib import Path

from matplotlib.figure import Figure
from rich.console import Console

from petalfoil import Case
from petalfoil.analysis import balance, liftoff, runup
from petalfoil.analysis.session import one_thread
from petalfoil.equilibria.work import Work
from petalfoil.plot import style
from petalfoil.results.record import Record

HERE = Path(__file__).parent
SHARES = (0.05, 0.01)  # of the contacts, below which the journal floats
RPM = math.pi / 30.0  # [rad/s]
TOP = 30000.0  # [rpm]

err = Console(stderr=True, markup=False, highlight=False)


@dataclass(frozen=True)
class Experiment:
    """A row of Table 1."""

    load: float  # [N]
    moment: float  # largest friction moment [N m]
    speed: float  # lowest ascent speed [rpm]


def experiments() -> list[Experiment]:
    """Table 1."""
    lines = (HERE / "rig_table1.csv").read_text(encoding="utf-8").splitlines()
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return [Experiment(**{name: float(value) for name, value in row.items()}) for row in rows]


@dataclass(frozen=True)
class Seen:
    """An experiment as the model sees it."""

    moment: float  # of the package at rest under the load [N m]
    speeds: tuple[float, ...]  # of lift-off for each of `SHARES` [rpm]


def seen(experiment: Experiment, case: Case) -> Seen:
    """Starting moment and lift-off speeds under the load of an experiment."""
    load = experiment.load
    still = balance.run(case, (0.0, -load), speed=0.0)
    near, speeds = case.replace(**{"operation.speed": experiment.speed * RPM}), []
    with one_thread():
        for share in SHARES:
            speeds.append(liftoff.crossings(near, load, share, Work())[0] / RPM)
            if math.isfinite(speeds[-1]):
                near = near.replace(**{"operation.speed": speeds[-1] * RPM})
    return Seen(float(still.scalars["friction_torque"]), tuple(speeds))


def table(case: Case, found: list[Seen]) -> str:
    """The experiments, measured and computed, in Markdown."""
    grid = f"{case.cells_per_pitch} × {case.axial_cells}"
    lines = [
        f"Grid {grid}",
        "",
        "| load, N | moment measured, N·m | model | difference | lift-off measured, rpm | "
        + " | ".join(f"model, share {100 * share:g} % | difference" for share in SHARES)
        + " |",
        "|---:|---:|---:|---:|---:|" + "---:|---:|" * len(SHARES),
    ]
    for e, s in zip(experiments(), found, strict=True):
        speeds = " | ".join(f"{v:.0f} | {100 * (v / e.speed - 1):+.0f} %" for v in s.speeds)
        moment = f"{e.moment:.2f} | {s.moment:.2f} | {100 * (s.moment / e.moment - 1):+.0f} %"
        lines.append(f"| {e.load:g} | {moment} | {e.speed:.0f} | {speeds} |")
    return "\n".join(lines) + "\n"


# ------------------------------------------------------------------------------------------- run-up


def run(case: Case, load: float) -> list[tuple[str, Record]]:
    """Run-up from rest and coast-down under a load [N]."""
    return list(runup.iterate(case, (0.0, -load), TOP * RPM))


def figure(legs: list[tuple[str, Record]], experiment: Experiment) -> Figure:
    """Friction moment and contact share over speed, up and down, with what was measured."""
    fig = style.figure(8.0, 5.5)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    looks = {"up": ("run-up", style.BLUE, "-", "o"), "down": ("coast-down", style.VERMILLION, "--", "s")}
    for leg, (label, colour, dashes, marker) in looks.items():
        records = [record for name, record in legs if name == leg and record.scalars["converged"]]
        rpm = [float(record.scalars["speed"]) / RPM for record in records]
        look = {"color": colour, "linestyle": dashes, "marker": marker, "markersize": 3.5, "label": label}
        upper.plot(rpm, [float(record.scalars["friction_torque"]) for record in records], **look)
        lower.plot(rpm, [100.0 * float(record.scalars["contact_share"]) for record in records], **look)
    upper.plot(
        0.0, experiment.moment, "*", color=style.INK, markersize=12, clip_on=False, label="measured, largest moment"
    )
    for ax in (upper, lower):
        ax.axvline(experiment.speed, color=style.INK, linestyle=":", label="measured, ascent")
    style.dress(upper, "", "friction moment [N m]")
    style.dress(lower, "speed [rpm]", "contact share [%]")
    upper.set_ylim(bottom=0.0)
    lower.set_ylim(bottom=0.0)
    lower.set_xlim(0.0, TOP)
    style.legend(upper)
    upper.set_title(f"Test rig under {experiment.load:g} N", fontsize=style.TITLE, loc="left")
    return fig


def main(folder: Path) -> None:
    """Compute the tables and the run-up; write each as it is done."""
    folder.mkdir(parents=True, exist_ok=True)
    own, known = Case.load(HERE / "rig.toml"), experiments()
    coarse = own.replace(
        **{"model.cells_per_pitch": own.cells_per_pitch // 2, "model.axial_cells": own.axial_cells // 2}
    )
    with Pool(2) as pool:
        legs = pool.apply_async(run, (own, known[0].load))
        for name, case in (("coarse", coarse), ("own", own)):
            text = table(case, pool.map(partial(seen, case=case), known, chunksize=1))
            (folder / f"experiments_{name}.md").write_text(text, encoding="utf-8")
            err.print(text)
        figure(legs.get(), known[0]).savefig(folder / "runup_rig.png", dpi=100, metadata={"Software": "petalfoil"})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/rig_report.py FOLDER")
    main(Path(sys.argv[1]))
