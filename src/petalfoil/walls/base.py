"""The protocol between a wall and the film, contacts and journal that load it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.contact import Contacts

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Elasticity:
    """Elastic energy `|strain difference W|^2 / 2` in the metric of `rigidity`, kept in factors.

    Attributes
    ----------
    difference : (k, n) sparse
        Differences of neighbouring deflections, entries +-1: free of rounding.
    strain : (m, k) sparse
        Strains from differences.
    rigidity : (m, m) sparse
        Symmetric, positive semi-definite: generalised stresses from strains, weights included.
    """

    difference: sp.csr_array
    strain: sp.csr_array
    rigidity: sp.csr_array

    @cached_property
    def stiffness(self) -> sp.csr_array:
        """Nodal forces from deflections, (n, n), symmetric [N/m]."""
        S = self.strain @ self.difference
        return sp.csr_array(S.T @ self.rigidity @ S)

    @cached_property
    def _levels(self) -> tuple[sp.csr_array, sp.csr_array, sp.csr_array]:
        """(whole, rest, metric): strains over the largest entry of their rows by jumps, and the rigidity between them.

        Jumps are differences of neighbouring deflections. Entries of `whole` are +-1 (none beside a cell of less than
        half the length): jumps of neighbouring cells, which lie close together, are subtracted before they are
        weighted, and their difference is free of rounding. Only `rest`, what unequal cells add, is rounded.
        """
        size = abs(self.strain).max(axis=1).toarray().ravel() if self.strain.nnz else np.ones(self.strain.shape[0])
        scale = sp.diags_array(np.where(size > 0.0, size, 1.0))
        unit = sp.csr_array(scale.power(-1) @ self.strain)
        whole, rest = unit.copy(), unit.copy()
        whole.data = np.round(unit.data)
        rest.data -= whole.data
        rest.data[np.abs(rest.data) < CELL_ROUNDING] = 0.0
        for part in (whole, rest):
            part.eliminate_zeros()
        return whole, rest, sp.csr_array(scale @ self.rigidity @ scale)

    def _strains(self, W: Array) -> Array:
        """Strains of deflections `W`, over the largest entry of their rows; (m,)."""
        (whole, rest, _), jumps = self._levels, self.difference @ W
        strains: Array = whole @ jumps + rest @ jumps
        return strains

    def force(self, W: Array, fine: Array | None = None) -> Array:
        """Nodal forces of deflections `W` plus `fine`, what of them lies below the last digit of `W`; (n,) [N]."""
        whole, rest, metric = self._levels
        moments = metric @ (self._strains(W) if fine is None else self._strains(W) + self._strains(fine))
        out: Array = self.difference.T @ (whole.T @ moments + rest.T @ moments)
        return out


CELL_ROUNDING = 1e-10
"""Cells whose ratio misses one by less are equal."""


def no_elasticity() -> Elasticity:
    """A wall that does not move."""
    nothing = sp.csr_array((0, 0))
    return Elasticity(nothing, nothing, nothing)


@dataclass(frozen=True)
class Wall:
    """A discretised wall: all that the coupled problem needs to know of it.

    Attributes
    ----------
    name : str
        ModelKind of wall, as registered.
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
        One-sided gaps; the `journal` rows, where there are any, are the film nodes in order: `h = g_J + h_min`.
    node_area : float
        A typical node's area, the unit of nodal forces [m^2].
    free_motions : (n, k) sparse
        Motions without elastic energy once the supports let go.
    support : (k, n) sparse
        Force of the supports in those motions from the deflections [N/m]: loads `f` are balanced when
        `free_motions^T f + support W = 0`.
    slip, share : (k, n), (k, m) sparse
        How far petals slide over bushing and neighbours by the deflections, and what presses them there (D1) [1].
    """

    name: str
    film: FilmMesh
    elasticity: Elasticity
    film_unknown: NDArray[np.intp]
    load_area: Array
    rest_film: Array
    contacts: Contacts
    node_area: float
    free_motions: sp.csr_array
    support: sp.csr_array
    slip: sp.csr_array
    share: sp.csr_array

    @property
    def n_unknown(self) -> int:
        """Deflection unknowns."""
        return int(self.elasticity.difference.shape[1])

    def film_thickness(self, W: Array, e: Array) -> Array:
        """Film over deflections `W` (n,) and journal displacement `e`, shape of the film mesh [m].

        `e` is (2,), or (4,) where the shaft tilts (`pair`).
        """
        if len(e) == 2:  # the same along the shaft
            normal = self.film.theta
            displaced = self.rest_film - (e[0] * np.cos(normal) + e[1] * np.sin(normal))[:, :, None]
        else:
            displaced = self.rest_film + (self.contacts.by_e[self.contacts.journal] @ e).reshape(self.rest_film.shape)
        thickness: Array = displaced + np.append(W, 0.0)[self.film_unknown]
        return thickness
