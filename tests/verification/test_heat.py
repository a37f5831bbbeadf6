"""The heat network: exact film, tangents, balances, cost, thermal runaway and warm-up."""

from __future__ import annotations

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq, minimize_scalar

from petalfoil import Case, balance, capacity, coefficients, curve, runup, sensitivity, solve
from petalfoil.case import Heat, HotGas
from petalfoil.equilibrium.heated import ThermalRunawayError
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.system.build import build_problem
from petalfoil.system.heat_network import FilmHeat, HeatNetwork
from petalfoil.system.heat_rows import HeatRows
from petalfoil.system.temperatures import Temperatures
from tests.cases import case
from tests.contract.taylor import assert_tangent, open_state
from tests.verification.film_helpers import REFERENCE

RPM = math.pi / 30.0
STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0, "expansion": 11.5e-6}
NETWORK = {"pack_to_bushing": 20.0, "bushing_to_ambient": 10.0, "shaft_to_ambient": 0.5}
CAPACITIES = {"shaft_capacity": 400.0, "pack_capacity": 20.0, "bushing_capacity": 300.0}
NODES = ("film", "shaft", "pack", "bushing")


def rows(name: str) -> list[dict[str, str]]:
    with (REFERENCE / name).open(newline="") as file:
        return list(csv.DictReader(file))


def plain(**changes: object) -> Case:
    """A plain journal that grows and warms up."""
    grown = {"shaft": STEEL, "bushing": {"expansion": 11.5e-6}, "heat": NETWORK}
    return case("plain_journal", **{"model.cells_per_pitch": 32, "model.axial_cells": 8, **grown, **changes})


def rig(**changes: object) -> Case:
    """The paper's test rig, with a shaft and a bushing of steel."""
    grown = {"shaft": STEEL, "bushing": {"expansion": 11.5e-6}, "heat": {**NETWORK, **CAPACITIES}}
    return case("rig", **{"model.cells_per_pitch": 32, "operation.load": (0.0, -46.4), **grown, **changes})


def temperatures(scalars) -> Temperatures:
    return Temperatures(*(float(scalars[f"{node}_temperature"]) for node in NODES))


# ---------------------------------------------------------------------------------------------- exact film


@pytest.mark.parametrize("number", range(4))
def test_a_couette_film_between_two_walls(number: int) -> None:
    """The mean temperature of Crocco's solution, weighted with the velocity, to all its digits."""
    row = rows("r1a_couette.csv")[number]
    U, c_p, prandtl = float(row["U_m_s"]), float(row["cp"]), float(row["Pr"])
    stationary, runner = float(row["T0_K(stationary)"]), float(row["T1_K(runner)"])
    gas = HotGas(1.8e-5, 300.0, c_p, prandtl, float(row["n"]))
    network = HeatNetwork(Heat(pack_to_bushing=1.0, shaft_to_ambient=1.0), gas)
    power = U**2 * prandtl / c_p  # over the conductance, [K]
    film = FilmHeat(viscous=power, rubbing=0.0, couette=power, conductance=1.0, carried=0.0)

    def gained(pack: float, mean: float) -> np.ndarray:
        T = Temperatures(mean, runner, pack, pack)
        return network.residual(T, film) + network.paths[0] @ T.nodes - network.paths[1]  # by the film alone

    if row["wall0"] == "isothermal":
        pack = stationary
        mean = brentq(lambda T: gained(pack, T)[0], 250.0, 600.0, xtol=1e-12)
    else:
        pack = brentq(lambda wall: gained(wall, (4.0 * wall + 2.0 * runner) / 6.0)[0], 250.0, 900.0, xtol=1e-12)
        mean = (4.0 * pack + 2.0 * runner) / 6.0
        assert_allclose(pack, float(row["Tmax"]), rtol=1e-11)
    assert_allclose(mean, float(row["Tmean_velocity_weighted_in_v"]), rtol=1e-11)
    drag = gas.ratio(mean) / gas.ratio(stationary) if row["wall0"] == "isothermal" else gas.ratio(mean)
    assert_allclose(drag, float(row["tau_h/(mu(T0)U)"]), rtol=2e-3)


