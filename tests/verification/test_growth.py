"""Growth of shaft and bushing: closed forms, and bearings solved with the clearance that growth leaves."""

from __future__ import annotations

import csv
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from petalfoil import Case, balance, check, orbit, runup, solve
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Bushing, Shaft
from petalfoil.case.growth import REFERENCE_TEMPERATURE, centrifugal_growth, thermal_growth
from petalfoil.case.metals import metal_of
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import follow, predict
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import DefinitionError, PackError
from petalfoil.system.build import build_problem
from tests.cases import case
from tests.verification.film_helpers import REFERENCE

RPM = math.pi / 30.0
STEEL = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0, "expansion": 11.5e-6}


def rows(name: str) -> list[dict[str, str]]:
    with (REFERENCE / name).open(newline="") as file:
        return list(csv.DictReader(file))


def shaft_of(row: dict[str, str]) -> Shaft:
    return Shaft(
        youngs_modulus=float(row["E_Pa"]),
        poisson_ratio=float(row["nu"]),
        density=float(row["rho"]),
        expansion=0.0,
        bore_radius=float(row["a_m"]),
    )


# ---------------------------------------------------------------------------------------------- closed forms


def test_centrifugal_growth_of_solid_and_hollow_shafts() -> None:
    for row in rows("r1e_growth.csv"):
        grown = centrifugal_growth(shaft_of(row), float(row["b_m"]), float(row["rpm"]) * RPM)
        assert_allclose(grown, float(row["centrifugal_m"]), rtol=1e-9)


@pytest.mark.parametrize(
    ("number", "rise"),
    [
        (0, lambda r, a, b: 40.0),
        (1, lambda r, a, b: 40.0 * (r / b) ** 2),
        (2, lambda r, a, b: 40.0 * math.log(r / a) / math.log(b / a)),
    ],
)
def test_thermal_growth_by_the_area_mean(number: int, rise) -> None:
    row = rows("r1e_thermal.csv")[number]
    a, b = float(row["a"]), float(row["b"])
    mean = quad(lambda r: rise(r, a, b) * 2.0 * r, a, b)[0] / (b**2 - a**2)
    part = Bushing(expansion=float(row["alpha"]))
    assert_allclose(thermal_growth(part, b, REFERENCE_TEMPERATURE + mean), float(row["closed_u(b)"]), rtol=1e-9)


# ---------------------------------------------------------------------------------------------- in a bearing


def plain(**changes: object) -> Case:
    return case("plain_journal", **{"model.cells_per_pitch": 32, "model.axial_cells": 8, **changes})


def test_a_grown_journal_is_one_in_a_smaller_clearance() -> None:
    """To the growth of areas and bearing number, a thousandth, which is left out."""
    hot = plain(shaft={**STEEL, "temperature": "50 degC"}, bushing={"expansion": 23e-6, "temperature": "30 degC"})
    grown = hot.growth.closing(hot.operation.speed)
    radius = hot.bearing.bushing_radius - grown
    same = plain(**{"bearing.bushing_radius": radius})
    one, other = solve.record(hot).scalars, solve.record(same).scalars
    for name in ("force_x", "force_y", "min_film_thickness", "friction_torque", "peak_pressure"):
        assert_allclose(one[name], other[name], rtol=1e-9)
    assert_allclose(one["shaft_growth"] - one["bushing_growth"], grown, rtol=1e-12)
    cold = solve.record(plain()).scalars
    assert float(cold["bearing_force"]) < 0.95 * float(one["bearing_force"])
    assert "shaft_growth" not in cold


