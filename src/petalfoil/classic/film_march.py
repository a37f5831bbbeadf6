"""Pressure at given deflections: explicit time steps until the film is steady (51)-(59), (Q1)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.film_cells import film_cells
from petalfoil.classic.kernels import KernelBackend, MarchSettings, kernels
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


@dataclass
class FilmMarch:
    """Time steps of the film of one bearing at one speed.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing.
    options : ClassicOptions
        Fraction of the stable time step.
    engine : KernelBackend or None
        Inner loops; None takes the fastest installed.
    steps : int
        Number of time steps so far.
    """

    problem: CoupledProblem
    options: ClassicOptions
    engine: KernelBackend | None = None
    steps: int = field(default=0, init=False)

    @property
    def passage(self) -> float:
        """Time in which the gas passes along a strip, in the unit of (51); 1 at zero speed [1]."""
        phi, Lam = self.problem.layout.balance.mesh.phi, self.problem.bearing_number
        return float(phi[-1] - phi[0]) / Lam if Lam > 0.0 else 1.0

    def advance(self, P: Array, H: Array, tolerance: float, max_steps: int) -> bool:
        """Advance `P` (strip, node, axial) in place; whether it has become steady.

        A film is steady if its pressures would change by less than `tolerance` (over ambient pressure) in the time in
        which the gas passes a strip.
        """
        cells = film_cells(self.problem.layout.balance, H, self.problem.bearing_number)
        settings = MarchSettings(self.options.time_step_fraction, self.passage, tolerance, max_steps)
        steps, change = kernels(self.engine).march(P.reshape(-1), cells, settings)
        self.steps += steps
        return change <= tolerance
