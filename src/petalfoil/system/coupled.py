"""Film and wall at one speed and journal position, in one vector `x = [w, P]`.

wall   K w - A (P - 1) - G^T lam = 0      (C1)
film   net outflow of each cell  = 0      (C2), h from the gaps
gaps   0 <= g(w)  complementary to  lam >= 0   (C3)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.sparsity import Elimination, Pattern
from petalfoil.system.film_rows import FilmRows, FilmState
from petalfoil.system.scales import Scales
from petalfoil.walls.base import Wall

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class Layout:
    """What never changes while speed and position do: mesh, places of entries, constant entries."""

    wall: Wall
    balance: FilmBalance
    scales: Scales

    @property
    def n_wall(self) -> int:
        """Deflection unknowns."""
        return self.wall.n_unknown

    @cached_property
    def film_rows(self) -> FilmRows:
        """The film's equations."""
        return FilmRows(self.balance)

    @cached_property
    def n(self) -> int:
        """All unknowns."""
        return self.n_wall + self.wall.film.n_unknown

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """`K` in the units of the problem [1]."""
        return sp.csr_array(self.wall.elasticity.stiffness * (self.scales.length / self.scales.force))

    def elastic_force(self, w: Array, fine: Array | None = None) -> Array:
        """`K w` by its factors, differences first; (n_wall,) [1]."""
        return self.wall.elasticity.force(w, fine) * (self.scales.length / self.scales.force)

    @cached_property
    def stiffness_size(self) -> sp.csr_array:
        """Magnitudes of the entries of `K` [1]."""
        return sp.csr_array(abs(self.stiffness))

    @cached_property
    def push(self) -> sp.csr_array:
        """`A`: nodal forces on the wall from the pressure unknowns, (n_wall, n_film) [1]."""
        wall, unknown = self.wall.film_unknown.ravel(), self.wall.film.unknown.ravel()
        both = (wall >= 0) & (unknown >= 0)
        area = self.wall.load_area.ravel()[both] * self.scales.pressure / self.scales.force
        shape = (self.n_wall, self.wall.film.n_unknown)
        return sp.coo_array((area, (wall[both], unknown[both])), shape=shape).tocsr()

    @cached_property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps by all unknowns, (m, n) [1]."""
        m = len(self.wall.contacts.rest)
        return sp.csr_array(sp.hstack([self.wall.contacts.G, sp.csr_array((m, self.n - self.n_wall))], format="csr"))

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
        return self.wall.film_unknown.ravel()[self.balance.storage_entries.cols]

    @cached_property
    def gap_products(self) -> tuple[Index, Index, Index, Array]:
        """Entries of `G^T diag G`: rows, columns, gap, coefficient."""
        G = self.wall.contacts.G
        pieces = []
        for first, second in _pairs(G):
            gap = G_row(G)[first]
            pieces.append((G.indices[first], G.indices[second], gap, G.data[first] * G.data[second]))
        if not pieces:
            none = np.zeros(0, dtype=np.intp)
            return none, none, none, np.zeros(0)
        rows, cols, gaps, factors = (np.concatenate(part) for part in zip(*pieces, strict=True))
        return rows.astype(np.intp), cols.astype(np.intp), gaps.astype(np.intp), factors

    @cached_property
    def places(self) -> tuple[Index, Index]:
        """Rows and columns of the tangent's entries in the order of `Linearization.entries`."""
        K, A, n_w = self.stiffness.tocoo(), self.push.tocoo(), self.n_wall
        by_P, by_H, moving = self.film_rows.by_pressure, self.film_rows.by_film, self.film_column >= 0
        held, under = self.balance.storage_entries, self.storage_column
        gap_rows, gap_cols, _, _ = self.gap_products
        rows = [K.row, A.row, n_w + by_P.rows, n_w + by_H.rows[moving], gap_rows]
        cols = [K.col, n_w + A.col, n_w + by_P.cols, self.film_column[moving], gap_cols]
        rows += [n_w + held.rows, n_w + held.rows[under >= 0]]
        cols += [n_w + held.rows, under[under >= 0]]
        return np.concatenate(rows).astype(np.intp), np.concatenate(cols).astype(np.intp)

    @cached_property
    def pattern(self) -> Pattern:
        """Sparsity of the tangent with contacts: one pattern for ever."""
        return Pattern.of(*self.places, self.n)

    @cached_property
    def elimination(self) -> Elimination:
        """Orders of elimination that its factorisations have found."""
        return Elimination()

    @cached_property
    def package_elimination(self) -> Elimination:
        """The same for the wall alone."""
        return Elimination()

    @cached_property
    def constant_entries(self) -> Array:
        """Values of the wall's own entries."""
        return np.concatenate([self.stiffness.tocoo().data, -self.push.tocoo().data])


def G_row(G: sp.csr_array) -> Index:
    """Row of every stored entry of `G`."""
    return np.repeat(np.arange(G.shape[0]), np.diff(G.indptr))


def _pairs(G: sp.csr_array) -> list[tuple[Index, Index]]:
    """Pairs of stored entries that share a row of `G` (rows hold one or two)."""
    held = np.diff(G.indptr)
    every = np.arange(G.nnz)
    first = G.indptr[:-1][held == 2]
    return [(every, every), (first, first + 1), (first + 1, first)] if G.nnz else []


