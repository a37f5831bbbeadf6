"""The film at given deflections, marched in time until it is steady (51)-(59), (Q1)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.film_cells import film_cells
from petalfoil.classic.kernels import Engine, March, kernels
from petalfoil.classic.options import ClassicOptions
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


@dataclass
class FilmMarch:
    """The film of one bearing at one speed.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing.
    options : ClassicOptions
        Share of the stable step.
    engine : Engine or None
        Which inner loops run; the fastest that is installed if None.
    steps : int
        Time steps taken so far.
    """

    problem: CoupledProblem
    options: ClassicOptions
    engine: Engine | None = None
    steps: int = field(default=0, init=False)

    @property
    def passage(self) -> float:
        """Time that the gas needs to pass along a strip, in the units of (51); 1 for a shaft at rest [1]."""
        phi, Lam = self.problem.layout.balance.mesh.phi, self.problem.bearing_number
        return float(phi[-1] - phi[0]) / Lam if Lam > 0.0 else 1.0

    def advance(self, P: Array, H: Array, tolerance: float, max_steps: int) -> bool:
        """March `P` (strip, node, axial) in place; whether it has become steady.

        Steady is what would change by less than `tolerance` of ambient pressure while the gas passes a strip.
        """
        cells = film_cells(self.problem.layout.balance, H, self.problem.bearing_number)
        drive = March(self.options.time_share, self.passage, tolerance, max_steps)
        steps, change = kernels(self.engine).march(P.reshape(-1), cells, drive)
        self.steps += steps
        return change <= tolerance
