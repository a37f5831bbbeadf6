"""Motions on contact points of petals that rub on each other under a journal that drags them (D6), (D7), (M13)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil import orbit
from petalfoil.case import Case
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.system.build import build_problem
from petalfoil.system.point_friction import RubbingStepEquations
from petalfoil.system.time_step import StepProblem
from tests.contract.taylor import assert_tangent
from tests.verification.test_contact_points import shifted
from tests.verification.test_journal_rubbing import MU, rubbed, with_rubbed_points

Array = NDArray[np.float64]


def falling(**changes: object) -> Case:
    """A rotor that falls on petals nearly without a film."""
    return rubbed(rotor={"mass": 3.0}, model__cells_per_pitch=24, **changes)


def moved(bearing: Case, tolerance: float = 1e-4, revolutions: float = 0.1) -> xr.Dataset:
    """A motion, all of it with contact points."""
    found = orbit(bearing, revolutions=revolutions, tolerance=tolerance)
    assert float(found.point_share) == 1.0
    return found


def in_time(found: PointContacts, bearing_number: float) -> RubbingStepEquations:
    """The equations of a stage at an equilibrium, with friction forces that it does not have."""
    equations, rng = found.equations, np.random.default_rng(7)
    steady = equations.problem
    problem = StepProblem(steady.layout, bearing_number, steady.displacement, steady.bearing_number)
    pulls = 0.1 * equations.state.points.reaction * rng.uniform(-1.0, 1.0, len(equations.state.points.reaction))
    return RubbingStepEquations(equations.whole, problem, equations.state, friction_force=pulls)


def test_tangent_of_a_stage_with_both_frictions() -> None:
    """Remainders of second order in petals, pressures, reactions and places, of the rows and of the journal's force."""
    found, rng = with_rubbed_points(16), np.random.default_rng(2)
    equations = in_time(found, found.equations.problem.bearing_number)
    equations = replace(equations, problem=replace(equations.problem, rate=3.0, start=0.9 * equations.gas))
    points, free = equations.state.points, equations.travels
    direction = np.concatenate([
        rng.uniform(-0.02, 0.02, equations.whole.n_wall),
        rng.uniform(-0.1, 0.1, equations.whole.n_film),
        rng.uniform(-1.0, 1.0, len(points.reaction)) * points.reaction,
        rng.uniform(-0.3, 0.3, len(free)) * np.minimum(points.position % 1.0, 1.0 - points.position % 1.0) * free,
    ])  # fmt: skip
    away = shifted(equations, 0.01 * direction)
    assert_tangent(lambda t: np.concatenate(shifted(away, t * direction).residual), away.steady @ direction)
    assert_tangent(lambda t: shifted(away, t * direction).force, away.force_rows @ direction)


@pytest.mark.slow
def test_a_journal_that_does_not_turn_drags_nothing_in_time() -> None:
    """Rows and force are those of a journal whose rubbing is torque alone; turning they are not."""
    found = with_rubbed_points(16)
    still, turning = (in_time(found, number) for number in (0.0, found.equations.problem.bearing_number))
    torque = build_problem(rubbed(surface__journal_rubbing="torque", petals__theory="shell")).layout.elements
    assert torque is not None
    plain = replace(turning, whole=torque)
    assert_allclose(still.residual[0], plain.residual[0], atol=1e-12 * float(np.max(np.abs(still.wall_forces[2]))))
    assert_allclose(still.journal_force, plain.journal_force, rtol=1e-12)
    assert np.linalg.norm(turning.journal_force - plain.journal_force) > 0.1 * MU * np.linalg.norm(plain.journal_force)
    assert not np.any(still.rubbing[0])
    assert not np.any(still.rubbing[1])
    assert_allclose(plain.residual[0] - turning.residual[0], turning.rubbing[0], atol=1e-10)
    assert_allclose(turning.journal_force - plain.journal_force, turning.rubbing[1], atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("petal_friction", [0.0, 0.1])
def test_no_energy_is_missing(petal_friction: float) -> None:
    """What the rotor loses film, rubbing and friction have taken, and petals have stored (O6)."""
    bearing = falling(surface__petal_friction=petal_friction)
    coarse, fine = (moved(bearing, tolerance) for tolerance in (1e-3, 1e-5))
    assert float(fine.energy_balance_error) < 5e-5
    assert float(fine.energy_balance_error) < 0.5 * float(coarse.energy_balance_error)
    assert (float(fine.petal_friction_work[-1]) > 1e-7) is (petal_friction > 0.0)
    assert "contact_model_energy" not in fine


@pytest.mark.slow
def test_either_law_alone_is_the_limit_of_both() -> None:
    """Histories of the journal with a coefficient of one law that tends to zero."""
    for key in ("surface__petal_friction", "surface__friction_coefficient"):
        other = {"surface__petal_friction": 0.1} if key == "surface__friction_coefficient" else {}
        alone = {"surface__petal_friction": 0.0} if not other else {"surface__journal_rubbing": "torque", **other}
        little, none = moved(falling(**other, **{key: 1e-7})), moved(falling(**alone))
        both = moved(falling(surface__petal_friction=0.1))
        place = [np.array([float(one.x[-1]), float(one.y[-1])]) for one in (little, none, both)]
        assert np.linalg.norm(place[0] - place[1]) < 1e-3 * np.linalg.norm(place[2] - place[1])


@pytest.mark.slow
@pytest.mark.parametrize("petal_friction", [0.0, 0.1])
def test_a_rotor_stays_where_its_balance_is(petal_friction: float) -> None:
    """Within a picometre; with contacts at nodes the balance of contact points is none."""
    bearing = rubbed(rotor={"mass": 1.5}, model__cells_per_pitch=24, surface__petal_friction=petal_friction)
    found = orbit(bearing, initial="balance", revolutions=0.2)
    assert float(found.point_share) == 1.0
    assert float(found.contact_fraction[0]) > 0.1
    assert np.ptp(found.x.values) < 1e-12
    assert np.ptp(found.y.values) < 1e-12
