"""Heat of the bearing as a network of a few temperatures: the conductances between them and to the surroundings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

from petalfoil.case import gas_properties
from petalfoil.case.definition import Definition
from petalfoil.case.gas import Gas
from petalfoil.case.number_fields import Quantity
from petalfoil.case.problems import Problem

MOST = 1e4
"""Largest conductance [W/K]: parts joined by it differ by hundredths of a kelvin."""

DIATOMIC = 3.5
"""Heat capacity at constant pressure over the gas constant of air and other gases of two atoms."""

PRANDTL, EXPONENT = 0.7, 0.7
"""Prandtl number and exponent of the viscosity over the temperature, of air, for a gas given by numbers."""

WARMER = 1.01
"""Factor on the temperature over which the exponent of a named gas is taken."""


def _conductance(meaning: str, symbol: str) -> Quantity:
    return Quantity(unit="W/K", meaning=meaning, symbol=symbol, at_least=0.0, at_most=MOST)


def _temperature(meaning: str) -> Quantity:
    return Quantity(unit="K", meaning=meaning, symbol="T", above=0.0, at_most=3000.0)


def _capacity(meaning: str, symbol: str) -> Quantity:
    return Quantity(unit="J/K", meaning=meaning, symbol=symbol, at_least=0.0, at_most=1e9)


class Heat(Definition):
    """Where the friction power of one bearing goes; without this table gas, shaft and bushing keep their temperatures.

    Film, shaft, petal pack (of a plain bearing the surface of the bore) and bushing have a temperature each. Heat
    passes from film to shaft and pack by conduction in the gas, which follows from the film; the other paths are given.
    """

    section: ClassVar[str] = "heat"

    pack_to_bushing: Annotated[float, _conductance("conductance from pack to bushing", "G_pb")]
    bushing_to_ambient: Annotated[float, _conductance("conductance from bushing to surroundings", "G_ba")] = 0.0
    shaft_to_ambient: Annotated[float, _conductance("conductance from shaft to surroundings", "G_sa")] = 0.0
    along_shaft: Annotated[float, _conductance("conductance along the shaft to its end", "G_se")] = 0.0
    pack_to_cooling: Annotated[float, _conductance("conductance from pack to cooling flow", "G_pc")] = 0.0
    cooling_flow: Annotated[
        float,
        Quantity(unit="kg/s", meaning="cooling flow of the gas past the pack", symbol="m_c", at_least=0.0, at_most=1e3),
    ] = 0.0
    ambient_temperature: Annotated[float, _temperature("temperature of the surroundings")] | None = None
    """By default that of the gas, with which it enters the film."""
    shaft_end_temperature: Annotated[float, _temperature("temperature of the shaft's end")] | None = None
    """By default that of the surroundings."""
    cooling_temperature: Annotated[float, _temperature("temperature of the cooling flow as it comes")] | None = None
    """By default that of the surroundings."""
    shaft_start_temperature: Annotated[float, _temperature("temperature of the shaft when a warm-up begins")] | None = (
        None
    )
    """By default that of the surroundings: a start from cold."""
    shaft_capacity: Annotated[float, _capacity("heat capacity of the shaft's part", "C_s")] = 0.0
    """For a warm-up in time; so are the next two."""
    pack_capacity: Annotated[float, _capacity("heat capacity of the pack", "C_p")] = 0.0
    bushing_capacity: Annotated[float, _capacity("heat capacity of the bushing", "C_b")] = 0.0
    gas_heat_capacity: (
        Annotated[
            float,
            Quantity(unit="J/(kg*K)", meaning="heat capacity of the gas", symbol="c_p", above=0.0, at_most=1e5),
        ]
        | None
    ) = None
    """At constant pressure; by default that of the named gas, or 3.5 times the gas constant."""
    prandtl_number: (
        Annotated[float, Quantity(unit="1", meaning="Prandtl number", symbol="Pr", above=0.0, at_most=100.0)] | None
    ) = None
    """By default that of the named gas, or 0.7."""
    viscosity_exponent: (
        Annotated[
            float,
            Quantity(unit="1", meaning="exponent of viscosity over temperature", symbol="n", at_least=0.0, at_most=2.0),
        ]
        | None
    ) = None
    """By default that of the named gas at its temperature, or 0.7."""

    def of_gas(self, gas: Gas) -> HotGas:
        """The gas as it warms up."""
        given = (self.gas_heat_capacity, self.prandtl_number, self.viscosity_exponent)
        known = (DIATOMIC * gas.gas_constant, PRANDTL, EXPONENT)
        if gas.name is not None:
            known = _named(gas.name, gas.temperature, gas.ambient_pressure)
        c_p, prandtl, exponent = (own if own is not None else other for own, other in zip(given, known, strict=True))
        return HotGas(gas.viscosity, gas.temperature, c_p, prandtl, exponent)


@dataclass(frozen=True)
class HotGas:
    """A gas whose viscosity follows a power of its temperature, its Prandtl number being constant (H1).

    Attributes
    ----------
    viscosity : float
        At `temperature` [Pa s].
    temperature : float
        Temperature with which it enters the film [K].
    heat_capacity : float
        At constant pressure [J/(kg K)].
    prandtl_number, exponent : float
        Prandtl number, and exponent of the viscosity [1].
    """

    viscosity: float
    temperature: float
    heat_capacity: float
    prandtl_number: float
    exponent: float

    def ratio(self, temperature: float) -> float:
        """Viscosity at a temperature [K] over that with which the gas enters [1]; that of the conductivity too."""
        return float((temperature / self.temperature) ** self.exponent)

    @property
    def conductivity(self) -> float:
        """Heat conductivity with which the gas enters, ``mu c_p / Pr`` [W/(m K)]."""
        return self.viscosity * self.heat_capacity / self.prandtl_number


def _named(name: str, T: float, p: float) -> tuple[float, float, float]:
    """Heat capacity, Prandtl number and exponent of the viscosity of a named gas."""
    c_p, prandtl = gas_properties.heat_properties(name, T, p)
    return c_p, prandtl, gas_properties.viscosity_exponent(name, T, p, WARMER)


def heat_problems(heat: Heat, given: dict[str, bool]) -> Iterator[Problem]:
    """Yield why a network cannot be solved: no way out for the heat, what follows from it, what it is not part of.

    Parameters
    ----------
    heat : Heat
        The network.
    given : dict
        What else the case says, by key: `shaft.temperature`, `bushing.temperature`, `model.slip`, `classic`.
    """
    out = heat.pack_to_bushing * heat.bushing_to_ambient + heat.shaft_to_ambient + heat.along_shaft
    if out + heat.pack_to_cooling * heat.cooling_flow <= 0.0:
        text = (
            "carries no heat to the surroundings; allowed: bushing_to_ambient with pack_to_bushing, shaft_to_ambient, "
            "along_shaft, or pack_to_cooling with cooling_flow, above zero"
        )
        yield Problem("heat", text, None, "a conductance to the surroundings")
    for key in ("shaft.temperature", "bushing.temperature"):
        if given[key]:
            yield Problem(key, "is given beside [heat], from which it follows; allowed: one of them", None, "no [heat]")
    if given["model.slip"]:
        text = "is for a gas of one temperature; allowed with [heat]: slip = false"
        yield Problem("model.slip", text, True, "false")
    if given["classic"]:
        yield Problem("heat", 'is not in the paper; allowed: model.method = "newton"', None, '"newton"')
