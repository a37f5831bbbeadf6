"""Newton's method for slips in several harmonics (E22): its tangent, and its steps by GMRES.

    dv_h + (R_h - r) sum_i (dT_h / dv_i) dv_i = right_h

Petals and film move contacts by each other in one harmonic, friction moves harmonics by each other in one contact.
Either alone is solved at once. Preconditioned with that part of friction by which a harmonic moves itself, GMRES takes
15 to 60 products where all together are up to thousands of unknowns. Harmonics above those that film and petals are
solved at have one `R_h`, and in the preconditioner the mean of what friction does to each: one inverse serves them all.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, gmres

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LESS = 1e-3
"""Part of the residual that a step may leave: two or three steps of Newton's method end at rounding with it."""

PRODUCTS, ROUNDS = 100, 2
"""Products before GMRES begins anew, and how often it does: what it has then is taken as the step."""


def moved_by_each(matrices: Complex, values: Complex) -> Complex:
    """Products with (harmonics, k) of matrices (m, k, k), one for each harmonic, the last for all above."""
    last = len(matrices) - 1
    first = [matrix @ value for matrix, value in zip(matrices[:last], values[:last], strict=False)]
    return np.concatenate([np.reshape(first, (-1, values.shape[1])), values[last:] @ matrices[-1].T])


@dataclass(frozen=True)
class HarmonicTangent:
    """The tangent at some slips.

    Attributes
    ----------
    coupling : (m, k, k) array
        `R_h - r` at the first harmonics; the last is that of all above.
    own : (contacts, directions 2 harmonics, directions 2 harmonics) array
        Derivative of each contact's friction by its slips, real parts before imaginary ones in each direction.
    """

    coupling: Complex
    own: Array

    @property
    def _shape(self) -> tuple[int, int, int]:
        """Harmonics, directions, contacts."""
        contacts, parts, _ = self.own.shape
        directions = self.coupling.shape[1] // contacts
        return parts // (2 * directions), directions, contacts

    def friction(self, step: Complex) -> Complex:
        """Change of the friction forces by a change of the slips, (harmonics, k) each."""
        harmonics, directions, contacts = self._shape
        parts = np.concatenate([step.real, step.imag]).reshape(2 * harmonics, directions, contacts)
        moved = self.own @ parts.transpose(2, 1, 0).reshape(contacts, -1, 1)
        out = moved.reshape(contacts, directions, 2 * harmonics).transpose(2, 1, 0).reshape(2 * harmonics, -1)
        return np.asarray(out[:harmonics] + 1j * out[harmonics:])

    def times(self, step: Complex) -> Complex:
        """Change of the residual by a change of the slips, (harmonics, k) each."""
        return step + moved_by_each(self.coupling, self.friction(step))

    @cached_property
    def _alone(self) -> Complex:
        """Inverse of what each harmonic does to itself, for motions that only turn their phase; (m, k, k) or fewer."""
        harmonics, directions, contacts = self._shape
        own = self.own.reshape(contacts, directions, 2, harmonics, directions, 2, harmonics)
        at, groups = np.arange(harmonics), min(harmonics, len(self.coupling))
        itself = own[:, :, :, at, :, :, at]  # (harmonic, contact, direction, part, by direction, by part)
        real = itself[:, :, :, 0, :, 0] + itself[:, :, :, 1, :, 1]
        stiffness = 0.5 * (real + 1j * (itself[:, :, :, 1, :, 0] - itself[:, :, :, 0, :, 1]))
        stiffness[groups - 1] = stiffness[groups - 1 :].mean(axis=0)
        coupled = self.coupling[:groups].reshape(groups, -1, directions, contacts)
        whole = np.einsum("hjdc,hcde->hjec", coupled, stiffness[:groups]).reshape(groups, *self.coupling.shape[1:])
        return np.asarray(np.linalg.inv(np.eye(self.coupling.shape[1]) + whole))

    def solve(self, right: Complex) -> Complex:
        """The step that leaves `LESS` of `right` (harmonics, k), or as little as so many products do."""
        size = 2 * right.size

        def joined(values: Complex) -> Array:
            return np.concatenate([values.real.ravel(), values.imag.ravel()])

        def apart(values: Array) -> Complex:
            return np.asarray(values[: right.size] + 1j * values[right.size :]).reshape(right.shape)

        def alone(values: Array) -> Array:
            return joined(moved_by_each(self._alone, apart(values)))

        whole = LinearOperator((size, size), matvec=lambda values: joined(self.times(apart(values))), dtype=float)
        near = LinearOperator((size, size), matvec=alone, dtype=float)
        found, _ = gmres(whole, joined(right), M=near, rtol=LESS, restart=PRODUCTS, maxiter=ROUNDS)
        return apart(np.asarray(found))
