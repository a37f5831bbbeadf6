"""Contact pressures over asperities along a central path from the free shape."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.solve import solve
from petalfoil.equilibrium.asperity_contacts import AsperityContacts, with_asperities
from petalfoil.equilibrium.asperity_path import free_petals, from_free_petals, moved, petals_alone
from petalfoil.equilibrium.element_contacts import start_at
from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_ASPERITIES
from petalfoil.solvers.sparse_lu import Counter, LinearSolver
from petalfoil.system.softened_asperities import SoftenedAsperities
from tests.contract.taylor import assert_tangent
from tests.verification.random_answers import answer_of, random_pack

Array = NDArray[np.float64]


def residuals(path: SoftenedAsperities) -> Array:
    """Those of wall, film, slacks and products."""
    left = path.slack * path.pressure - path.product
    return np.concatenate([*path.residual, path.open_by.ravel(), left.ravel()])


def test_a_step_of_the_path_solves_its_linearised_equations() -> None:
    """Residuals fall in proportion to the length of the step, but for a remainder of second order."""
    whole, answer = answer_of(5)
    with running():
        path, _ = petals_alone(free_petals(whole, answer.problem))
    path = replace(path, product=0.5 * path.slack * path.pressure)
    tangent = ElementTangent.at(path, None, LinearSolver(Counter()))
    change, _ = tangent.correction(path.newton_residual, np.zeros(2))

    def along(t: float) -> Array:
        ahead, length = moved(path, t * change, 1.0)
        assert length == 1.0
        pressure, slack = path.change(path.whole.curves.by_w @ change[: whole.n_wall])
        return residuals(replace(ahead, pressure=path.pressure + t * pressure, slack=path.slack + t * slack))

    assert_tangent(along, -residuals(path), 2.0**-9)


@pytest.mark.slow
@pytest.mark.parametrize("number", [42, 69])
def test_the_path_ends_where_asperities_lead_from_contacts_at_nodes(number: int) -> None:
    """Two ways to one equilibrium; the path takes a half of the factorisations."""
    whole, answer = answer_of(number)
    with running() as run:
        path = from_free_petals(whole, answer.problem)
    with running() as other:
        near = with_asperities(whole, answer.problem, start_at(whole, answer))
    assert_allclose(path.equations.force, near.equations.force, rtol=1e-7)
    assert_allclose(path.equations.deflection, near.equations.deflection, atol=1e-7)
    assert run.film.factorizations <= min(26, other.film.factorizations)  # 20 and 21 when this was written


@pytest.mark.slow
def test_stiff_packs_are_nearer_to_fine_grids_than_contacts_at_nodes() -> None:
    """Pack 20: on 32 cells per pitch its force is off by 60 % with contacts at nodes, which need 256 cells to tell."""
    number = 20
    fine = solve.record(random_pack(number, **{"model.contacts": "nodes", "model.cells_per_pitch": 256})).scalars
    nodes, found = (solve.record(random_pack(number, **{"model.contacts": one})).scalars for one in ("nodes", "points"))
    assert found["contact_model"] == AT_ASPERITIES
    apart = [
        float(np.hypot(one["force_x"] - fine["force_x"], one["force_y"] - fine["force_y"])) for one in (nodes, found)
    ]
    force = float(np.hypot(fine["force_x"], fine["force_y"]))
    assert apart[0] >= 0.5 * force
    assert apart[1] <= 0.05 * force


@pytest.mark.slow
def test_other_equilibria_over_asperities_are_told() -> None:
    """Pack 88, led away by 0.3 of its displacement and back, has 8.7 N for 10.1; the answer tells of others."""
    case = random_pack(88)
    assert float(solve(case)["known_equilibria"]) >= 2.0
    with running():
        answer = operating_point(case, None).answer
        found = answer.elements
        assert isinstance(found, AsperityContacts)
        away = found.at(answer.problem.at(displacement=1.3 * answer.problem.displacement))
        other = away.at(answer.problem)
    assert other.residual <= 1e-8
    force = [float(np.linalg.norm(one.equations.force)) for one in (found, other)]
    assert abs(force[1] - force[0]) > 0.1 * force[0]
