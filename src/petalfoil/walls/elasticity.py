"""Elastic forces of a wall, in factors that keep them free of rounding."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import SparseRows

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
    def _levels(self) -> tuple[SparseRows, SparseRows, SparseRows]:
        """(whole, rest, metric): strains over the largest entry of their rows by jumps, and the rigidity between them.

        Jumps are differences of neighbouring deflections. Entries of `whole` are multiples of 1 / `PARTS`, +-1 between
        equal cells. Jumps of neighbouring cells are nearly equal: they are subtracted before they are weighted, so that
        their difference is free of rounding. Only `rest`, what unequal cells add beyond that, is rounded.
        """
        size = abs(self.strain).max(axis=1).toarray().ravel() if self.strain.nnz else np.ones(self.strain.shape[0])
        scale = sp.diags_array(np.where(size > 0.0, size, 1.0))
        unit = sp.csr_array(scale.power(-1) @ self.strain)
        whole, rest = unit.copy(), unit.copy()
        whole.data = np.round(PARTS * unit.data) / PARTS
        rest.data -= whole.data
        rest.data[np.abs(rest.data) < CELL_ROUNDING] = 0.0
        for part in (whole, rest):
            part.eliminate_zeros()
        return SparseRows(whole), SparseRows(rest), SparseRows(scale @ self.rigidity @ scale)

    @cached_property
    def _jumps(self) -> SparseRows:
        """`difference`, for products."""
        return SparseRows(self.difference)

    def _strains(self, W: Array) -> Array:
        """Strains of deflections `W`, over the largest entry of their rows; (m,)."""
        (whole, rest, _), jumps = self._levels, self._jumps @ W
        strains: Array = whole @ jumps + rest @ jumps
        return strains

    def force(self, W: Array, low_order: Array | None = None) -> Array:
        """Nodal forces of deflections `W` plus their low-order part, below the last digit of `W`; (n,) [N]."""
        whole, rest, metric = self._levels
        moments = metric @ (self._strains(W) if low_order is None else self._strains(W) + self._strains(low_order))
        out: Array = self._jumps.T @ (whole.T @ moments + rest.T @ moments)
        return out


PARTS = 1024
"""Parts of one in which the ratio of two cells' lengths takes part in sums without rounding.

Jumps of finest grids have some 42 binary digits, so that products with ten more are exact. With whole numbers alone
what was rounded beside unequal cells left a residual of 1e-8 at 4096 cells per pitch, a digit of one node up or down.
"""

CELL_ROUNDING = 1e-10
"""Cells whose length ratio differs from 1 by less than this count as equal [1]."""


def no_elasticity() -> Elasticity:
    """A wall that does not move."""
    nothing = sp.csr_array((0, 0))
    return Elasticity(nothing, nothing, nothing)
