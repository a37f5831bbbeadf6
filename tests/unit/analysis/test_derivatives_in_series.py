"""Derivatives at each point of a load characteristic and of a run-up, and questions that have none."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis import derivatives_in_series
from petalfoil.analysis.operating_point import OperatingPoint
from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.system.coupled import CoupledProblem
from tests.cases import case

PLAIN = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 16})


@pytest.mark.slow
def test_each_point_of_a_curve_has_the_derivatives_of_solve() -> None:
    paths, asked = "gas.viscosity, bearing.bushing_radius", "bearing_force, min_film_thickness"
    told = petalfoil.sensitivity(PLAIN, paths, ask="curve", displacements="5 um, 10 um", of=asked)
    assert list(told["place"].values) == ["e = 5 µm"] * 4 + ["e = 10 µm"] * 4
    for number, distance in enumerate((5e-6, 10e-6)):
        alone = petalfoil.sensitivity(PLAIN, paths, ask="solve", eccentricity=(0.0, -distance), of=asked)
        here = told.isel(point=slice(4 * number, 4 * number + 4))
        assert list(here["parameter"].values) == list(alone["parameter"].values)
        assert_allclose(here["derivative"], alone["derivative"], rtol=1e-6)


@pytest.mark.slow
def test_each_speed_of_a_run_up_has_the_derivatives_of_balance() -> None:
    of, asked = case(**{"model.cells_per_pitch": 12}), "min_film_thickness, friction_torque"
    speeds = "4000 rad/s, 8000 rad/s"
    told = petalfoil.sensitivity(of, "petals.thickness", ask="runup", load="20 N", speeds=speeds, of=asked)
    for number, speed in enumerate((4000.0, 8000.0)):
        alone = petalfoil.sensitivity(of, "petals.thickness", load="20 N", speed=speed, of=asked)
        here = told.isel(point=slice(2 * number, 2 * number + 2))
        assert_allclose(here["speed"], speed)
        assert_allclose(here["derivative"], alone["derivative"], rtol=1e-4)


def test_a_point_that_is_not_found_leaves_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    found = derivatives_in_series.point_after

    def lost_at_first(of: Case, problem: CoupledProblem, before: Solution | None, *, leads: bool) -> OperatingPoint:
        if of.operation.eccentricity == (0.0, -5e-6):
            raise ConvergenceError("lost")
        return found(of, problem, before, leads=leads)

    monkeypatch.setattr(derivatives_in_series, "point_after", lost_at_first)
    told = petalfoil.sensitivity(PLAIN, "gas.viscosity", ask="curve", displacements="5 um, 10 um", of="bearing_force")
    assert list(told["converged"].values) == [False, True]
    assert str(told["status"].values[0]).startswith("not converged: lost")
    assert list(told["place"].values) == ["e = 5 µm", "e = 10 µm"]


def test_what_has_no_derivatives_says_why() -> None:
    with pytest.raises(UsageError, match="orbit has no derivatives: its results are extremes of a motion"):
        petalfoil.sensitivity(PLAIN, ask="orbit")
    with pytest.raises(UsageError, match="curve is asked for at several points: give --displacements"):
        petalfoil.sensitivity(PLAIN, ask="curve")
    with pytest.raises(UsageError, match="--speeds are the points of `runup`: solve has none"):
        petalfoil.sensitivity(PLAIN, ask="solve", speeds="100 rad/s, 200 rad/s")
    rubbing = case(**{"model.cells_per_pitch": 8, "surface.petal_friction": 0.1})
    with pytest.raises(UsageError, match="a run-up keeps the friction forces that petals gather on the way"):
        petalfoil.sensitivity(rubbing, ask="runup", load="20 N", speeds="4000 rad/s, 8000 rad/s")
