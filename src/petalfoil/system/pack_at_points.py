"""The foil pack without film, with contact points and friction: round a journal of its size or thinner."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_friction import RubbingEquations
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]

THICK = 1e6
"""Thickness of a film at rest, which presses on nothing, over the reference film: steps do not close it."""


@dataclass(frozen=True)
class PackAtPoints(RubbingEquations):
    """The pack at zero speed.

    Attributes
    ----------
    withdrawn : float
        What the journal's radius is short of its own, over the reference length: while it is inserted [1].
    """

    withdrawn: float = 0.0

    @classmethod
    def of(
        cls, whole: PointLayout, problem: CoupledProblem, state: PointState, force: Array, withdrawn: float = 0.0
    ) -> Self:
        """The pack of `problem` in a state with friction forces `force` (j,), whatever the film."""
        thick = np.full(whole.layout.wall.film.shape, THICK)
        still = problem.at(bearing_number=0.0)
        return cls(whole, still, state, film_held=thick, friction_force=force, withdrawn=withdrawn)

    @property
    def turns(self) -> bool:
        """Its journal does not turn, and drags nothing along."""
        return False

    @cached_property
    def nodal_gaps(self) -> Array:
        """Nodal (value, slope) of all gap curves, that on the journal wider by `withdrawn`."""
        gaps: Array = super().nodal_gaps
        gaps[: self.whole.journal_entries : 2] += self.withdrawn
        return gaps
