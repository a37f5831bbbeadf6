"""Free whirls with as many harmonics of the slips as they need, from those of one harmonic (E18), (E19), (E22)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.rubbing_cycle import CHANGE, MOST
from petalfoil.dynamics.rubbing_whirl import ONE_LEAVES, HarmonicsLeft, RubbingWhirl
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError

Complex = NDArray[np.complex128]

ROUNDS = 3
"""Most numbers of harmonics, one after another: that which the start needs is nearly always enough."""


class FreeWhirl(Protocol):
    """A solution of (E19)."""

    @property
    def motion(self) -> tuple[complex, Complex]:
        """`s` and `v`."""


Found = TypeVar("Found", bound=FreeWhirl)


def bettered(
    whirl: RubbingWhirl, found: Found, near: Callable[[RubbingWhirl, Found], Found | None]
) -> tuple[Found, HarmonicsLeft]:
    """The whirl near one of one harmonic, and what its harmonics leave; the one of one harmonic where none is found.

    `near` solves (E19) near a whirl. The number of harmonics is that which the start needs. Where the solution needs
    more, it is begun with again.
    """
    if not whirl.takes_several:
        return found, ONE_LEAVES
    here, outcome = found, "none is found near it with several"
    try:
        for _ in range(ROUNDS):
            several = whirl.with_enough(here.motion)
            better = near(several, here)
            if better is None:
                break
            left, here = several.left(better.motion), better
            if left.told.friction_harmonics_change <= CHANGE or left.told.friction_harmonics >= MOST:
                return better, left
        else:
            outcome = "their number does not settle"
    except ConvergenceError as failure:
        outcome = str(failure)
    current_run().note("one harmonic", s=f"{found.motion[0]:.6g}", outcome=outcome)
    return found, ONE_LEAVES