@dataclass(frozen=True)
class CoupledProblem:
    """The system at one speed and journal position.

    Attributes
    ----------
    layout : Layout
        Mesh, wall and constant entries.
    bearing_number : float
        `Lam` on the reference film [1].
    displacement : (2,) array
        Journal displacement over the reference length [1].
    """

    layout: Layout
    bearing_number: float
    displacement: Array

    def at(self, *, bearing_number: float | None = None, displacement: Array | None = None) -> Self:
        """The same bearing at another speed or position."""
        Lam = self.bearing_number if bearing_number is None else bearing_number
        e = self.displacement if displacement is None else displacement
        return replace(self, bearing_number=Lam, displacement=e)

    @property
    def G(self) -> sp.csr_array:
        """Derivative of the gaps by the unknowns."""
        return self.layout.G

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.layout.weight

    @property
    def rank(self) -> Elimination | None:
        """Orders of elimination, kept for all speeds and positions; a film alone gains nothing by them."""
        return self.layout.elimination if self.layout.n_wall else None

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive: the pressures."""
        return slice(self.layout.n_wall, self.layout.n)

    def gaps(self, x: Array) -> Array:
        """Gaps over the reference length, (m,) [1]."""
        contacts, h_ref = self.layout.wall.contacts, self.layout.scales.length
        moved: Array = contacts.by_e @ self.displacement + contacts.G @ x[: self.layout.n_wall]
        return contacts.rest / h_ref + moved

    def film(self, x: Array, shift: Array | None = None) -> Array:
        """Film thickness over the reference length; `shift` (m,) replaces `g` by `g + shift` on the journal rows."""
        wall, h_ref = self.layout.wall, self.layout.scales.length
        H = wall.film_thickness(x[: self.layout.n_wall] * h_ref, self.displacement * h_ref) / h_ref
        if shift is None or not len(shift):
            return H
        return H + shift[wall.contacts.journal].reshape(H.shape)

    def pressure(self, x: Array) -> Array:
        """Pressure at every film node [1]."""
        return self.layout.balance.nodal_pressure(x[self.layout.n_wall :])

    def admits(self, x: Array) -> bool:
        """The film is open everywhere."""
        return bool(np.min(self.film(x)) > 0.0)

    def linearize(self, x: Array, shift: Array | None = None, fine: Array | None = None) -> Linearization:
        """Residual, its tangent and its row sizes at `x`.

        `fine` (n_wall,) is what of the deflections lies below the last digit of `x`: it matters where `K w` loses it.
        """
        film = self.layout.film_rows.at(self.pressure(x), self.film(x, shift), self.bearing_number)
        return Linearization(self.layout, x, film, fine)


@dataclass(frozen=True)
class Linearization:
    """The system at one state: residual (reactions apart), tangent, and the sizes that residuals are measured by.

    `rate` adds the squeeze term of an implicit step of `1 / rate` in `tau` from this very state: the mass stored
    has not changed yet, so the residual is the steady one and only the tangent grows.
    """

    layout: Layout
    x: Array
    film: FilmState
    fine: Array | None = None

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (C2); shape (n,) [1]."""
        w, P = self.x[: self.layout.n_wall], self.x[self.layout.n_wall :]
        if not len(w):
            return self.film.residual
        elastic = self.layout.elastic_force(w, self.fine)
        pushed = self.layout.push @ (P - 1.0)
        return np.concatenate([elastic - pushed, self.film.residual])

    @cached_property
    def size(self) -> Array:
        """What each row's residual is measured by (C4), shape (n,) [1].

        A film row: the flows it adds up. A wall row: see `wall_size`.
        """
        w = self.x[: self.layout.n_wall]
        if not len(w):
            return self.film.size
        wall = wall_size(self.layout, w) if self.fine is None else np.ones(len(w))
        return np.concatenate([wall, self.film.size])

    def matrix(self, theta: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `G^T diag(theta) G`, plus `rate` times the derivative of the stored mass; (n, n)."""
        by_P, by_H = self.film.tangent
        held_P, held_H = self.film.storage
        _, _, gap, factor = self.layout.gap_products
        moving, under = self.layout.film_column >= 0, self.layout.storage_column >= 0
        values = [self.layout.constant_entries, by_P, by_H[moving], theta[gap] * factor]
        return self.layout.pattern.assemble(np.concatenate([*values, rate * held_P, rate * held_H[under]]))

    @property
    def stored(self) -> sp.csc_array:
        """Derivative of the stored mass, (n, n)."""
        layout, (held_P, held_H) = self.layout, self.film.storage
        under, n = layout.storage_column >= 0, layout.n
        values = np.concatenate([held_P, held_H[under]])
        rows, cols = (place[len(place) - len(values) :] for place in layout.places)
        return sp.coo_array((values, (rows, cols)), shape=(n, n)).tocsc()

    def by_shift(self, shift: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the shift of the gaps, applied to `shift` (m,); shape (n,)."""
        out = np.zeros(self.layout.n)
        journal = shift[self.layout.wall.contacts.journal]
        if len(journal):
            out[self.layout.n_wall :] = self.film.moved(journal, rate)
        return out


def wall_size(layout: Layout, w: Array) -> Array:
    """What the residual of the wall's rows is measured by while it is iterated on, (n_wall,) [1].

    Ambient pressure on the node; where the rounding of `w` alone makes more than the tolerance of that, this rounding
    (`K w` loses it as `dphi^-4`). An answer is refined below the last digit of `w` and then measured by the former.
    """
    rounding: Array = WALL_ROUNDING * np.finfo(float).eps * (layout.stiffness_size @ np.abs(w))
    return np.maximum(1.0, rounding / RESIDUAL_TOLERANCE)


WALL_ROUNDING = 8.0
"""Roundings of `K w` add up: up to 5 were seen at 512 cells a pitch."""

RESIDUAL_TOLERANCE = 1e-8
"""Largest scaled residual of an answer."""