@pytest.mark.parametrize(("number", "tolerance"), [(0, 0.005), (1, 0.045), (2, 0.007)])
def test_a_journal_with_conductances_in_the_lumped_limit(number: int, tolerance: float) -> None:
    """The rise of the shaft against a film whose temperature varies round the journal, at the friction power there."""
    row = {name: float(value) for name, value in rows("r1c_journal_groove.csv")[number].items() if "digits" not in name}
    conductance = row["S"] / 6.0 * 2.0 * math.pi / math.sqrt(1.0 - row["eps"] ** 2)
    heat = Heat(pack_to_bushing=1e4, bushing_to_ambient=2.0 * math.pi * row["Gb"], shaft_to_ambient=row["Gs"])
    network = HeatNetwork(heat, HotGas(1.0, 1.0, 1.0, 1.0, row["n"]))
    power, T = row["power"] - row["Q_gas"], Temperatures.even(1.0)
    for _ in range(30):
        film = FilmHeat(power, 0.0, power, conductance * T.film ** row["n"], 0.0)
        slope = network.by_temperature(T, film)
        T = Temperatures(*(T.nodes - np.linalg.solve(slope, network.residual(T, film))))
    assert np.abs(network.residual(T, film)).max() < 1e-9 * power
    assert_allclose(T.shaft - 1.0, row["Ts/T0"] - 1.0, rtol=tolerance)
    assert_allclose(T.pack - 1.0, row["Tb_mean/T0"] - 1.0, rtol=0.04)


# ---------------------------------------------------------------------------------------------- tangents

HOT = Temperatures(331.0, 337.0, 322.0, 309.0)


@pytest.mark.parametrize("name", ["plain", "petals"])
def test_derivatives_of_the_heat_balances(name: str) -> None:
    """By unknowns, position and temperatures; without ends, whose leakage the derivative leaves out."""
    bearing = plain(**{"model.kind": "2d"}) if name == "plain" else rig(**{"model.cells_per_pitch": 6})
    problem, rng = build_problem(bearing).at(temperatures=HOT), np.random.default_rng(5)
    network = HeatNetwork.of(bearing)
    x = open_state(problem, rng)
    lam = rng.uniform(0.0, 1.0, len(problem.weight))
    rows_ = HeatRows(network, problem, x, lam)
    direction, de, dT = rng.uniform(-1.0, 1.0, len(x)), np.array([0.3, -0.2]), np.array([0.2, 0.3, -0.1, 0.05])
    unit = network.gas.temperature

    def moved(t: float, *, x_too: bool, e_too: bool, warm_too: bool) -> np.ndarray:
        there = problem.at(
            displacement=problem.displacement + (t * de if e_too else 0.0),
            temperatures=Temperatures(*(HOT.nodes + (t * unit * dT if warm_too else 0.0))),
        )
        return HeatRows(network, there, x + (t * direction if x_too else 0.0), lam).residual

    if problem.layout.n_wall:
        assert_tangent(lambda t: moved(t, x_too=True, e_too=False, warm_too=False), rows_.by_unknowns @ direction)
    else:  # linear in the pressures
        change = moved(1.0, x_too=True, e_too=False, warm_too=False) - rows_.residual
        assert_allclose(change, rows_.by_unknowns @ direction, rtol=0.0, atol=1e-9 * np.abs(change).max())
    assert_tangent(lambda t: moved(t, x_too=False, e_too=True, warm_too=False), rows_.by_position @ de)
    assert_tangent(lambda t: moved(t, x_too=False, e_too=False, warm_too=True), rows_.by_temperature @ dT, 2.0**-8)
    assert_allclose(
        HeatRows(network, problem, x, 2.0 * lam).residual - rows_.residual, rows_.by_reactions @ lam, rtol=1e-9
    )


