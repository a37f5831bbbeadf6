"""Stiffness and damping of a journal that tilts: 4 by 4, in the blocks of force and moment, displacement and slope."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.results.variable import Variable
from petalfoil.system.build import lever_of

Array = NDArray[np.float64]

ENTRIES = ("whirl_frequency", "row", "column")
"""Dimensions of stiffness and damping."""
TILTING = {
    "stiffness_force_tilt": Variable(ENTRIES, "N rad-1", "stiffness, force by slope of the journal's axis", "K_Fa"),
    "stiffness_moment_displacement": Variable(ENTRIES, "N", "stiffness, moment by displacement", "K_Me"),
    "stiffness_moment_tilt": Variable(ENTRIES, "N m rad-1", "stiffness, moment by slope of the axis", "K_Ma"),
    "damping_force_tilt": Variable(ENTRIES, "N s rad-1", "damping, force by slope of the journal's axis", "C_Fa"),
    "damping_moment_displacement": Variable(ENTRIES, "N s", "damping, moment by displacement", "C_Me"),
    "damping_moment_tilt": Variable(ENTRIES, "N m s rad-1", "damping, moment by slope of the axis", "C_Ma"),
}
"""Stiffness and damping of a journal that tilts."""
FORCE, MOMENT = slice(0, 2), slice(2, 4)
"""Rows of force and moment, columns of displacement and slopes."""
TILT_BLOCKS = {"force_tilt": (FORCE, MOMENT), "moment_displacement": (MOMENT, FORCE), "moment_tilt": (MOMENT, MOMENT)}
"""Rows and columns of the blocks of a journal that tilts, beside those of force and displacement."""


def blocks(case: Case, pairs: list[tuple[Array, Array]]) -> dict[str, Array]:
    """Stiffness and damping at each frequency by name, (frequency, 2, 2) each; of a journal that tilts all blocks."""
    both = {"stiffness": np.array([K for K, _ in pairs]), "damping": np.array([C for _, C in pairs])}
    fields = {name: matrix[:, :2, :2] for name, matrix in both.items()}
    if next(iter(both.values())).shape[1] == 2:
        return fields
    lever = np.array([1.0, 1.0, lever_of(case), lever_of(case)])  # of slopes, and of moments
    for name, matrix in both.items():
        scaled = matrix * lever[:, None] * lever
        fields |= {f"{name}_{block}": scaled[:, row, col] for block, (row, col) in TILT_BLOCKS.items()}
    return fields
