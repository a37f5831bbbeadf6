"""Contact lines that lead from point to point of a 3-D curve, beside points found with contacts at nodes first.

python benchmarks/led_lines.py CELLS AXIAL [POINTS]
"""

from __future__ import annotations

import sys
import time
import warnings
from pathlib import Path

import numpy as np

from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.curve import displaced_problem, point_after
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.solution import Solution
from petalfoil.system.build import build_problem

BEARING = Path(__file__).parents[1] / "examples" / "paper_n8_spatial.toml"


def main(cells: int, axial: int, points: int) -> None:
    """Print a row for each point: factorisations, processor time and bearing force of both sides."""
    warnings.simplefilter("ignore")
    case = with_stations(Case.load(BEARING).replace(**{"model.cells_per_pitch": cells, "model.axial_cells": axial}))
    base, before = build_problem(case), [None, None]
    print("displacement [um], then factorisations, time [s], contact lines, force [N]: nodes first; lines lead")
    with running():
        for down in np.linspace(0.0, 280e-6, points):
            here = case.replace(**{"operation.eccentricity": (0.0, -down)})
            rows = []
            for side in range(2):
                before[side], row = timed(here, displaced_problem(base, here), before[side], leads=side == 1)
                rows.append(row)
            print(f"{1e6 * down:.0f}  {rows[0]};  {rows[1]}")


def timed(case: Case, problem: object, before: Solution | None, *, leads: bool) -> tuple[Solution, str]:
    """A point after the one before, and its row."""
    with running() as run:
        begin = time.process_time()
        answer = point_after(case, problem, before, leads=leads).answer
        seconds = time.process_time() - begin
    force = float(np.linalg.norm(answer.unbalanced)) * answer.problem.layout.scales.force
    return answer, f"{run.film.factorizations} {seconds:.2f} {answer.lines is not None} {force:.9g}"


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 15)
