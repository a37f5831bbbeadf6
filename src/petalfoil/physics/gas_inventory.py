"""How much gas a film holds that has no ends: the limit of a long bearing.

A flat film that closes on itself exchanges no gas with its surroundings, and its cells' balances leave its content
free: they add up to nothing. In a bearing of finite length `d_z^2 sum (H^3 P^2 + 12 Kn H^2 P) dphi = 0` with ambient
ends, so that the sum is that of `P = 1` at every station, however long it is (F6). The flat film takes that for one
balance.
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
class GasContent:
    """The condition on a film without ambient nodes: `area` (node, axial) of its cells, Knudsen number (F7) [1]."""

    mesh: FilmMesh
    area: Array
    knudsen: float = 0.0

    @property
    def needed(self) -> bool:
        """No node of the film is ambient."""
        return bool(np.all(self.mesh.unknown >= 0))

    def value(self, P: Array, H: Array) -> float:
        """`sum H^3 (P^2 - 1) + 12 Kn H^2 (P - 1)` over the film (F6) [1]."""
        return float(np.sum(self.area * H**3 * (P**2 - 1.0) + self._slip(H) * (P - 1.0)))

    def size(self, P: Array, H: Array) -> float:
        """Sum of the magnitudes of its terms [1]."""
        return float(np.sum(self.area * H**3 * (P**2 + 1.0) + self._slip(H) * (P + 1.0)))

    def _slip(self, H: Array) -> Array:
        return 12.0 * self.knudsen * self.area * H**2

    def tangent(self, P: Array, H: Array) -> tuple[Array, Array]:
        """Derivatives by the pressure unknowns (n_unknown,) and by the film at every node (flat)."""
        by_P = 2.0 * self.area * H**3 * P + self._slip(H)
        by_H = 3.0 * self.area * H**2 * (P**2 - 1.0) + 2.0 * self._slip(H) / H * (P - 1.0)
        return add_up(self.mesh.unknown.ravel(), by_P.ravel(), self.mesh.n_unknown), by_H.ravel()

    @cached_property
    def by_pressure(self) -> Entries:
        """Places of the derivatives by pressure: the first balance gives way."""
        n = self.mesh.n_unknown
        return Entries(np.zeros(n, dtype=np.intp), np.arange(n))

    @cached_property
    def by_film(self) -> Entries:
        """Places of the derivatives by film thickness."""
        n = self.mesh.unknown.size
        return Entries(np.zeros(n, dtype=np.intp), np.arange(n))
