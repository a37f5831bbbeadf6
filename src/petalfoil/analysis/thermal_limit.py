"""The speed up to which a bearing has a steady temperature, where it has none at the speed that is asked for."""

from __future__ import annotations

import math
from collections.abc import Callable

from petalfoil.analysis.heat_results import with_heat
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.heated import ThermalRunawayError
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem

Vector = tuple[float, float]
Steady = Callable[[float], bool]

HALVINGS = 8
"""Halvings of the speed after which there is no steady temperature at any."""

PRECISION = 2e-3
"""Relative precision of the speed."""

RPM = 30.0 / math.pi


def beyond_thermal_limit(case: Case, load: Vector | None, failure: ThermalRunawayError) -> ThermalRunawayError:
    """The error of a bearing without a steady temperature, with the speed at which the runaway begins.

    Parameters
    ----------
    case : Case
        The bearing, at its speed.
    load : (x, y) or None
        The load [N]; None where the journal is held at the case's eccentricity.
    failure : ThermalRunawayError
        What was found at its speed.
    """
    speed = case.operation.speed
    limit = highest(speed, in_place(case) if load is None else under(case, load))
    where = "at this eccentricity" if load is None else f"under {math.hypot(*load):g} N"
    least = f"at any speed down to {speed * RPM / 2**HALVINGS:.0f} rpm"
    begins = f"{f'above {limit * RPM:.0f} rpm' if limit > 0.0 else least} {where}"
    return ThermalRunawayError(
        f"no steady temperature {begins}; at {speed * RPM:.0f} rpm {str(failure).partition(': ')[2]}",
        history=failure.history,
        advice=failure.advice,
    )


def highest(speed: float, steady: Steady) -> float:
    """Highest speed below `speed` [rad/s] at which a temperature is steady; zero where there is none."""
    low = high = speed
    for _ in range(HALVINGS):
        high, low = low, 0.5 * low
        if steady(low):
            break
    else:
        return 0.0
    while high > (1.0 + PRECISION) * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if steady(middle) else (low, middle)
    return low


def under(case: Case, load: Vector) -> Steady:
    """Whether the balance under a load [N] has a steady temperature at a speed, followed from the last that had."""
    line = SpeedLine(case, load)

    def steady(speed: float) -> bool:
        known, warm = line.known, line.temperatures
        line.gradually = known is None
        try:
            line.at(speed)
        except ConvergenceError as failure:
            current_run().note("thermal limit", outcome=str(failure))
            line.known, line.temperatures = known, warm
            return False
        return True

    return steady


def in_place(case: Case) -> Steady:
    """The same with the journal held."""
    base = build_problem(case)

    def steady(speed: float) -> bool:
        number = base.bearing_number * speed / case.operation.speed
        try:
            with_heat(case, solve_cold(base.at(bearing_number=number)))
        except ConvergenceError as failure:
            current_run().note("thermal limit", outcome=str(failure))
            return False
        return True

    return steady
