"""Which motions are evaluated in compiled loops: long ones, where numba is installed."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from petalfoil.compiled import numba_is_installed
from petalfoil.system.point_step import PointStepEquations

if TYPE_CHECKING:
    from petalfoil.dynamics.tr_bdf2 import RotorBearing

WORTH = 1000.0
"""Fewest steps of a motion that is evaluated in compiled loops."""


def worth_compiling(bearing: RotorBearing, steps: float) -> bool:
    """Whether a motion of as many `steps` or more takes less time in compiled loops, numba's import included.

    They know contact points without friction, between petals or of a journal that drags them along.
    """
    plain = bearing.points is not None and bearing.friction is None and not bearing.points.journal_friction
    return plain and steps >= WORTH and numba_is_installed()


@cache
def compiled_equations() -> type[PointStepEquations]:
    """The equations in compiled loops; the first call imports numba."""
    from petalfoil.system.compiled_step import CompiledStepEquations

    return CompiledStepEquations
