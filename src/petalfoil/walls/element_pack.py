"""A leaf pack of Hermite elements, 2-D: petals with continuous slopes on a grid of their own.

It is made beside the pack of nodes (`petals.py`), whose film it keeps. The gaps of undeflected petals are those of the
nodes, interpolated by a cubic spline, so that whatever is built into them is in the gap curves too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.mesh.pack import PackMesh
from petalfoil.mesh.pitch import petal_angles
from petalfoil.mesh.splines import smooth
from petalfoil.physics.gap_curves import ContactPoints, Facing, GapCurves
from petalfoil.physics.petal_elements import PetalElements, clamped_beam
from petalfoil.physics.petal_sliding import Faces
from petalfoil.physics.shell import PetalShell
from petalfoil.sparsity import SparseRows, block_diagonal, compressed, repeated
from petalfoil.walls.base import Wall

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class ElementLoads:
    """Point loads on petals, (k,) each: petal, element, place in it, force toward the bushing over its unit."""

    petal: Index
    element: Index
    place: Array
    force: Array


@dataclass(frozen=True)
class ElementPack:
    """Petals of Hermite elements under the film of a pack of nodes.

    Attributes
    ----------
    petals : tuple of PetalElements
        The petals, on the same nodes.
    mesh : PackMesh
        Nodes of the pack whose film this one bounds.
    wall : Wall
        That pack.
    per_pitch : int
        Elements per pitch.
    faces : Faces
        What the petals slide on.
    """

    petals: tuple[PetalElements, ...]
    mesh: PackMesh
    wall: Wall
    per_pitch: int
    faces: Faces

    @property
    def elements(self) -> PetalElements:
        """One of the petals: nodes and supports are those of all."""
        return self.petals[0]

    @cached_property
    def nodal(self) -> sp.csr_array:
        """(value, slope) at the nodes of all petals from the unknowns."""
        return repeated(self.elements.nodal, self.mesh.count)

    @cached_property
    def bending(self) -> sp.csr_array:
        """`B` of all petals, see `PetalElements.bending`."""
        known: dict[int, sp.csr_array] = {}
        for petal in self.petals:
            if id(petal) not in known:
                known[id(petal)] = petal.bending
        return block_diagonal([known[id(petal)] for petal in self.petals])

    @property
    def n_unknown(self) -> int:
        """Unknowns of all petals."""
        return int(self.nodal.shape[1])

    @property
    def nodes(self) -> dict[Facing, slice]:
        """Nodes of a petal along each of its gap curves."""
        last = len(self.elements.phi)
        return {
            Facing.JOURNAL: slice(last - self.per_pitch - 1, last),
            Facing.BUSHING: slice(0, self.per_pitch + 1),
            Facing.PETAL: slice(self.per_pitch, last),
        }

    @cached_property
    def curves(self) -> GapCurves:
        """Gaps toward journal, bushing and petals below, petal by petal in each kind [m]."""
        parts = [self._curves_of(facing, kind) for kind, facing in enumerate(self.nodes)]
        facing, rest, by_e, by_w, angle, soft, nodes = zip(*parts, strict=True)
        toward_journal = np.repeat([kind is Facing.JOURNAL for kind in self.nodes], self.mesh.count * np.array(nodes))
        softness = np.concatenate(soft)
        per_curve = np.repeat(nodes, self.mesh.count)
        return GapCurves(
            tuple(kind for kind in facing for _ in range(self.mesh.count)),
            np.cumsum(per_curve) - per_curve,
            per_curve - 1,
            np.concatenate(angle)[:-1],
            np.where(toward_journal, 0.0, softness)[:-1],
            softness[:-1],
            np.concatenate(rest),
            np.concatenate(by_e),
            sp.csr_array(sp.vstack(by_w, format="csr")),
        )

    def _curves_of(self, facing: Facing, kind: int) -> tuple[Facing, Array, Array, sp.csr_array, Array, Array, int]:
        """The curves of one kind: rest, derivatives, element angles and softnesses with a gap behind each curve."""
        nodes, n = self.nodes[facing], self.mesh.count
        phi = self.elements.phi[nodes]
        lines = self.wall.contacts.lines[kind]
        gaps = smooth(lines.phi, self.wall.contacts.rest[lines.number], axis=1)
        rest = np.stack([gaps(phi), gaps(phi, 1)], axis=-1).ravel()
        theta = (self.mesh.roots[:, None] + phi).ravel()
        towards_journal = np.stack([-np.cos(theta), -np.sin(theta), np.sin(theta), -np.cos(theta)], axis=1)
        by_e = towards_journal.reshape(-1, 2) * float(facing is Facing.JOURNAL)
        angle = np.append(self.elements.element_angle[nodes.start : nodes.stop - 1], 1.0)
        C = np.pad(self.compliance[:, nodes.start : nodes.stop - 1], ((0, 0), (0, 1)))
        if facing is Facing.PETAL:  # both petals give
            C = C + C[np.arange(1, n + 1) % n]
        return facing, rest, by_e, self._by_w(facing), np.tile(angle, n), C.ravel(), len(phi)

    def _by_w(self, facing: Facing) -> sp.csr_array:
        """Derivative of the nodal gaps of one kind by the unknowns."""
        nodes, n = self.nodes[facing], self.mesh.count
        pairs = np.arange(2 * n * len(self.elements.phi)).reshape(n, -1)
        mine = self.nodal[pairs[:, 2 * nodes.start : 2 * nodes.stop].ravel()]
        if facing is Facing.JOURNAL:
            return sp.csr_array(mine)
        if facing is Facing.BUSHING:
            return sp.csr_array(-mine)
        below = pairs[np.arange(1, n + 1) % n, : 2 * (nodes.stop - nodes.start)]
        return sp.csr_array(self.nodal[below.ravel()] - mine)

    @cached_property
    def film_rows(self) -> SparseRows:
        """Gap toward the journal at the film nodes from the nodal gaps of all curves, (film nodes, 2 n_node)."""
        curves, phi = self.curves, self.mesh.phi[self.mesh.exposed]
        element, t = hermite.located(phi, self.elements.phi[self.nodes[Facing.JOURNAL]])
        petal = np.repeat(np.arange(self.mesh.count), len(phi))
        return SparseRows(curves.rows(petal, np.tile(element + t, self.mesh.count)))

    @cached_property
    def floor(self) -> Array:
        """Film thickness less the gap toward the journal at the film nodes: the contact film thickness [m]."""
        out: Array = self.wall.rest_film.ravel() - self.wall.contacts.rest[self.wall.contacts.journal]
        return out

    @cached_property
    def node_places(self) -> tuple[Index, Array]:
        """Element of each node of `mesh` but the root, and place in it, (n_node - 1,)."""
        return hermite.located(self.mesh.phi[1:], self.elements.phi)

    @cached_property
    def at_nodes(self) -> SparseRows:
        """Deflections at the nodes of all petals from the unknowns, roots apart, cubics alone; (n_wall, n)."""
        rows = hermite.rows(*self.node_places, self.elements.element_angle)
        return SparseRows(repeated(rows @ self.elements.nodal, self.mesh.count))

    @cached_property
    def bent_at_nodes(self) -> SparseRows:
        """What forces on these nodes bend within their own element (S7), at the same nodes, (n_wall, n_wall) [m/N]."""
        element, t = self.node_places
        at, load = np.nonzero(element[:, None] == element)
        bend, shape = clamped_beam(t[at], t[load]), (len(t), len(t))
        starts = np.searchsorted(at, np.arange(len(t) + 1))
        parts = [compressed(sp.csr_array, C[element[at]] * bend, load, starts, shape) for C in self.compliance]
        return SparseRows(block_diagonal(parts))

    @cached_property
    def compliance(self) -> Array:
        """Point compliance of the elements of each petal, (petal, element) [m/N]."""
        return np.stack([petal.point_compliance for petal in self.petals])

    def from_nodes(self, deflection: Array) -> Array:
        """Unknowns of petals whose nodes have `deflection` (n_wall, ...), by a cubic spline; (n, ...)."""
        count, several = self.mesh.count, deflection.shape[1:]
        inner = deflection[: count * (self.mesh.n_node - 1)].reshape(count, self.mesh.n_node - 1, *several)
        W = np.concatenate([np.zeros((count, 1, *several)), inner], axis=1)
        curve, phi = smooth(self.mesh.phi, W, axis=1), self.elements.phi
        pairs = np.stack([curve(phi), curve(phi, 1) * self.elements.slope_angle], axis=2)
        first = 2 if self.elements.clamped else 1
        return np.asarray(pairs.reshape(count, -1, *several)[:, first:].reshape(-1, *several))

    @cached_property
    def free_motions(self) -> Array:
        """Motions that bend nothing (S4) in the unknowns, (n, k)."""
        return self.from_nodes(self.wall.free_motions.toarray())

    def contact_places(self, points: ContactPoints) -> tuple[ElementLoads, ElementLoads]:
        """Where contact points are on the petals that touch, and between petals on those behind them.

        Forces are those on these petals, toward the bushing.
        """
        curves, n = self.curves, self.mesh.count
        facing, petal = np.divmod(points.every_curve, n)
        at, place = curves.locate(points.every_curve, points.every_position)
        at = at - curves.first[points.every_curve]
        kinds = list(self.nodes)
        start = np.array([self.nodes[kind].start for kind in kinds])[facing]
        sign = np.array([1.0 if kind is Facing.JOURNAL else -1.0 for kind in kinds])[facing]
        lies = facing == kinds.index(Facing.PETAL)
        own = ElementLoads(petal, at + start, place, sign * points.reaction)
        return own, ElementLoads((petal[lies] + 1) % n, at[lies], place[lies], points.reaction[lies])


def element_pack(shells: Sequence[PetalShell], mesh: PackMesh, wall: Wall, per_pitch: int, faces: Faces) -> ElementPack:
    """The pack of `wall` in Hermite elements; `per_pitch` as in `ElementPack`."""
    pitch = 2.0 * np.pi / mesh.count
    phi = petal_angles(pitch, float(mesh.phi[-1]) / pitch, per_pitch)
    made: dict[int, PetalElements] = {}
    for shell in shells:
        if id(shell) not in made:
            made[id(shell)] = PetalElements(
                phi, mesh.axial.length, shell.metric_radius, shell.bend_radius, shell.rigidity, shell.clamped
            )
    return ElementPack(tuple(made[id(shell)] for shell in shells), mesh, wall, per_pitch, faces)
