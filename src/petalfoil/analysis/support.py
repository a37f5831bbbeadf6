"""A bearing on a shaft that another bearing carries too: its equilibrium where the shaft moves its journal (O7)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import WARM, follow, restart
from petalfoil.equilibrium.heated import ThermalRunawayError, heated, stiffness
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import from_neighbour
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import arm_of, askew_of, build_problem, build_tilting, lever_of
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.heat_network import HeatNetwork

Array = NDArray[np.float64]
Vector = tuple[float, float]

SAME_PLACE = 1e-14
"""Movement of the journal that counts as zero, in reference films."""

BORROWED = replace(WARM, tangents=2, borrow=True)
"""The last tangent serves as long as its steps contract; with more than two new ones the bearing is followed anew."""

PARTS = (1, 4)
"""Parts into which a step is cut where a bearing does not follow it at once."""


@dataclass(frozen=True)
class Support:
    """A bearing on the shaft.

    Attributes
    ----------
    case : Case
        The bearing alone, its slopes those at which it stands askew.
    place : float
        Where it is, from the mass centre along the shaft [m].
    network : HeatNetwork or None
        Where its heat goes.
    """

    case: Case
    place: float
    network: HeatNetwork | None

    @cached_property
    def problem(self) -> CoupledProblem:
        """The bearing under a journal that is free to tilt; a 2-D film does not feel the slopes."""
        return build_problem(self.case) if self.case.model.kind is ModelKind.TWO_D else build_tilting(self.case)

    @property
    def tilts(self) -> bool:
        """Whether slopes are among the coordinates of its journal."""
        return self.case.model.kind is not ModelKind.TWO_D

    @property
    def by_shaft(self) -> Array:
        """Position of its journal, slopes times the lever, by that of the shaft (x, y, a_x, a_y); (n_position, 4)."""
        return arm_of(self.case, self.place)

    @property
    def askew(self) -> Array:
        """Position of its journal, slopes times the lever, under a shaft at the origin, (n_position,) [m]."""
        return askew_of(self.case)

    def displacement(self, q: Array) -> Array:
        """Displacement of its journal over the reference length under a shaft at `q` (4,); (n_position,) [1]."""
        return np.asarray((self.askew + self.by_shaft @ q) / self.problem.layout.scales.length)

    def slopes(self, found: Solution) -> Vector:
        """Slopes of its journal [rad]."""
        a_x, a_y = found.problem.displacement[2:] * found.problem.layout.scales.length / lever_of(self.case)
        return float(a_x), float(a_y)

    def force(self, found: Solution) -> Array:
        """Force and moment about the mass centre on the shaft, (4,) [N, N m]."""
        pushed = replace(found, load=None).unbalanced * found.problem.layout.scales.force
        return np.asarray(self.by_shaft.T @ pushed)

    def resists(self, found: Solution) -> Array:
        """Stiffness against the shaft's position, (4, 4)."""
        scales = found.problem.layout.scales
        K = stiffness(found, self.network) * scales.force / scales.length
        return np.asarray(self.by_shaft.T @ K @ self.by_shaft)

    def moved(self, known: Solution, q: Array) -> Solution:
        """The equilibrium under a shaft at `q`, from one at another position.

        Raises
        ------
        ConvergenceError
            None was found.
        """
        start, end = known.problem.displacement, self.displacement(q)
        if np.max(np.abs(end - start)) <= SAME_PLACE:
            return known
        for parts in PARTS:
            found: Solution | None = known
            for part in range(1, parts + 1):
                here = known.problem.at(displacement=start + part / parts * (end - start))
                found = None if found is None else self._followed(found, here)
            if found is not None:
                return found
        raise no_way()

    def _followed(self, known: Solution, here: CoupledProblem) -> Solution | None:
        found = follow(known, here, BORROWED) or follow(known, here) or restart(known, here)
        try:
            return None if found is None else self.warm(found)
        except ThermalRunawayError as failure:
            current_run().note("shaft", outcome=str(failure))
            return None

    def warm(self, found: Solution) -> Solution:
        """The equilibrium at its position with the temperatures of its network."""
        return found if self.network is None else heated(replace(found, load=None), self.network)

    def carrying(self, known: Solution, speed: float, load: Vector) -> Solution:
        """The equilibrium under a load [N] at a speed [rad/s], from a neighbour.

        Raises
        ------
        ConvergenceError
            None was found from there.
        """
        layout = known.problem.layout
        here = known.problem.at(bearing_number=layout.bearing_number(speed))
        found = from_neighbour(known, here, np.array(load) / layout.scales.force)
        if found is None:
            raise no_way()
        return replace(found if self.network is None else heated(found, self.network), load=None)

    def at_speed(self, known: Solution, speed: float) -> Solution:
        """The equilibrium at another speed [rad/s], the shaft where it was."""
        here = known.problem.at(bearing_number=known.problem.layout.bearing_number(speed))
        if here.bearing_number == known.problem.bearing_number:
            nodal = replace(known, elements=None, lines=None, elements_sought=False, nodal_force_difference=None)
            return replace(nodal, load=None)
        return self._followed(known, here) or self.warm(solve_cold(here))


def no_way() -> ConvergenceError:
    """The error of a bearing that does not follow the shaft."""
    return ConvergenceError(
        "a bearing of the rotor finds no equilibrium where the shaft moves to",
        history=current_run().history,
        advice="lower the load, or ask for each bearing alone under its part of it",
    )
