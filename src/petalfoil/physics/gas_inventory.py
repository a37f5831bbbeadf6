"""The gas inventory of a film without ambient boundary: the limit of a long bearing.

A 2-D film that closes on itself exchanges no gas with its surroundings. Its mass balances add up to zero, so that one
of them follows from the others and the gas inventory is undetermined. In a bearing of finite length with ambient ends,
`d_z^2 sum (H^3 P^2 + 12 Kn H^2 P) dphi = 0`. The sum therefore has the value of `P = 1` at every station, for any
length (F6). The 2-D film takes this condition in place of its first mass balance.

In motion the bearing fills and empties through its ends: with `q` this sum and `m = sum 2 Lam P H dphi`,
`-d_Z^2 q / 2 + d_tau m = 0`. `q` over its ambient value is taken as a parabola in `Z`, as under a uniform source, so
that its mean obeys `q - q_a + (L / R_j)^2 / 6 d_tau m = 0` (F6b). The cell whose balance is left out gains and loses
for all others; in a fast motion all share it (F6d, `system.film_rows.FilmRows.shared`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.mass_balance import Entries
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]


@dataclass(frozen=True)
class GasInventory:
    """The condition (F6) on a film without ambient nodes.

    Parameters
    ----------
    mesh : FilmMesh
        Strips and pressure unknowns.
    area : (node, axial) array
        Cell areas over the journal radius squared [1].
    slenderness : float
        Bearing length over journal radius [1].
    knudsen : float
        Knudsen number on the reference film at ambient pressure (F7); zero without slip [1].
    """

    mesh: FilmMesh
    area: Array
    slenderness: float
    knudsen: float = 0.0

    @property
    def filling(self) -> float:
        """Factor of the rate of the stored mass beside `value` (F6b) [1]."""
        return self.slenderness**2 / 6.0

    @property
    def needed(self) -> bool:
        """Whether no node of the film is ambient."""
        return bool(np.all(self.mesh.unknown >= 0))

    def value(self, P: Array, H: Array) -> float:
        """Residual `sum H^3 (P^2 - 1) + 12 Kn H^2 (P - 1)` over the film (F6) [1]."""
        return float(np.sum(self.excess(P, H)))

    def row_scale(self, P: Array, H: Array) -> float:
        """Sum of the magnitudes of the terms of the residual [1]."""
        return float(np.sum(self.magnitude(P, H)))

    def excess(self, P: Array, H: Array) -> Array:
        """Its term of each node, (strip, node, axial) [1]."""
        return self.area * H**3 * (P**2 - 1.0) + self._slip(H) * (P - 1.0)

    def magnitude(self, P: Array, H: Array) -> Array:
        """Sum of the magnitudes of that term's parts, (strip, node, axial) [1]."""
        return self.area * H**3 * (P**2 + 1.0) + self._slip(H) * (P + 1.0)

    def excess_derivatives(self, P: Array, H: Array) -> tuple[Array, Array]:
        """Derivatives of each node's term by its own pressure and film thickness, (strip, node, axial) each."""
        by_P = 2.0 * self.area * H**3 * P + self._slip(H)
        by_H = 3.0 * self.area * H**2 * (P**2 - 1.0) + 2.0 * self._slip(H) / H * (P - 1.0)
        return by_P, by_H

    def _slip(self, H: Array) -> Array:
        return 12.0 * self.knudsen * self.area * H**2

    def tangent(self, P: Array, H: Array) -> tuple[Array, Array]:
        """Derivatives with respect to the pressure unknowns (n_unknown,) and to the film at every node (flattened)."""
        by_P, by_H = self.excess_derivatives(P, H)
        return add_up(self.mesh.unknown.ravel(), by_P.ravel(), self.mesh.n_unknown), by_H.ravel()

    @cached_property
    def by_pressure(self) -> Entries:
        """Positions of the derivatives with respect to pressure: the row of the first mass balance."""
        n = self.mesh.n_unknown
        return Entries(np.zeros(n, dtype=np.intp), np.arange(n))

    @cached_property
    def by_film(self) -> Entries:
        """Positions of the derivatives with respect to film thickness."""
        n = self.mesh.unknown.size
        return Entries(np.zeros(n, dtype=np.intp), np.arange(n))
