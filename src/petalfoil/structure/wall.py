"""The protocol between a wall and the film, contacts and journal that load it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.contact import Contacts

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wall:
    """A discretised wall: all that the coupled problem needs to know of it.

    Attributes
    ----------
    name : str
        Kind of wall, as registered.
    film : FilmMesh
        The film's strips over the wall.
    stiffness : (n, n) sparse
        Symmetric, positive semi-definite: elastic nodal forces from deflections [N/m].
    film_unknown : (strip, node, axial) int array
        Number of the deflection unknown under each film node, -1 where the wall does not move.
    load_area : (strip, node, axial) array
        Area through which the film's excess pressure pushes that unknown outward [m^2].
    rest_film : (strip, node, axial) array
        Film thickness of the free wall over a centred journal [m].
    contacts : Contacts
        One-sided gaps; the `journal` rows, where there are any, are the film nodes in order: `h = g_J + h_min`.
    node_area : float
        A typical node's area, the unit of nodal forces [m^2].
    free_motions : (n, k) sparse
        Motions without elastic energy once the supports let go.
    support : (k, n) sparse
        Force of the supports in those motions from the deflections [N/m]: loads `f` are balanced when
        `free_motions^T f + support W = 0`.
    """

    name: str
    film: FilmMesh
    stiffness: sp.csr_array
    film_unknown: NDArray[np.intp]
    load_area: Array
    rest_film: Array
    contacts: Contacts
    node_area: float
    free_motions: sp.csr_array
    support: sp.csr_array

    @property
    def n_unknown(self) -> int:
        """Deflection unknowns."""
        return int(self.stiffness.shape[0])

    def film_thickness(self, W: Array, e: Array) -> Array:
        """Film over deflections `W` (n,) and journal displacement `e` (2,), shape of the film mesh [m]."""
        normal = self.film.theta
        displaced = self.rest_film - (e[0] * np.cos(normal) + e[1] * np.sin(normal))[:, :, None]
        return displaced + np.append(W, 0.0)[self.film_unknown]
