"""What stays the same of the equations with contact points, as plain arrays that compiled loops read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

if TYPE_CHECKING:
    from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]
Index = NDArray[np.integer[Any]]


class EntriesByRow(NamedTuple):
    """A sparse matrix by rows: first entry of each row, columns and values of the entries.

    Numbers are unsigned: of signed ones numba asks whether they count from the end, at twice the cost of a product.
    """

    start: Index
    column: Index
    value: Array

    @classmethod
    def of(cls, matrix: sp.csr_array) -> EntriesByRow:
        """Those of a matrix."""
        return cls(matrix.indptr.astype(np.uint32), matrix.indices.astype(np.uint32), matrix.data)


class CurveTables(NamedTuple):
    """The gap curves (`GapCurves`), their first nodal entries toward the journal (`journal`), and the petals' count."""

    first: Index
    elements: Index
    angle: Array
    compliance: Array
    rest: Array
    by_e: Array
    by_w: EntriesByRow
    journal: int
    petals: int


class FilmTables(NamedTuple):
    """The film of one station: thickness from nodal gaps, numbers of the pressures, faces and cells.

    `filling` is the weight of all gas in the row of the gas inventory (F6b), 0 where the film has ends.
    """

    floor: Array
    by_gaps: EntriesByRow
    unknown: Index
    dphi: Array
    width: float
    area: Array
    knudsen: float
    filling: float


class WallTables(NamedTuple):
    """Changes of curvature, magnitudes of the stiffness, and loads by pressures; rows are those of the petals."""

    bending: EntriesByRow
    size: EntriesByRow
    push: EntriesByRow


class PointTables(NamedTuple):
    """All of them."""

    curves: CurveTables
    film: FilmTables
    wall: WallTables
    moves: Moves

    @classmethod
    def of(cls, whole: PointLayout) -> PointTables:
        """Those of a bearing, 2-D: one station."""
        curves, balance, inventory = whole.curves, whole.layout.balance, whole.layout.film_rows.inventory
        gaps = CurveTables(
            curves.first,
            curves.elements,
            curves.angle,
            curves.compliance,
            curves.rest,
            np.ascontiguousarray(curves.by_e),
            EntriesByRow.of(curves.by_w),
            whole.journal_entries,
            whole.pack.mesh.count,
        )
        film = FilmTables(
            (whole.pack.floor / whole.layout.scales.length).reshape(balance.mesh.shape[:2]),
            EntriesByRow.of(whole.pack.film_rows),
            np.ascontiguousarray(balance.mesh.unknown[:, :, 0]),
            np.ascontiguousarray(balance.dphi[:, 0]),
            float(balance.width_Z[0]),
            np.ascontiguousarray(balance.area[:, 0]),
            float(balance.knudsen),
            0.0 if inventory is None else float(inventory.filling),
        )
        wall = WallTables(
            EntriesByRow.of(whole.bending), EntriesByRow.of(whole.stiffness_size), EntriesByRow.of(whole.push)
        )
        moves = Moves(EntriesByRow.of(whole.film_by_w), np.ascontiguousarray(whole.film_by_e))
        return cls(gaps, film, wall, moves)


class Moves(NamedTuple):
    """Changes of the film thickness by the petals' unknowns, and by the journal's displacement, (film nodes, d)."""

    film_by_w: EntriesByRow
    film_by_e: Array


class PointPlaces(NamedTuple):
    """Curve, position and reaction of all contact points, (j,), and which of them travel by themselves, (k,)."""

    curve: Index
    position: Array
    reaction: Array
    ends: Index


class StepNumbers(NamedTuple):
    """Numbers of a stage: displacement `e` (d,), growth of the shaft, bearing numbers, rate and what it starts from."""

    displacement: Array
    closing: float
    film_number: float
    time_number: float
    rate: float
    start: Array


class PointValues(NamedTuple):
    """What there is at the contact points.

    Attributes
    ----------
    slope : (j,) array
        Slope of the gap, at all of them.
    travels : (k,) array
        1 for a travelling point, 0 where it is at an end of its curve.
    idle : (j,) array
        1 for a point at a root, which bears on the bushing without a reaction.
    loads : (2 n_node,) array
        Reactions on the nodal gaps.
    """

    slope: Array
    travels: Array
    idle: Array
    loads: Array


class PointRows(NamedTuple):
    """The equations at one state.

    Attributes
    ----------
    gaps : (2 n_node,) array
        Nodal (value, slope) of all gaps.
    thickness : (strip, node) array
        Film thickness [1].
    wall, film, value, slope : arrays
        Residuals, as `PointStepEquations.residual`.
    imbalance : tuple
        Largest of the first two over what they are compared with, and of the other two.
    contacts : PointValues
        What there is at the contact points.
    mass : (n_film,) array
        Gas in the cell of each pressure [1].
    wall_scale, film_scale : arrays
        What the first two residuals are compared with.
    """

    gaps: Array
    thickness: Array
    wall: Array
    film: Array
    value: Array
    slope: Array
    imbalance: tuple[float, float, float]
    contacts: PointValues
    mass: Array
    wall_scale: Array
    film_scale: Array
