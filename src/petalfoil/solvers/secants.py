"""Steps with the factor of another state, bettered by what the steps before them have shown.

With the factor `B` of a state nearby, a step `z = -B^-1 F(x)` leaves a part of the residual that `B` does not know.
Steps `dx_i` and the changes `dz_i` of `z` along them tell how it answers: those of an exact tangent would be `-dx_i`.
The next step is

    z - sum_i g_i (dx_i + dz_i) ,   g = argmin |z - sum_i g_i dz_i|                                    (C15)

Anderson 1965, doi:10.1145/321296.321305: a quasi-Newton method that needs no solves but those of the steps.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REMEMBERED = 2
"""Steps that are remembered, the last ones: the early ones mislead, for the equations are not straight. Lift-off of the
rig takes 269 steps and 45 tangents with two, 299 and 44 with five."""


@dataclass
class Secants:
    """What steps with one factor have shown; states and steps are over the same units.

    Attributes
    ----------
    differences : list of (step, change)
        Steps taken, (n,), and changes of what the factor asked for along them.
    last : (state, asked) or None
        The state before the last step, and what the factor asked for there.
    """

    differences: list[tuple[Array, Array]] = field(default_factory=list)
    last: tuple[Array, Array] | None = None

    def bettered(self, state: Array, asked: Array) -> Array:
        """The step (n,) from a `state` (n,) at which the factor asks for another one (n,) (C15)."""
        if self.last is not None:
            before, asked_before = self.last
            self.differences = [*self.differences, (state - before, asked - asked_before)][-REMEMBERED:]
        self.last = state, asked
        if not self.differences:
            return asked
        steps, changes = (np.stack(part) for part in zip(*self.differences, strict=True))
        weights = np.linalg.lstsq(changes @ changes.T, changes @ asked)[0]  # steps alike are weighted as one
        return np.asarray(asked - weights @ (steps + changes))
