"""What the heat network of a solution tells: temperatures, where the heat goes, and whether it balances."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.case import Case, Gas
from petalfoil.equilibrium.heated import heated
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import UsageError
from petalfoil.physics.heat import FILM, OTHER, OWN
from petalfoil.results.record import Record
from petalfoil.system.heat_network import HeatNetwork
from petalfoil.system.heat_rows import HeatRows
from petalfoil.system.temperatures import Temperatures


@dataclass(frozen=True, kw_only=True)
class HeatResults:
    """Temperatures [K], heat flows [W], and what is missing of their balance over the friction power [1]."""

    film_temperature: float
    shaft_temperature: float
    pack_temperature: float
    bushing_temperature: float
    heat_to_shaft: float
    heat_to_pack: float
    heat_to_gas: float
    heat_balance_error: float


def with_heat(case: Case, found: Solution, *, gradually: bool = True) -> Solution:
    """The equilibrium with its heat network, where the case has one; see `heated`.

    Raises
    ------
    ThermalRunawayError
        There is no steady temperature.
    """
    network = HeatNetwork.of(case)
    return found if network is None else heated(found, network, gradually=gradually)


def at_temperatures(case: Case, warm: Temperatures) -> Case:
    """The isothermal case whose gas, shaft and bushing have given temperatures, as in a motion of some milliseconds."""
    if case.heat is None:
        return case
    gas, hot = case.gas, case.heat.of_gas(case.gas)
    sections: dict[str, object] = {
        "heat": None,
        "gas": Gas(
            viscosity=gas.viscosity * hot.ratio(warm.film),
            ambient_pressure=gas.ambient_pressure,
            temperature=warm.film,
            gas_constant=gas.gas_constant,
        ),
    }
    for name, part, temperature in (("shaft", case.shaft, warm.shaft), ("bushing", case.bushing, warm.bushing)):
        if part is not None:  # the modulus is that of the case, as in the network
            sections[name] = part.model_copy(update={"temperature": temperature})
    return case.replace(**sections)


def warm_up_step(case: Case, found: Solution, before: Temperatures, step: float) -> Solution:
    """The equilibrium a time `step` [s] after the temperatures `before`.

    Raises
    ------
    UsageError
        The case has no heat network, or one without heat capacities.
    ThermalRunawayError
        The temperatures run away within the step.
    """
    return heated(found, network_in_time(case).after(before, step))


def network_in_time(case: Case) -> HeatNetwork:
    """The network of a case whose temperatures take time.

    Raises
    ------
    UsageError
        The case has no heat network, or one without heat capacities.
    """
    network = HeatNetwork.of(case)
    if network is None:
        raise UsageError("a warm-up needs the heat network of the bearing: give the table [heat]")
    if network.heat.shaft_capacity <= 0.0:
        raise UsageError("a warm-up takes time by heat capacities: give heat.shaft_capacity above 0 J/K")
    return network


def heat_results(case: Case, answer: Solution) -> HeatResults | None:
    """Temperatures and heat flows of a solution; None where its case has no heat network.

    In a warm-up what is stored belongs to what flows; the balance is then that of the film alone.
    """
    network, warm = HeatNetwork.of(case), answer.problem.temperatures
    if network is None or warm is None:
        return None
    heat = HeatRows(network, answer.problem, answer.x, answer.lam).film_heat
    rubbing = 0.5 * heat.rubbing
    shaft = heat.conductance * (FILM * warm.film - OWN * warm.shaft - OTHER * warm.pack) + rubbing
    pack = heat.conductance * (FILM * warm.film - OWN * warm.pack - OTHER * warm.shaft) + rubbing
    gas = heat.carried * (warm.film - network.gas.temperature)
    power = heat.viscous + heat.rubbing
    return HeatResults(
        film_temperature=warm.film,
        shaft_temperature=warm.shaft,
        pack_temperature=warm.pack,
        bushing_temperature=warm.bushing,
        heat_to_shaft=shaft,
        heat_to_pack=pack,
        heat_to_gas=gas,
        heat_balance_error=abs(power - shaft - pack - gas) / power if power > 0.0 else 0.0,
    )


def stored_temperatures(record: Record) -> Temperatures | None:
    """Temperatures of a stored point; None where it has none."""
    names = ("film_temperature", "shaft_temperature", "pack_temperature", "bushing_temperature")
    found = [float(record.scalars.get(name, math.nan)) for name in names]
    return Temperatures(*found) if all(map(math.isfinite, found)) else None
