"""Sections of a case other than petals and gas: bearing, surface, operation, model."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import Annotated, ClassVar, Self

from pydantic import BeforeValidator, StrictBool

from petalfoil.case.definition import Definition
from petalfoil.case.number_fields import Count, NumbersOrWord, Quantity, as_load, as_pair

MAX_SPEED = 1e6  # rad/s, 9.5 million rpm: beyond any shaft


class Bearing(Definition):
    """Journal and bushing."""

    section: ClassVar[str] = "bearing"

    journal_radius: Annotated[
        float, Quantity(unit="m", meaning="journal radius", symbol="R_j", above=0.0, at_most=10.0)
    ]
    bushing_radius: Annotated[
        float, Quantity(unit="m", meaning="bushing radius", symbol="R_B", above=0.0, at_most=10.0)
    ]
    length: Annotated[float, Quantity(unit="m", meaning="bearing length", symbol="L", above=0.0, at_most=20.0)]

    @property
    def clearance(self) -> float:
        """Radial clearance of the centred journal, ``R_B − R_j`` [m]."""
        return self.bushing_radius - self.journal_radius


class FrictionHistory(StrEnum):
    """Which friction forces petals have in an equilibrium."""

    RELAXED = "relaxed"
    ASSEMBLED = "assembled"


class JournalRubbing(StrEnum):
    """What dry friction of the journal does: resist its turning alone, or also pull at petals and rotor."""

    TORQUE = "torque"
    FORCE = "force"


class Surface(Definition):
    """Roughness and dry friction of journal and petals."""

    section: ClassVar[str] = "surface"

    contact_film_thickness: Annotated[
        float,
        Quantity(
            unit="m",
            meaning="contact film thickness, below which surfaces touch",
            symbol="h_c",
            above=0.0,
            at_most=1e-2,
        ),
    ] = 1e-6
    friction_coefficient: Annotated[
        float, Quantity(unit="1", meaning="dry friction coefficient", symbol="mu_f", at_least=0.0, at_most=5.0)
    ] = 0.3
    journal_rubbing: JournalRubbing = JournalRubbing.TORQUE
    """What dry friction of the turning journal does where it touches: `torque` resists its turning alone; `force` also
    drags the petals along the journal's motion, and holds the rotor back (D6), (D7). In 3-D contacts are then at nodes.
    At zero speed an equilibrium is that of a journal about to turn."""
    petal_friction: Annotated[
        float,
        Quantity(
            unit="1",
            meaning="dry friction coefficient between petals and on the bushing",
            symbol="mu_p",
            at_least=0.0,
            at_most=5.0,
        ),
    ] = 0.0
    friction_width: Annotated[
        float,
        Quantity(unit="m", meaning="slip within which friction builds up", symbol="s_f", above=0.0, at_most=1e-3),
    ] = 1e-9
    friction_history: FrictionHistory | None = None
    """Friction forces between petals in an equilibrium: `assembled`, those of the path that the pack has gone
    (assembled, loaded at rest, run up); or `relaxed`, none, as vibrations leave it. By default `runup` (and `static`)
    follows the path where petals slide along themselves in 2-D, and every other question is about the relaxed pack."""


_Displacement = Annotated[
    float, Quantity(unit="m", meaning="journal displacement", symbol="e", at_least=-10.0, at_most=10.0)
]
_Slope = Annotated[
    float, Quantity(unit="rad", meaning="slope of the journal's axis", symbol="a", at_least=-0.1, at_most=0.1)
]
_Moment = Annotated[
    float, Quantity(unit="N*m", meaning="moment on the journal", symbol="moment", at_least=-1e9, at_most=1e9)
]
_Force = Annotated[float, Quantity(unit="N", meaning="load on the journal", symbol="load", at_least=-1e9, at_most=1e9)]


class Operation(Definition):
    """What the journal does: its speed and where it sits, or the load on it (`x`, `y` in the bushing frame).

    A load given as one quantity acts along -y, as a weight does. The axis of the journal is parallel to the bushing's,
    held at the slopes `tilt`, or free to tilt under a `moment` about the bearing's centre or on a rotor with a span.
    """

    section: ClassVar[str] = "operation"

    speed: Annotated[
        float,
        Quantity(
            unit="rad/s",
            meaning="angular speed",
            symbol="omega",
            at_least=0.0,
            at_most=MAX_SPEED,
            beyond="petals point in the direction of rotation, so that a bearing that turns the other way is this one "
            "seen from its other end: x with the other sign",
        ),
    ]
    eccentricity: Annotated[tuple[_Displacement, _Displacement], BeforeValidator(as_pair)] = (0.0, 0.0)
    """Components `[x, y]`."""
    load: Annotated[tuple[_Force, _Force], BeforeValidator(as_load)] | None = None
    """Components `[x, y]`, or one value along -y. Give a load or an eccentricity: one follows from the other."""
    tilt: Annotated[tuple[_Slope, _Slope], BeforeValidator(as_pair)] | None = None
    """Slopes `[x, y]` of the axis at which the journal is held; needs the 3-D model. Parallel to the bushing unless
    given. With a `rotor.span` the bearing stands askew by them to the line through both bearings, and the slopes of the
    shaft add to it."""
    moment: Annotated[tuple[_Moment, _Moment], BeforeValidator(as_pair)] | None = None
    """Components `[x, y]` about the bearing's centre. The journal is then free to tilt; give a load as well. With a
    `rotor.span` it acts on the rotor."""

    def alone(self, tilt: tuple[float, float] | None) -> Self:
        """The same without what is asked of the journal but its speed, at slopes `tilt` [rad]."""
        return type(self)(speed=self.speed, tilt=tilt)

    def farthest(self, length: float) -> float:
        """Largest displacement of the journal's axis over a bearing `length` [m], at one of its ends [m]."""
        ends = (-0.5 * length, 0.5 * length)
        (x, y), (a_x, a_y) = self.eccentricity, self.tilt or (0.0, 0.0)
        return max(math.hypot(x + a_x * z, y + a_y * z) for z in ends)


