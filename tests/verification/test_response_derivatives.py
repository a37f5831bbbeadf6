"""Derivatives of stiffness, damping, critical mass and threshold speed beside equilibria that are solved again."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.derivatives import DerivativesOf, ResultsOf
from petalfoil.analysis.mode_derivatives import mode_results
from petalfoil.analysis.operating_point import at_position, under_load
from petalfoil.analysis.response_derivatives import coefficient_results, stability_derivatives, whirl_results
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.sensitivity_table import MODES
from petalfoil.case import Case
from petalfoil.case.parameters import with_values
from petalfoil.equilibrium.small_motion import AT_POINTS, ON_LINES
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from tests.cases import case
from tests.verification.resolved import difference_quotient

PLAIN = {"model.cells_per_pitch": 12, "model.axial_cells": 4}
LINES = {"model.cells_per_pitch": 8, "model.axial_cells": 4}


EXACT = {
    "stiffness": 1e-5,
    "damping": 1e-5,
    "critical": 1e-6,
    "whirl": 1e-6,
    "natural": 1e-6,
    "mode": 2e-6,
    "logarithm of": 1e-6,
}
"""Agreement by kind of result. Stiffness with contact points is rounded to some 1e-11, and differenced over 1e-6."""


def found_at(of: Case) -> Solution:
    """The equilibrium that results are taken from."""
    load = of.operation.load
    return reported(of, at_position(of).answer if load is None else under_load(of, load)[0])


def derivatives(of: Case, results: Callable[[Case, Solution], ResultsOf]) -> DerivativesOf:
    """Derivatives of results that belong to an equilibrium."""
    found = found_at(of)
    return DerivativesOf(of, found, results(of, found), as_points=found.contact_model in (AT_POINTS, ON_LINES))


def loaded(of: Case, load: float) -> Case:
    """The case under a load along -y [N]."""
    return of.replace(**{"operation.load": (0.0, -load), "operation.eccentricity": (0.0, 0.0)})


def assert_solved_again(found: DerivativesOf, paths: tuple[str, ...]) -> None:
    """Derivatives agree with those of equilibria that are solved again, over the largest entry of their kind."""
    for path in paths:
        variation = found.variation(path)
        derivative = found.along(variation)
        quotient = difference_quotient(found, variation.finer(derivative.fineness))
        for name, value in quotient.items():
            kind = name.split("_")[0]
            size = max(abs(each) for other, each in found.values.items() if other.startswith(kind)) / variation.size
            size = max(size, *(abs(each) for other, each in quotient.items() if other.startswith(kind)))
            exact = next(bound for beginning, bound in EXACT.items() if name.startswith(beginning))
            assert_allclose(derivative.above[name], value, rtol=0.0, atol=exact * size, err_msg=f"{name} by {path}")


@pytest.mark.slow
def test_stiffness_and_damping_with_contact_points() -> None:
    of = loaded(case(**{"model.cells_per_pitch": 16}), 20.0)
    found = derivatives(of, lambda _case, _found: coefficient_results(None))
    assert found.solution.contact_model == AT_POINTS
    assert_solved_again(found, ("petals.thickness", "operation.speed"))


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [None, 0.0, 2000.0])
def test_stiffness_and_damping_by_all_kinds_of_parameters(frequency: float | None) -> None:
    of = loaded(case(**{"model.cells_per_pitch": 16}), 20.0)
    found = derivatives(of, lambda _case, _found: coefficient_results(frequency))
    assert_solved_again(found, ("petals.bend_radius", "petals.arc_length", "bearing.bushing_radius", "gas.viscosity"))


@pytest.mark.slow
@pytest.mark.parametrize(("theory", "load"), [("inextensible", None), ("shell", 20.0)])
def test_stiffness_and_damping_with_contact_lines(theory: str, load: float | None) -> None:
    of = case("paper_n8_spatial", **{**LINES, "petals.theory": theory})
    found = derivatives(of if load is None else loaded(of, load), lambda _case, _found: coefficient_results(None))
    assert found.solution.contact_model == ON_LINES
    assert_solved_again(found, ("petals.thickness", "operation.speed", "bearing.bushing_radius"))


@pytest.mark.slow
def test_stiffness_and_damping_of_petals_that_stick_on_contact_lines() -> None:
    changes = {**LINES, "petals.theory": "shell", "surface.petal_friction": 0.3}
    of = loaded(case("paper_n8_spatial", **changes), 20.0)
    found = derivatives(of, lambda _case, _found: coefficient_results(None))
    assert found.solution.contact_model == ON_LINES
    assert_solved_again(found, ("petals.thickness", "operation.speed"))
    ours = petalfoil.sensitivity(of, "petals.thickness", ask="coefficients", of="stiffness_yy")
    assert_allclose(ours["derivative"].item(), found.along(found.variation("petals.thickness")).above["stiffness_yy"])


@pytest.mark.slow
def test_stiffness_and_damping_with_contact_lines_follow_a_change_of_a_thousandth() -> None:
    """The whole way, where one set of contacts holds: `sensitivity` beside `coefficients` of neighbours."""
    of = loaded(case("paper_n8_spatial", **{**LINES, "petals.theory": "shell"}), 20.0)
    of = of.replace(**{"petals.youngs_modulus": 0.9985 * of.petals.youngs_modulus})
    wanted = "stiffness_xx, stiffness_yy, damping_yy"
    table = petalfoil.sensitivity(of, "petals.youngs_modulus", ask="coefficients", of=wanted)
    value = of.petals.youngs_modulus
    stiffer = [of.replace(**{"petals.youngs_modulus": share * value}) for share in (0.9995, 1.0005)]
    there = [petalfoil.coefficients(one) for one in stiffer]
    for name, entry in (("stiffness_xx", (0, 0)), ("stiffness_yy", (1, 1)), ("damping_yy", (1, 1))):
        row = table.isel(point=list(table["quantity"].values).index(name))
        change = float(there[1][name[:-3]][0][entry] - there[0][name[:-3]][0][entry])
        assert_allclose(float(row["derivative"]) * 0.001 * value, change, rtol=1e-3)


@pytest.mark.slow
def test_stiffness_and_damping_follow_a_change_of_one_per_cent() -> None:
    """The whole way: values of `sensitivity` beside those of `coefficients` of neighbours."""
    of = case("plain_journal", **PLAIN)
    table = petalfoil.sensitivity(of, "gas.viscosity", ask="coefficients", load="15 N", of="stiffness_xy, damping_xx")
    there = [
        petalfoil.coefficients(of.replace(**{"gas.viscosity": share * of.gas.viscosity}), load="15 N")
        for share in (0.999, 1.001)
    ]
    for name, entry in (("stiffness_xy", (0, 1)), ("damping_xx", (0, 0))):
        row = table.isel(point=list(table["quantity"].values).index(name))
        change = float(there[1][name[:-3]][0][entry] - there[0][name[:-3]][0][entry])
        assert_allclose(float(row["derivative"]) * 0.002 * of.gas.viscosity, change, rtol=1e-4)


def test_critical_mass_of_a_plain_journal() -> None:
    of = loaded(case("plain_journal", **PLAIN), 15.0)
    found = derivatives(of, lambda there, answer: whirl_results(there, answer, None))
    assert_solved_again(found, ("gas.viscosity", "operation.speed", "bearing.bushing_radius"))
    whirl = RotorOnBearings(of, 1.0)
    searched = whirl.whirl(whirl.impedance(found.solution), of.operation.speed)
    assert_allclose(found.values["critical_mass"], searched.mass, rtol=1e-5)
    assert_allclose(found.values["whirl_ratio"], searched.ratio, rtol=1e-5)


@pytest.mark.slow
def test_threshold_speed_of_a_plain_journal() -> None:
    of = loaded(case("plain_journal", **PLAIN), 15.0)
    threshold = stability_derivatives(of, 2.0, ["critical_mass", "threshold_speed"], as_points=True)[1]
    value, path = of.gas.viscosity, "gas.viscosity"
    speeds = [
        float(petalfoil.stability(with_values(of, {path: share * value}), mass="2 kg")["threshold_speed"])
        for share in (0.99, 1.0, 1.01)
    ]
    assert_allclose(threshold.values["threshold_speed"], speeds[1], rtol=2e-6)
    assert_allclose(threshold.by(path).above["threshold_speed"], (speeds[2] - speeds[0]) / (0.02 * value), rtol=1e-3)


def test_what_has_no_critical_mass_is_refused() -> None:
    of = loaded(case(**{"model.cells_per_pitch": 8}), 20.0)
    with pytest.raises(ConvergenceError, match="stable for any rotor mass"):
        stability_derivatives(of, None, ["critical_mass"], as_points=False)
    with pytest.raises(UsageError, match="turning shaft"):
        petalfoil.sensitivity(of.replace(**{"operation.speed": 0.0}), ask="coefficients")
    with pytest.raises(UsageError, match=r"--frequency is that of stiffness and damping: balance has none"):
        petalfoil.sensitivity(of, ask="balance", frequency="100 rad/s")


@pytest.mark.slow
def test_natural_modes() -> None:
    of = loaded(case(**{"model.cells_per_pitch": 16}), 20.0)
    found = derivatives(of, lambda there, answer: mode_results(there, answer, 2.0))
    assert set(found.values) == {name for mode in MODES[:2] for name in mode}
    modes = petalfoil.stability(of, mass=2.0)
    for number, (frequency, growth, damping) in enumerate(MODES[:2]):
        assert_allclose(found.values[frequency], float(modes["natural_frequency"][number]), rtol=1e-7)
        assert_allclose(found.values[growth], float(modes["mode_growth_rate"][number]), rtol=1e-4)
        assert_allclose(found.values[damping], float(modes["damping_ratio"][number]), rtol=1e-4)
    assert_solved_again(found, ("petals.thickness", "bearing.bushing_radius"))


def test_modes_need_a_mass() -> None:
    plain = case("plain_journal", **PLAIN)
    told = petalfoil.sensitivity(
        plain, "gas.viscosity", ask="stability", mass=2.0, of="natural_frequency_1, damping_ratio_1"
    )
    assert list(told["quantity"].values) == ["natural_frequency_1", "damping_ratio_1"]
    with pytest.raises(ConvergenceError, match="no derivative of natural modes"):
        petalfoil.sensitivity(plain, "gas.viscosity", ask="stability", of="natural_frequency_1")
