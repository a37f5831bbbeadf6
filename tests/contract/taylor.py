"""Taylor's test of a tangent, and the states to take it at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.system.coupled import CoupledProblem
from tests.cases import case

Array = NDArray[np.float64]

SLOPE = 2.0
TOLERANCE = 0.05
HALVINGS = 5


def taylor_slopes(along: Callable[[float], Array], change: Array, largest: float = 2.0**-7) -> Array:
    """Slopes of the remainder `|f(t) - f(0) - t f'(0)|` between steps `t`, each half of the one before.

    2 says that `change` is the derivative; 1 that it is not. Steps of 1e-2 to 1e-4 of the unknowns leave the next
    order of the series below 1 % of the remainder, and rounding too.
    """
    start = along(0.0)
    remainder = [float(np.linalg.norm(along(t) - start - t * change)) for t in largest * 0.5 ** np.arange(HALVINGS + 1)]
    assert remainder[-1] > 0.0, "the function is linear: there is no remainder to measure"
    return np.asarray(np.log2(np.array(remainder[:-1]) / np.array(remainder[1:])))


def assert_tangent(along: Callable[[float], Array], change: Array, largest: float = 2.0**-7) -> None:
    """The remainder falls with slope 2 ± 0.05."""
    np.testing.assert_allclose(taylor_slopes(along, change, largest), SLOPE, rtol=0.0, atol=TOLERANCE)


BEARINGS: dict[str, tuple[str, str, str, bool]] = {
    "plain, 2d": ("plain_journal", "2d", "ambient", True),
    "plain, half": ("plain_journal", "3d", "ambient", True),
    "plain, whole": ("plain_journal", "3d", "ambient", False),
    "petals, 2d": ("paper_n8", "2d", "ambient", True),
    "petals, half": ("paper_n8", "3d", "ambient", True),
    "petals, whole": ("paper_n8", "3d", "ambient", False),
    "stepped petals, 2d": ("paper_n8", "2d", "continuous", True),
    "stepped petals, half": ("paper_n8", "3d", "continuous", True),
    "stepped petals, whole": ("paper_n8", "3d", "continuous", False),
    "tilted petals, whole": ("paper_n8", "3d", "ambient", True),
    "tilting petals, whole": ("paper_n8", "3d", "continuous", True),
    "stretching petals, half": ("paper_n8", "3d", "ambient", True),
    "stretching petals, whole": ("paper_n8", "3d", "continuous", False),
    "backed petals, 2d": ("backed_petals", "2d", "ambient", True),
    "backed petals, whole": ("backed_petals", "3d", "continuous", False),
    "bump foil, 2d": ("bump_foil", "2d", "ambient", True),
    "bump foil, half": ("bump_foil", "3d", "ambient", True),
    "bending bump foil, whole": ("bump_foil", "3d", "ambient", False),
    "rubbed petals, 2d": ("paper_n8", "2d", "ambient", True),
    "rubbed stretching petals, half": ("paper_n8", "3d", "ambient", True),
    "rubbed plain, 2d": ("plain_journal", "2d", "ambient", True),
    "slipping plain, 2d": ("plain_journal", "2d", "ambient", True),
    "slipping plain, half": ("plain_journal", "3d", "ambient", True),
    "slipping petals, half": ("paper_n8", "3d", "ambient", True),
    "slipping stepped petals, 2d": ("paper_n8", "2d", "continuous", True),
}
"""Example, kind, edges, symmetry; the slipping ones in a gas so thin that slip is a good part of the flow."""

THIN = {"model.slip": True, "gas.ambient_pressure": 2e3}
"""The mean free path is 3.4 um: Knudsen numbers of 0.1 to 0.3 on the reference films."""


TILTED = {"operation.tilt": (3e-4, -2e-4)}
TILTING = {"operation.moment": (0.0, 0.0)}
"""A journal that is held at slopes, and one that is free to tilt."""
RUBBED = {"surface.journal_rubbing": "force", "surface.friction_coefficient": 0.4}
"""A journal that drags petals along."""
BENDING = {
    "bump_foil.top_foil_thickness": "0.2 mm",
    "bump_foil.youngs_modulus": "213 GPa",
    "bump_foil.poisson_ratio": 0.29,
}
"""A top foil that bends over springs."""


def theory_of(name: str) -> dict[str, object]:
    """Petals that stretch where the name says so."""
    return {"petals.theory": "shell" if "stretching" in name else "inextensible"}


def bearing(name: str) -> Case:
    """One of `BEARINGS` on a coarse grid."""
    example, kind, edges, symmetry = BEARINGS[name]
    changes: dict[str, object] = {
        "model.kind": kind,
        "model.edges": edges,
        "model.symmetry": symmetry,
        "model.cells_per_pitch": 6 if "petals" in name else 16,
        "model.axial_cells": 4,
        **(BENDING if name.startswith("bending") else {}),
        **(theory_of(name) if "petals" in name and kind == "3d" else {}),
        **(RUBBED if name.startswith("rubbed") else {}),
        **(THIN if name.startswith("slipping") else {}),
        **(TILTED if name.startswith("tilted") else {}),
        **(TILTING if name.startswith("tilting") else {}),
    }
    return case(example, **changes)


def open_state(problem: CoupledProblem, rng: np.random.Generator) -> Array:
    """Unknowns `[w, P]` with films between 0.5 and 2 of the reference film and pressures between 0.7 and 1.7."""
    layout = problem.layout
    w = rng.uniform(-1.0, 1.0, layout.n_wall)
    rest = problem.film(np.concatenate([np.zeros(layout.n_wall), np.ones(layout.n - layout.n_wall)]))
    under = layout.wall.film_unknown
    film = rng.uniform(0.5, 2.0, rest.shape)
    w[under[under >= 0]] = (film - rest)[under >= 0]
    return np.concatenate([w, rng.uniform(0.7, 1.7, layout.n - layout.n_wall)])