def test_a_shaft_and_a_bushing_of_named_metals() -> None:
    """The constants are those of the table, the modulus that at the temperature; no file repeats them."""
    named = plain(shaft={"material": "718", "temperature": 300.0}, bushing={"material": "titanium"})
    metal, given = metal_of("inconel 718"), {"temperature": 300.0, "youngs_modulus": 0.0}
    given["youngs_modulus"] = metal.youngs_modulus(300.0)
    given |= {name: getattr(metal, name) for name in ("poisson_ratio", "density", "expansion")}
    numbers = plain(shaft=given, bushing={"expansion": 8.6e-6})
    assert named.growth == numbers.growth
    assert Case.from_toml(named.to_toml()) == named
    assert "density" not in named.to_toml()
    with pytest.raises(DefinitionError, match=r"shaft\.density: .* is given beside shaft\.material"):
        plain(shaft={"material": "718", "density": 8000.0})
    with pytest.raises(DefinitionError, match=r"shaft\.youngs_modulus: is missing"):
        plain(shaft={"density": 8000.0})
    with pytest.raises(DefinitionError, match="not in the table of metals"):
        plain(bushing={"material": "cheese"})


def test_check_shows_growth_and_the_clearance_that_it_leaves() -> None:
    hot = plain(shaft={**STEEL, "temperature": "50 degC"})
    ds = check(hot)
    assert_allclose(float(ds["shaft_growth"]), hot.growth.journal(hot.operation.speed), rtol=1e-12)
    assert_allclose(float(ds["radial_clearance"]), 25e-6 - 10e-6 - float(ds["shaft_growth"]), rtol=1e-9)


def test_growth_follows_the_speed_along_a_line() -> None:
    """At every speed of a line the balance is that of the case at this speed."""
    hot = plain(shaft=STEEL)
    line = SpeedLine(hot, (0.0, -20.0))
    for speed in (1000.0, 4000.0):
        e = line.at(speed).problem.displacement * line.base.layout.scales.length
        alone = balance.record(hot, (0.0, -20.0), speed=speed).scalars
        assert_allclose(e, [alone["eccentricity_x"], alone["eccentricity_y"]], rtol=1e-7, atol=1e-15)


@pytest.mark.parametrize("name", ["plain_journal", "paper_n8"])
def test_a_prediction_knows_growth(name: str) -> None:
    """The remainder of the prediction falls with the square of the change of speed."""
    changes = {"model.kind": "2d", "model.cells_per_pitch": 24, "shaft": {**STEEL, "density": 5e4}}
    hot = case(name, **changes)
    problem = build_problem(hot)
    with running():
        known, errors = solve_cold(problem), []
        known = follow(known, problem)
        for change in (1e-3, 2e-3):
            faster = problem.at(bearing_number=(1.0 + change) * problem.bearing_number)
            there = follow(known, faster)
            errors.append(np.abs(there.x - known.x - predict(known, faster)).max())
    assert errors[1] / errors[0] == pytest.approx(4.0, rel=0.1)


@pytest.mark.slow
def test_a_tight_pack_starts_harder_when_it_is_hot() -> None:
    """10 µm of growth in the paper's rig, two of whose layers have 18 µm of clearance."""
    cold = case("rig", **{"model.cells_per_pitch": 48, "operation.load": (0.0, -46.4)})
    hot = cold.replace(shaft={**STEEL, "density": 1.0, "temperature": 293.15 + 30.4})
    first, second = (float(runup(of, to=1.0, points=3)["friction_torque"][0]) for of in (cold, hot))
    assert second > 1.5 * first


def test_a_grown_shaft_that_does_not_fit_is_refused() -> None:
    with pytest.raises(PackError, match="shaft and bushing as grown"):
        plain(shaft={**STEEL, "temperature": "200 degC"})
    with pytest.raises(DefinitionError, match="leaves nothing of the shaft"):
        plain(shaft={**STEEL, "bore_radius": 0.05})


@pytest.mark.slow
def test_the_energy_of_a_motion_counts_growth() -> None:
    """A run-up in which the journal grows onto its petals: the energy-balance error stays that of the steps."""
    hot = case("orbit_n8", **{"model.cells_per_pitch": 12, "shaft": {**STEEL, "density": 5e4}})
    ds = orbit(hot, duration=2e-4, speeds=[(0.0, 0.0), (2e-4, 3000.0)])
    assert float(ds["energy_balance_error"]) < 1e-2
