"""Metals that foils are made of, by name: elastic constants, density, expansion, yield strength, and their sources.

Young's modulus is linear between the temperatures of its source; the other values are those at about 20 °C. They are
typical: a strip's own certificate is better. A yield strength stands only where the source states one for a temper.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np
from pydantic import AfterValidator

from petalfoil.case.hints import nearest
from petalfoil.case.number_fields import VALUE_PROBLEM, refuse

CELSIUS = 273.15
"""0 °C [K]."""

NEAR = 30.0
"""Temperatures about room temperature within which a modulus that is stated there holds [K]: it falls by 1 % or so."""


@dataclass(frozen=True)
class Metal:
    """A metal.

    Attributes
    ----------
    name : str
        Name in a case.
    modulus : tuple of (float, float)
        Temperature [°C] and Young's modulus [Pa], the temperatures growing.
    poisson_ratio : float
        Poisson's ratio [1].
    density : float
        Density [kg/m^3].
    expansion : float
        Mean thermal expansion coefficient from 20 °C on [1/K].
    yield_strength : float or None
        Yield strength of the temper [Pa]; None where it depends on a temper that the source does not name.
    temper : str
        Condition of the strip.
    sources : dict
        Where each value is from, and at which temperatures it holds, by its name here.
    """

    name: str
    modulus: tuple[tuple[float, float], ...]
    poisson_ratio: float
    density: float
    expansion: float
    yield_strength: float | None
    temper: str
    sources: dict[str, str]

    @property
    def range(self) -> tuple[float, float]:
        """Temperatures between which the modulus is known [K]."""
        first, last = self.modulus[0][0], self.modulus[-1][0]
        below, beyond = NEAR if first > 0.0 else 0.0, NEAR if len(self.modulus) == 1 else 0.0
        return first - below + CELSIUS, last + beyond + CELSIUS

    @property
    def known_at(self) -> str:
        """The temperatures of the source, for people."""
        first, last = self.modulus[0][0], self.modulus[-1][0]
        return f"{first:.0f} °C only" if first == last else f"{first:.0f} to {last:.0f} °C"

    def youngs_modulus(self, temperature: float) -> float:
        """Young's modulus at a temperature [K], outside its range that of the nearest end [Pa]."""
        at, values = np.array(self.modulus).T
        return float(np.interp(temperature - CELSIUS, at, values))


FALL_OF_TITANIUM = 4.73e-4
"""Fall of the modulus of Ti-6Al-4V from 20 °C on, over it [1/K]: the straight line through 63 measurements from 23 to
835 °C is 119.90 GPa - 0.04981 GPa/K T, and none is farther from it than 2.1 GPa."""

FALL_OF_BERYLLIUM_COPPER = 3.5e-4
"""Fall of the modulus of beryllium copper, over it, from -50 to 50 °C [1/K]."""

