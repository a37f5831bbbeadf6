"""Film and petals of Hermite elements with contact pressures over asperities.

    wall     K w - A (P - 1) - rows^T lam = 0 ,   lam by (K13) from the gaps                           (C9)
    film     net outflow of each cell = 0

Where the turning journal drags petals along, `rows + mu_f D` act in place of `rows` (D6), and it is held back (D7).
The pressures are iterated on beside deflections and film, and follow (K13) exactly in a solution.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.asperity_contact import FULL_PRESSURE, ContactResponse, ContactSamples
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.point_equations import PointEquations
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]

OPEN = 15.0
"""Gap over the asperities from which the pressure is that of (K13) at every iterate."""

NO_PRESSURE = 32.0
"""Gap over the asperities from which there is none: 1e-14 of the full one. A derivative follows all pressures below:
those past `OPEN`, few millionths of the largest, still have a thousandth of the stiffness of a film."""


@dataclass(frozen=True)
class AsperityEquations:
    """The equations at one state.

    Attributes
    ----------
    smooth : PointEquations
        Film and petals without contact.
    samples : ContactSamples
        Where contact pressures are.
    pressure : (E, S) array
        Contact pressures over ambient pressure.
    height : float
        Mean height of the asperities, over the reference length [1].
    followed : float
        Gap over the asperities up to which pressures are unknowns [1].
    """

    smooth: PointEquations
    samples: ContactSamples
    pressure: Array
    height: float
    followed: float = OPEN

    def with_film(self, thickness: Array) -> AsperityEquations:
        """The same at a given film thickness (strip, node, axial) [1]."""
        return replace(self, smooth=self.smooth.with_film(thickness))

    @property
    def problem(self) -> CoupledProblem:
        """Speed and journal position."""
        return self.smooth.problem

    @property
    def whole(self) -> PointLayout:
        """What stays the same."""
        return self.smooth.whole

    @property
    def nodal_gaps(self) -> Array:
        """Nodal (value, slope) of all gap curves, without what reactions bend within an element."""
        return self.smooth.nodal_gaps

    @property
    def film_thickness(self) -> Array:
        """At every film node, (strip, node, axial) [1]."""
        return self.smooth.film_thickness

    @property
    def journal_friction(self) -> float:
        """`mu_f` of a journal that turns and drags petals along; 0 where it does not [1]."""
        return self.smooth.journal_friction

    @property
    def n(self) -> int:
        """All unknowns."""
        return self.smooth.n

    @property
    def film(self) -> FilmState:
        """The film's rows."""
        return self.smooth.film

    @property
    def deflection(self) -> Array:
        """Unknowns of the petals, (n_wall,) [1]."""
        return self.smooth.state.w

    @property
    def pressures(self) -> Array:
        """Pressure unknowns, (n_film,) [1]."""
        return self.smooth.state.P

    @cached_property
    def gaps(self) -> Array:
        """Gaps at the samples, (E, S) [1]."""
        return self.samples.gaps(self.smooth.nodal_gaps, self.pressure)

    @property
    def reaction(self) -> Array:
        """Reactions of the samples, (E, S)."""
        return np.asarray(self.samples.weight * self.pressure)

    @property
    def law(self) -> Array:
        """Pressures of (K13) at the gaps, (E, S)."""
        return np.asarray(FULL_PRESSURE * np.exp(-np.clip(self.gaps / self.height, -OPEN, 5.0 * OPEN)))

    @property
    def bears(self) -> NDArray[np.bool_]:
        """Samples whose pressure is iterated on, (E, S)."""
        return self.gaps < self.followed * self.height

    @cached_property
    def mismatch(self) -> Array:
        """`g / s + ln(q / q_0)`, zero where (K13) holds, (E, S)."""
        left = self.gaps / self.height + np.log(self.pressure / FULL_PRESSURE)
        return np.where(self.bears, left, 0.0)

    @cached_property
    def contact(self) -> ContactResponse:
        """How reactions follow the gaps."""
        return ContactResponse.at(self.samples, self.pressure, self.height, self.mismatch)

    @cached_property
    def residual(self) -> tuple[Array, Array]:
        """Wall and film."""
        wall, film, *_ = self.smooth.residual
        return wall - self.samples.on_petals(self.reaction), film

    @property
    def wall_forces(self) -> tuple[Array, Array, Array]:
        """Generalised forces on the petals: elastic, by pressure and contacts, and magnitudes of these, (n_wall,)."""
        elastic, loads, size = self.smooth.wall_forces
        on_petals = self.samples.on_petals(self.reaction)
        pressing = abs(self.smooth.whole.curves.by_w.T) @ np.abs(self.samples.nodal(self.reaction))
        return elastic, loads + on_petals, size + np.maximum(pressing, np.abs(on_petals))

    @cached_property
    def scaled(self) -> Array:
        """Residuals over their row scales, as without contact, then the mismatch of the law times the pressure."""
        wall, film = self.residual
        scales = self.smooth.row_scales
        mismatch = self.mismatch * np.minimum(self.pressure, FULL_PRESSURE)
        return np.concatenate([wall / scales[0], film / scales[1], mismatch.ravel()])

    @property
    def newton_residual(self) -> Array:
        """Residual of Newton's method, with the reactions that the mismatch asks for; (n,)."""
        wall, film = self.residual
        return np.concatenate([wall + self.samples.on_petals(self.contact.every(self.contact.left)), film])

    @cached_property
    def steady(self) -> sp.csc_array:
        """The tangent."""
        by_w, n = self.smooth.whole.curves.by_w, self.n
        contact = sp.coo_array(self.contact.on_petals @ by_w)
        among_all = sp.coo_array((contact.data, (contact.row, contact.col)), shape=(n, n))
        return sp.csc_array(self.smooth.steady + among_all.tocsc())

    @property
    def stored(self) -> sp.csc_array:
        """Derivative of what the film stores."""
        return self.smooth.stored

    def forcing(self, rate: float = 0.0) -> Array:
        """Derivative of the rows by the journal's displacement, with `rate` times that of what the film stores."""
        forcing = self.smooth.forcing(rate)
        forcing[: self.smooth.whole.n_wall] += self.contact.on_petals @ self.smooth.whole.curves.by_e
        return forcing

    @cached_property
    def _lost_force(self) -> Array:
        """Loss of the force of the contacts on the journal by the nodal gaps, (2 n_node, d)."""
        return np.asarray(self.contact.stiffness @ self.smooth.whole.reaction_on_journal)

    @property
    def force_rows(self) -> Array:
        """Derivative of the force on the journal by the unknowns, (d, n)."""
        rows = self.smooth.force_rows
        rows[:, : self.smooth.whole.n_wall] -= (self.smooth.whole.curves.by_w.T @ self._lost_force).T
        return rows

    @property
    def force_direct(self) -> Array:
        """Derivative of the force on the journal by its displacement, unknowns held, (d, d)."""
        return np.asarray(-self._lost_force.T @ self.smooth.whole.curves.by_e)

    @property
    def force(self) -> Array:
        """Force of film and contacts on the journal over the unit of force, (d,)."""
        contact = self.smooth.whole.reaction_on_journal.T @ self.samples.nodal(self.reaction)
        return np.asarray(self.smooth.force + contact)

    @property
    def newton_force(self) -> Array:
        """The same with the reactions that the mismatch asks for, as in `newton_residual`."""
        lost = self.samples.nodal(self.contact.every(self.contact.left))
        return np.asarray(self.force - self.smooth.whole.reaction_on_journal.T @ lost)

    @property
    def points(self) -> ContactPoints:
        """One point for the contact in each element."""
        return self.samples.as_points(self.pressure)

    @property
    def friction_points(self) -> ContactPoints:
        """Points at which friction between petals acts."""
        return self.samples.friction_points(self.pressure)
