"""Draws the pictures of the README: the bearing with 8 petals in 3-D, journal displaced by 200 µm; a rotor run up.

python examples/readme_figures.py docs/images
"""

from __future__ import annotations

import sys
from pathlib import Path

import xarray as xr

import petalfoil
from petalfoil import Case, plot

HERE = Path(__file__).parent


def main(folder: Path) -> None:
    """Draw both."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, (result, dpi) in {"petal_bearing": (point(), 110), "orbit": (run_up(), 80)}.items():
        plot.summary(result).savefig(folder / f"{name}.png", dpi=dpi, metadata={"Software": "petalfoil"})


def point() -> xr.Dataset:
    """On the default grid; `docs/validation/accuracy-3d.md` tells how near it is to a finer one."""
    return petalfoil.solve(Case.load(HERE / "paper_n8_spatial.toml"), eccentricity="0 um, -200 um")


def run_up() -> xr.Dataset:
    """From rest to speed in a tenth of a second: half a minute."""
    return petalfoil.orbit(Case.load(HERE / "orbit_n8.toml"), speeds="0 rpm : 76400 rpm : 100 ms")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/readme_figures.py FOLDER")
    main(Path(sys.argv[1]))
