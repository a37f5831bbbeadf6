"""Draws the picture of the README: the bearing with 8 petals in space, journal displaced by 200 µm.

python examples/readme_figures.py docs/images
"""

from __future__ import annotations

import sys
from pathlib import Path

import petalfoil
from petalfoil import Case, plot


def main(folder: Path) -> None:
    """Solve on 64 x 32 cells (within 1 % of the limit in load, 6 % in the smallest film) and draw."""
    case = Case.load(Path(__file__).parent / "paper_n8_spatial.toml").replace(
        **{"model.cells_per_pitch": 64, "model.axial_cells": 32}
    )
    point = petalfoil.solve(case, eccentricity="0 um, -200 um")
    folder.mkdir(parents=True, exist_ok=True)
    plot.summary(point).savefig(folder / "petal_bearing.png", dpi=110, metadata={"Software": "petalfoil"})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/readme_figures.py FOLDER")
    main(Path(sys.argv[1]))
