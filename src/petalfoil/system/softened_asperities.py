"""Contact pressures over asperities on a central path: slacks keep pressures positive while both are far from the law.

    g + s ln(q / q_0) = sigma ,   sigma q = mu                                                        (K13b)

For a large barrier `mu` contact is soft and wide, `q = mu / g`; for `mu -> 0` it is (K13). With `sigma` eliminated
(K14) holds with `W = lam / (s + sigma)`: no contact is stiffer than its asperities, and none than its barrier.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.asperity_contact import FULL_PRESSURE, ContactResponse
from petalfoil.system.asperity_equations import AsperityEquations

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SoftenedAsperities(AsperityEquations):
    """The equations at one state; every pressure is iterated on.

    Attributes
    ----------
    slack : (E, S) array
        `sigma`, positive [1].
    product : (E, S) array
        What `sigma q` is to become [1].
    """

    slack: Array = field(kw_only=True)
    product: Array = field(kw_only=True)

    @property
    def open_by(self) -> Array:
        """`sigma - g - s ln(q / q_0)`, (E, S)."""
        return np.asarray(self.slack - self.gaps - self.height * np.log(self.pressure / FULL_PRESSURE))

    @property
    def barrier(self) -> float:
        """Mean of `sigma q` over the angle [1]."""
        weight = np.broadcast_to(self.samples.weight, self.slack.shape)
        return float(np.average(self.slack * self.pressure, weights=weight))

    @cached_property
    def contact(self) -> ContactResponse:
        """How reactions follow the gaps."""
        softness = self.slack + self.height
        wanted = self.slack - self.open_by - self.product / self.pressure
        return ContactResponse.at(self.samples, self.pressure, softness, wanted / softness)

    def change(self, nodal: Array) -> tuple[Array, Array]:
        """Changes of pressures and slacks by a change of all nodal gaps (2 n_node,), (E, S) each."""
        pressure = self.contact.change(nodal) / self.samples.weight
        return pressure, (self.product - self.slack * (self.pressure + pressure)) / self.pressure
