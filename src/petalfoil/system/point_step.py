"""Film and petals with contact points within an implicit step in time: the film stores gas, the journal has mass.

    film     net outflow + rate (m(P, H) - m_start) = 0                                                (O2)
    rotor    F + L - S e = 0 ,  S = M rate^2 + N rate                                                  (O3)

`L` has all of (O3) that does not depend on the position, `N` turns velocities across. Petals and contacts are as at
rest, (C6) to (C8): a stage in time is a balance under the load `L` of a journal that springs `S` hold.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.system.point_equations import PointEquations
from petalfoil.system.time_step import StepProblem, StoringFilm

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointStepEquations(PointEquations):
    """The equations of a stage at one state.

    Attributes
    ----------
    problem : StepProblem
        Speed and position, and what the film's storage starts from.
    resists : (d, d) array
        `S` [1].
    """

    problem: StepProblem
    resists: Array = field(default_factory=lambda: np.zeros((2, 2)))

    @cached_property
    def film(self) -> StoringFilm:
        """The film's rows; its storage has the bearing number of a radian per unit of time."""
        layout, problem = self.whole.layout, self.problem
        pressure = layout.balance.nodal_pressure(self.state.P)
        return StoringFilm(layout.film_rows, pressure, self.film_thickness, problem.bearing_number, problem.time_number)

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """Wall, film with what it stores (O2), gaps of all points, slopes of the travelling ones."""
        wall, film, value, slope = super().residual
        if not self.problem.rate:
            return wall, film, value, slope
        return wall, film + self.problem.rate * (self.gas - self.problem.start), value, slope

    @property
    def gas(self) -> Array:
        """Gas in the cell of each pressure (F5), (n_film,) [1]."""
        return self.film.mass

    @cached_property
    def film_imbalance(self) -> float:
        """Largest residual of the film's rows over the flows of their cells."""
        return float(np.max(np.abs(self.residual[1] / self.row_scales[1]), initial=0.0))

    @cached_property
    def wall_imbalance(self) -> float:
        """Largest residual of the petals' rows over what they are compared with."""
        return float(np.max(np.abs(self.residual[0]) / self.row_scales[0], initial=0.0))

    @cached_property
    def opening(self) -> float:
        """Largest gap, and slope by the place in an element, at the contact points [reference films]."""
        return float(max(np.max(np.abs(part), initial=0.0) for part in self.residual[2:]))

    @cached_property
    def steady(self) -> sp.csc_array:
        """The tangent, storage included."""
        tangent = super().steady
        return tangent if not self.problem.rate else sp.csc_array(tangent + self.problem.rate * self.stored)

    def forcing(self, rate: float = 0.0) -> Array:
        """Derivative of the rows by the journal's displacement, storage included."""
        return super().forcing(self.problem.rate + rate)

    @property
    def force(self) -> Array:
        """Force of film and contacts on the journal less that of the springs `S`, over the unit of force, (d,)."""
        return np.asarray(self.journal_force - self.resists @ self.problem.displacement)

    @property
    def force_direct(self) -> Array:
        """Derivative of the force by the displacement, unknowns held: `-S`, (d, d)."""
        return -self.resists
