"""A gas by its name: viscosity and gas constant from CoolProp, refused where they do not hold.

CoolProp is loaded when a name is used, which takes most of a second.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import Any

from petalfoil.case.hints import nearest
from petalfoil.case.number_fields import VALUE_PROBLEM, refuse
from petalfoil.units.reading import shown
from petalfoil.units.writing import format_percent, format_quantity

COMMON = {
    "air": "Air",
    "helium": "Helium",
    "nitrogen": "Nitrogen",
    "argon": "Argon",
    "co2": "CarbonDioxide",
    "steam": "Water",
}
"""Names a user may expect, and what CoolProp calls them; all its other names are known too."""

IDEAL = 0.02
"""Largest `|Z - 1|` of a gas that is taken for ideal: what it costs in the film is of the same size."""

FAILURES = (ValueError, RuntimeError)
"""What CoolProp raises, by version, when it finds no answer."""

LADDER = 8
"""Pressures, each half of the one before, at which a gas is looked at: a hundredth of it is as good as none."""

BISECTIONS = 40
"""Halvings of a range that is told to a user: far below its four digits."""

KNOWN = f"{', '.join(COMMON)} and the fluids of CoolProp, such as R134a"

NUMBERS = "numbers (gas.viscosity, gas.gas_constant) in place of the name"


def fluid_of(name: str) -> str:
    """CoolProp's name of a gas whose viscosity it knows."""
    fluid = COMMON.get(name.lower()) or _fluids().get(name.lower()) or _by_alias(name)
    if not fluid:
        hint = nearest(name, [*COMMON, *_fluids()])
        raise refuse(VALUE_PROBLEM, f"{shown(name)} is not a known gas; known: {KNOWN}.{hint}", KNOWN)
    if not _has_viscosity(fluid):
        raise refuse(VALUE_PROBLEM, f"CoolProp knows {fluid} but not its viscosity; allowed: {NUMBERS}", NUMBERS)
    return fluid


def check_temperature(name: str, T: float) -> None:
    """Refuse a temperature [K] outside the equation of state."""
    low, high = _limits(_state(fluid_of(name)))
    if not low <= T <= high:
        allowed = f"{_K(low)} to {_K(high)}"
        raise refuse(VALUE_PROBLEM, f"{_K(T)} is outside the range of {name}; allowed: {allowed}", allowed)


def within_temperatures(name: str, T: float) -> bool:
    """Whether a temperature [K] is inside the equation of state."""
    low, high = _limits(_state(fluid_of(name)))
    return low <= T <= high


def unlike_ideal(name: str, T: float, p: float) -> str:
    """Why a gas is no ideal one to 2 % at a temperature [K] that is known and a pressure [Pa]; empty where it is."""
    state = _state(fluid_of(name))
    dew = _dew_pressure(state, T)
    if p >= dew:
        ends = "condenses at" if T < state.T_critical() else "is known up to"
        return f"{name} at {_K(T)} {ends} {_Pa(dew)}, below {_Pa(p)}"
    if _departure(state, T, p) > IDEAL:
        return f"{name} at {_K(T)} and {_Pa(p)} is {format_percent(_departure(state, T, p))} off the ideal-gas law"
    return ""


def check_pressure(name: str, T: float, p: float) -> None:
    """Refuse a pressure [Pa] at which the gas would condense, or would not be ideal to 2 %."""
    if not (found := unlike_ideal(name, T, p)):
        return
    allowed = _allowed(_state(fluid_of(name)), T, p)
    ideal = "; a numeric gas.viscosity and gas.gas_constant in place of the name run as an ideal gas"
    raise refuse(VALUE_PROBLEM, f"{found}; allowed: {allowed}{ideal}", allowed)


def viscosity(name: str, T: float, p: float) -> float:
    """Dynamic viscosity at a state that the checks let through [Pa s]."""
    state = _state(fluid_of(name))
    try:
        state.update(_library().PT_INPUTS, p, T)
        return float(state.viscosity())
    except FAILURES:  # its correlation has holes: the state of a reference fluid is not found
        text = f"CoolProp finds none for {name} at {_K(T)} and {_Pa(p)}; allowed: {NUMBERS}"
        raise refuse(VALUE_PROBLEM, text, NUMBERS) from None


def gas_constant(name: str) -> float:
    """Specific gas constant [J/(kg K)]."""
    state = _state(fluid_of(name))
    return float(state.gas_constant() / state.molar_mass())


