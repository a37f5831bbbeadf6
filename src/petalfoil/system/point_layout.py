"""What stays the same of the equations with contact points: petals of Hermite elements under the film of the nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.gap_curves import GapCurves
from petalfoil.physics.mass_balance import Entries
from petalfoil.sparsity import SparseRows, SummedEntries, Triplets
from petalfoil.system.point_tables import PointTables
from petalfoil.walls.element_pack import ElementPack

if TYPE_CHECKING:
    from petalfoil.system.bearing_layout import BearingLayout

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointLayout:
    """What stays the same while speed, position and contacts change, over the units of the problem.

    Attributes
    ----------
    pack : ElementPack
        The petals.
    layout : BearingLayout
        Film, units and forces, those of the nodal pack.
    """

    pack: ElementPack
    layout: BearingLayout

    @property
    def n_wall(self) -> int:
        """Unknowns of the petals."""
        return self.pack.n_unknown

    @property
    def n_film(self) -> int:
        """Pressures."""
        return self.layout.wall.film.n_unknown

    @cached_property
    def bending(self) -> SparseRows:
        """`B` with `K = B^T B` [1]."""
        return SparseRows(self.pack.bending * math.sqrt(self.layout.scales.length / self.layout.scales.force))

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """`K` [1]."""
        return sp.csr_array(self.bending.T @ self.bending)

    def elastic(self, w: Array) -> Array:
        """`K w` from changes of curvature: a small part of the digits that the sum of `K`'s entries loses."""
        return np.asarray(self.bending.T @ (self.bending @ w))

    @cached_property
    def stiffness_size(self) -> SparseRows:
        """Magnitudes of the entries of `K` [1]."""
        return SparseRows(abs(self.stiffness))

    @cached_property
    def curves(self) -> GapCurves:
        """The gap curves [1]."""
        scales, curves = self.layout.scales, self.pack.curves
        return replace(
            curves,
            rest=curves.rest / scales.length,
            by_e=np.asfortranarray(curves.by_e),  # products with a vector take half as long by columns
            by_w=SparseRows(curves.by_w),
            compliance=curves.compliance * (scales.force / scales.length),
            softness=curves.softness * (scales.force / scales.length),
        )

    @cached_property
    def tables(self) -> PointTables:
        """The same for compiled loops."""
        return PointTables.of(self)

    @property
    def journal_entries(self) -> int:
        """Nodal (value, slope) of the gaps toward the journal, which come first."""
        return 2 * int(self.curves.first[self.pack.mesh.count])

    @property
    def journal_friction(self) -> float:
        """`mu_f` of a journal that drags petals along, and is held back; 0 where its rubbing is torque alone [1]."""
        case = self.layout.case
        return case.surface.friction_coefficient if case.drags_petals else 0.0

    @cached_property
    def reaction_on_journal(self) -> Array:
        """Force on the journal by unit loads on the nodal gaps, with its dry friction (D7), (2 n_node, d)."""
        return np.asarray(self.curves.by_e + self.rubbing_on_journal)

    @cached_property
    def rubbing_on_journal(self) -> Array:
        """What dry friction of a journal that turns adds to it, (2 n_node, d)."""
        normal = self.curves.by_e
        along = np.zeros_like(normal)
        along[:, 0::2], along[:, 1::2] = -normal[:, 1::2], normal[:, 0::2]
        return self.journal_friction * along

    @cached_property
    def film_by_w(self) -> SparseRows:
        """Derivative of the film thickness by the petals' unknowns, (film nodes, n_wall)."""
        return SparseRows(self.pack.film_rows @ self.curves.by_w)

    @cached_property
    def fixed(self) -> Triplets:
        """Entries of the rows of the wall by deflections and pressures, which come first: `K`, `-A`."""
        return Triplets.of(sp.hstack([self.stiffness, -self.push], format="csr"))

    @cached_property
    def film_entries(self) -> tuple[SummedEntries, SummedEntries]:
        """Entries of the film's tangent by pressures and by the petals' unknowns, from those of `FilmState.tangent`."""
        rows = self.layout.film_rows
        return self._film_entries(rows.by_pressure, rows.by_film)

    @cached_property
    def storage_entries(self) -> tuple[SummedEntries, SummedEntries]:
        """The same of what the film stores, from those of `FilmState.storage`."""
        rows = self.layout.film_rows
        return self._film_entries(rows.storage_by_pressure, rows.storage_by_film)

    def _film_entries(self, by_pressure: Entries, by_film: Entries) -> tuple[SummedEntries, SummedEntries]:
        same = sp.csr_array(sp.eye_array(self.n_film))
        return (
            SummedEntries.of_product(by_pressure.rows, by_pressure.cols, same),
            SummedEntries.of_product(by_film.rows, by_film.cols, self.film_by_w),
        )

    @cached_property
    def film_by_e(self) -> Array:
        """Derivative of the film thickness by the journal's displacement, (film nodes, d)."""
        return np.asfortranarray(self.pack.film_rows @ self.curves.by_e)

    @cached_property
    def push(self) -> SparseRows:
        """`A`: generalised forces on the petals from the pressure unknowns, (n_wall, n_film)."""
        wall, scales = self.layout.wall, self.layout.scales
        unknown = wall.film.unknown.ravel()
        nodes = np.flatnonzero(unknown >= 0)
        area = wall.load_area.ravel()[nodes] * scales.pressure / scales.force
        shape = (len(unknown), self.n_film)
        nodal = sp.coo_array((area, (nodes, unknown[nodes])), shape=shape).tocsr()
        return SparseRows(self.film_by_w.T @ nodal)
