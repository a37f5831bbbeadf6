"""What of the coupled system stays the same while speed and position change: its unknowns and its constant entries."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case, HotGas, JournalRubbing
from petalfoil.case.growth import Growth
from petalfoil.physics.forces import film_force_rows, node_area
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.solvers.problem import Border
from petalfoil.sparsity import SparseRows, add_up
from petalfoil.system.film_rows import FilmRows
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.scales import Scales
from petalfoil.system.temperatures import Temperatures
from petalfoil.system.unknowns import DEFLECTION, PRESSURE, BlockEntries, BlockPattern, ExtraField, Unknowns
from petalfoil.walls import wall_kind
from petalfoil.walls.base import Wall
from petalfoil.walls.tilting import tilt_columns

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class BearingLayout:
    """What stays the same while speed and position change: mesh, places of entries, constant entries.

    Attributes
    ----------
    case : Case
        The bearing that was discretised.
    wall, balance, scales
        Its wall, the mass balance of its film, and the units of the unknowns.
    fields : tuple of ExtraField
        Fields beside deflection and pressure.
    """

    case: Case
    wall: Wall
    balance: FilmBalance
    scales: Scales
    fields: tuple[ExtraField, ...] = ()

    @cached_property
    def unknowns(self) -> Unknowns:
        """Blocks of the vector of unknowns."""
        sizes = {DEFLECTION: self.wall.n_unknown, PRESSURE: self.wall.film.n_unknown}
        return Unknowns({**sizes, **{field.name: field.size for field in self.fields}})

    @property
    def n(self) -> int:
        """All unknowns."""
        return self.unknowns.n

    @property
    def n_wall(self) -> int:
        """Deflection unknowns."""
        return self.wall.n_unknown

    @property
    def n_position(self) -> int:
        """Components of the journal's position: 2, or 4 where the shaft tilts."""
        return self.wall.n_position

    def ambient(self, deflection: Array) -> Array:
        """Unknowns (n,) of a wall with `deflection` under a film at ambient pressure."""
        initial = {field.name: field.initial for field in self.fields}
        return self.unknowns.join({DEFLECTION: deflection, PRESSURE: 1.0, **initial})

    def bearing_number(self, speed: float) -> float:
        """Bearing number (F1) of the gas as it enters, at an angular velocity [rad/s]."""
        return self.scales.bearing_number(self.case.gas.viscosity, speed, self.balance.radius)

    def speed(self, bearing_number: float) -> float:
        """Angular velocity at a bearing number of the gas as it enters [rad/s]."""
        return bearing_number / self.bearing_number(1.0)

    def closing(self, bearing_number: float, warm: Temperatures | None = None) -> float:
        """What growth takes from the gaps on the journal at a bearing number (G5), over the reference length [1]."""
        growth = self._growth if warm is None else self.case.growth_at(warm.shaft, warm.bushing)
        return growth.closing(self.speed(bearing_number)) / self.scales.length

    @cached_property
    def _growth(self) -> Growth:
        """How shaft and bushing have grown at the temperatures of the case."""
        return self.case.growth

    @cached_property
    def hot_gas(self) -> HotGas:
        """The gas as it warms up.

        Raises
        ------
        ValueError
            The case has no heat network.
        """
        if self.case.heat is None:
            raise ValueError("this case has no [heat]")
        return self.case.heat.of_gas(self.case.gas)

    @cached_property
    def elements(self) -> PointLayout | None:
        """The same bearing with contacts between nodes; None where it is not asked for so, or its shaft tilts."""
        plain = not self.fields and self.n_position == len(self.case.operation.eccentricity)
        points = plain and self.case.has_contact_points
        pack = wall_kind(self.case).elements(self.case, self.wall) if points else None
        return None if pack is None else PointLayout(pack, self)

    @cached_property
    def film_rows(self) -> FilmRows:
        """The film's equations."""
        return FilmRows(self.balance)

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """`K` in the units of the problem [1]."""
        return sp.csr_array(self.wall.elasticity.stiffness * (self.scales.length / self.scales.force))

    def elastic_force(self, w: Array, low_order: Array | None = None) -> Array:
        """`K w` by its factors, differences first; (n_wall,) [1]."""
        return self.wall.elasticity.force(w, low_order) * (self.scales.length / self.scales.force)

    @cached_property
    def stiffness_size(self) -> SparseRows:
        """Magnitudes of the entries of `K` [1]."""
        return SparseRows(abs(self.stiffness))

    @cached_property
    def loss(self) -> sp.csr_array | None:
        """Structural loss of the wall in the units of the problem (B5), (n_wall, n_wall) [1]; None without any."""
        loss = self.wall.loss
        return None if loss is None else sp.csr_array(loss * (self.scales.length / self.scales.force))

    def among_all(self, wall: sp.csr_array) -> sp.csc_array:
        """A matrix of the deflections (n_wall, n_wall) among all unknowns, (n, n)."""
        held = wall.tocoo()
        return sp.coo_array((held.data, (held.row, held.col)), shape=(self.n, self.n)).tocsc()

    @cached_property
    def push(self) -> SparseRows:
        """`A`: nodal forces on the wall from the pressure unknowns, (n_wall, n_film) [1]."""
        wall, unknown = self.wall.film_unknown.ravel(), self.wall.film.unknown.ravel()
        both = (wall >= 0) & (unknown >= 0)
        area = self.wall.load_area.ravel()[both] * self.scales.pressure / self.scales.force
        shape = (self.n_wall, self.wall.film.n_unknown)
        return SparseRows(sp.coo_array((area, (wall[both], unknown[both])), shape=shape))

    @cached_property
    def G(self) -> SparseRows:
        """Derivative of the gaps by all unknowns, (m, n) [1]."""
        by_w = self.wall.contacts.G
        return SparseRows(sp.hstack([by_w, sp.csr_array((by_w.shape[0], self.n - self.n_wall))], format="csr"))

    @cached_property
    def rubbing(self) -> SparseRows | None:
        """`mu_f D`: what else unit reactions on a journal that turns do to the wall (D6), (m, n_wall) [1].

        None where its rubbing is torque alone.
        """
        surface, contacts = self.case.surface, self.wall.contacts
        if surface.journal_rubbing is JournalRubbing.TORQUE or not surface.friction_coefficient:
            return None
        none = sp.csr_array(contacts.G.shape)
        dragged = none if self.wall.dragged is None else self.wall.dragged
        return SparseRows(surface.friction_coefficient * dragged)

    @cached_property
    def acting(self) -> SparseRows:
        """`H`: forces of unit reactions on all unknowns where the journal turns (D6), (m, n) [1]."""
        if self.rubbing is None:
            return self.G
        return SparseRows(self.G + sp.hstack([self.rubbing, sp.csr_array((len(self.weight), self.n - self.n_wall))]))

    @cached_property
    def rubbing_products(self) -> tuple[Index, Index, Index, Array] | None:
        """Entries of `(H - G)^T diag G`: rows, columns, gap, coefficient; a gap on the journal is of one deflection."""
        if self.rubbing is None:
            return None
        more, G = self.rubbing.tocoo(), self.wall.contacts.G
        gap, first = more.row.astype(np.intp), G.indptr[more.row]
        return more.col.astype(np.intp), G.indices[first].astype(np.intp), gap, more.data * G.data[first]

    @cached_property
    def weight(self) -> Array:
        """Area of each gap's node over a typical one, (m,) [1]."""
        return self.wall.contacts.area / self.wall.node_area

    @cached_property
    def film_column(self) -> Index:
        """Deflection unknown of every derivative by film thickness, -1 where the wall does not move."""
        return self.wall.film_unknown.ravel()[self.film_rows.by_film.cols]

    @cached_property
    def storage_column(self) -> Index:
        """Deflection unknown of every derivative of the stored mass by film thickness, -1 where none."""
        return self.wall.film_unknown.ravel()[self.film_rows.storage_by_film.cols]

    @cached_property
    def gap_products(self) -> tuple[Index, Index, Index, Array]:
        """Entries of `G^T diag G`: rows, columns, gap, coefficient."""
        G = self.wall.contacts.G
        held, gap = np.diff(G.indptr), np.repeat(np.arange(G.shape[0]), np.diff(G.indptr))
        every, first = np.arange(G.nnz), G.indptr[:-1][held == 2]  # a row holds one or two entries
        one = np.concatenate([every, first, first + 1])
        other = np.concatenate([every, first + 1, first])
        rows, cols = G.indices[one].astype(np.intp), G.indices[other].astype(np.intp)
        return rows, cols, gap[one].astype(np.intp), G.data[one] * G.data[other]

    @cached_property
    def contact_entries(self) -> BlockEntries:
        """Places of `G^T diag G` among the deflections."""
        rows, cols, _, _ = self.gap_products
        return BlockEntries(DEFLECTION, DEFLECTION, rows, cols)

    @cached_property
    def stiffness_entries(self) -> BlockEntries:
        """Places of `K` among the deflections."""
        K = self.stiffness.tocoo()
        return BlockEntries(DEFLECTION, DEFLECTION, K.row, K.col)

    @cached_property
    def pattern(self) -> BlockPattern:
        """Sparsity of the tangent with every contact, the same for all states."""
        A, by_P, by_H = self.push.tocoo(), self.film_rows.by_pressure, self.film_rows.by_film
        held_P, held_H = self.film_rows.storage_by_pressure, self.film_rows.storage_by_film
        moving, under = self.film_column >= 0, self.storage_column >= 0
        return BlockPattern(
            self.unknowns,
            [
                self.stiffness_entries,
                BlockEntries(DEFLECTION, PRESSURE, A.row, A.col),
                BlockEntries(PRESSURE, PRESSURE, by_P.rows, by_P.cols),
                BlockEntries(PRESSURE, DEFLECTION, by_H.rows[moving], self.film_column[moving]),
                self.contact_entries,
                BlockEntries(PRESSURE, PRESSURE, held_P.rows, held_P.cols),
                BlockEntries(PRESSURE, DEFLECTION, held_H.rows[under], self.storage_column[under]),
                *(entries for field in self.fields for entries in field.entries),
                *self.rubbing_entries,
            ],
        )

    @property
    def rubbing_entries(self) -> list[BlockEntries]:
        """Places of `(H - G)^T diag G` among the deflections."""
        products = self.rubbing_products
        return [] if products is None else [BlockEntries(DEFLECTION, DEFLECTION, products[0], products[1])]

    @cached_property
    def constant_entries(self) -> list[Array]:
        """Values of the wall's own entries."""
        return [self.stiffness.tocoo().data, -self.push.tocoo().data]

    @cached_property
    def border(self) -> Border:
        """How the journal's position enters: gaps by position, force on the journal by pressures and reactions.

        A gap narrows along the normal, so that its derivative by the position gives the normals of the film's force.
        """
        return self._border(self.wall.contacts.by_e)

    @cached_property
    def rubbed_border(self) -> Border:
        """The same where the journal turns and what it touches holds it back (D7)."""
        return self._rubbed(self.border)

    @cached_property
    def moment_border(self) -> Border:
        """The same of the slopes of the journal's axis over 1 m: moments about the bearing's centre (J7) [m].

        The rows of half a length would be half of a moment that is zero: it has none.
        """
        return self._rubbed(self._border(tilt_columns(self.wall, 1.0)))

    def _rubbed(self, border: Border) -> Border:
        """A border with `-mu_f t` beside the normals `n` in the forces of unit reactions: pairs `(x, y)` turn (D7)."""
        if self.rubbing is None:
            return border
        normal = border.gap_derivative.T
        along = np.zeros_like(normal)
        along[0::2], along[1::2] = -normal[1::2], normal[0::2]
        return replace(border, reaction_derivative=normal + self.case.surface.friction_coefficient * along)

    def _border(self, by_e: Array) -> Border:
        mesh = self.wall.film
        numbers = np.where(mesh.unknown >= 0, mesh.unknown, mesh.n_unknown).ravel()
        area = node_area(mesh, self.balance.radius) * self.scales.pressure / self.scales.force
        nodal = film_force_rows(mesh, area, by_e[self.wall.contacts.journal].T)
        by_P = np.array([add_up(numbers, force, mesh.n_unknown + 1)[:-1] for force in nodal])
        return Border(by_e, by_P, self.unknowns[PRESSURE])
