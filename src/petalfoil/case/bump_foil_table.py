"""Bumps as springs: under the smooth top foil of a bump foil, and behind petals."""

from __future__ import annotations

import math
from collections.abc import Iterator
from enum import StrEnum
from typing import Annotated, ClassVar

from petalfoil.case.definition import Definition
from petalfoil.case.metals import Metal, MetalName, metal_of
from petalfoil.case.number_fields import Quantity
from petalfoil.case.problems import Problem
from petalfoil.case.wall_tables import WallTable


class Feet(StrEnum):
    """What the feet of a bump do under its load: slide without friction (`FREE`), or stay (`HELD`)."""

    FREE = "free"
    HELD = "held"


STRIP = ("bump_pitch", "bump_half_length", "thickness", "youngs_modulus", "poisson_ratio")
"""Keys from which the stiffness of the bumps follows."""


class Springs(Definition):
    """Springs side by side that a corrugated strip makes, by their stiffness or by the geometry of the strip."""

    foundation_stiffness: (
        Annotated[
            float,
            Quantity(unit="Pa/m", meaning="pressure over deflection", symbol="k_b", above=0.0, at_most=1e18),
        ]
        | None
    ) = None
    """Required, or else the strip from which it follows: pitch, half length, thickness and metal."""
    loss_factor: Annotated[
        float, Quantity(unit="1", meaning="structural loss factor", symbol="gamma", at_least=0.0, at_most=2.0)
    ] = 0.0
    bump_pitch: (
        Annotated[
            float, Quantity(unit="m", meaning="distance of neighbouring crowns", symbol="s_b", above=0.0, at_most=0.1)
        ]
        | None
    ) = None
    bump_half_length: (
        Annotated[float, Quantity(unit="m", meaning="half the chord of a bump", symbol="l_b", above=0.0, at_most=0.05)]
        | None
    ) = None
    bump_half_angle: (
        Annotated[
            float,
            Quantity(unit="rad", meaning="half the angle of a bump's arc", symbol="t_0", at_least=0.05, at_most=1.5),
        ]
        | None
    ) = None
    """Without it the bump is shallow, and its height unknown."""
    feet: Feet = Feet.FREE
    """What the feet of a bump do: slide freely (`free`), or stay where they are (`held`)."""
    thickness: (
        Annotated[
            float, Quantity(unit="m", meaning="metal thickness of the bumps", symbol="t_f", above=0.0, at_most=0.01)
        ]
        | None
    ) = None
    material: MetalName = None
    """Metal of the strip by name, in place of its modulus and Poisson's ratio. Only the stiffness of a strip, and a top
    foil that bends, need one."""
    metal_temperature: Annotated[
        float, Quantity(unit="K", meaning="temperature of the foil's metal", symbol="T_m", above=0.0, at_most=2000.0)
    ] = 293.15
    """Of effect on the modulus of a material."""
    youngs_modulus: (
        Annotated[float, Quantity(unit="Pa", meaning="Young's modulus", symbol="E_y", above=0.0, at_most=1e13)] | None
    ) = None
    poisson_ratio: (
        Annotated[float, Quantity(unit="1", meaning="Poisson's ratio", symbol="nu", above=-1.0, below=0.5)] | None
    ) = None

    @property
    def bends_top_foil(self) -> bool:
        """Whether a top foil bends on the springs, of the same metal."""
        return False

    @property
    def travel(self) -> float:
        """Height of the bumps, as far as they can be pressed in; infinite where it is unknown [m]."""
        if self.bump_half_length is None or self.bump_half_angle is None:
            return math.inf
        return self.bump_half_length * math.tan(0.5 * self.bump_half_angle)

    @property
    def metal(self) -> Metal | None:
        """What is known of the material; None without one."""
        return None if self.material is None else metal_of(self.material)

    @property
    def elastic(self) -> tuple[float, float]:
        """Young's modulus [Pa] and Poisson's ratio of the foil, of its material or as given; nan where neither is."""
        if self.metal is not None:
            return self.metal.youngs_modulus(self.metal_temperature), self.metal.poisson_ratio
        given = self.youngs_modulus, self.poisson_ratio
        return math.nan if given[0] is None else given[0], math.nan if given[1] is None else given[1]

    def rigidity(self, thickness: float) -> float:
        """Bending stiffness of foil of a thickness, `E_y t^3 / (12 (1 - nu^2))` [N m]; nan without its metal."""
        modulus, poisson_ratio = self.elastic
        return modulus * thickness**3 / (12.0 * (1.0 - poisson_ratio**2))

    def problems(self) -> Iterator[Problem]:
        """Yield what keeps the stiffness of the springs from being known, or gives it twice."""
        given = [key for key in (*STRIP, "bump_half_angle") if getattr(self, key) is not None]
        yield from self._metal_problems()
        either = "foundation_stiffness alone, or the strip: " + ", ".join(STRIP)
        metal = {"youngs_modulus", "poisson_ratio"}
        if self.foundation_stiffness is not None:
            twice = [key for key in given if not (self.bends_top_foil and key in metal)]
            if twice:
                text = f"is given beside {', '.join(twice)}, from which it follows too; allowed: {either}"
                yield self._problem("foundation_stiffness", text, self.foundation_stiffness, either)
            needed: tuple[str, ...] = tuple(sorted(metal)) if self.bends_top_foil else ()
            held = self.feet is Feet.HELD
        else:
            needed, held = STRIP, self.feet is Feet.HELD and self.bump_half_angle is None
        for key in needed:
            if self.material is not None and key in metal:
                continue
            if getattr(self, key) is None:
                why = "a top foil bends by it" if self.foundation_stiffness is not None else either
                yield self._problem(key, f"is missing; expected {why}", None, why)
        if held:
            need = "feet that are held need a strip with bump_half_angle: a shallow bump on held feet does not deflect"
            yield self._problem("feet", f"'held' has no stiffness here; {need}", self.feet.value, need)
        elif self.bump_pitch is not None and self.bump_half_length is not None:
            yield from self._pitch_problems(self.bump_pitch, 2.0 * self.bump_half_length)

    def _metal_problems(self) -> Iterator[Problem]:
        for key in ("youngs_modulus", "poisson_ratio"):
            if self.material is not None and getattr(self, key) is not None:
                text = f"is given beside {self.section}.material = {self.material!r}; allowed: one of them"
                yield self._problem(key, text, getattr(self, key), "a material or numbers")

    def _pitch_problems(self, pitch: float, chord: float) -> Iterator[Problem]:
        if pitch < chord:
            text = f"{pitch:g} m is less than the chord of a bump, {chord:g} m; allowed: at least that"
            yield self._problem("bump_pitch", text, pitch, f"at least {chord:g} m")

    def _problem(self, key: str, text: str, given: object, allowed: str) -> Problem:
        return Problem(f"{self.section}.{key}", text, given, allowed)


