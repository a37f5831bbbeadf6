"""The equations of a stage with contact points, evaluated in compiled loops."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.system.compiled_points import overlaps, point_rows, relative_changes
from petalfoil.system.point_step import PointStepEquations
from petalfoil.system.point_tables import PointPlaces, PointRows, StepNumbers

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CompiledStepEquations(PointStepEquations):
    """The same numbers as those of `PointStepEquations`, all rows at once; tangents are those of NumPy."""

    @cached_property
    def rows(self) -> PointRows:
        """All rows at the state."""
        state, problem = self.state, self.problem
        at = StepNumbers(
            problem.displacement,
            float(problem.closing),
            float(problem.bearing_number),
            float(problem.time_number),
            float(problem.rate),
            problem.start,
        )
        return point_rows(self.whole.tables, state.w, state.P, self._placed, at)

    @cached_property
    def _placed(self) -> PointPlaces:
        points = self.state.points
        return PointPlaces(points.every_curve, points.every_position, points.reaction, points.ends)

    @cached_property
    def nodal_gaps(self) -> Array:
        """Nodal (value, slope) of all gap curves."""
        return self.rows.gaps

    @cached_property
    def film_thickness(self) -> Array:
        """At every film node, (strip, node, axial) [1]."""
        return self.rows.thickness[:, :, None]

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """Wall, film with what it stores (O2), gaps of all points, slopes of the travelling ones."""
        rows = self.rows
        return rows.wall, rows.film, rows.value, rows.slope

    @cached_property
    def row_scales(self) -> tuple[Array, Array]:
        """What residuals of wall and film are compared with."""
        return self.rows.wall_scale, self.rows.film_scale

    @property
    def gas(self) -> Array:
        """Gas in the cell of each pressure (F5), (n_film,) [1]."""
        return self.rows.mass

    @cached_property
    def travels(self) -> Array:
        """1 for a travelling point, 0 where it is at an end of its curve, (k,)."""
        return self.rows.contacts.travels

    @cached_property
    def idle(self) -> Array:
        """1 for a point at a root, which bears on the bushing without a reaction; (j,)."""
        return self.rows.contacts.idle

    @cached_property
    def _nodal_loads(self) -> Array:
        """Reactions on the nodal (value, slope) of the gaps."""
        return self.rows.contacts.loads

    @property
    def end_slopes(self) -> Array:
        """Slopes of the gaps at the travelling points, (k,)."""
        return self.rows.contacts.slope[self.state.points.ends]

    @cached_property
    def wall_imbalance(self) -> float:
        """Largest residual of the petals' rows over what they are compared with."""
        return self.rows.imbalance[0]

    @cached_property
    def film_imbalance(self) -> float:
        """Largest residual of the film's rows over the flows of their cells."""
        return self.rows.imbalance[1]

    @cached_property
    def opening(self) -> float:
        """Largest gap, and slope by the place in an element, at the contact points [reference films]."""
        return self.rows.imbalance[2]

    def relative_changes(self, change: Array, move: Array) -> tuple[float, float]:
        """The most that pressures or films fall by, and that pressures grow by [1]."""
        whole, P = self.whole, self.state.P
        first = change[: whole.n_wall + whole.n_film]
        return relative_changes(whole.tables.moves, P, self.rows.thickness, first, move)

    def may_overlap(self, depth: float, per_element: int) -> bool:
        """Whether some gap of as many samples per element is below zero by `depth` [1]."""
        return overlaps(self.whole.tables.curves, self.rows.gaps, self._placed, depth, per_element)
