"""Film and wall at one speed and journal position.

wall   K w - A (P - 1) - H^T lam = 0               (C1), H = G but for a journal that rubs (D6)
film   net outflow of each cell  = 0               (C2), h from the gaps
gaps   0 <= g(w)  complementary to  lam >= 0       (C3)
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, Border
from petalfoil.sparsity import SparseRows
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.film_rows import FilmState
from petalfoil.system.temperatures import Temperatures
from petalfoil.system.unknowns import DEFLECTION, PRESSURE, FieldRows

Array = NDArray[np.float64]


STORAGE = slice(5, 7)
"""Entries of the pattern that hold the derivative of the stored mass."""


@dataclass(frozen=True)
class CoupledProblem:
    """The system at one speed and journal position.

    Attributes
    ----------
    layout : BearingLayout
        Mesh, wall and constant entries.
    bearing_number : float
        `Lam` on the reference film, with the viscosity of the gas as it enters [1].
    displacement : (n_position,) array
        Journal displacement over the reference length [1].
    temperatures : Temperatures or None
        Those of the heat network; None without one. The film has one temperature, which cancels in (F1) but for the
        viscosity.
    """

    layout: BearingLayout
    bearing_number: float
    displacement: Array
    temperatures: Temperatures | None = field(default=None, kw_only=True)

    def at(
        self,
        *,
        bearing_number: float | None = None,
        displacement: Array | None = None,
        temperatures: Temperatures | None = None,
    ) -> Self:
        """The same bearing at another speed, position or with other temperatures."""
        Lam = self.bearing_number if bearing_number is None else bearing_number
        e = self.displacement if displacement is None else displacement
        T = self.temperatures if temperatures is None else temperatures
        return replace(self, bearing_number=Lam, displacement=e, temperatures=T)

    @property
    def viscosity_ratio(self) -> float:
        """Viscosity of the gas in the film over that of the gas as it enters [1]."""
        return 1.0 if self.temperatures is None else self.layout.hot_gas.ratio(self.temperatures.film)

    @property
    def film_number(self) -> float:
        """Bearing number with the viscosity of the gas in the film [1]."""
        return self.bearing_number * self.viscosity_ratio

    @property
    def G(self) -> SparseRows:
        """Derivative of the gaps by the unknowns."""
        return self.layout.G

    @property
    def acting(self) -> SparseRows:
        """Forces of unit reactions (D6), (m, n): a journal that turns drags along what it touches, if it is to."""
        return self.layout.acting if self.turns else self.layout.G

    @property
    def endless(self) -> bool:
        """Whether petals bound a film that has no ends: the limit of a long bearing (F6)."""
        return self.layout.film_rows.inventory is not None and self.layout.n_wall > 0

    @property
    def turns(self) -> bool:
        """Whether dry friction of the journal has its full force: in equilibria at zero speed, too, it is about to."""
        return True

    @property
    def wall_acting(self) -> SparseRows:
        """The same on the deflections, (m, n_wall)."""
        own = self.acting
        return self.layout.wall.contacts.G if own is self.layout.G else SparseRows(own[:, : self.layout.n_wall])

    @property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return self.layout.weight

    @property
    def elimination_key(self) -> Hashable | None:
        """One for all speeds and positions; a film alone gains nothing by remembered orders."""
        return self.layout if self.layout.n_wall else None

    @property
    def positive(self) -> slice:
        """Unknowns that must stay positive: the pressures."""
        return self.layout.unknowns[PRESSURE]

    @property
    def closing(self) -> float:
        """What growth takes from the gaps on the journal at this speed (G5), over the reference length [1]."""
        return self.layout.closing(self.bearing_number, self.temperatures)

    def gaps(self, x: Array) -> Array:
        """Gaps over the reference length, (m,) [1]."""
        contacts, h_ref = self.layout.wall.contacts, self.layout.scales.length
        moved: Array = contacts.by_e @ self.displacement + contacts.G @ x[self.layout.unknowns[DEFLECTION]]
        gaps: Array = contacts.rest / h_ref + moved
        gaps[contacts.journal] -= self.closing
        return gaps

    def film(self, x: Array, shift: Array | None = None) -> Array:
        """Film thickness over the reference length; `shift` (m,) replaces `g` by `g + shift` on the journal rows."""
        wall, h_ref = self.layout.wall, self.layout.scales.length
        w = x[self.layout.unknowns[DEFLECTION]]
        H: Array = wall.film_thickness(w * h_ref, self.displacement * h_ref) / h_ref - self.closing
        if shift is None or not len(shift):
            return H
        return H + shift[wall.contacts.journal].reshape(H.shape)

    def pressure(self, x: Array) -> Array:
        """Pressure at every film node [1]."""
        return self.layout.balance.nodal_pressure(x[self.positive])

    @property
    def border(self) -> Border:
        """How the journal's position enters."""
        return self.layout.rubbed_border if self.turns else self.layout.border

    def film_force(self, x: Array) -> Array:
        """Force of the film on the journal over the unit of force, (n_position,) [1]."""
        force: Array = self.border.row_derivative @ (x[self.positive] - 1.0)
        return force

    def journal_force(self, x: Array, lam: Array) -> Array:
        """Force of film and contacts on the journal over the unit of force, (n_position,) [1]."""
        return self.film_force(x) + self.contact_force(lam)

    def contact_force(self, lam: Array) -> Array:
        """Force of solid contact on the journal over the unit of force, (n_position,) [1]."""
        force: Array = self.border.by_reactions @ lam
        return force

    def journal_moment(self, x: Array, lam: Array) -> Array:
        """Moment of film and contacts on the journal about the bearing's centre (J7) over the unit of force, (2,) [m].

        Raises
        ------
        ValueError
            Half of the length is solved.
        """
        border = self.layout.moment_border
        moment: Array = border.row_derivative @ (x[self.positive] - 1.0) + border.by_reactions @ lam
        return moment

    def admits(self, x: Array) -> bool:
        """The film is open everywhere."""
        return bool(np.min(self.film(x)) > 0.0)

    def linearize(self, x: Array, shift: Array | None = None, low_order: Array | None = None) -> Linearization:
        """Residual, its tangent and its row scales at `x`.

        `low_order` (n_wall,) is the part of the deflections below the last digit of `x`: it matters where `K w` loses
        it.
        """
        film = self.layout.film_rows.at(self.pressure(x), self.film(x, shift), self.film_number)
        return Linearization(self.layout, x, film, low_order)


