"""The gas: one by its name and state, or numbers."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import Field, ValidationInfo, field_validator

from petalfoil.case import gas_properties
from petalfoil.case.definition import LookedUp
from petalfoil.case.number_fields import UNSET, Quantity

REFUSED = 1.0
"""Stands for a number of a gas that is refused for another of its fields; nobody sees it."""

AIR = 287.05
"""Gas constant [J/(kg K)] of a gas given by numbers that does not say it."""


class Gas(LookedUp):
    """Isothermal ideal gas.

    A gas by its `name` takes viscosity and gas constant from CoolProp at its state; both are written to no file then.
    Of a gas given by numbers, temperature and gas constant only matter to slip and to the mass units of side leakage.
    """

    section: ClassVar[str] = "gas"
    by_name: ClassVar[frozenset[str]] = frozenset({"viscosity", "gas_constant"})
    """Fields that a name gives."""

    # in the order of validation: what a name gives needs the state
    name: str | None = None
    """Gas whose viscosity and gas constant CoolProp gives, such as `air`, `helium` or `R134a`."""
    temperature: Annotated[
        float, Quantity(unit="K", meaning="gas temperature", symbol="T", above=0.0, at_most=5000.0)
    ] = Field(default=293.15, validate_default=True)
    ambient_pressure: Annotated[
        float, Quantity(unit="Pa", meaning="absolute ambient pressure", symbol="p_a", above=0.0, at_most=1e9)
    ]
    viscosity: Annotated[
        float, Quantity(unit="Pa*s", meaning="dynamic viscosity", symbol="mu", above=0.0, at_most=10.0)
    ] = Field(default=UNSET, validate_default=True)
    """Required unless the gas has a name."""
    gas_constant: Annotated[
        float, Quantity(unit="J/(kg*K)", meaning="specific gas constant", symbol="R_g", above=0.0, at_most=1e5)
    ] = Field(default=UNSET, validate_default=True)
    """That of air, 287.05 J/(kg K), unless the gas has a name."""

    @property
    def ambient_density(self) -> float:
        """Density at ambient pressure, ``p_a / (R_g T)`` [kg/m³]."""
        return self.ambient_pressure / (self.gas_constant * self.temperature)

    @property
    def mean_free_path(self) -> float:
        """Mean free path of the molecules at ambient pressure, ``(mu / p_a) sqrt(pi R_g T / 2)`` (F8) [m]."""
        mu, p_a = self.viscosity, self.ambient_pressure
        return mu / p_a * math.sqrt(0.5 * math.pi * self.gas_constant * self.temperature)

    def is_written(self, field: str) -> bool:
        """Not what the name of the gas gives."""
        return self.name is None or field not in self.by_name

    @field_validator("name")
    @classmethod
    def _is_known(cls, name: str | None) -> str | None:
        if name is not None:
            gas_properties.fluid_of(name)
        return name

    @field_validator("temperature")
    @classmethod
    def _has_properties(cls, temperature: float, info: ValidationInfo) -> float:
        name = info.data.get("name")
        if name is not None:
            gas_properties.check_temperature(name, temperature)
        return temperature

    @field_validator("ambient_pressure")
    @classmethod
    def _is_ideal(cls, pressure: float, info: ValidationInfo) -> float:
        name = info.data.get("name")
        if name is not None and "temperature" in info.data:
            gas_properties.check_pressure(name, info.data["temperature"], pressure)
        return pressure

    @field_validator(*by_name, mode="before")
    @classmethod
    def _resolved(cls, given: object, info: ValidationInfo) -> object:
        """What was given, or what follows from the name."""
        field, known = str(info.field_name), info.data
        name = known.get("name")
        if name is None:
            return given if given is not UNSET else cls._without_name(field, refused="name" not in known)
        if given is not UNSET:
            raise cls.given_twice(given, "name", name)
        if not {"temperature", "ambient_pressure"} <= known.keys():
            return REFUSED
        if field == "gas_constant":
            return gas_properties.gas_constant(name)
        return gas_properties.viscosity(name, known["temperature"], known["ambient_pressure"])

    @classmethod
    def _without_name(cls, field: str, *, refused: bool) -> float:
        if refused:
            return REFUSED
        if field == "gas_constant":
            return AIR
        raise cls.missing(field, "name", "air")