@pytest.mark.parametrize("name", ["plain", "petals"])
def test_derivatives_of_the_equations_by_the_temperatures(name: str) -> None:
    bearing = plain() if name == "plain" else rig(**{"model.cells_per_pitch": 6})
    problem, rng = build_problem(bearing).at(temperatures=HOT), np.random.default_rng(6)
    x, dT = open_state(problem, rng), np.array([0.2, 0.3, -0.1, 0.05])
    network = HeatNetwork.of(bearing)
    border = HeatRows(network, problem, x, np.zeros(len(problem.weight))).border(None)
    unit, film = network.gas.temperature, problem.layout.n_wall

    def there(t: float):
        return problem.at(temperatures=Temperatures(*(HOT.nodes + t * unit * dT)))

    line = problem.linearize(x)
    change = line.slack_derivative(border.gap_derivative @ dT) + border.forcing @ dT
    assert_tangent(lambda t: there(t).linearize(x).residual[film:], change[film:], largest=2.0**-9)
    assert_allclose(there(0.01).gaps(x) - problem.gaps(x), border.gap_derivative @ (0.01 * dT), rtol=0.0, atol=1e-12)


# ---------------------------------------------------------------------------------------------- solutions


def test_power_balances_and_the_film_is_that_of_the_case_at_these_temperatures() -> None:
    """What leaves through the conductances and with the gas is the friction power, to 1e-9."""
    hot = plain()
    found = solve.record(hot).scalars
    T, power = temperatures(found), float(found["power_loss"])
    leaving = 0.5 * (T.shaft - 293.15) + 10.0 * (T.bushing - 293.15) + float(found["heat_to_gas"])
    assert_allclose(leaving, power, rtol=1e-9)
    assert_allclose(20.0 * (T.pack - T.bushing), found["heat_to_pack"], rtol=1e-9)
    assert float(found["heat_balance_error"]) < 1e-9
    still = hot.replace(
        heat=None,
        **{
            "gas.viscosity": hot.gas.viscosity * (T.film / 293.15) ** 0.7,
            "shaft.temperature": T.shaft,
            "bushing.temperature": T.bushing,
        },
    )
    cold = solve.record(still).scalars
    for name in ("force_x", "force_y", "min_film_thickness", "power_loss", "shaft_growth", "bushing_growth"):
        assert_allclose(found[name], cold[name], rtol=1e-8)
    longer = (T.film / 293.15) ** (0.7 + 0.5)  # mean free path
    assert_allclose(found["knudsen_number"], 67.26e-9 * longer / float(found["min_film_thickness"]), rtol=1e-3)
    assert_allclose(found["side_leakage"], float(cold["side_leakage"]) * 293.15 / T.film, rtol=1e-8)


@pytest.mark.parametrize("name", ["plain", "rig"])
def test_heat_costs_three_factorisations_at_most(name: str) -> None:
    hot = plain(**{"operation.load": (0.0, -60.0), "operation.eccentricity": (0.0, 0.0)}) if name == "plain" else rig()
    warm, isothermal = (balance.record(of, speed=10000.0 * RPM).scalars for of in (hot, hot.replace(heat=None)))
    assert warm["factorizations"] <= isothermal["factorizations"] + 3
    assert float(warm["force_residual"]) < 1e-9
    assert float(warm["heat_balance_error"]) < 1e-9


def test_rubbing_heats_too() -> None:
    """At 2000 rpm the journal rubs; half of that power enters the shaft."""
    found = balance.record(rig(), speed=2000.0 * RPM).scalars
    assert float(found["contact_fraction"]) > 0.3
    T = temperatures(found)
    leaving = 0.5 * (T.shaft - 293.15) + 10.0 * (T.bushing - 293.15)
    assert_allclose(leaving, found["power_loss"], rtol=1e-9)
    assert T.shaft > 310.0


def test_a_shaft_at_rest_is_cold() -> None:
    found = balance.record(rig(), speed=0.0).scalars
    assert_allclose(temperatures(found).nodes, 293.15, rtol=1e-12)