def heat_properties(name: str, T: float, p: float) -> tuple[float, float]:
    """Heat capacity at constant pressure [J/(kg K)] and Prandtl number [1] at a state that the checks let through."""
    state = _state(fluid_of(name))
    try:
        state.update(_library().PT_INPUTS, p, T)
        return float(state.cpmass()), float(state.cpmass() * state.viscosity() / state.conductivity())
    except FAILURES:
        allowed = "numbers (heat.gas_heat_capacity, heat.prandtl_number, heat.viscosity_exponent)"
        text = f"CoolProp finds no heat conductivity of {name} at {_K(T)} and {_Pa(p)}; allowed: {allowed}"
        raise refuse(VALUE_PROBLEM, text, allowed) from None


def viscosity_exponent(name: str, T: float, p: float, factor: float) -> float:
    """Exponent of the power law that the viscosity follows from a temperature [K] to `factor` times it [1]."""
    return math.log(viscosity(name, factor * T, p) / viscosity(name, T, p)) / math.log(factor)


# ---------------------------------------------------------------------------------------------- the library


@cache
def _library() -> ModuleType:
    return import_module("CoolProp.CoolProp")


@cache
def _fluids() -> dict[str, str]:
    """CoolProp's names by themselves in lower case."""
    return {fluid.lower(): fluid for fluid in _library().FluidsList()}


def _by_alias(name: str) -> str:
    """The fluid that CoolProp calls `name` too, such as N2 or R744; nothing if none."""
    try:
        fluid = str(_library().get_fluid_param_string(name, "name"))
    except FAILURES:
        return ""
    aliases = _library().get_fluid_param_string(fluid, "aliases").split(",")
    return fluid if name in aliases else ""  # CoolProp also takes mixtures and names of models in front


@cache
def _has_viscosity(fluid: str) -> bool:
    """Whether there is a model at all: asked at a thin, hot state."""
    state = _state(fluid)
    state.update(_library().DmolarT_INPUTS, 1e-3, 0.9 * state.Tmax())
    try:
        state.viscosity()
    except FAILURES:
        return False
    return True


def _state(fluid: str) -> Any:
    """A state of `fluid` as a gas; where it would be none the checks do not ask."""
    state = _library().AbstractState("HEOS", fluid)
    state.specify_phase(_library().iphase_gas)
    return state


# ---------------------------------------------------------------------------------------------- where it holds


def _limits(state: Any) -> tuple[float, float]:
    """Temperatures of the equation of state, above the triple point [K]."""
    return max(state.Tmin(), state.Ttriple()), state.Tmax()


def _dew_pressure(state: Any, T: float) -> float:
    """Pressure at which the gas condenses, at the most that of the equation of state [Pa]."""
    if T >= state.T_critical():
        return float(state.pmax())
    return float(_saturated(state, _library().QT_INPUTS, 1.0, T).p())


def _dew_temperature(state: Any, p: float) -> float:
    """Temperature at which the gas condenses, at the least that of the equation of state [K]."""
    low, _ = _limits(state)
    if p >= state.p_critical() or p <= _dew_pressure(state, low):
        return low
    return float(_saturated(state, _library().PQ_INPUTS, p, 1.0).T())


def _saturated(state: Any, inputs: int, first: float, second: float) -> Any:
    """The fluid's dew point; `state` itself stays a gas."""
    dew = _library().AbstractState("HEOS", state.name())
    dew.update(inputs, first, second)
    return dew


def _departure(state: Any, T: float, p: float) -> float:
    """Largest `|Z - 1|` up to `p`, what the ideal-gas law is off by [1].

    Not that at `p` alone: on its way from a gas to a liquid, `Z` comes through 1 again.
    """
    factors = []
    for halvings in range(LADDER):
        state.update(_library().PT_INPUTS, 0.5**halvings * p, T)
        factors.append(float(state.compressibility_factor()))
    return max(abs(Z - 1.0) for Z in factors)


def _allowed(state: Any, T: float, p: float) -> str:
    """Words for the pressures at this temperature and the temperatures at this pressure that are let through."""
    _, hottest = _limits(state)
    highest = _edge(lambda pressure: _departure(state, T, pressure), 0.0, min(p, _dew_pressure(state, T)))
    texts = [f"less than {_Pa(highest)} at this temperature"]
    if _departure(state, hottest, p) < IDEAL:
        lowest = _edge(lambda warm: _departure(state, warm, p), hottest, max(T, _dew_temperature(state, p)))
        texts.append(f"more than {_K(lowest)} at this pressure")
    return ", or ".join(texts)


def _edge(departure: Callable[[float], float], good: float, bad: float) -> float:
    """Last value on the way from `good` to `bad` whose departure is allowed."""
    nearly = bad + 1e-6 * (good - bad)  # `bad` may lie on the dew line itself
    if departure(nearly) <= IDEAL:
        return bad
    for _ in range(BISECTIONS):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if departure(middle) <= IDEAL else (good, middle)
    return good


def _K(temperature: float) -> str:
    return format_quantity(temperature, "K", digits=5)


def _Pa(pressure: float) -> str:
    return format_quantity(pressure, "Pa")
