"""The adjoint of an equilibrium beside its tangent: the same derivatives, from one solve for each result."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.adjoint import AdjointDerivatives
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.derivatives import DerivativesOf, equilibrium_results
from petalfoil.analysis.operating_point import at_position, under_load
from petalfoil.analysis.result_gradients import GRADIENTS
from petalfoil.case import Case
from petalfoil.equilibrium.element_rates import ElementValues, element_rate
from petalfoil.equilibrium.run_context import RunContext
from tests.cases import case
from tests.random_packs import random_case

SAME = 1e-12
"""Agreement with the tangent for the same derivatives of equations and result, over the sum of the magnitudes."""

BEARINGS: dict[str, tuple[Case, float | None]] = {
    "points at a position": (case(**{"model.cells_per_pitch": 16}), None),
    "points under a load": (case(**{"model.cells_per_pitch": 16}), 20.0),
    "nodes under a load": (case(**{"model.cells_per_pitch": 8, "model.contacts": "nodes"}), 20.0),
    "plain journal under a load": (
        case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4}),
        15.0,
    ),
    "asperities": (random_case(np.random.default_rng(2), **{"model.cells_per_pitch": 16}), None),
    "3-D at a position": (case("paper_n8_spatial", **{"model.cells_per_pitch": 8, "model.axial_cells": 4}), None),
}
PATHS = ("gas.viscosity", "bearing.bushing_radius", "operation.speed")
IN_PETALS = ("petals.thickness", "petals.bend_radius")


def tangent_of(name: str) -> DerivativesOf:
    """Derivatives of one of the bearings by its tangent."""
    of, load = BEARINGS[name]
    if load is not None:
        of = of.replace(**{"operation.load": (0.0, -load), "operation.eccentricity": (0.0, 0.0)})
    found = at_position(of).answer if load is None else under_load(of, (0.0, -load))[0]
    found = reported(of, found)
    return DerivativesOf(of, found, equilibrium_results, as_points=found.elements is not None)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in ("points under a load", "nodes under a load") else pytest.mark.slow)
        for name in BEARINGS
    ],
)
def test_adjoint_and_tangent_are_transposes(name: str) -> None:
    tangent = tangent_of(name)
    adjoint = AdjointDerivatives.of_all(tangent)
    told = tangent.told
    variation = tangent.variation("bearing.bushing_radius")
    rates = adjoint.rates(variation)
    if told.elements is not None:
        assert isinstance(rates, ElementValues)
        moved = element_rate(told.elements, tangent.smooth.held_elements, rates)
        change, lam, displacement = moved.change, np.zeros(0), moved.displacement
    else:
        rate = tangent.held.respond(rates)
        change, lam, displacement = rate.x, rate.lam, rate.displacement
    displacement = displacement if told.load is not None else np.zeros_like(displacement)
    assert (
        len(adjoint.names) >= len(GRADIENTS) - 3
    )  # all, but the minimum film where contact keeps it, and torque at rest
    for result in adjoint.names:
        by_state = adjoint.gradient(result)
        parts = (by_state.residual * change, by_state.gaps * lam, by_state.force * displacement)
        size = sum(float(np.sum(np.abs(part))) for part in parts)
        by_tangent = sum(float(np.sum(part)) for part in parts)
        weights = adjoint.weights(result)
        size = max(size, float(np.sum(np.abs(weights.residual * rates.residual))))
        assert_allclose(weights.of(rates), by_tangent, rtol=0.0, atol=SAME * size, err_msg=result)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["points under a load", "asperities", "plain journal under a load", "3-D at a position"]
)
def test_derivatives_by_both(name: str) -> None:
    tangent = tangent_of(name)
    adjoint = AdjointDerivatives.of_all(tangent)
    paths = {"asperities": IN_PETALS[:1], "plain journal under a load": PATHS}.get(name, PATHS + IN_PETALS)
    for path in paths:
        by_tangent, by_adjoint = tangent.by(path), adjoint.by(path)
        for result, value in by_adjoint.above.items():
            size = max(abs(each) for each in by_tangent.above.values()) if "force" in result else 0.0
            size = max(size, abs(by_tangent.above[result]), abs(tangent.values[result]) / tangent.variation(path).size)
            assert_allclose(value, by_tangent.above[result], rtol=0.0, atol=1e-5 * size, err_msg=f"{result} by {path}")


@pytest.mark.slow
def test_one_solve_for_each_result(run: RunContext) -> None:
    tangent = tangent_of("points under a load")
    adjoint = AdjointDerivatives(tangent, ["bearing_force", "min_film_thickness"])
    assert tangent.smooth.held_elements.units.shape[1] == 2  # solved for with the factor, whatever is asked
    before = run.probes.solves, run.probes.factorizations
    for path in PATHS:
        adjoint.by(path)
    solves = run.probes.solves - before[0]
    assert 2 <= solves <= 2 * 2  # one for each, another where the factor has lost digits
    for path in PATHS:
        tangent.by(path)
    assert len(PATHS) <= run.probes.solves - before[0] - solves <= 2 * len(PATHS)
    assert run.probes.factorizations == before[1]


@pytest.mark.slow
def test_what_has_no_adjoint_comes_by_the_tangent_and_says_so() -> None:
    of, path = case(**{"model.cells_per_pitch": 8}), "gas.viscosity"
    stress, torque = "max_bending_stress", "friction_torque"
    by_tangent, by_adjoint = (
        petalfoil.sensitivity(of, path, of=f"{stress}, {torque}", method=method).to_dataframe().set_index("quantity").T
        for method in ("tangent", "adjoint")
    )
    assert by_adjoint[stress]["status"] == "converged; no adjoint of this result: by the tangent"
    assert by_adjoint[stress]["derivative"] == by_tangent[stress]["derivative"]
    assert by_adjoint[torque]["status"] == "converged"
    assert_allclose(by_adjoint[torque]["derivative"], by_tangent[torque]["derivative"], rtol=1e-5)


def test_a_question_without_adjoints_is_answered_by_the_tangent() -> None:
    plain = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
    found = [
        petalfoil.sensitivity(plain, "gas.viscosity", ask="coefficients", of="stiffness_yy", method=method)
        for method in ("tangent", "adjoint")
    ]
    assert float(found[0]["derivative"][0]) == float(found[1]["derivative"][0])
    assert "by the tangent" in str(found[1]["status"].values[0])


@pytest.mark.slow
def test_the_lift_off_speed_by_both() -> None:
    of = case("plain_journal", **{"model.cells_per_pitch": 12, "model.axial_cells": 4})
    paths = "gas.viscosity, bearing.bushing_radius"
    of = of.replace(**{"operation.speed": 3000.0})
    found = [
        petalfoil.sensitivity(of, paths, ask="balance", load="15 N", of="friction_torque", method=method)
        for method in ("tangent", "adjoint")
    ]
    assert_allclose(found[1]["derivative"], found[0]["derivative"], rtol=1e-6)
    assert (int(found[0]["derivative_solves"][0]), int(found[1]["derivative_solves"][0])) == (
        4,
        3,
    )  # two for the position
    petals = case(**{"model.cells_per_pitch": 16})
    by_both = [
        petalfoil.sensitivity(petals, "gas.viscosity", ask="liftoff", load="30 N", method=method)
        for method in ("tangent", "adjoint")
    ]
    assert_allclose(by_both[1]["derivative"], by_both[0]["derivative"], rtol=1e-5)