def test_paths_to_the_end_of_the_shaft_and_to_a_cooling_flow() -> None:
    """A cooling flow takes `m c_p (1 - exp(-G / (m c_p)))` a kelvin; the shaft's end has its own temperature."""
    heat = {
        "pack_to_bushing": 1.0,
        "pack_to_cooling": 4.0,
        "cooling_flow": 2e-3,
        "cooling_temperature": "300 K",
        "along_shaft": 2.0,
        "shaft_end_temperature": "330 K",
    }
    found = solve.record(plain(heat=heat)).scalars
    T, flow = temperatures(found), 2e-3 * 3.5 * 287.05
    cooled = flow * (1.0 - math.exp(-4.0 / flow)) * (T.pack - 300.0)
    leaving = 2.0 * (T.shaft - 330.0) + cooled + float(found["heat_to_gas"])
    assert_allclose(leaving, found["power_loss"], rtol=1e-9)
    assert_allclose(T.bushing, T.pack, rtol=1e-9)


@pytest.mark.slow
def test_a_named_gas_brings_its_properties() -> None:
    air = plain(gas={"name": "air", "ambient_pressure": "1 bar", "temperature": "20 degC"})
    gas = air.heat.of_gas(air.gas)
    assert_allclose([gas.heat_capacity, gas.prandtl_number, gas.exponent], [1006.0, 0.707, 0.78], rtol=0.01)
    helium = plain(gas={"name": "helium", "ambient_pressure": "1 bar", "temperature": "20 degC"})
    assert_allclose(helium.heat.of_gas(helium.gas).conductivity, 0.154, rtol=0.02)


# ---------------------------------------------------------------------------------------------- bottomed out


def hot_rig() -> Case:
    """The example of a hot rig, on a coarse grid."""
    return case("rig_hot", **{"model.cells_per_pitch": 16})


def test_a_pack_that_is_bottomed_out_only_while_it_is_cold() -> None:
    """Cold the load closes it to its solid height, and no contact set determines the reactions; warm the film carries
    98 % of it. That was taken for a runaway."""
    cold, hot = (balance.record(of, (0.0, -319.0)).scalars for of in (hot_rig().replace(heat=None), hot_rig()))
    assert "bottomed out" in str(cold["solution_path"])
    assert "bottomed out" not in str(hot["solution_path"])
    assert float(hot["heat_balance_error"]) < 1e-9
    assert_allclose(hot["contact_fraction"], 0.01845, rtol=1e-3)


@pytest.mark.slow
def test_a_pack_that_stays_bottomed_out_has_its_steady_temperature() -> None:
    """Heat and load balance; the temperatures rise with the load."""
    found = [balance.record(hot_rig(), (0.0, -load)).scalars for load in (330.0, 400.0)]
    for one in found:
        assert "bottomed out" in str(one["solution_path"])
        assert float(one["heat_balance_error"]) < 1e-9
        assert float(one["force_residual"]) < 1e-8
        T, power = temperatures(one), float(one["power_loss"])
        leaving = 1.5 * (T.shaft - 293.15) + 10.0 * (T.bushing - 293.15)
        assert_allclose(leaving, power, rtol=1e-9)
    assert float(found[1]["shaft_temperature"]) > float(found[0]["shaft_temperature"]) + 20.0


# ---------------------------------------------------------------------------------------------- every verb


@pytest.mark.slow
def test_verbs_that_visit_states_know_the_heat() -> None:
    hot = plain()
    alone = solve.record(hot).scalars
    followed = curve(hot, [5e-6, 1e-5])
    assert_allclose(followed["shaft_temperature"].values[-1], alone["shaft_temperature"], rtol=1e-9)
    T = temperatures(alone)
    still = hot.replace(
        heat=None,
        **{
            "gas.viscosity": hot.gas.viscosity * (T.film / 293.15) ** 0.7,
            "shaft.temperature": T.shaft,
            "bushing.temperature": T.bushing,
        },
    )
    warm, cold = (coefficients.record(of, [1500.0]).fields for of in (hot, still))
    assert_allclose(warm["stiffness"], cold["stiffness"], rtol=1e-7)
    told = sensitivity(hot, "heat.bushing_to_ambient", of="bushing_temperature")
    assert float(told["derivative"].item()) < 0.0  # what carries more heat away is colder


