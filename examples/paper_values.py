"""Converged values of the paper's packs: regenerates docs/paper-values.md.

    python examples/paper_values.py docs/paper-values.md

6, 8 and 10 petals at four displacements, 2-D and 3-D, and the foil packs at zero speed; each value extrapolated from
several grids, with its error bar. Some 45 minutes of processor time, a third of them for the finest 3-D grid.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date
from multiprocessing import Pool
from pathlib import Path

from rich.console import Console

import petalfoil
from petalfoil import Case
from petalfoil.analysis.grid_study import contacts_alike, resolution
from petalfoil.analysis.richardson import Extrapolation, fitted, richardson

HERE = Path(__file__).parent
COUNTS, DISPLACEMENTS = (6, 8, 10), (0, 100, 200, 280)  # the latter in µm, downward
MODELS = {"2d": "2-D", "3d": "3-D"}
GRIDS = {"2d": (64, 128, 256, 512), "3d": (64, 72, 80, 88, 96, 112, 128)}
"""Cells per pitch; in 3-D half as many over the length, and many sizes, because values scatter. On 24 petals come down
where they should not."""

RESTING_GRIDS = GRIDS | {"3d": (32, 48, 64, 96)}
"""At zero speed nothing scatters."""

RUNNING = {"bearing_force": 1.0, "min_film_thickness": 1e6, "peak_pressure": 1e-3}  # factors to N, µm, kPa
RESTING = {"contact_normal_force": 1.0, "starting_torque": 1e3}  # factors to N, mN·m

HEAD = """# Grid-converged values of the paper's foil packs

Foil packs of 6, 8 and 10 petals as in `examples/paper_n6.toml`, `paper_n8.toml` and `paper_n10.toml` (what the paper
does not state is marked there as an assumption), at 8000 rad/s, the journal displaced downward by *e*. Written on
{day} by

    python examples/paper_values.py docs/paper-values.md

In 2-D a value is grid-converged by Richardson extrapolation from the last three of the nested grids above the table,
with its error bar. **Bold**: the observed order of convergence is within 0.5 (`CREDIBLE`) of the order of the method, 2
(`DECLARED_ORDER`), and the bar is 1.75 (`richardson.SAFETY`) times the distance of the finest grid from the value.
Plain: no such order is observed, because the coarsest of the grids do not resolve what decides the result, or contacts
change between them; the bar is 3 (`SUSPICION`) times the largest distance that the differences between the grids allow.
`petalfoil converge` follows the same rules; see [analysis/richardson.py](../src/petalfoil/analysis/richardson.py).

