"""The rotor that rides in the bearing."""

from __future__ import annotations

from typing import Annotated, ClassVar

from petalfoil.case.definition import Definition
from petalfoil.case.fields import Quantity
from petalfoil.case.sections import MAX_SPEED


class Rotor(Definition):
    """A rigid rotor: the part of its mass that this bearing carries, and what turns with it."""

    section: ClassVar[str] = "rotor"

    mass: Annotated[float, Quantity(unit="kg", meaning="mass on this bearing", symbol="m", above=0.0, at_most=1e6)]
    unbalance: Annotated[
        float,
        Quantity(unit="m", meaning="distance of the mass centre from the axis", symbol="u", at_least=0.0, at_most=1.0),
    ] = 0.0
    rotating_load: Annotated[
        float, Quantity(unit="N", meaning="rotating load", symbol="F_r", at_least=0.0, at_most=1e9)
    ] = 0.0
    rotating_speed: (
        Annotated[
            float,
            Quantity(
                unit="rad/s",
                meaning="speed of the rotating load",
                symbol="Omega_r",
                at_least=-MAX_SPEED,
                at_most=MAX_SPEED,
            ),
        ]
        | None
    ) = None