def test_coefficients_of_a_hot_pack_are_those_at_its_temperatures() -> None:
    """Petals with continuous slopes and contact points between nodes see the same film."""
    hot = rig()
    T = temperatures(balance.record(hot, speed=12000.0 * RPM).scalars)
    still = hot.replace(
        heat=None,
        **{
            "gas.viscosity": hot.gas.viscosity * (T.film / 293.15) ** 0.7,
            "shaft.temperature": T.shaft,
            "bushing.temperature": T.bushing,
        },
    )
    there, alone = (coefficients.record(of, [600.0], speed=12000.0 * RPM) for of in (hot, still))
    warm, cold = there.fields, alone.fields
    assert_allclose(float(there.scalars["shaft_temperature"]), T.shaft, rtol=1e-9)
    for name in ("stiffness", "damping"):
        assert_allclose(warm[name], cold[name], rtol=0.0, atol=1e-6 * np.abs(cold[name].astype(float)).max())


@pytest.mark.slow
def test_the_load_capacity_is_that_of_the_warm_bearing() -> None:
    hot = rig(**{"operation.speed": 12000.0 * RPM})
    found = capacity.record(hot, contact_fraction=0.02).scalars
    load = float(found["load_capacity"])
    there = balance.record(hot, (0.0, -load)).scalars
    assert_allclose(there["contact_fraction"], 0.02, rtol=0.02)


# ---------------------------------------------------------------------------------------------- warm-up


@pytest.mark.slow
def test_a_bearing_warms_up_on_the_way() -> None:
    """Cold at first, hotter on the way down; long enough it is as hot as in steady states."""
    hot, top = rig(), 6000.0 * RPM
    steady = runup(hot, to=top, points=4)
    quick, slow = (runup(hot, to=top, points=4, warm_up=time) for time in (2.0, 1e7))
    assert_allclose(slow["shaft_temperature"][1:], steady["shaft_temperature"][1:], rtol=1e-5)
    shaft = quick["shaft_temperature"].values
    assert shaft[0] == pytest.approx(293.15, abs=1e-6)
    assert np.all(np.diff(shaft) > 0.0)
    assert shaft[-1] < 310.0
    assert quick["friction_torque"].values[-1] > quick["friction_torque"].values[0]


@pytest.mark.slow
def test_a_warm_shaft_starts_harder() -> None:
    """30 K above the bushing the rig needs more than twice the torque."""
    warm = rig(heat={**NETWORK, **CAPACITIES, "shaft_start_temperature": 323.15})
    first, second = (runup(of, to=100.0, points=3, warm_up=1.0) for of in (rig(), warm))
    assert float(second["friction_torque"][0]) > 1.8 * float(first["friction_torque"][0])
    assert_allclose(float(second["shaft_temperature"][0]), 323.15, atol=1e-2)


def test_an_implicit_step_stores_what_it_does_not_pass_on() -> None:
    network = HeatNetwork.of(rig()).after(Temperatures.even(300.0), 2.0)
    T, film = Temperatures(310.0, 305.0, 304.0, 301.0), FilmHeat(0.0, 0.0, 0.0, 0.0, 0.0)
    gained = network.residual(T, film)
    expected_shaft = -0.5 * (305.0 - 293.15) - 400.0 * 5.0 / 2.0
    assert_allclose(gained[1], expected_shaft, rtol=1e-12)
    assert_allclose(gained[3], 20.0 * 3.0 - 10.0 * (301.0 - 293.15) - 300.0 * 1.0 / 2.0, rtol=1e-12)


# ---------------------------------------------------------------------------------------------- runaway

TIGHT = {
    "model.kind": "2d",
    "model.cells_per_pitch": 32,
    "bushing": None,
    "operation.eccentricity": (0.0, -4e-6),
    "heat": {"pack_to_bushing": 2.0, "bushing_to_ambient": 1e4, "shaft_to_ambient": 0.02},
}
"""A bushing at the temperature of the surroundings: the friction power heats the shaft, which grows."""


