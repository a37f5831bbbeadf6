"""How far petals that differ by a few micrometres move the lift-off speed of the paper's test rig.

    python examples/scatter_rig.py FOLDER

Each petal's thickness scatters by itself, uniformly by ± 5 µm; beside it all petals of a pack scatter together. The
load is that of the paper's first experiment, the grid that of the case file: coarse grids make the difference smaller
(a factor of 1.79 on 32 cells per pitch for 1.94 between packs 5 µm thinner and thicker). The folder holds both studies,
with figures and a page each; a run that was interrupted goes on from there. About ten minutes on two cores.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

import petalfoil
from petalfoil import Case
from petalfoil.studies.run import Execution

HERE = Path(__file__).parent
LOAD = 46.4  # N
SCATTER = {"each petal by itself": "± 5 um each", "all petals alike": "± 5 um"}
SAMPLES = 64
RPM = 30.0 / math.pi


def scattered(
    text: str, folder: Path, workers: int | None = None, samples: int = SAMPLES, case: Case | None = None
) -> dict[str, Any]:
    """Statistics of the lift-off speed [rad/s] for a scatter of the thickness, of the rig or another case."""
    ds = petalfoil.tolerance(
        case or Case.load(HERE / "rig.toml"),
        {"petals.thickness": text},
        "liftoff",
        loads=LOAD,
        samples=samples,
        out=folder,
        execution=Execution(workers=workers),
    )
    told: dict[str, Any] = json.loads(ds.attrs["tolerance"])["results"]["liftoff_speed"]
    speeds = ds["liftoff_speed"].values
    return {**told, "least": float(np.nanmin(speeds)), "greatest": float(np.nanmax(speeds))}


def line(name: str, told: dict[str, Any]) -> str:
    """One scatter in words."""
    low, middle, high = (told[key] * RPM for key in ("quantile_05", "quantile_50", "quantile_95"))
    least, greatest, nominal = (told[key] * RPM for key in ("least", "greatest", "nominal"))
    return (
        f"{name}: nominal {nominal:.0f} rpm, median {middle:.0f} rpm, 90 % of packs from {low:.0f} to {high:.0f} rpm, "
        f"all {told['cases']:.0f} from {least:.0f} to {greatest:.0f} rpm (a factor of {greatest / least:.2f}); "
        f"standard deviation {told['standard_deviation'] * RPM:.0f} rpm, first order "
        f"{told['first_order_standard_deviation'] * RPM:.0f} rpm"
    )


def main(folder: Path) -> None:
    """Run both studies."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, (name, text) in enumerate(SCATTER.items()):
        print(line(name, scattered(text, folder / f"scatter{number}")), flush=True)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(f"usage: python examples/{Path(__file__).name} FOLDER")
    main(Path(sys.argv[1]))
