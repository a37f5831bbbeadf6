"""A discretised wall: all that film, contacts and journal need to know of what bounds the film."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case, ModelKind
from petalfoil.mesh.axial import AxialGrid, axis_2d, axis_3d
from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.contact import Contacts
from petalfoil.walls.elasticity import Elasticity

Array = NDArray[np.float64]

ALIGNED = 2
"""Coordinates of the position of a shaft that stays parallel to the bushing: x, y."""


@dataclass(frozen=True)
class Wall:
    """A discretised wall.

    Attributes
    ----------
    film : FilmMesh
        The film's strips over the wall.
    elasticity : Elasticity
        Elastic nodal forces from deflections.
    film_unknown : (strip, node, axial) int array
        Number of the deflection unknown under each film node, -1 where the wall does not move.
    load_area : (strip, node, axial) array
        Area through which the film's excess pressure pushes that unknown outward [m^2].
    rest_film : (strip, node, axial) array
        Film thickness of the free wall over a centred journal [m].
    contacts : Contacts
        One-sided gaps; the `journal` rows, where there are any, are the film nodes in order: `h = g_J + h_c`.
    node_area : float
        A typical node's area, the unit of nodal forces [m^2].
    reference_film : float
        Film thickness that unknowns are scaled with: films of this wall are about that thick [m].
    free_motions : (n, k) sparse
        Motions without elastic energy once the supports are released.
    support : (k, n) sparse
        Force of the supports in those motions from the deflections [N/m]: loads `f` are balanced when
        `free_motions^T f + support W = 0`.
    slip, reaction_share : (k, n), (k, m) sparse
        Slip where surfaces slide on each other, from the deflections, and the share of each gap's reaction that
        presses there (D1) [1].
    dragged : (m, n) sparse or None
        Motion of the surface under the journal along that of the journal, from the deflections, on its gaps (D6) [1];
        None where it cannot move that way.
    loss : (n, n) sparse or None
        Nodal forces that are a quarter of a cycle ahead of the deflections, whatever the frequency: structural loss
        factor times stiffness (B5) [N/m]; None of a wall that loses no energy.
    axial_slip : (k, n) sparse or None
        Slip along the shaft where `slip` is that along the petals [1]; None where nothing moves along the shaft.
    """

    film: FilmMesh
    elasticity: Elasticity
    film_unknown: NDArray[np.intp]
    load_area: Array
    rest_film: Array
    contacts: Contacts
    node_area: float
    reference_film: float
    free_motions: sp.csr_array
    support: sp.csr_array
    slip: sp.csr_array
    reaction_share: sp.csr_array
    dragged: sp.csr_array | None = None
    loss: sp.csr_array | None = None
    axial_slip: sp.csr_array | None = None

    @property
    def n_unknown(self) -> int:
        """Deflection unknowns."""
        return int(self.elasticity.difference.shape[1])

    @property
    def n_position(self) -> int:
        """Coordinates of the journal's position: 2, or 4 where the shaft is free to tilt."""
        return int(self.contacts.by_e.shape[1])

    @cached_property
    def _normal(self) -> tuple[Array, Array]:
        """Components of the normal at the film nodes, (strip, node) each [1]."""
        return np.cos(self.film.theta), np.sin(self.film.theta)

    def film_thickness(self, W: Array, e: Array) -> Array:
        """Film over deflections `W` (n,) and journal position `e` (n_position,), shape of the film mesh [m]."""
        if self.n_position == ALIGNED:  # the same along the shaft
            along_x, along_y = self._normal
            displaced = self.rest_film - (e[0] * along_x + e[1] * along_y)[:, :, None]
        else:
            displaced = self.rest_film + (self.contacts.by_e[self.contacts.journal] @ e).reshape(self.rest_film.shape)
        thickness: Array = displaced + np.append(W, 0.0)[self.film_unknown]
        return thickness


@dataclass(frozen=True)
class PlacedContacts:
    """Contacts between nodes, at their places.

    Attributes
    ----------
    petal : (k,) int array
        Petal that touches.
    facing : (k,) int array
        What it touches: 0 the journal, 1 the bushing, 2 the petal behind it, on which it lies.
    angle : (k,) array
        Angle from its root [rad].
    force : (k,) array
        Normal force [N].
    curvature : (k, 2) array
        Change of curvature of this petal there, and of the one on which it lies; nan where there is none [1/m].
    """

    petal: NDArray[np.intp]
    facing: NDArray[np.intp]
    angle: Array
    force: Array
    curvature: Array


@dataclass(frozen=True)
class WallState:
    """What film and contacts do to a wall.

    Attributes
    ----------
    deflection : (n,) array
        Deflections, positive toward the bushing [m].
    contact_pressure : (m,) array
        Contact pressure on each gap [Pa].
    placed : PlacedContacts or None
        The contacts at their places; None where they are at nodes.
    membrane : (petal, node) array or None
        Membrane force along the petals over the width [N/m]; None where it follows from the deflections.
    """

    deflection: Array
    contact_pressure: Array
    placed: PlacedContacts | None = None
    membrane: Array | None = None


def axial_grid(case: Case) -> AxialGrid:
    """One station for a 2-D model; else half the length, or the whole where symmetry is not used."""
    length = case.bearing.length
    if case.model.kind is ModelKind.TWO_D:
        return axis_2d(length)
    cells, half = case.axial_cells, case.symmetric
    return axis_3d(length, cells, half=half, grading=case.axial_grading, density=case.axial_density)