In 3-D contact lines begin and end at stations, and values scatter by some thousandths from grid to grid. The value is
that of a line in the square of the cells' size by least squares through those of all grids (`richardson.fitted`; Eça
and Hoekstra 2014, [doi:10.1016/j.jcp.2014.01.006](https://doi.org/10.1016/j.jcp.2014.01.006)). Its bar is the
interval in which it lies with a confidence of 95 % (`richardson.CONFIDENCE`) by Student's t, at least 1.25 (`FITTED`)
times the distance of the finest grid from it. **Bold**: the change with the size of the cells is seen through the
scatter with that confidence. Plain: it is not.

Stations along the shaft are those of the default, adapted to a coarse solution (`model.axial_density`): grids of
all sizes lie in the same map. At zero speed they are equal, and the 3-D grids are {resting}. Petals bend
only, as the paper's (`petals.theory = "inextensible"`).

The bearing force on the centred journal is zero by symmetry. Pressures are absolute, at an ambient pressure of 100 kPa.
"""


@dataclass(frozen=True)
class Task:
    """One position of one pack in one model; at rest without a displacement."""

    count: int
    kind: str
    e: int | None  # [µm]

    @property
    def case(self) -> Case:
        """The pack, whose petals bend only."""
        changes: dict[str, object] = {"model.kind": self.kind, "petals.theory": "inextensible"}
        changes |= {} if self.e is None else {"operation.eccentricity": (0.0, -1e-6 * self.e)}
        return Case.load(HERE / f"paper_n{self.count}.toml").replace(**changes)

    @property
    def on_grids(self) -> list[Case]:
        """The pack on the grids, coarsest first."""
        return [
            self.case.replace(**{"model.cells_per_pitch": cells, "model.axial_cells": cells // 2})
            for cells in self.grids
        ]

    @property
    def grids(self) -> tuple[int, ...]:
        """Cells per pitch, coarsest first."""
        return (RESTING_GRIDS if self.e is None else GRIDS)[self.kind]

    def limit(self, values: list[float], equal: float = 0.0, *, alike: bool = True) -> Extrapolation:
        """Grid-converged value and its bar; differences below `equal` are none.

        Raises
        ------
        ValueError
            In 3-D, contacts are not described `alike` on all grids.
        """
        if self.kind == "2d":
            return richardson(values, resolution=equal, alike=alike)
        if not alike:
            raise ValueError(f"contacts are at nodes on some grids and between them on others: {values}")
        return fitted(values, self.grids, equal)


def run(task: Task) -> dict[str, Extrapolation]:
    """Extrapolate the results of one task."""
    return at_rest(task) if task.e is None else turning(task)


def turning(task: Task) -> dict[str, Extrapolation]:
    """The pack at speed: bearing force, minimum film thickness, peak pressure."""
    records = [petalfoil.solve.record(case) for case in task.on_grids]
    equal, alike = {"bearing_force": resolution(records[-1])["N"]}, contacts_alike(records)
    return {
        name: task.limit([float(record.scalars[name]) for record in records], equal.get(name, 0.0), alike=alike)
        for name in RUNNING
    }


def at_rest(task: Task) -> dict[str, Extrapolation]:
    """The pack without rotation: contact reactions on the journal and starting torque."""
    points = [petalfoil.static(case) for case in task.on_grids]
    return {name: task.limit([float(point[name][0]) for point in points]) for name in RESTING}


# ------------------------------------------------------------------------------------------- the page


def head(day: str) -> str:
    """What stands above the tables."""
    return HEAD.format(day=day, resting=named("3d", RESTING_GRIDS["3d"]))


def named(kind: str, grids: Sequence[int]) -> str:
    """Grids in words."""
    return ", ".join(f"{cells} × {cells // 2}" if kind == "3d" else str(cells) for cells in grids)


def page(found: dict[Task, dict[str, Extrapolation]], day: str) -> str:
    """The whole page."""
    sections = [head(day)]
    for kind, grids in GRIDS.items():
        sections.append(f"## {MODELS[kind]} model, grids {named(kind, grids)}\n")
        sections.append(
            table(
                found,
                kind,
                DISPLACEMENTS,
                RUNNING,
                ("bearing force, N", "minimum film thickness, µm", "peak pressure, kPa"),
            )
        )
        sections.append("At zero speed, centred journal:\n")
        sections.append(
            table(found, kind, (None,), RESTING, ("contact normal force on the journal, N", "starting torque, mN·m"))
        )
    return "\n".join(sections)


def table(
    found: dict[Task, dict[str, Extrapolation]],
    kind: str,
    displacements: Sequence[int | None],
    factors: dict[str, float],
    headings: Sequence[str],
) -> str:
    """A table in Markdown."""
    columns = ("petals", *(() if displacements == (None,) else ("e, µm",)), *headings)
    lines = ["| " + " | ".join(columns) + " |", "|" + "---:|" * len(columns)]
    for count in COUNTS:
        for e in displacements:
            values = found[Task(count, kind, e)]
            places = (str(count), *(() if e is None else (str(e),)))
            lines.append("| " + " | ".join((*places, *(text(values[n], f) for n, f in factors.items()))) + " |")
    return "\n".join(lines) + "\n"


def text(value: Extrapolation, factor: float) -> str:
    """Value ± bar with two digits of the bar, at most six decimals, bold where it is trusted."""
    middle, error = value.limit * factor, value.error * factor
    if abs(middle) <= error:
        return "0"
    digits = 0
    while digits < 6 and error * 10**digits < 9.5:
        digits += 1
    error = max(error, 10.0**-digits)
    shown = f"{middle:.{digits}f} ± {error:.{digits}f}"
    return f"**{shown}**" if value.trusted else shown


def main(path: Path) -> None:
    """Run all tasks, the longest first, and write the page when all are done."""
    err = Console(stderr=True, highlight=False)
    tasks = [Task(n, kind, e) for kind in ("3d", "2d") for n in COUNTS for e in (*DISPLACEMENTS, None)]
    found: dict[Task, dict[str, Extrapolation]] = {}
    with Pool(2) as pool:
        for task, values in zip(tasks, pool.imap(run, tasks), strict=True):
            found[task] = values
            err.print(f"{len(found)} of {len(tasks)}: {task.count} petals, {task.kind}, e = {task.e}")
    path.write_text(page(found, date.today().isoformat()), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/paper_values.py FILE.md")
    main(Path(sys.argv[1]))