def least_gain(bearing: Case, speed: float) -> float:
    """Least gain of the shaft over its temperature [W], by isothermal runs alone: negative where one is steady."""
    isothermal = bearing.replace(heat=None, **{"operation.speed": speed})
    gas, wall = bearing.heat.of_gas(bearing.gas), 1.0 / (1.0 / 2.0 + 1e-4)

    def gain(shaft: float) -> float:
        film = shaft
        for _ in range(40):
            changes = {"gas.viscosity": gas.viscosity * gas.ratio(film), "shaft.temperature": shaft}
            try:
                ds = solve(isothermal.replace(**changes))
            except DefinitionError:
                return 1e3
            h = ds["film_thickness"].values[0, :, 0]
            area = bearing.bearing.journal_radius * 2.0 * math.pi / (len(h) - 1) * bearing.bearing.length
            G = gas.conductivity * gas.ratio(film) * area * float(np.sum(1.0 / h[:-1]))
            # film: power = G (12 T_f - 6 T_s - 6 T_p); wall: G (6 T_f - 4 T_p - 2 T_s) = wall (T_p - ambient)
            system = np.array([[12.0 * G, -6.0 * G], [6.0 * G, -4.0 * G - wall]])
            there = [float(ds["power_loss"]) + 6.0 * G * shaft, 2.0 * G * shaft - wall * 293.15]
            before, (film, pack) = film, np.linalg.solve(system, there)
            if abs(film - before) < 1e-6:
                break
        return float(G * (6.0 * film - 4.0 * shaft - 2.0 * pack) - 0.02 * (shaft - 293.15))

    return float(minimize_scalar(gain, bounds=(294.0, 390.0), method="bounded", options={"xatol": 0.2}).fun)


@pytest.mark.slow
def test_thermal_runaway_begins_where_an_independent_scan_says() -> None:
    """Within 1 %, on a plain journal whose clearance the hot shaft closes."""
    bearing = plain(**TIGHT)
    with pytest.raises(ThermalRunawayError) as failed:
        solve(bearing.replace(**{"operation.speed": 60000.0 * RPM}))
    said = str(failed.value)
    assert "no steady temperature above" in said
    begins = float(said.split("above ")[1].split(" rpm")[0]) * RPM
    low, high = 0.9 * begins, 1.1 * begins
    assert least_gain(bearing, low) < 0.0 < least_gain(bearing, high)
    for _ in range(5):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if least_gain(bearing, middle) < 0.0 else (low, middle)
    assert_allclose(begins, 0.5 * (low + high), rtol=1e-2)


@pytest.mark.slow
def test_the_speed_of_a_runaway_under_load_parts_steady_from_unsteady() -> None:
    hot = rig()
    with pytest.raises(
        ThermalRunawayError, match=r"no steady temperature above \d+ rpm under 46.4 N; at 70000 rpm"
    ) as it:
        balance(hot, speed=70000.0 * RPM)
    begins = float(str(it.value).split("above ")[1].split(" rpm")[0]) * RPM
    assert bool(balance(hot, speed=0.99 * begins)["converged"])
    with pytest.raises(ThermalRunawayError):
        balance(hot, speed=1.01 * begins)


# ---------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"heat": {"pack_to_bushing": 1.0}}, "heat: carries no heat to the surroundings"),
        ({"heat": {"pack_to_bushing": -1.0}}, "heat.pack_to_bushing"),
        ({"shaft": {**STEEL, "temperature": 330.0}}, "shaft.temperature: is given beside [heat]"),
        ({"model.slip": True}, "model.slip: is for a gas of one temperature"),
        ({"model.method": "classic"}, "heat: is not in the paper"),
    ],
)
def test_a_network_that_has_no_meaning_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(DefinitionError) as refused:
        plain(**changes)
    assert words in str(refused.value)


def test_a_warm_up_needs_heat_capacities() -> None:
    with pytest.raises(UsageError, match="heat network"):
        runup(rig(heat=None), to=100.0, points=3, warm_up=1.0)
    with pytest.raises(UsageError, match="shaft_capacity"):
        runup(rig(heat=NETWORK), to=100.0, points=3, warm_up=1.0)
    assert replace(HeatNetwork.of(rig()), power=0.5).power == 0.5