ADAPTED, UNIFORM = "adapted", "uniform"
"""Stations along the shaft where a solution on a coarse grid bends most, or at equal distances."""


class ModelKind(StrEnum):
    """Dimensions of the model: infinitely long, without side leakage (`TWO_D`), or of finite length (`THREE_D`)."""

    TWO_D = "2d"
    THREE_D = "3d"


class Edges(StrEnum):
    """Pressure at the edges of a petal's film: ambient, or continuous across the step."""

    AMBIENT = "ambient"
    CONTINUOUS = "continuous"


class Method(StrEnum):
    """Solution method: coupled Newton, or the paper's relaxation."""

    NEWTON = "newton"
    CLASSIC = "classic"


class ContactDiscretization(StrEnum):
    """Where petals touch: at points and along stretches that travel between nodes, or at nodes of the film's grid."""

    POINTS = "points"
    NODES = "nodes"


class Model(Definition):
    """What is solved, on which grid; None lets `Case` choose the grid."""

    section: ClassVar[str] = "model"

    kind: ModelKind
    """Infinitely long without side leakage, or of finite length."""
    edges: Edges = Edges.AMBIENT
    """Pressure at the edges of a petal's film: ambient, or continuous across the step."""
    cells_per_pitch: Annotated[int, Count(meaning="cells per pitch", at_least=4, at_most=4096)] | None = None
    """128 in 2-D and 64 in 3-D unless given; without petals 128 round the circle."""
    petal_cells: Annotated[int, Count(meaning="elements of a petal per pitch", at_least=12, at_most=96)] = 32
    """Cubic elements of petals whose contacts are points; of no effect in 3-D, or with contacts at nodes. Stiffness on
    16 and 32 of them differs from that on 48 by up to 0.6 and 0.04 %; many make stretches of contact hard to find."""
    contacts: ContactDiscretization = ContactDiscretization.POINTS
    """At points that travel between nodes, in 2-D on petals with continuous slopes, in 3-D where they are isolated; or
    at nodes of the film's grid."""
    axial_cells: Annotated[int, Count(meaning="cells over the whole length", at_least=2, at_most=512)] | None = None
    """24 unless given, of a bump foil 64, of a plain bearing 32; of no effect in 2-D."""
    axial_grading: (
        Annotated[
            float,
            Quantity(unit="1", meaning="how far cells shrink toward the ends", symbol="a_z", at_least=0.0, at_most=0.9),
        ]
        | None
    ) = None
    """0 unless given, without petals 0.6; of no effect in 2-D or beside `axial_density`."""
    axial_density: (
        Annotated[
            tuple[float, ...] | str,
            NumbersOrWord(
                meaning="density of the stations at equal distances from an end of the bearing to its middle",
                words=(ADAPTED, UNIFORM),
                symbol="rho_z",
                least=3,
                most=65,
                at_least=1e-2,
                at_most=1e2,
            ),
        ]
        | None
    ) = None
    """Density of the stations from an end to the middle. With petals, unless given, from 8 cells on: adapted to a
    coarse solution where they bend only, crowded at their sides where they stretch."""
    symmetry: StrictBool = True
    """Solve half of the length in 3-D."""
    slip: StrictBool = False
    """First-order slip at the walls of the film (F7)."""
    method: Method = Method.NEWTON
    """Film, petals and contacts together by Newton's method, or the paper's relaxation."""
