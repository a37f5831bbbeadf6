"""The rotor that rides in the bearing."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated, ClassVar, Self

from pydantic import model_validator

from petalfoil.case.definition import Definition
from petalfoil.case.number_fields import VALUE_PROBLEM, Quantity, refuse
from petalfoil.case.second_bearing import SecondBearing
from petalfoil.case.sections import MAX_SPEED


class Which(StrEnum):
    """One of the two bearings of a rotor."""

    FIRST = "first"
    SECOND = "second"


class Rotor(Definition):
    """A rigid rotor: its mass, unbalance and rotating load, and the distance of its second bearing if it has one.

    Without `span` its axis keeps its direction, and `mass` is the part of its mass on this bearing. With `span` it runs
    in two bearings and may tilt; `mass` is then its whole mass. They are equal unless `second` says how the second one
    differs, and equally far from the mass centre unless `centre` says where it is.
    """

    section: ClassVar[str] = "rotor"

    mass: Annotated[
        float,
        Quantity(
            unit="kg",
            meaning="rotor mass on this bearing, with span of the whole rotor",
            symbol="m",
            above=0.0,
            at_most=1e6,
        ),
    ]
    unbalance: Annotated[
        float,
        Quantity(unit="m", meaning="distance of the mass centre from the axis", symbol="u", at_least=0.0, at_most=1.0),
    ] = 0.0
    rotating_load: Annotated[
        float, Quantity(unit="N", meaning="rotating load", symbol="F_r", at_least=0.0, at_most=1e9)
    ] = 0.0
    span: (
        Annotated[
            float,
            Quantity(unit="m", meaning="distance between two bearings", symbol="2 l", above=0.0, at_most=1e3),
        ]
        | None
    ) = None
    """Without it there is one bearing, and the axis of the rotor keeps its direction."""
    centre: Annotated[
        float,
        Quantity(
            unit="m",
            meaning="mass centre, from the middle of the bearings toward the second",
            symbol="z_G",
            at_least=-1e3,
            at_most=1e3,
        ),
    ] = 0.0
    """Beyond half the span the rotor is overhung."""
    load_place: (
        Annotated[
            float,
            Quantity(
                unit="m",
                meaning="where operation.load acts, from the middle of the bearings toward the second",
                symbol="z_F",
                at_least=-1e3,
                at_most=1e3,
            ),
        ]
        | None
    ) = None
    """At the mass centre unless given."""
    second: SecondBearing | None = None
    """The second bearing where it differs from the first."""
    results_of: Which = Which.FIRST
    """Bearing that results of a rotor on unequal bearings describe; of the other one they tell the most important."""
    transverse_inertia: Annotated[
        float,
        Quantity(unit="kg*m^2", meaning="moment of inertia about a diameter", symbol="I_t", at_least=0.0, at_most=1e9),
    ] = 0.0
    """With a span; without it a cylinder of the journal's radius between the bearings is taken."""
    polar_inertia: Annotated[
        float,
        Quantity(unit="kg*m^2", meaning="moment of inertia about the axis", symbol="I_p", at_least=0.0, at_most=1e9),
    ] = 0.0
    skew: Annotated[
        float,
        Quantity(
            unit="rad", meaning="angle of the principal axis to the axis", symbol="chi", at_least=-0.1, at_most=0.1
        ),
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
    """That of the shaft unless given; negative against the shaft's."""

    @property
    def lever(self) -> float:
        """Half the distance of two bearings [m]; 0 for one."""
        return 0.5 * self.span if self.span else 0.0

    @property
    def bearings(self) -> int:
        """Bearings that it runs in."""
        return 2 if self.span else 1

    @property
    def places(self) -> tuple[float, ...]:
        """Where its bearings are, from the mass centre along the shaft [m]."""
        return (0.0,) if self.span is None else (-0.5 * self.span - self.centre, 0.5 * self.span - self.centre)

    @property
    def load_arm(self) -> float:
        """Distance of the load from the mass centre [m]."""
        return 0.0 if self.load_place is None else self.load_place - self.centre

    @property
    def is_even(self) -> bool:
        """Whether its bearings are equal and equally far from mass centre and load."""
        return self.second is None and self.centre == 0.0 and self.load_arm == 0.0

    @property
    def inertia_is_estimated(self) -> bool:
        """Whether it may tilt, and its inertias are not given."""
        return self.span is not None and self.transverse_inertia == 0.0

    def with_inertias(self, radius: float) -> Self:
        """The rotor with inertias where none are given: those of a cylinder of a radius [m] between its bearings.

        ``I_t = m (span^2 / 12 + R^2 / 4)``, ``I_p = m R^2 / 2``.
        """
        if self.span is None or not self.inertia_is_estimated:
            return self
        transverse = self.mass * (self.span**2 / 12.0 + radius**2 / 4.0)
        return self.model_copy(update={"transverse_inertia": transverse, "polar_inertia": 0.5 * self.mass * radius**2})

    @model_validator(mode="after")
    def _tilts_as_a_body(self) -> Self:
        """Refuse inertias without a span, and a polar inertia beyond that of a disk or without the other."""
        if self.span is None and (self.transverse_inertia or self.polar_inertia or self.skew):
            text = "inertias and skew matter only to a rotor in two bearings: give its span, or leave them out"
            raise refuse(VALUE_PROBLEM, text, "together with span")
        if self.span is None and (self.centre or self.load_place is not None or self.second is not None):
            text = "centre, load_place and second are of a rotor in two bearings: give its span, or leave them out"
            raise refuse(VALUE_PROBLEM, text, "together with span")
        if self.polar_inertia and not self.transverse_inertia:
            text = "polar_inertia is given alone: give transverse_inertia too, or neither to have both estimated"
            raise refuse(VALUE_PROBLEM, text, "transverse_inertia greater than 0 kg*m^2")
        if self.polar_inertia > 2.0 * self.transverse_inertia:
            text = (
                f"polar_inertia {self.polar_inertia:g} kg*m^2 is more than a body of this transverse_inertia can have"
            )
            raise refuse(VALUE_PROBLEM, text, "at most twice transverse_inertia")
        return self
