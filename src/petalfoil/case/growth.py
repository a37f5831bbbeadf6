"""Growth of shaft and bushing: the shaft by its speed, both by their temperatures.

The radii of a case hold at rest at 20 °C (`REFERENCE_TEMPERATURE`). A shaft with a free end, of outer radius `b` and
bore radius `a`, at the angular velocity `omega` and the mean temperature `T`, is larger by

    u(b) = rho omega^2 b ((1 - nu) b^2 + (3 + nu) a^2) / (4 E)  +  alpha b (T - T_0)                        (G5)

(Timoshenko and Goodier, Theory of Elasticity, 3rd ed. 1970, sections 32 and 150). Growth closes or opens the gaps on
the journal. Areas, arcs and the bearing number keep the radii of the case: growth is below a thousandth of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from pydantic import Field, ValidationInfo, field_validator

from petalfoil.case.definition import LookedUp
from petalfoil.case.metals import MetalName, metal_of
from petalfoil.case.number_fields import UNSET, Quantity
from petalfoil.case.problems import Problem
from petalfoil.case.sections import Bearing
from petalfoil.units import format_quantity

REFERENCE_TEMPERATURE = 293.15
"""Temperature at which the dimensions of drawings hold: 20 °C (ISO 1:2022) [K]."""

REFUSED = 1e-3
"""Stands for a number of a material that is refused; nobody sees it."""

_Expansion = Annotated[
    float,
    Quantity(unit="1/K", meaning="thermal expansion coefficient", symbol="alpha", at_least=-1e-5, at_most=1e-3),
]
_Temperature = Annotated[float, Quantity(unit="K", meaning="mean temperature", symbol="T", above=0.0, at_most=3000.0)]


class MetalPart(LookedUp):
    """A part whose metal is given by its name or by numbers; what a name gives is written to no file."""

    by_material: ClassVar[frozenset[str]] = frozenset()
    """Fields that a material gives."""

    # before the numbers that a material gives
    material: MetalName = None
    """Metal whose constants are looked up, such as `inconel 718`."""
    temperature: _Temperature = REFERENCE_TEMPERATURE
    """Mean over the section; with a heat network it follows, and is left out."""

    def is_written(self, field: str) -> bool:
        """Not what the material gives."""
        return self.material is None or field not in self.by_material

    @classmethod
    def resolved(cls, given: object, info: ValidationInfo) -> object:
        """What was given of a field, or what follows from the material."""
        field, known = str(info.field_name), info.data
        if "material" not in known:  # it is refused itself
            return REFUSED
        material = known["material"]
        if material is None and given is UNSET:
            raise cls.missing(field, "material", "inconel 718")
        if material is None:
            return given
        if given is not UNSET:
            raise cls.given_twice(given, "material", material)
        metal = metal_of(material)
        if field == "youngs_modulus":
            return metal.youngs_modulus(known.get("temperature", REFERENCE_TEMPERATURE))
        return getattr(metal, field)


class Shaft(MetalPart):
    """The shaft, which grows by its speed and its temperature; without this table its radius is that of the case."""

    section: ClassVar[str] = "shaft"
    by_material: ClassVar[frozenset[str]] = frozenset({"youngs_modulus", "poisson_ratio", "density", "expansion"})

    youngs_modulus: Annotated[
        float, Quantity(unit="Pa", meaning="Young's modulus of the shaft", symbol="E_s", above=0.0, at_most=1e13)
    ] = Field(default=UNSET, validate_default=True)
    """Required unless the shaft has a material; so are the next three."""
    poisson_ratio: Annotated[
        float, Quantity(unit="1", meaning="Poisson's ratio of the shaft", symbol="nu_s", above=-1.0, below=0.5)
    ] = Field(default=UNSET, validate_default=True)
    density: Annotated[
        float, Quantity(unit="kg/m^3", meaning="density of the shaft", symbol="rho_s", above=0.0, at_most=1e5)
    ] = Field(default=UNSET, validate_default=True)
    expansion: _Expansion = Field(default=UNSET, validate_default=True)
    bore_radius: Annotated[
        float, Quantity(unit="m", meaning="radius of the shaft's bore", symbol="a", at_least=0.0, at_most=10.0)
    ] = 0.0

    @field_validator(*by_material, mode="before")
    @classmethod
    def _resolved(cls, given: object, info: ValidationInfo) -> object:
        return cls.resolved(given, info)


class Bushing(MetalPart):
    """The bushing, which grows by its temperature; without this table its radius is that of the case."""

    section: ClassVar[str] = "bushing"
    by_material: ClassVar[frozenset[str]] = frozenset({"expansion"})

    expansion: _Expansion = Field(default=UNSET, validate_default=True)
    """Required unless the bushing has a material."""

    @field_validator(*by_material, mode="before")
    @classmethod
    def _resolved(cls, given: object, info: ValidationInfo) -> object:
        return cls.resolved(given, info)


def centrifugal_growth(shaft: Shaft, radius: float, speed: float) -> float:
    """Growth of the journal by its speed [rad/s], first term of (G5) [m]."""
    a, b, nu = shaft.bore_radius, radius, shaft.poisson_ratio
    return shaft.density * speed**2 * b * ((1.0 - nu) * b**2 + (3.0 + nu) * a**2) / (4.0 * shaft.youngs_modulus)


def thermal_growth(part: Shaft | Bushing, radius: float, temperature: float) -> float:
    """Growth of a radius by the area mean of the temperature [K], second term of (G5) [m]."""
    return part.expansion * radius * (temperature - REFERENCE_TEMPERATURE)


@dataclass(frozen=True)
class Growth:
    """How radii have grown.

    Attributes
    ----------
    thermal : float
        Growth of the journal by its temperature [m].
    centrifugal : float
        Growth of the journal by its speed, over the square of the speed [m s^2].
    bushing : float
        Growth of the bushing [m].
    """

    thermal: float = 0.0
    centrifugal: float = 0.0
    bushing: float = 0.0

    @classmethod
    def of(cls, shaft: Shaft | None, bushing: Bushing | None, radii: tuple[float, float]) -> Growth:
        """That of a shaft and a bushing with the `radii` of journal and bushing [m]; of none, nothing."""
        journal_radius, bushing_radius = radii
        return cls(
            thermal=0.0 if shaft is None else thermal_growth(shaft, journal_radius, shaft.temperature),
            centrifugal=0.0 if shaft is None else centrifugal_growth(shaft, journal_radius, 1.0),
            bushing=0.0 if bushing is None else thermal_growth(bushing, bushing_radius, bushing.temperature),
        )

    @staticmethod
    def by_kelvin(shaft: Shaft | None, bushing: Bushing | None, radii: tuple[float, float]) -> tuple[float, float]:
        """Growth of journal and bushing by a kelvin [m/K]; zero without their tables."""
        parts = zip((shaft, bushing), radii, strict=True)
        journal, bore = (0.0 if part is None else part.expansion * radius for part, radius in parts)
        return journal, bore

    def journal(self, speed: float) -> float:
        """Growth of the journal at an angular velocity [rad/s], (G5) [m]."""
        return self.thermal + self.centrifugal * speed**2

    def closing(self, speed: float) -> float:
        """What growth takes from the radial clearance at an angular velocity [rad/s] [m]."""
        return self.journal(speed) - self.bushing


def growth_problems(bearing: Bearing, shaft: Shaft | None) -> Iterator[Problem]:
    """Yield what makes a shaft no ring: a bore as large as its journal."""
    if shaft is None or shaft.bore_radius < bearing.journal_radius:
        return
    bore, journal = (format_quantity(radius, "m", digits=6) for radius in (shaft.bore_radius, bearing.journal_radius))
    yield Problem(
        "shaft.bore_radius",
        f"{bore} leaves nothing of the shaft; allowed: less than bearing.journal_radius, {journal}",
        shaft.bore_radius,
        f"less than {bearing.journal_radius:g} m",
    )
