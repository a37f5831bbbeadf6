"""Small motions of a rigid shaft in two bearings, each about its own equilibrium (E6).

    dF = sum_k T_k^T dF_k,    de_k = T_k dq

`q = (x, y, l a_x, l a_y)` is the position of the shaft at its mass centre, `T_k` the position of the journal in bearing
`k` by it. Units of length and force are those of the first bearing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.small_motion import Motion, Response
from petalfoil.solvers.reduced_model import MovedSystem
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Each = TypeVar("Each")
Values = NDArray[Any]
"""Real, or complex where a wall loses energy or at a frequency."""


@dataclass(frozen=True)
class JointResponse:
    """Response of both bearings at one rate of change.

    Attributes
    ----------
    motion : JointMotion
        What moves.
    parts : tuple of Response
        Response of each bearing to its own journal.
    """

    motion: JointMotion
    parts: tuple[Response, ...]

    @property
    def force_gradient(self) -> Values:
        """`dF/dq`, (4, 4) [1]."""
        return self.motion.summed([part.force_gradient for part in self.parts])

    def slope(self) -> Values:
        """Its derivative by `s` [1]."""
        return self.motion.summed([part.slope() for part in self.parts])


@dataclass(frozen=True)
class JointMotion:
    """Both bearings about their equilibria.

    Attributes
    ----------
    parts : tuple of Motion
        Small motions in each bearing.
    by_shaft : tuple of (n_position, 4) array
        `T_k`.
    """

    parts: tuple[Motion, ...]
    by_shaft: tuple[Array, ...]

    @property
    def problem(self) -> CoupledProblem:
        """The first bearing, whose units hold."""
        return self.parts[0].problem

    @property
    def contact_model(self) -> str:
        """Where the contacts are, for people."""
        return "; ".join(dict.fromkeys(part.contact_model for part in self.parts))

    @property
    def film_thickness(self) -> Array:
        """Film of both bearings over the reference length of the first [1]."""
        unit = self.problem.layout.scales.length
        films = [part.film_thickness.ravel() * part.problem.layout.scales.length / unit for part in self.parts]
        return np.concatenate(films)

    @property
    def loss(self) -> sp.csc_array | None:
        """That of the first wall that loses energy."""
        return next((part.loss for part in self.parts if part.loss is not None), None)

    @property
    def units(self) -> list[tuple[float, float]]:
        """Unit of length of the first bearing over that of each, and unit of force of each over that of the first."""
        first = self.problem.layout.scales
        scales = (part.problem.layout.scales for part in self.parts)
        return [(first.length / one.length, one.force / first.force) for one in scales]

    def summed(self, gradients: list[Values]) -> Values:
        """`sum_k T_k^T G_k T_k` in the units of the first bearing, (4, 4)."""
        each = zip(gradients, self.by_shaft, self.units, strict=True)
        total: Values = np.sum([length * force * T.T @ G @ T for G, T, (length, force) in each], axis=0)
        return total

    def moved_system(self, solver: LinearSolver) -> MovedSystem:
        """Both as one system for a reduced model; one factorisation for each that moves in its own way."""
        systems = self._each(lambda part: part.moved_system(solver))
        ends = np.cumsum([one.S.shape[0] for one in systems])[:-1]
        each = list(zip(systems, self.by_shaft, self.units, strict=True))

        def solve(right: Values) -> Values:
            return np.concatenate([one.solve(piece) for one, piece in zip(systems, np.split(right, ends), strict=True)])

        def stacked(pick: str, order: int, factor: int) -> Values:
            return np.vstack([getattr(one, pick)[order] @ T * unit[factor] for one, T, unit in each])

        return MovedSystem(
            solve,
            sp.csc_array(sp.block_diag([one.S for one in systems], format="csc")),
            (stacked("forcing", 0, 0), stacked("forcing", 1, 0)),
            (stacked("force", 0, 1), stacked("force", 1, 1)),
            (self.summed([one.direct[0] for one in systems]), self.summed([one.direct[1] for one in systems])),
        )

    def growing(self, s: complex, solver: LinearSolver) -> JointResponse:
        """The response to a motion in `exp(s tau)`; one factorisation for each that moves in its own way."""
        return JointResponse(self, tuple(self._each(lambda part: part.growing(s, solver))))

    def _each(self, of: Callable[[Motion], Each]) -> list[Each]:
        """What `of` makes of each part, once where both bearings move alike."""
        first = of(self.parts[0])
        return [first if part is self.parts[0] else of(part) for part in self.parts]
