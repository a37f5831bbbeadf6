"""Factorisations on coarse and fine grids: `python benchmarks/at_any_grid.py [CELLS ...]`, a table of ten bearings.

A position from nothing on every grid (32 to 1024 cells per pitch, or those given), then four more of a load
characteristic, half a micrometre apart. Counted are factorisations of the pack, of film and pack with contact points,
and those of growth rates and other equilibria; then all under the coarse film that leads there, plainly, and all
together with these by their share of cells. Beside them the contacts, the bearing force, and how far stiffness is from
that on the grid before, over its largest entry.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import petalfoil
from petalfoil.case import Case
from petalfoil.equilibrium.coarse_film import COARSE_FILM_CELLS
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.verification.test_results_from_points import TEN

CELLS = (32, 64, 128, 256, 512, 1024)
STEP, POINTS = 5e-7, 5
"""Distance of the followed positions [m], and how many they are with the first."""

HEAD = (
    "| bearing | cells | pack + film + probe | coarse film | by cells | followed, median | contacts | force, N | "
    "change of stiffness |\n|---|---:|---:|---:|---:|---:|---|---:|---:|"
)


def parts(record: Record) -> list[int]:
    """Factorisations of the pack, of film and pack, and of growth rates and other equilibria."""
    return [int(str(record.scalars[name])) for name in ("pack_iterations", "factorizations", "probe_factorizations")]


def under_coarse_film(record: Record) -> int:
    """Factorisations under the coarse film."""
    return int(str(record.scalars["coarse_factorizations"]))


def followed(case: Case, found: Record) -> float:
    """Median factorisations of the next points of a load characteristic, toward the centre unless it begins there."""
    x, y = (float(record_value(found, f"eccentricity_{axis}")) for axis in "xy")
    begin = math.hypot(x, y)
    way = -1.0 if begin > POINTS * STEP else 1.0
    places = [f"{begin + way * k * STEP} m" for k in range(POINTS)]
    points = petalfoil.curve.records(case, eccentricity=places, direction=f"{math.atan2(y, x)} rad")
    return float(np.median([sum(parts(point)) for point in list(points)[1:]]))


def record_value(record: Record, name: str) -> float:
    """A scalar result."""
    return float(str(record.scalars[name]))


def stiffness(case: Case, found: Record) -> NDArray[np.float64]:
    """Stiffness at the position that was found [N/m], (2, 2)."""
    place = tuple(record_value(found, f"eccentricity_{axis}") for axis in "xy")
    at = case.replace(**{"operation.eccentricity": place, "operation.load": None})
    return np.asarray(petalfoil.coefficients.record(at).fields["stiffness"][0], dtype=np.float64)


def main() -> None:
    """Print the table."""
    print(HEAD)
    for name, bearing in TEN.items():
        before: NDArray[np.float64] | None = None
        for cells in [int(given) for given in sys.argv[1:]] or CELLS:
            case = bearing.replace(**{"model.cells_per_pitch": cells})
            try:
                found = petalfoil.solve.record(case)
                K = stiffness(case, found)
                warm = followed(case.replace(**{"operation.load": None}), found)
            except ConvergenceError as failure:
                print(f"| {name} | {cells} | {failure} |", flush=True)
                continue
            change = "" if before is None else f"{100.0 * np.max(np.abs(K - before)) / np.max(np.abs(K)):.2g} %"
            kind = str(found.scalars["contact_model"]).split(" on ")[0].split(" of ")[0]
            counts = " + ".join(map(str, parts(found)))
            force, coarse = record_value(found, "bearing_force"), under_coarse_film(found)
            weighed = f"{coarse} | {sum(parts(found)) + coarse * COARSE_FILM_CELLS / cells:.3g}"
            print(
                f"| {name} | {cells} | {counts} | {weighed} | {warm:g} | {kind} | {force:.5g} | {change} |", flush=True
            )
            before = K


if __name__ == "__main__":
    main()
