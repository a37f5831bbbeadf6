"""Tasks of the comparison with an earlier state, in the sources that PYTHONPATH names: a line of JSON for each.

    python benchmarks/former_tasks.py TASK [TASK ...] [--quick] [KEY=VALUE ...]

Keys and values change the cases of the task, such as model.contacts=nodes.

Processor time is that of the call alone, after a small solution has loaded all that is needed. Factorisations are those
of the results.
"""

from __future__ import annotations

import importlib.util
import json
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import petalfoil
from petalfoil.case import Case

SOURCES = Path(petalfoil.__file__).parents[2]
EXAMPLES = (SOURCES if (SOURCES / "examples").is_dir() else Path(__file__).parents[1]) / "examples"
"""The cases as the sources read them: the same bearings, in an earlier state under earlier keys."""


CHANGES: dict[str, object] = {}
"""Other keys of the cases, by path."""


def pack(name: str, cells: int, axial: int = 0, down: float = 0.0) -> Case:
    """One of the example packs on a grid, the journal displaced by `down` [m]; `cells` 0 leaves the default grid."""
    changes: dict[str, object] = {"operation.eccentricity": (0.0, -down)}
    changes |= {"model.cells_per_pitch": cells} if cells else {}
    changes |= {"model.axial_cells": axial} if axial else {}
    changes |= CHANGES
    return Case.load(EXAMPLES / f"{name}.toml").replace(**changes)


def records(case: Case, displacements: NDArray[np.float64]) -> Iterator[object]:
    """The points of a curve as they are found, in either state."""
    if hasattr(petalfoil.curve, "records"):
        return iter(petalfoil.curve.records(case, displacements))
    from petalfoil.analysis import load_curve  # an earlier name

    return iter(load_curve.iterate(case, displacements.tolist()))


def cold_3d(quick: bool) -> None:
    """A position from nothing in 3-D, on the default grid."""
    petalfoil.solve(pack("paper_n8_spatial", *((8, 4) if quick else (0, 0)), down=2e-4))


def warm_3d(quick: bool) -> float:
    """Three followed points of a curve in 3-D [s]."""
    case = pack("paper_n8_spatial", *((8, 4) if quick else (24, 16)))
    points = records(case, 2e-5 * np.arange(4))
    next(points)
    begin = time.process_time()
    for _ in points:
        pass
    return time.process_time() - begin


def curve_2d(quick: bool) -> None:
    """Fifteen points of a load characteristic in 2-D."""
    petalfoil.curve(pack("paper_n8", 12 if quick else 0), np.linspace(0.0, 280e-6, 15))


def frequencies_3d(quick: bool) -> None:
    """Stiffness and damping at twenty frequencies in 3-D."""
    case = pack("paper_n8_spatial", *((8, 4) if quick else (24, 16)), down=1e-4)
    petalfoil.coefficients(case, frequencies=np.linspace(400.0, 8000.0, 20))


def threshold(quick: bool) -> None:
    """Critical mass, natural modes and threshold speed in 2-D."""
    petalfoil.stability(pack("paper_n8", 12 if quick else 0), load="20 N", mass="2 kg")


def liftoff(quick: bool) -> None:
    """Lift-off and touchdown of the rig in 2-D."""
    petalfoil.liftoff(pack("rig", 12 if quick else 0), loads=[46.4])


def runup(quick: bool) -> None:
    """A run-up of the rig over nine speeds and back."""
    petalfoil.runup(pack("rig", 12 if quick else 0), load="46.4 N", to="12000 rpm", points=5 if quick else 9)


def orbit_2d(quick: bool) -> None:
    """Six turns in 2-D."""
    petalfoil.orbit(pack("orbit_n8", 12 if quick else 0), revolutions=0.2 if quick else 6.0)


def orbit_fifth(quick: bool) -> float:
    """Six turns in 2-D, the fifth such motion of a process [s]: with numba it has paid for compiled loops by then."""
    for _ in range(0 if quick else 4):
        orbit_2d(quick)
    begin = time.process_time()
    orbit_2d(quick)
    return time.process_time() - begin


def spatial_orbit(quick: bool) -> Case:
    """The rotor of the motions in 3-D."""
    case = pack("orbit_n8", *((8, 4) if quick else (24, 16)))
    spatial = pack("paper_n8_spatial", 8, 4)
    changes: dict[str, object] = {"model.kind": spatial.model.kind}
    if hasattr(spatial.petals, "theory"):  # petals that bend only, the only ones of the earlier state
        changes["petals.theory"] = spatial.petals.theory
    return case.replace(**changes)


def orbit_3d(quick: bool) -> None:
    """Three turns in 3-D."""
    petalfoil.orbit(spatial_orbit(quick), revolutions=0.2 if quick else 3.0)


def per_turn(case: Case, few: float, many: float) -> float:
    """A further turn of a motion: `many` turns less a `few`, each over their difference [s].

    A first turn is not counted: with numba it loads the loops, of which a motion of many turns pays for.
    """
    compiled = "petalfoil.system.compiled_points"
    if importlib.util.find_spec("numba") and importlib.util.find_spec(compiled.rpartition(".")[0]):
        importlib.import_module(compiled)
    spent = []
    for turns in (1.0, few, many):
        begin = time.process_time()
        petalfoil.orbit(case, revolutions=turns)
        spent.append(time.process_time() - begin)
    return (spent[2] - spent[1]) / (many - few)


def orbit_turn_2d(quick: bool) -> float:
    """A turn in 2-D, without the start of the motion [s]."""
    return per_turn(pack("orbit_n8", 12 if quick else 0), *((1.0, 2.0) if quick else (6.0, 46.0)))


def orbit_turn_3d(quick: bool) -> float:
    """A turn in 3-D, without the start of the motion [s]."""
    return per_turn(spatial_orbit(quick), *((1.0, 2.0) if quick else (2.0, 8.0)))


def designs(quick: bool) -> None:
    """Packs of other thickness and bend radius in 2-D, on 64 cells per pitch."""
    rng = np.random.default_rng(3)
    for _ in range(2 if quick else 12):
        changes = {"petals.thickness": rng.uniform(0.12e-3, 0.2e-3), "petals.bend_radius": rng.uniform(0.035, 0.05)}
        petalfoil.solve(pack("paper_n8", 64, down=1e-4).replace(**changes))


ASKED = (
    cold_3d,
    warm_3d,
    curve_2d,
    frequencies_3d,
    threshold,
    liftoff,
    runup,
    orbit_2d,
    orbit_fifth,
    orbit_3d,
    orbit_turn_2d,
    orbit_turn_3d,
    designs,
)
TASKS: dict[str, Callable[[bool], float | None]] = {task.__name__: task for task in ASKED}


VERBS = ("solve", "curve", "coefficients", "stability", "liftoff", "runup", "orbit")
"""What the tasks ask, loaded before the clock starts: an earlier state loads all at once, the present one as asked."""


def main(names: list[str], quick: bool, changes: dict[str, str]) -> None:
    """Run tasks, their cases with other keys, and print the processor time of each."""
    warnings.simplefilter("ignore")
    for verb in VERBS:
        getattr(petalfoil, verb)
    petalfoil.solve(pack("paper_n8", 16))
    CHANGES.update(changes)
    for name in names:
        begin = time.process_time()
        own = TASKS[name](quick)
        print(json.dumps({"seconds": time.process_time() - begin if own is None else own, "task": name}))


if __name__ == "__main__":
    words = sys.argv[1:]
    main([one for one in words if one in TASKS], "--quick" in words, dict(w.split("=", 1) for w in words if "=" in w))
