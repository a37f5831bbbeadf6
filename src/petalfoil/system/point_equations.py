"""Film and petals of Hermite elements with contact points as unknowns.

Unknowns are the petals' `w`, the film's pressures `P`, the reactions `lam` of all contact points and the places `t` of
those that travel. With `n`, `n'` the derivative of gap and slope at a point by `w`,

    wall     K w - A (P - 1) - n^T lam = 0                                                             (C6)
    film     net outflow of each cell = 0 ,  h = contact film thickness + gap toward the journal
    points   p + sum_d C b lam_d = 0                                                                   (C7)
    ends     p' + sum_d C b_s lam_d = 0    at points that travel, not at the end of a curve             (C8)

Where the turning journal drags petals along, `n + mu_f D` acts in place of `n` (D6), and it is held back (D7).
Without that and without stretches these are the stationary points of `E(w) - sum lam p - 1/2 sum lam lam_d C b` beside
the film. The tangent has exact second derivatives, `-lam n'` among them: it is that of the equilibrium itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.gap_curves import ContactPoints, PointGaps
from petalfoil.sparsity import Triplets, add_up, added_blocks
from petalfoil.system.coupled import CoupledProblem, rounding_scale
from petalfoil.system.film_rows import FilmState
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.pack_slip import dragged_faces

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PointState:
    """Unknowns: deflections `w` (n_wall,), pressures `P` (n_film,), contacts."""

    w: Array
    P: Array
    points: ContactPoints


def same_contacts(one: PointState, other: PointState) -> bool:
    """Whether two states have contacts on the same curves."""
    mine, its = one.points, other.points
    return mine is its or (same(mine.curve, its.curve) and same(mine.inner, its.inner))


def same(one: NDArray[Any], other: NDArray[Any]) -> bool:
    """Whether two arrays (k,) hold the same; steps ask it of the same array as a rule."""
    return one is other or (len(one) == len(other) and not bool((one != other).any()))


@dataclass(frozen=True)
class PointEquations:
    """The equations at one state.

    Attributes
    ----------
    whole : PointLayout
        What stays the same.
    problem : CoupledProblem
        Speed and journal position.
    state : PointState
        The unknowns.
    film_held : (strip, node, axial) array or None
        Film thickness that does not follow petals and journal [1]; None where it does.
    """

    whole: PointLayout
    problem: CoupledProblem
    state: PointState
    film_held: Array | None = None

    def with_film(self, thickness: Array) -> PointEquations:
        """The same at a given film thickness (strip, node, axial) [1]."""
        return replace(self, film_held=thickness)

    @property
    def n(self) -> int:
        """All unknowns."""
        points = self.state.points
        return self.whole.n_wall + self.whole.n_film + len(points.reaction) + len(points.position)

    @property
    def deflection(self) -> Array:
        """Unknowns of the petals, (n_wall,) [1]."""
        return self.state.w

    @property
    def pressures(self) -> Array:
        """Pressure unknowns, (n_film,) [1]."""
        return self.state.P

    @cached_property
    def nodal_gaps(self) -> Array:
        """Nodal (value, slope) of all gap curves."""
        gaps = self.whole.curves.nodal(self.state.w, self.problem.displacement)
        gaps[: self.whole.journal_entries : 2] -= self.problem.closing
        return gaps

    @cached_property
    def film_thickness(self) -> Array:
        """At every film node, (strip, node, axial) [1]."""
        if self.film_held is not None:
            return self.film_held
        layout = self.whole.layout
        H: Array = self.whole.pack.floor / layout.scales.length + self.whole.pack.film_rows @ self.nodal_gaps
        return H.reshape(layout.wall.film.shape)

    @property
    def end_slopes(self) -> Array:
        """Slopes of the gaps at the travelling points, those at an end of their curve among them; (k,)."""
        return np.asarray(self.gaps.slope[self.state.points.ends])

    def relative_changes(self, change: Array, move: Array) -> tuple[float, float]:
        """How far a `change` (n,) of the unknowns and a `move` (d,) of the journal lead, over what there is [1].

        The most that a pressure or a film thickness falls by, and the most that a pressure grows by; 0 or more.
        """
        whole, P = self.whole, change[self.whole.n_wall : self.whole.n_wall + self.whole.n_film]
        growth = P / self.state.P
        opening = (whole.film_by_w @ change[: whole.n_wall] + whole.film_by_e @ move) / self.film_thickness.ravel()
        falls = -min(float(growth.min(initial=0.0)), float(opening.min(initial=0.0)))
        return falls, float(growth.max(initial=0.0))

    def may_overlap(self, depth: float, per_element: int) -> bool:
        """Whether some gap of as many samples per element may be below zero by `depth` [1]; it is then looked for."""
        return True

    @cached_property
    def film(self) -> FilmState:
        """The film's rows."""
        layout = self.whole.layout
        pressure = layout.balance.nodal_pressure(self.state.P)
        return layout.film_rows.at(pressure, self.film_thickness, self.problem.film_number)

    @cached_property
    def gaps(self) -> PointGaps:
        """Gaps at the travelling points."""
        return PointGaps(self.whole.curves, self.state.points, self.nodal_gaps)

    @cached_property
    def travels(self) -> Array:
        """1 for a travelling point, 0 where it is at an end of its curve, (k,)."""
        points = self.state.points
        inside = (points.position > 0.0) & (points.position < self.whole.curves.elements[points.curve])
        return inside.astype(np.float64)

    @cached_property
    def idle(self) -> Array:
        """1 for a point at a root, which bears on the bushing without a reaction; (j,)."""
        points, n = self.state.points, self.whole.pack.mesh.count
        on_bushing = points.every_curve // n == 1
        return np.asarray(on_bushing & (points.every_position <= 0.0), dtype=np.float64)

    @cached_property
    def _nodal_loads(self) -> Array:
        """Reactions on the nodal (value, slope) of the gaps."""
        return self.gaps.nodal_loads

    @cached_property
    def by_e(self) -> tuple[Array, Array]:
        """Derivatives of the gaps at all points, and of their slopes, by the journal's displacement."""
        return self.gaps.of_nodal(self.whole.curves.by_e)

    @cached_property
    def _dragged(self) -> tuple[sp.csr_array, sp.csr_array]:
        """`D`: motion along the journal of the faces that it drags, and its derivative by the places (D6)."""
        return dragged_faces(self.whole.pack, self.state.points)

    @property
    def turns(self) -> bool:
        """Whether dry friction of the journal has its full force."""
        return self.problem.turns

    @property
    def journal_friction(self) -> float:
        """`mu_f` of a journal that drags petals along, 0 where it does not, or in time while it does not turn [1]."""
        return self.whole.journal_friction if self.turns else 0.0

    @property
    def reaction_on_journal(self) -> Array:
        """Force on the journal by unit loads on the nodal gaps, (2 n_node, d)."""
        return self.whole.reaction_on_journal if self.turns else self.whole.curves.by_e

    @property
    def rubbing(self) -> tuple[Array, Array]:
        """Dry friction of the journal on the petals (D6), (n_wall,), and on the journal itself (D7), (d,)."""
        if not self.journal_friction:
            return np.zeros(self.whole.n_wall), np.zeros(len(self.problem.displacement))
        on_petals = self.journal_friction * (self._dragged[0].T @ self.state.points.reaction)
        return on_petals, self.whole.rubbing_on_journal.T @ self._nodal_loads

    @cached_property
    def acting(self) -> tuple[Triplets, Triplets]:
        """Forces of unit reactions on the petals, (j, n_wall), and their derivative by the places (D6)."""
        friction, shape = self.journal_friction, (len(self.idle), self.whole.n_wall)
        if not friction:
            return self.gaps.by_w
        gaps = (sp.csr_array((n.data, (n.rows, n.cols)), shape=shape) for n in self.gaps.by_w)
        value, by_place = (n + friction * along for n, along in zip(gaps, self._dragged, strict=True))
        return Triplets.of(value), Triplets.of(by_place)

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """Wall, film, gaps of all points, slopes of the travelling ones."""
        points, state, gaps = self.state.points, self.state, self.gaps
        elastic = self.whole.elastic(state.w) - self.whole.push @ (state.P - 1.0)
        wall = elastic - self.whole.curves.by_w.T @ self._nodal_loads
        if self.journal_friction:
            wall -= self.rubbing[0]
        value = np.where(self.idle > 0.0, points.reaction, gaps.value)
        return wall, self.film.residual, value, gaps.slope[points.ends] * self.travels

    @property
    def newton_residual(self) -> Array:
        """All residuals, (n,)."""
        return np.concatenate(self.residual)

    @property
    def wall_forces(self) -> tuple[Array, Array, Array]:
        """Generalised forces on the petals: elastic, by pressure and contacts, and magnitudes of these, (n_wall,)."""
        (acts, _), reaction, over = self.acting, self.state.points.reaction, self.state.P - 1.0
        pulls, wall, n = acts.data * reaction[acts.rows], acts.cols.astype(np.intp), self.whole.n_wall
        loads = self.whole.push @ over + add_up(wall, pulls, n)
        size = self.whole.push.magnitude @ np.abs(over) + add_up(wall, np.abs(pulls), n)
        return self.whole.elastic(self.state.w), loads, size

    @cached_property
    def scaled(self) -> Array:
        """Residuals over their row scales: ambient pressure on a node, the flows of a cell, the reference film.

        A row of the wall is not compared with less than the rounding of its `K w`.
        """
        wall, film, value, slope = self.residual
        wall_scale, film_scale = self.row_scales
        return np.concatenate([wall / wall_scale, film / film_scale, value, slope])

    @cached_property
    def row_scales(self) -> tuple[Array, Array]:
        """What residuals of wall and film are compared with."""
        return rounding_scale(self.whole.stiffness_size @ np.abs(self.state.w)), self.film.row_scale

    @cached_property
    def steady(self) -> sp.csc_array:
        """The tangent."""
        gaps, points, whole = self.gaps, self.state.points, self.whole
        n, n_slope = gaps.by_w
        pull, pull_by_place = self.acting
        by_P, by_w = (entries.at(values) for entries, values in zip(whole.film_entries, self.film.tangent, strict=True))
        acts, free, ends = (
            1.0 - self.idle,
            self.travels,
            partial(Triplets.from_rows, chosen=points.ends, size=self.idle.size),
        )
        film = whole.n_wall
        lam = film + whole.n_film
        place = lam + len(acts)
        blocks = [
            (0, 0, whole.fixed),
            (0, lam, pull.T.times(rows=-1.0)),
            (0, place, points.by_travel(pull_by_place.T.times(cols=-points.reaction)).times(cols=free)),
            (film, 0, by_w),
            (film, film, by_P),
            (lam, 0, n.times(rows=acts)),
            (lam, lam, gaps.bend.times(rows=acts)),
            (lam, place, points.by_travel(gaps.value_by_place).times(rows=acts, cols=free)),
            (place, 0, ends(n_slope).times(rows=free)),
            (place, lam, ends(gaps.bend_slope).times(rows=free)),
            (place, place, points.by_travel(ends(gaps.slope_by_place)).times(rows=free, cols=free)),
        ]
        diagonal = np.concatenate([np.zeros(lam), self.idle, 1.0 - free])
        return added_blocks(blocks, diagonal)

    @cached_property
    def stored(self) -> sp.csc_array:
        """Derivative of what the film stores, in the place of the tangent."""
        pairs = zip(self.whole.storage_entries, self.film.storage, strict=True)
        (by_P, by_w), film = (entries.at(values) for entries, values in pairs), self.whole.n_wall
        return added_blocks([(film, 0, by_w), (film, film, by_P)], np.zeros(self.n))

    def forcing(self, rate: float = 0.0) -> Array:
        """Derivative of the rows by the journal's displacement, with `rate` times that of what the film stores."""
        moved = [self.film.moved(column, rate) for column in self.whole.film_by_e.T]
        none = np.zeros((self.whole.n_wall, len(moved)))
        value, slope = self.by_e
        slopes = slope[self.state.points.ends] * self.travels[:, None]
        return np.concatenate([none, np.column_stack(moved), value, slopes])

    @property
    def force_rows(self) -> Array:
        """Derivative of the force on the journal by the unknowns, (d, n)."""
        points = self.state.points
        value, slope = self.gaps.of_nodal(self.reaction_on_journal)
        film = self.whole.layout.border.row_derivative
        by_place = slope.T * points.reaction
        travel = (by_place @ points.spread if points.inner.any() else by_place) * self.travels
        return np.concatenate([np.zeros((len(film), self.whole.n_wall)), film, value.T, travel], axis=1)

    @property
    def force_direct(self) -> Array:
        """Derivative of the force on the journal by its displacement, unknowns held, (d, d): none."""
        size = len(self.problem.displacement)
        return np.zeros((size, size))

    @cached_property
    def journal_force(self) -> Array:
        """Force of film and contacts on the journal over the unit of force, (d,)."""
        film: Array = self.whole.layout.border.row_derivative @ (self.state.P - 1.0)
        return film + self.reaction_on_journal.T @ self._nodal_loads

    @property
    def force(self) -> Array:
        """The same, and all else that holds the journal, (d,)."""
        return self.journal_force

    @property
    def newton_force(self) -> Array:
        """The same: reactions are unknowns."""
        return self.force
