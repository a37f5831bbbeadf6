"""Derivatives of an equilibrium whose temperatures follow, beside equilibria that are solved again with their heat."""

from __future__ import annotations

import math

import pytest

from petalfoil.analysis.derivatives import equilibrium_results
from petalfoil.analysis.heated_derivatives import HeatedDerivatives, derivatives_of
from petalfoil.analysis.liftoff_derivatives import refined, speed_derivatives
from petalfoil.analysis.operating_point import at_position, under_load
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.case.parameters import with_values
from petalfoil.equilibrium.heated import warmed
from petalfoil.equilibrium.solution import Solution
from petalfoil.system.heat_network import HeatNetwork
from tests.verification.test_heat import plain, rig

RESULTS = ("min_film_thickness", "friction_torque", "peak_pressure", "shaft_temperature", "film_temperature")
HEATED = ("gas.viscosity", "gas.temperature", "heat.pack_to_bushing", "shaft.expansion", "operation.speed")
"""Parameters that act through viscosity, the gas, a conductance, growth, and all of them."""


def heated(of: Case) -> HeatedDerivatives:
    """Derivatives at the position of a case, or under its load."""
    load = of.operation.load
    solution = at_position(of).answer if load is None else under_load(of, load)[0]
    found = derivatives_of(of, solution, equilibrium_results)
    assert isinstance(found, HeatedDerivatives)
    return found


def solved_again(derivatives: HeatedDerivatives, path: str, change: float) -> dict[str, float]:
    """Results at another value of a parameter, by Newton's method with the temperatures from the first equilibrium."""
    there = with_values(derivatives.case, {path: derivatives.variation(path).value + change})
    network, first = HeatNetwork.of(there), derivatives.solution
    assert network is not None
    _, equations = derivatives.frozen.variation(path).at_value(change)
    problem = equations.problem
    if equations.load is not None:
        problem = problem.at(displacement=first.problem.displacement)
    begin = Solution(problem, first.state, first.residual, "", first.contacts, equations.load)
    found = warmed(begin, network)
    assert found is not None
    return dict(equilibrium_results(there, found))


def assert_exact(derivatives: HeatedDerivatives, path: str, part: float = 1e-4, tolerance: float = 3e-6) -> None:
    """Beside a difference quotient of fourth order over `part` of the parameter."""
    found, step = derivatives.by(path), part * derivatives.variation(path).size
    sides = {k: solved_again(derivatives, path, k * step) for k in (-2, -1, 1, 2)}
    for name in RESULTS:
        quotient = (sides[-2][name] - 8.0 * sides[-1][name] + 8.0 * sides[1][name] - sides[2][name]) / (12.0 * step)
        size = abs(derivatives.values[name]) / derivatives.variation(path).size
        assert found.above[name] == pytest.approx(quotient, rel=tolerance, abs=tolerance * size), (path, name)


@pytest.mark.slow
def test_a_plain_journal_under_a_load() -> None:
    """With side leakage, which carries a part of the heat."""
    derivatives = heated(plain(**{"model.cells_per_pitch": 16, "model.axial_cells": 4, "operation.load": (0.0, -50.0)}))
    for path in HEATED:
        assert_exact(derivatives, path)


@pytest.mark.slow
@pytest.mark.parametrize("path", [*HEATED, "petals.thickness", "bearing.journal_radius"])
def test_petals_under_a_load(path: str) -> None:
    derivatives = heated(rig(**{"model.cells_per_pitch": 8, "operation.speed": "20000 rpm"}))
    part = 1e-4 if path in HEATED else 1e-7
    assert min(derivatives.by(path).reach) > 2.0 * part * derivatives.variation(path).size
    assert_exact(derivatives, path, part, 3e-5)


@pytest.mark.slow
def test_the_lift_off_speed_of_a_hot_bearing() -> None:
    of = rig(**{"model.cells_per_pitch": 8})
    lift_off = speed_derivatives(of, 46.4, 0.01)[0]
    speed = lift_off.values["liftoff_speed"]
    value = of.heat.pack_to_bushing
    found = lift_off.by("heat.pack_to_bushing").above["liftoff_speed"]
    change = 1e-3 * value
    speeds = []
    for sign in (-1.0, 1.0):
        there = with_values(lift_off.balance.case, {"heat.pack_to_bushing": value + sign * change})
        line = SpeedLine(there, there.operation.load)
        line.known, line.temperatures = lift_off.balance.solution, lift_off.balance.solution.problem.temperatures
        speeds.append(refined("liftoff_speed", line, (speed, 0.01), as_points=False).values["liftoff_speed"])
    assert math.isfinite(found)
    assert found == pytest.approx((speeds[1] - speeds[0]) / (2.0 * change), rel=1e-3)
