"""Which motions are evaluated in compiled loops, where numba is installed: by what is still to be paid for them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.compiled import is_on_disk, numba_is_installed
from petalfoil.system.point_step import PointStepEquations

if TYPE_CHECKING:
    from petalfoil.dynamics.tr_bdf2 import RotorBearing

LOOPS = "petalfoil.system.compiled_points"
"""The module of the loops, which a process has once it has paid for them: its import is that of numba."""

TO_LOAD = 500.0
"""Steps that gain the time in which numba is imported and loops on disk are loaded."""

TO_COMPILE = 1000.0
"""Steps that are compiled for: a seventh of those that gain the time it takes, once for an installation."""


@dataclass
class StepsBefore:
    """Steps of motions in NumPy that loops would have served."""

    steps: float = 0.0


BEFORE = StepsBefore()
"""Those of this process."""


def worth_compiling(bearing: RotorBearing, steps: float) -> bool:
    """Whether a motion of as many `steps` or more is evaluated in compiled loops.

    They know contact points without friction, between petals or of a journal that drags them along. Steps of earlier
    motions count (`BEFORE`): many short ones then take no longer than they would have with loops from the first on, by
    more than loading takes.
    """
    plain = bearing.points is not None and bearing.friction is None and not bearing.points.journal_friction
    if not plain or not numba_is_installed():
        return False
    if LOOPS in sys.modules or BEFORE.steps + steps >= (TO_LOAD if compiled_before() else TO_COMPILE):
        return True
    BEFORE.steps += steps
    return False


@cache
def compiled_before() -> bool:
    """Whether what has been compiled of the loops is younger than all sources; looked at once in a process."""
    package = Path(__file__).parents[1]
    return is_on_disk(package / "system" / "compiled_points.py", "point_rows", package)


@cache
def compiled_equations() -> type[PointStepEquations]:
    """The equations in compiled loops; the first call imports numba."""
    from petalfoil.system.compiled_step import CompiledStepEquations

    return CompiledStepEquations