class BumpFoil(Springs, WallTable):
    """A bump foil under a smooth top foil, as springs side by side; the bushing radius is that of the free top foil.

    The springs are linear both ways: where the film is below ambient pressure the top foil follows it inward, as one
    that is held to its bumps.
    """

    section: ClassVar[str] = "bump_foil"

    top_foil_thickness: Annotated[
        float,
        Quantity(unit="m", meaning="thickness of a top foil that bends", symbol="t_t", at_least=0.0, at_most=0.01),
    ] = 0.0

    @property
    def bends_top_foil(self) -> bool:
        """Where it has a thickness."""
        return self.top_foil_thickness > 0.0


class Backing(Springs):
    """Backing springs: a corrugated strip between petals and bushing, over the pitch behind each root.

    A petal that is pressed outward rests on the springs in place of a rigid bushing, and leaves them where it is drawn
    inward. The roots of the petals are held at the bushing radius.
    """

    section: ClassVar[str] = "backing"

    height: Annotated[
        float,
        Quantity(
            unit="m",
            meaning="height of the free crowns inside the bushing radius",
            symbol="h_s",
            at_least=0.0,
            at_most=0.01,
        ),
    ] = 0.0
    start: Annotated[
        float,
        Quantity(unit="m", meaning="arc length from the root to the strip", symbol="l_s", at_least=0.0, at_most=1.0),
    ] = 0.0
    """In front of it petals lie on the bushing."""

    def problems_under(self, pitch: float) -> Iterator[Problem]:
        """Yield the same, and a strip that begins behind the arc of a `pitch` [m]."""
        yield from self.problems()
        if self.start >= pitch:
            text = f"{self.start:g} m is behind the arc of a pitch, {pitch:g} m, on which springs stand; allowed: less"
            yield self._problem("start", text, self.start, f"less than {pitch:g} m")
