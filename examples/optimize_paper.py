"""The paper's bearing optimised under its own assumptions: which petals carry most?

    python examples/optimize_paper.py FOLDER

For 6, 8 and 10 petals, thickness, arc length and bend radius are chosen so that the bearing carries most with its
journal displaced by 200 µm, with a film of at least 5 µm, a bending stress of at most 350 MPa and hardly any contact;
the 2-D model of the paper, assumptions as in the case files. Every design and the best ones as case files are kept in
FOLDER; a run that was interrupted goes on from there. About five minutes on two cores.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import petalfoil
from petalfoil import Case
from petalfoil.studies.run import Execution

HERE = Path(__file__).parent
COUNTS = (6, 8, 10)
CELLS = 32  # per pitch: forces within 1 % of those on 128
DISPLACED = (0.0, -200e-6)  # journal [m], as in the paper's Figure 8
VARY = {
    "petals.thickness": "0.12 mm : 0.26 mm",
    "petals.arc_length": "40 mm : 54 mm",
    "petals.bend_radius": "32 mm : 60 mm",
}
LIMITS = ["min_film_thickness > 5 um", "max_bending_stress < 350 MPa", "contact_fraction < 1 %"]
BUDGET = 60


def optimized(count: int, folder: Path, workers: int | None = None, budget: int = BUDGET) -> dict[str, Any]:
    """The paper's bearing with this number of petals and its best design: results of both, SI."""
    case = Case.load(HERE / f"paper_n{count}.toml").replace(**{"model.cells_per_pitch": CELLS})
    here = petalfoil.solve(case, eccentricity=DISPLACED)
    ds = petalfoil.optimize(
        case,
        VARY,
        maximize="bearing_force",
        subject=LIMITS,
        budget=budget,
        out=folder / f"n{count}",
        execution=Execution(workers=workers),
        eccentricity=DISPLACED,
    )
    names = ("bearing_force", "min_film_thickness", "max_bending_stress")
    told = json.loads(ds.attrs["optimum"])
    return {"count": count, "paper": {name: float(here[name]) for name in names}, **told}


def line(found: dict[str, Any]) -> str:
    """One bearing in words."""
    paper, best = found["paper"], found["best"][0] if found["best"] else None
    text = f"{found['count']:3d} petals: {paper['bearing_force']:6.2f} N in the paper"
    if best is None:
        return f"{text}; no design keeps every limit"
    values, results = best["values"], best["results"]
    return (
        f"{text}, {results['bearing_force']:6.2f} N with {1e6 * values['thickness']:.0f} um, "
        f"{1e3 * values['arc_length']:.1f} mm, bent to {1e3 * values['bend_radius']:.1f} mm: film "
        f"{1e6 * results['min_film_thickness']:.1f} um, {1e-6 * results['max_bending_stress']:.0f} MPa; "
        f"{found['designs']} designs, {found['with_derivatives']} with exact derivatives"
    )


def main(folder: Path) -> None:
    """Optimise each bearing and write what is found."""
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for count in COUNTS:
        found.append(optimized(count, folder))
        print(line(found[-1]), flush=True)
    (folder / "optimum.json").write_text(json.dumps(found, indent=1), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: python examples/{Path(__file__).name} FOLDER")
    main(Path(sys.argv[1]))
