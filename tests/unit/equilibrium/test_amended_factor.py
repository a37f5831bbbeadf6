"""One factor for other contact points: the same solutions as with a factor of their own, and when it is given up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.operating_point import operating_point
from petalfoil.equilibrium import amended_factor
from petalfoil.equilibrium.amended_factor import AmendedFactor, NodalAnswers, ServedTangent, ServingFactor
from petalfoil.equilibrium.contact_sets import TravellingContact, listed, packed
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import running
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.near_factor import PRECISE
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.point_equations import PointEquations
from tests.cases import case


@pytest.fixture(scope="module")
def known() -> PointEquations:
    """Ten petals, which touch along stretches, at 200 um."""
    changes = {"model.cells_per_pitch": 32, "operation.eccentricity": (0.0, -200e-6)}
    with running():
        found = operating_point(case("paper_n10", **changes), None).answer.elements
    assert isinstance(found, PointContacts)
    assert found.points.inner.any()
    return found.equations


def with_points(equations: PointEquations, points: ContactPoints) -> PointEquations:
    return replace(equations, state=replace(equations.state, points=points))


def others(equations: PointEquations) -> PointEquations:
    """Some points farther along by up to an element and a half, one gone, one more."""
    contacts = listed(equations.state.points)
    alone = [k for k, one in enumerate(contacts) if not one.inner and one.position > 2.0 and not contacts[k - 1].inner]
    for k in alone[1::2]:
        contacts[k].position -= 1.5
    gone, twin = contacts[alone[0]], contacts[alone[1]]
    contacts.remove(gone)
    return with_points(
        equations, packed([*contacts, TravellingContact(twin.curve, twin.position - 0.4, 0.3 * twin.reaction, [])])
    )


@pytest.mark.parametrize("travelled", [0.0, 0.05])
def test_other_points_are_solved_with_the_same_factor(known: PointEquations, travelled: float) -> None:
    """Also where the journal has moved, so that the film is another."""
    solver, here = LinearSolver(), others(known)
    e = here.problem.displacement
    here = replace(here, problem=here.problem.at(displacement=e + travelled))
    amended = AmendedFactor.of(NodalAnswers.of(known, solver.factor(known.steady)), here)
    rhs = np.random.default_rng(1).standard_normal((here.n, 2))
    J = here.steady.toarray()
    for found, exact in (
        (amended.solve(rhs), np.linalg.solve(J, rhs)),
        (amended.solve_transposed(rhs[:, 0]), np.linalg.solve(J.T, rhs[:, 0])),
    ):
        assert_allclose(found, exact, rtol=0.0, atol=10.0 * PRECISE * np.linalg.norm(exact))
    if not travelled:  # the border alone differs: no GMRES is needed
        exact = np.linalg.solve(J, rhs[:, 0])
        assert_allclose(amended.nearly(rhs[:, 0]), exact, rtol=0.0, atol=1e-7 * np.linalg.norm(exact))
    assert solver.counter.factorizations == 1


def test_states_are_served_by_one_factor_until_it_is_too_far_away(known: PointEquations) -> None:
    serving = ServingFactor(LinearSolver(), 0)
    served = [serving.tangent(one, None) for one in (known, others(known), known)]
    for tangent in served:
        assert isinstance(tangent.factor, ServedTangent)
        change = tangent.factor.solve(np.ones(tangent.n))
        assert np.max(np.abs(tangent.equations.steady @ change - 1.0)) <= 1e-2
    assert serving.solver.counter.factorizations == 1
    far = replace(known, problem=known.problem.at(bearing_number=50.0 * known.problem.bearing_number))
    serving.tangent(far, None).factor.solve(np.ones(far.n))
    assert serving.solver.counter.factorizations == 2


def test_the_first_states_may_have_factors_of_their_own(known: PointEquations) -> None:
    serving = ServingFactor(LinearSolver(), 2)
    for _ in range(4):
        serving.tangent(known, None)
    assert serving.solver.counter.factorizations == 2


def test_states_close_by_are_spared_a_factor_of_their_own(known: PointEquations) -> None:
    """Where the contacts are the same; others, and points that have travelled far, have one."""
    sparing, points = ServingFactor(LinearSolver(), 3, sparing=True), known.state.points
    near, far = (with_points(known, replace(points, position=points.position + part)) for part in (1e-3, 0.9))
    rhs = np.random.default_rng(1).standard_normal(known.n)
    sparing.tangent(known, None)
    served = sparing.tangent(near, None).factor
    assert isinstance(served, ServedTangent)
    for found, matrix in ((served.solve(rhs), near.steady), (served.solve_transposed(rhs), near.steady.T)):
        exact = np.linalg.solve(matrix.toarray(), rhs)
        assert_allclose(found, exact, rtol=0.0, atol=10.0 * PRECISE * np.linalg.norm(exact))
    assert sparing.solver.counter.factorizations == 1
    sparing.tangent(far, None)
    assert sparing.solver.counter.factorizations == 2
    sparing.tangent(others(known), None)
    assert sparing.solver.counter.factorizations == 3


def test_too_many_nodal_loads_ask_for_another_factor(known: PointEquations, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(amended_factor, "MOST_LOADS", 3)
    serving = ServingFactor(LinearSolver(), 0)
    for _ in range(2):
        serving.tangent(known, None)
    assert serving.solver.counter.factorizations == 2
