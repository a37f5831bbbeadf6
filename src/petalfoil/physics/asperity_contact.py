"""Contact pressure that decays exponentially with the gap, on gap curves of Hermite elements (K13), (K14).

    q = q_0 exp(-g / s)                                                                                (K13)

is the contact of rough surfaces with exponentially distributed asperity heights of mean `s` (Greenwood and Williamson
1966, doi:10.1098/rspa.1966.0242). For small `s` it is contact of smooth surfaces. A contact point becomes a pressure
over the width `sqrt(s / g'')`, whatever it carries, and nothing has to be found but the pressure: no contact opens,
closes or jumps. Gaps and pressures are sampled evenly in each element. Reactions bend their own element further, as
those of points do (K11), which couples the samples of an element (S8):

    g = rows n + C b lam ,   lam = weight q ,   dlam = -(1 + W C b)^-1 W rows dn ,   W = lam / s         (K14)

with the nodal gaps `n` of the element. A journal that turns drags the petals that it presses on with `mu_f lam` (D6).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.gap_curves import ContactPoints, Facing, GapCurves
from petalfoil.physics.lumped_pressure import two_points
from petalfoil.physics.petal_elements import clamped_beam
from petalfoil.physics.sprung_beam import on_springs
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]
Index = NDArray[np.intp]

FULL_PRESSURE = 1.0
"""`q_0`, the contact pressure at a gap of zero, over ambient pressure. Where it is ten times as much, gaps are wider by
2.3 asperities."""

NOTHING = 1e-12
"""Stiffness of samples, over the unit of reaction over gap, below which their element has no contact."""


@dataclass(frozen=True)
class DraggedSamples:
    """Motion of the inner faces along the journal at the samples, times `mu_f` (D6); zero where no journal is.

    Attributes
    ----------
    within : (E, S, 4) array
        Of a sample over the start of its element, from the nodal gaps of the element.
    before : (E, n) sparse
        Of the start of each element, from the unknowns of the petals.
    """

    within: Array
    before: sp.csr_array


@dataclass(frozen=True)
class ContactSamples:
    """Samples of all gap curves; the element at a root, which always lies on the bushing, has none.

    Attributes
    ----------
    curves : GapCurves
        The curves.
    per_element : int
        Samples per element.
    unit_angle : float
        Angle whose pressure of one is a reaction of one [rad].
    dragged : DraggedSamples or None
        What a journal that drags petals does beside pressing on them; None where it does not.
    """

    curves: GapCurves
    per_element: int
    unit_angle: float
    dragged: DraggedSamples | None = None

    @cached_property
    def _sampled(self) -> tuple[Index, Index]:
        """Curve and element of each sampled element."""
        curves = self.curves
        curve = np.repeat(np.arange(len(curves.first)), curves.elements)
        number = np.arange(len(curve)) - np.repeat(np.cumsum(curves.elements) - curves.elements, curves.elements)
        at_root = np.array([facing is Facing.BUSHING for facing in curves.facing])[curve] & (number == 0)
        return curve[~at_root], (curves.first[curve] + number)[~at_root]

    @property
    def element(self) -> Index:
        """Elements that are sampled, (E,)."""
        return self._sampled[1]

    @property
    def curve(self) -> Index:
        """Curves of these elements, (E,)."""
        return self._sampled[0]

    @cached_property
    def place(self) -> Array:
        """Places of the samples in an element, (S,)."""
        return (np.arange(self.per_element) + 0.5) / self.per_element

    @cached_property
    def weight(self) -> Array:
        """Reaction of a pressure of one at the samples of each element, (E, 1)."""
        return self.curves.angle[self.element][:, None] / (self.per_element * self.unit_angle)

    @cached_property
    def columns(self) -> Index:
        """Nodal (value, slope) pairs of each element, (E, 4)."""
        return 2 * self.element[:, None] + np.arange(4)

    @cached_property
    def rows(self) -> Array:
        """Gaps at the samples from the nodal pairs of their element, (E, S, 4)."""
        rows = np.repeat(hermite.basis(self.place)[None], len(self.element), axis=0)
        rows[:, :, 1::2] *= self.curves.angle[self.element][:, None, None]
        return rows

    @cached_property
    def bending(self) -> Array:
        """`b` between the samples of an element, (S, S)."""
        return clamped_beam(self.place[:, None], self.place[None, :])

    @cached_property
    def compliance(self) -> Array:
        """`C` of each element, (E,)."""
        return self.curves.compliance[self.element]

    def gaps(self, nodal: Array, pressure: Array) -> Array:
        """Gaps at the samples from all nodal gaps and the pressures (E, S); (E, S)."""
        return np.asarray(self.at_samples(nodal) + self.compliance[:, None] * ((self.weight * pressure) @ self.bending))

    def at_samples(self, nodal: Array) -> Array:
        """Values at the samples of all nodal pairs (2 n_node,), (E, S)."""
        return np.asarray(np.einsum("esk,ek->es", self.rows, nodal[self.columns]))

    def nodal(self, reaction: Array) -> Array:
        """Generalised forces on the nodal gaps by reactions (E, S) of the samples; (2 n_node,)."""
        return self._on_nodes(self.rows, reaction)

    def _on_nodes(self, rows: Array, reaction: Array) -> Array:
        """Forces along `rows` (E, S, 4) by reactions (E, S), summed at the nodal gaps; (2 n_node,)."""
        forces = np.einsum("esk,es->ek", rows, reaction)
        return add_up(self.columns.ravel(), forces.ravel(), len(self.curves.rest))

    @cached_property
    def acting(self) -> Array:
        """Forces of unit reactions on the nodal gaps of their element, friction on it included; (E, S, 4)."""
        return self.rows if self.dragged is None else self.rows + self.dragged.within

    def on_petals(self, reaction: Array) -> Array:
        """Generalised forces on the petals by reactions (E, S) and the friction of a journal (D6); (n,)."""
        loads = self.curves.by_w.T @ self._on_nodes(self.acting, reaction)
        if self.dragged is not None:
            loads = loads + self.dragged.before.T @ reaction.sum(axis=1)
        return np.asarray(loads)

    def as_points(self, pressure: Array) -> ContactPoints:
        """One point in each element that carries load, at the centroid of its reactions."""
        loaded, reaction = self._loaded(pressure)
        total = reaction.sum(axis=1)
        return self._in_order(loaded, (reaction @ self.place) / total, total)

    def friction_points(self, pressure: Array) -> ContactPoints:
        """Points at which friction acts: two in each element whose pressure is wide, else one (K18)."""
        loaded, reaction = self._loaded(pressure)
        element, place, part = two_points(self.place, reaction)
        return self._in_order(loaded[element], place, part)

    def _loaded(self, pressure: Array) -> tuple[Index, Array]:
        """Elements that carry load, (L,), and the reactions of their samples, (L, S)."""
        reaction = self.weight * pressure
        total = reaction.sum(axis=1)
        loaded = np.flatnonzero(total > NOTHING * max(float(total.sum()), 1.0))
        return loaded, reaction[loaded]

    def _in_order(self, element: Index, place: Array, reaction: Array) -> ContactPoints:
        """Contacts at places in sampled elements, (k,) each, in their order along the curves."""
        curve = self.curve[element]
        position = self.element[element] - self.curves.first[curve] + place
        order = np.lexsort((position, curve))
        none = np.zeros(len(order), dtype=np.intp)
        return ContactPoints(curve[order], position[order], none, reaction[order])


@dataclass(frozen=True)
class ContactResponse:
    """How reactions follow nodal gaps (K14), and what is left of (K13) at the pressures given.

    Attributes
    ----------
    samples : ContactSamples
        The samples.
    loaded : (L,) int array
        Sampled elements with contact.
    by_gaps : (L, S, 4) array
        Loss of reaction by the nodal gaps of the element.
    left : (L, S) array
        Loss of reaction that the mismatch of pressure and gap asks for.
    """

    samples: ContactSamples
    loaded: Index
    by_gaps: Array
    left: Array

    @classmethod
    def at(cls, samples: ContactSamples, pressure: Array, height: float | Array, mismatch: Array) -> ContactResponse:
        """At pressures (E, S), asperities of `height`, one or (E, S), and the mismatch `g / s + ln(q / q_0)` (E, S)."""
        stiffness = samples.weight * pressure / height
        loaded = np.flatnonzero(np.max(stiffness, axis=1, initial=0.0) > NOTHING)
        k, C = stiffness[loaded], samples.compliance[loaded]
        right = k[:, :, None] * samples.rows[loaded], (stiffness * height * mismatch)[loaded][:, :, None]
        solved = on_springs(k, C, np.concatenate(right, axis=2))
        return cls(samples, loaded, solved[:, :, :4], solved[:, :, 4])

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """Generalised forces on the nodal gaps by these, (2 n_node, 2 n_node), symmetric."""
        return self._along(self.samples.rows)

    @cached_property
    def on_petals(self) -> sp.csr_array:
        """Loss of the generalised forces on the petals by the nodal gaps, (n, 2 n_node): `by_w^T stiffness`.

        With friction of a journal, whose part is not symmetric.
        """
        samples, by_w = self.samples, self.samples.curves.by_w
        if samples.dragged is None:
            return sp.csr_array(by_w.T @ self.stiffness)
        columns, sums = samples.columns[self.loaded], self.by_gaps.sum(axis=1)
        where = np.repeat(self.loaded, 4), columns.ravel()
        shape = (len(samples.element), by_w.shape[0])
        of_elements = sp.coo_array((sums.ravel(), where), shape=shape).tocsr()
        return sp.csr_array(by_w.T @ self._along(samples.acting) + samples.dragged.before.T @ of_elements)

    def _along(self, rows: Array) -> sp.csr_array:
        """Loss of forces along `rows` (E, S, 4) by the nodal gaps, (2 n_node, 2 n_node)."""
        blocks = np.einsum("esk,esj->ekj", rows[self.loaded], self.by_gaps)
        columns, n = self.samples.columns[self.loaded], len(self.samples.curves.rest)
        where = np.repeat(columns, 4, axis=1).ravel(), np.tile(columns, (1, 4)).ravel()
        return sp.coo_array((blocks.ravel(), where), shape=(n, n)).tocsr()

    def by_nodal(self, weights: Array) -> Array:
        """Loss of the sum of the reactions times `weights` (E, S) by the nodal gaps, (2 n_node,)."""
        loss = np.einsum("es,esk->ek", weights[self.loaded], self.by_gaps)
        return add_up(self.samples.columns[self.loaded].ravel(), loss.ravel(), len(self.samples.curves.rest))

    def every(self, part: Array) -> Array:
        """Values of the loaded elements (L, S) among all, (E, S)."""
        out = np.zeros((len(self.samples.element), self.samples.per_element))
        out[self.loaded] = part
        return out

    def change(self, nodal: Array) -> Array:
        """Change of the reactions by a change of all nodal gaps, mismatch included; (E, S)."""
        moved = np.einsum("esk,ek->es", self.by_gaps, nodal[self.samples.columns[self.loaded]])
        return self.every(-(self.left + moved))
