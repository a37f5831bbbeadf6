"""The paper's test rig as the model sees it: the four experiments of its Table 1, and a run-up and coast-down.

    python examples/rig_report.py FOLDER

The bearing is that of `rig.toml`. Writes the tables of docs/validation-rig.md and its figure; about two minutes.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.console import Console

from petalfoil import Case
from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.balance import balance
from petalfoil.analysis.crossings import CONTACT_FRACTION, crossings
from petalfoil.analysis.runup import runup
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.errors import ConvergenceError
from petalfoil.plot import style
from petalfoil.results.record import Record

HERE = Path(__file__).parent
RPM = math.pi / 30.0  # [rad/s]
TOP = 30000.0  # [rpm]
POINTS = 49  # of a run-up
ARM = 0.16 * 9.80665  # moment over what the rig's sensor shows [N m/kgf]: 1.19 for 0.76, 1.10 for 0.70, 3.79 for 2.42
GRIDS = (96, 192, 384)  # cells per pitch
SPACE = {"model.kind": "3d", "model.cells_per_pitch": 64, "petals.theory": "inextensible"}  # as in the paper
STATIONS = (24, 48)  # cells over the length in 3-D
IN_SPACE = (4000.0, 6000.0, 8800.0, 10500.0, 12000.0, 16000.0)  # [rpm]

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


def rig(**changes: object) -> Case:
    """The bearing of `rig.toml`, with changes by dotted path."""
    return Case.load(HERE / "rig.toml").replace(**changes)


def starting_moment(case: Case, load: float) -> float:
    """Friction moment of the foil pack at zero speed under a load [N m]."""
    return float(balance.record(case, (0.0, -load), speed=0.0).scalars["friction_torque"])


def lift_off(case: Case, experiment: Experiment, share: float = CONTACT_FRACTION) -> float:
    """Lift-off speed under the load of an experiment, looked for from the measured one on [rpm]."""
    near = case.replace(**{"operation.speed": experiment.speed * RPM})
    with one_thread():
        return crossings(SpeedLine(near, (0.0, -experiment.load)), share)[0] / RPM


# ------------------------------------------------------------------------------------------- tables


def table(case: Case) -> str:
    """The experiments, measured and computed, in Markdown."""
    lines = [
        "| load, N | moment measured, N·m | model | residual | lift-off measured, rpm | model | residual |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for e in experiments():
        moment, speed = starting_moment(case, e.load), lift_off(case, e)
        lines.append(
            f"| {e.load:g} | {e.moment:.2f} | {moment:.3f} | {percent(moment / e.moment)} "
            f"| {e.speed:.0f} | {speed:.0f} | {percent(speed / e.speed)} |"
        )
    return "\n".join(lines) + "\n"


def percent(ratio: float) -> str:
    """A ratio as a signed difference from one."""
    return f"{100.0 * (ratio - 1.0):+.1f} %".replace("-", "−")


VARIATIONS: dict[str, tuple[dict[str, object], float]] = {
    **{f"{cells} cells per pitch": ({"model.cells_per_pitch": cells}, CONTACT_FRACTION) for cells in GRIDS},
    "lift-off at a contact fraction of 0.5 %": ({}, 0.005),
    "lift-off at a contact fraction of 2 %": ({}, 0.02),
    "lift-off at a contact fraction of 5 %": ({}, 0.05),
    "contact film thickness 0.5 µm": ({"surface.contact_film_thickness": 0.5e-6}, CONTACT_FRACTION),
    "contact film thickness 1.5 µm": ({"surface.contact_film_thickness": 1.5e-6}, CONTACT_FRACTION),
    "slip at the walls": ({"model.slip": True}, CONTACT_FRACTION),
    "journal radius 10 µm larger": ({"bearing.journal_radius": 28.6414e-3}, CONTACT_FRACTION),
    "journal radius 10 µm smaller": ({"bearing.journal_radius": 28.6214e-3}, CONTACT_FRACTION),
}


def variations() -> str:
    """Experiments 1 and 4 with other grids, criteria and assumptions, in Markdown."""
    lines = ["| | moment 1, N·m | moment 4 | lift-off 1, rpm | lift-off 4 |", "|---|---:|---:|---:|---:|"]
    ends = (experiments()[0], experiments()[-1])
    for name, (changes, share) in VARIATIONS.items():
        case = rig(**changes)
        try:
            moments = [f"{starting_moment(case, e.load):.3f}" for e in ends]
            speeds = [f"{lift_off(case, e, share):.0f}" for e in ends]
        except ConvergenceError as failure:
            moments, speeds = [str(failure), ""], ["", ""]
        lines.append(f"| {name} | " + " | ".join((*moments, *speeds)) + " |")
    return "\n".join(lines) + "\n"


def in_space() -> str:
    """Experiment 1 in 3-D: moment at zero speed, contact fraction over speed on adapted stations, in Markdown."""
    lines = [
        f"| cells over the length | moment, N·m | {' | '.join(f'{rpm:.0f} rpm' for rpm in IN_SPACE)} |",
        "|---:|" + "---:|" * (1 + len(IN_SPACE)),
    ]
    first = experiments()[0]
    at_work = {"operation.load": (0.0, -first.load), "operation.speed": first.speed * RPM}
    for cells in STATIONS:
        case = with_stations(rig(**SPACE, **at_work, **{"model.axial_cells": cells}))
        line = SpeedLine(case, (0.0, -first.load))
        with one_thread():
            fractions = [f"{100.0 * line.contact_fraction(rpm * RPM):.2f} %" for rpm in IN_SPACE]
        lines.append(f"| {cells} | {starting_moment(case, first.load):.3f} | {' | '.join(fractions)} |")
    return "\n".join(lines) + "\n"


# ------------------------------------------------------------------------------------------- run-up

Legs = Sequence[Record]
LEGS = {"up": "run-up (the paper's Figure 10)", "down": "coast-down (Figure 11)"}


def run(case: Case, load: float) -> Legs:
    """Run-up from rest and coast-down under a load [N]."""
    return list(runup.records(case, (0.0, -load), to=TOP * RPM, points=POINTS))


def figure(runs: dict[float, Legs]) -> Figure:
    """Moment, contact fraction and minimum film thickness over speed under each load: left run-up, right coast-down."""
    fig = style.figure(10.0, 8.0)
    axes = fig.subplots(3, 2, sharey="row", height_ratios=(2.0, 1.0, 1.2))
    for column, (leg, title) in zip(axes.T, LEGS.items(), strict=True):
        for (load, legs), colour in zip(runs.items(), (style.BLUE, style.VERMILLION), strict=True):
            draw(column, of_leg(legs, leg), (f"model, {load:g} N", colour))
        measured(column, leg)
        column[0].set_title(title, fontsize=style.LABEL, loc="left")
        column[2].set_xlabel("speed [rpm]", fontsize=style.LABEL)
    for ax, label in zip(
        axes[:, 0], ("friction moment [N m]", "contact fraction [%]", "minimum film thickness [µm]"), strict=True
    ):
        ax.set_ylabel(label, fontsize=style.LABEL)
    scale = axes[0, 1].secondary_yaxis("right", functions=(lambda m: m / ARM, lambda f: f * ARM))
    scale.set_ylabel("force at the rig's sensor [kgf]", fontsize=style.LABEL)
    style.legend(axes[0, 0], loc="upper right")
    fig.suptitle("Test rig of Table 1, as the model sees it", fontsize=style.TITLE, color=style.INK)
    return fig


def of_leg(legs: Legs, leg: str) -> list[Record]:
    """The records of a leg; a coast-down begins where the run-up ended."""
    top = [record for record in legs if record.scalars["leg"] == "up"][-1:] if leg == "down" else []
    return top + [record for record in legs if record.scalars["leg"] == leg]


def draw(column: Sequence[Axes], records: Sequence[Record], look: tuple[str, str]) -> None:
    """One leg under one load in the three panels."""
    label, colour = look
    known = [record.scalars for record in records if record.converged]
    rpm = [float(s["speed"]) / RPM for s in known]
    for ax, name, factor in zip(
        column, ("friction_torque", "contact_fraction", "min_film_thickness"), (1.0, 1e2, 1e6), strict=True
    ):
        values = [factor * float(s[name]) for s in known]
        ax.plot(rpm, values, color=colour, marker=".", markersize=4, linewidth=1.6, label=label)


def measured(column: Sequence[Axes], leg: str) -> None:
    """What was measured in experiments 1 and 4, and the axes: a coast-down is read from the right, as it went."""
    for e, colour in zip((experiments()[0], experiments()[-1]), (style.BLUE, style.VERMILLION), strict=True):
        for ax in column:
            label = f"measured ascent, {e.load:g} N" if ax is column[0] else None
            ax.axvline(e.speed, color=colour, linestyle=":", linewidth=1.2, label=label)
        if leg == "up":
            look: style.Look = {"color": colour, "markersize": 12, "clip_on": False, "zorder": 5}
            column[0].plot(0.0, e.moment, "*", label=f"measured largest moment, {e.load:g} N", **look)
    for ax in column:
        style.dress(ax)
        ax.set_xlim((0.0, TOP) if leg == "up" else (TOP, 0.0))
        ax.set_ylim(bottom=0.0)
    floor = 1e6 * rig().surface.contact_film_thickness
    column[2].axhline(floor, color=style.GREY, linestyle="--", linewidth=1.0)
    if leg == "up":  # on the other side the curves lie there
        place = {"xycoords": ("axes fraction", "data"), "ha": "right", "va": "top"}
        column[2].annotate("contact film thickness", (0.98, floor), **place)


def main(folder: Path) -> None:
    """Compute the tables and the run-up; write each as it is done."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (("experiments", table(rig())), ("variations", variations()), ("space", in_space())):
        (folder / f"{name}.md").write_text(text, encoding="utf-8")
        err.print(text)
    loads = (experiments()[0].load, experiments()[-1].load)
    figure({load: run(rig(), load) for load in loads}).savefig(
        folder / "rig_runup.png", dpi=110, metadata={"Software": "petalfoil"}
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/rig_report.py FOLDER")
    main(Path(sys.argv[1]))