@dataclass(frozen=True)
class Linearization:
    """The system at one state: residual without reactions, tangent, row scales.

    `rate` adds the squeeze term of an implicit step of `1 / rate` in `tau` from this very state: the mass stored
    has not changed yet, so the residual is the steady one and only the tangent grows.
    """

    layout: BearingLayout
    x: Array
    film: FilmState
    low_order: Array | None = None

    @property
    def turns(self) -> bool:
        """Whether dry friction of the journal has its full force."""
        return True

    @cached_property
    def _fields(self) -> list[FieldRows]:
        """Rows of the extra fields."""
        unknowns = self.layout.unknowns
        blocks = {name: self.x[unknowns[name]] for name in unknowns.sizes}
        return [field.at(blocks, self.film.H) for field in self.layout.fields]

    @cached_property
    def residual(self) -> Array:
        """(C1) without reactions, then (C2); shape (n,) [1]."""
        unknowns, out = self.layout.unknowns, self.layout.unknowns.zeros()
        w, P = self.x[unknowns[DEFLECTION]], self.x[unknowns[PRESSURE]]
        if len(w):
            out[unknowns[DEFLECTION]] = self.layout.elastic_force(w, self.low_order) - self.layout.push @ (P - 1.0)
        out[unknowns[PRESSURE]] = self.film.residual
        for rows in self._fields:
            for block, values in rows.residual.items():
                out[unknowns[block]] += values
        return out

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with (C4), shape (n,) [1].

        A film row: the flows it adds up. A wall row: see `wall_scale`.
        """
        w = self.x[self.layout.unknowns[DEFLECTION]]
        wall = wall_scale(self.layout, w) if self.low_order is None else np.ones(len(w))
        return np.concatenate([wall, self.film.row_scale, *(rows.row_scale for rows in self._fields)])

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """Tangent plus `H^T diag(barrier_weight) G`, plus `rate` times the derivative of the stored mass; (n, n)."""
        by_P, by_H = self.film.tangent
        held_P, held_H = self._storage
        _, _, gap, factor = self.layout.gap_products
        film = [by_P, by_H[self.layout.film_column >= 0]]
        fields = [values for rows in self._fields for values in rows.values]
        contact = barrier_weight[gap] * factor
        values = [*self.layout.constant_entries, *film, contact, rate * held_P, rate * held_H, *fields]
        if (rubbing := self.layout.rubbing_products) is not None:
            _, _, gap, factor = rubbing
            values.append(barrier_weight[gap] * factor * float(self.turns))
        return self.layout.pattern.assemble(values)

    @property
    def _storage(self) -> tuple[Array, Array]:
        """Derivatives of the stored mass by pressure and by deflection, in the order of the pattern."""
        held_P, held_H = self.film.storage
        return held_P, held_H[self.layout.storage_column >= 0]

    @property
    def stored(self) -> sp.csc_array:
        """Derivative of the stored mass, (n, n)."""
        return self.layout.pattern.assemble_part(STORAGE, self._storage)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """Derivative of the residual by the slacks that it reads, times their `change` (m,); shape (n,)."""
        unknowns, out = self.layout.unknowns, self.layout.unknowns.zeros()
        journal = change[self.layout.wall.contacts.journal]
        if len(journal):
            out[unknowns[PRESSURE]] = self.film.moved(journal, rate)
            for field, rows in zip(self.layout.fields, self._fields, strict=True):
                if rows.by_film is not None:
                    out[unknowns[field.name]] = rows.by_film @ journal
        return out


def wall_scale(layout: BearingLayout, w: Array) -> Array:
    """What the residual of the wall's rows is compared with while it is iterated on, (n_wall,) [1].

    Ambient pressure on the node; where the rounding of `w` alone makes more than the tolerance of that, this rounding
    (`K w` loses it as `dphi^-4`). A solution is refined below the last digit of `w` and then compared with the former.
    """
    return rounding_scale(layout.stiffness_size @ np.abs(w))


def rounding_scale(size: Array) -> Array:
    """The same from sums of the magnitudes of the terms of `K w`, (n_wall,)."""
    return np.maximum(1.0, ROUNDED * size)


WALL_ROUNDING = 8.0
"""Roundings of `K w` add up: up to 5 were seen at 512 cells per pitch."""

ROUNDED = WALL_ROUNDING * float(np.finfo(float).eps) / RESIDUAL_TOLERANCE
"""Rounding of a row of the wall over its terms and the tolerance of a residual."""