METALS = {
    metal.name: metal
    for metal in (
        Metal(
            "spring steel",
            (
                *((-73.0, 206.8e9), (21.0, 202.0e9), (93.0, 197.2e9), (149.0, 193.7e9), (204.0, 189.6e9)),
                *((260.0, 186.8e9), (316.0, 182.7e9)),
            ),
            0.29, 7850.0, 12.1e-6, None, "hardened and tempered, any",
            {
                "modulus": "Young and Budynas, Roark's Formulas for Stress and Strain, table of the effect of "
                "temperature, carbon steel with C > 0.3 %, -73 to 316 °C",
                "poisson_ratio": "ASTM A231, room temperature",
                "density": "data sheet of AISI 1095 (Dandong Foundry), 7.85 g/cm³, room temperature",
                "expansion": "ASME BPVC II-D table TE-1, 70 to 200 °F",
            },
        ),
        Metal(
            "stainless steel 302", ((20.0, 193e9), (260.0, 177.9e9), (316.0, 174.4e9), (371.0, 171.0e9)),
            0.30, 7920.0, 17.3e-6, 517e6, "cold rolled, 75 ksi",
            {
                "modulus": "at 20 °C eCourses material tables (AISI 302 cold rolled), at 500, 600 and 700 °F ASME "
                "B31.3 table C-6, austenitic steels, 25.8, 25.3 and 24.8 Msi",
                "poisson_ratio": "eCourses material tables (AISI 302 cold rolled), room temperature",
                "density": "ASTM A313, room temperature",
                "expansion": "eCourses material tables (AISI 302 cold rolled), from room temperature on",
                "yield_strength": "eCourses material tables (AISI 302 cold rolled), room temperature",
            },
        ),
        Metal(
            "inconel x-750", ((21.0, 214e9), (538.0, 184e9)), 0.29, 8280.0, 14.0e-6, None, "spring temper, aged",
            {
                "modulus": "Special Metals SMC-067 and Tokkin data sheet, 31.0 and 26.7 Msi at 70 and 1000 °F",
                "poisson_ratio": "E over 2 G, less 1, with G 12.0 Msi of the same data sheets, 70 °F",
                "density": "Special Metals SMC-067 and Tokkin data sheet, room temperature",
                "expansion": "Special Metals SMC-067 and Tokkin data sheet, 70 to 1000 °F",
            },
        ),
        Metal(
            "inconel 718", ((21.0, 200.0e9), (149.0, 198.6e9), (204.0, 196.5e9), (260.0, 193.1e9)),
            0.29, 8220.0, 12.8e-6, None, "annealed and aged, any",
            {
                "modulus": "Special Metals SMC-045: dynamic modulus 29.0, 28.8, 28.5 and 28.0 Msi at 70, 300, 400 "
                "and 500 °F",
                "poisson_ratio": "Special Metals SMC-045, 70 °F",
                "density": "High Temp Metals data sheet of Inconel 718, room temperature",
                "expansion": "High Temp Metals data sheet of Inconel 718, 25 to 93 °C",
            },
        ),
        Metal(
            "beryllium copper c17200",
            tuple((at, 127e9 * (1.0 - FALL_OF_BERYLLIUM_COPPER * (at - 20.0))) for at in (-50.0, 20.0, 50.0)),
            0.30, 8260.0, 17.8e-6, 960e6, "age hardened TF00, least",
            {
                "modulus": "at 20 °C NGK alloy 25 data sheet; its temperature coefficient in tension, -0.00035 per K "
                "from -50 to 50 °C: Copper Development Association, Beryllium Copper, publication 54, 1962",
                "poisson_ratio": "NGK alloy 25 data sheet, room temperature",
                "density": "NGK alloy 25 data sheet, room temperature",
                "expansion": "NGK alloy 25 data sheet, 20 to 300 °C",
                "yield_strength": "NGK alloy 25 data sheet, room temperature",
            },
        ),
        Metal(
            "phosphor bronze c51000", ((20.0, 110e9), (100.0, 110e9 * 98.0 / 102.0), (200.0, 110e9 * 94.0 / 102.0)),
            0.33, 8860.0, 17.8e-6, 690e6, "spring temper H08, nominal",
            {
                "modulus": "at 20 °C Olin Brass C51000 (ASTM B103); its fall is that of CuSn6, cold formed, 102, 98 "
                "and 94 kN/mm² at 20, 100 and 200 °C: data sheet of 2.1020 after DIN 17662",
                "poisson_ratio": "eCourses material tables, bronze, room temperature",
                "density": "Olin Brass C51000 (ASTM B103), room temperature",
                "expansion": "Olin Brass C51000 (ASTM B103), 20 to 300 °C",
                "yield_strength": "Olin Brass C51000 (ASTM B103), room temperature",
            },
        ),
        Metal(
            "titanium ti-6al-4v",
            tuple((at, 114e9 * (1.0 - FALL_OF_TITANIUM * (at - 20.0))) for at in (20.0, 100.0, 200.0, 300.0, 400.0)),
            0.31, 4420.0, 8.6e-6, 828e6, "annealed, least",
            {
                "modulus": "at 20 °C data sheet of grade 5, typical; its fall is the straight line through the "
                "measurements "
                "of DOI 10.1007/BF00420541 from 23 to 835 °C, as digitised in the material library of BELFEM",
                "poisson_ratio": "Lumina data sheet, room temperature",
                "density": "data sheet of grade 5, typical, room temperature",
                "expansion": "data sheet of grade 5, from 20 °C on",
                "yield_strength": "data sheet of grade 5, least, room temperature",
            },
        ),
    )
}  # fmt: skip
"""Metals by name."""

SHORT = {
    "x-750": "inconel x-750",
    "x750": "inconel x-750",
    "inconel x750": "inconel x-750",
    "718": "inconel 718",
    "beryllium copper": "beryllium copper c17200",
    "c17200": "beryllium copper c17200",
    "phosphor bronze": "phosphor bronze c51000",
    "c51000": "phosphor bronze c51000",
    "titanium": "titanium ti-6al-4v",
    "ti-6al-4v": "titanium ti-6al-4v",
    "carbon steel": "spring steel",
    "stainless steel": "stainless steel 302",
}
"""Other names of them."""


def metal_of(name: str) -> Metal:
    """The metal of a name, in any spelling of letters.

    Raises
    ------
    PydanticCustomError
        It is not in the table.
    """
    plain = " ".join(name.lower().split())
    plain = SHORT.get(plain, plain)
    if plain not in METALS:
        allowed = ", ".join(METALS)
        hint = nearest(plain, [*METALS, *SHORT])
        raise refuse(VALUE_PROBLEM, f"{name!r} is not in the table of metals; known: {allowed}.{hint}", allowed)
    return METALS[plain]


def _name_in_table(name: str | None) -> str | None:
    return None if name is None else metal_of(name).name


MetalName: TypeAlias = Annotated[str | None, AfterValidator(_name_in_table)]
"""Field for the name of a metal, as the table writes it."""
