"""How far petals that differ by a few micrometres move the lift-off speed of the paper's test rig.

    python examples/scatter_rig.py FOLDER

Each petal's thickness scatters by itself, uniformly by ± 5 µm; beside it all petals of a pack scatter together. The
load is that of the paper's first experiment. The folder holds both studies, with figures and a page each; a run that
was interrupted goes on from there. About ten minutes on two cores.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import petalfoil
from petalfoil import Case
from petalfoil.studies.run import Execution

HERE = Path(__file__).parent
CELLS = 32  # per pitch
LOAD = 46.4  # N
SCATTER = {"each petal by itself": "± 5 um each", "all petals alike": "± 5 um"}
SAMPLES = 64
RPM = 30.0 / math.pi


def scattered(text: str, folder: Path, workers: int | None = None, samples: int = SAMPLES) -> dict[str, Any]:
    """Statistics of the lift-off speed [rad/s] for a scatter of the thickness."""
    case = Case.load(HERE / "rig.toml").replace(**{"model.cells_per_pitch": CELLS})
    ds = petalfoil.tolerance(
        case,
        {"petals.thickness": text},
        "liftoff",
        loads=LOAD,
        samples=samples,
        out=folder,
        execution=Execution(workers=workers),
    )
    told: dict[str, Any] = json.loads(ds.attrs["tolerance"])["results"]["liftoff_speed"]
    return told


def line(name: str, told: dict[str, Any]) -> str:
    """One scatter in words."""
    low, middle, high, nominal = (told[key] * RPM for key in ("quantile_05", "quantile_50", "quantile_95", "nominal"))
    return (
        f"{name}: nominal {nominal:.0f} rpm, median {middle:.0f} rpm, 90 % of packs from {low:.0f} to {high:.0f} rpm "
        f"(a factor of {high / low:.2f}), {told['cases']:.0f} packs"
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
